#include "evaluation/scoring/calibration.hpp"

#include "evaluation/scoring/statistics.hpp"

#include <algorithm>
#include <cmath>

namespace conelane {

void Calibration::add(double confidence, bool is_usable) {
    const auto place = static_cast<std::size_t>(confidence * static_cast<double>(kBins));
    Bin& bin = bins_[std::min(place, kBins - 1)];
    ++bin.lanes;
    bin.confidence += confidence;
    ++lanes_;
    if (is_usable) ++bin.usable;
    if (confidence < kSure) return;
    ++sure_;
    if (is_usable) ++usable_where_sure_;
}

void Calibration::add_trust(double trusted_m, double lane_length_m, std::optional<double> divergence_m) {
    ++with_trust_;
    if (!divergence_m || *divergence_m >= trusted_m) ++right_where_trusted_;
    trusted_m_ += std::min(trusted_m, lane_length_m);
    length_m_ += lane_length_m;
}

std::optional<double> Calibration::error() const {
    if (lanes_ == 0) return std::nullopt;
    double sum = 0.0;
    for (const Bin& bin : bins_) sum += std::abs(bin.confidence - static_cast<double>(bin.usable));
    return sum / static_cast<double>(lanes_);
}

std::optional<double> Calibration::usable_where_sure() const {
    return share(usable_where_sure_, sure_);
}

std::optional<double> Calibration::sure() const {
    return share(sure_, lanes_);
}

std::optional<double> Calibration::right_where_trusted() const {
    return share(right_where_trusted_, with_trust_);
}

std::optional<double> Calibration::trusted_share() const {
    if (length_m_ <= 0.0) return std::nullopt;
    return trusted_m_ / length_m_;
}

}  // namespace conelane
