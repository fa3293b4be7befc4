#include "graph_search/ranking.hpp"

#include "graph_search/lane_width.hpp"
#include "model/invalid_input.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

namespace conelane {
namespace {

/// Candidates that go through the network at once, so that what is between the layers stays in the cache.
constexpr Eigen::Index kBatch = 64;

class RankNet final : public LaneRanking {
  public:
    explicit RankNet(const RankNetWeights& weights)
        : weights_(weights),
          mean_(Eigen::Map<const Eigen::Array<double, 8, 1>>(weights.mean.data())),
          deviation_(Eigen::Map<const Eigen::Array<double, 8, 1>>(weights.deviation.data())) {}

    void score(std::span<const LaneFeatures> lanes, std::span<double> scores) const override {
        assert(lanes.size() == scores.size());
        Eigen::Matrix<float, 8, Eigen::Dynamic> inputs(8, kBatch);
        Eigen::MatrixXf units(weights_.hidden.rows(), kBatch);
        const auto count = static_cast<Eigen::Index>(lanes.size());
        for (Eigen::Index first = 0; first < count; first += kBatch) {
            const Eigen::Index batch = std::min(kBatch, count - first);
            for (Eigen::Index i = 0; i < batch; ++i) {
                const LaneFeatures& lane = lanes[static_cast<std::size_t>(first + i)];
                const Eigen::Map<const Eigen::Array<double, 8, 1>> features(lane.data());
                inputs.col(i) = ((features - mean_) / deviation_).cast<float>();
            }
            units.leftCols(batch).noalias() = weights_.hidden * inputs.leftCols(batch);
            units.leftCols(batch).colwise() += weights_.hidden_bias;
            for (Eigen::Index i = 0; i < batch; ++i) {
                scores[static_cast<std::size_t>(first + i)] =
                    weights_.output.dot(units.col(i).cwiseMax(0.0F)) + weights_.output_bias;
            }
        }
    }

  private:
    RankNetWeights weights_;
    Eigen::Array<double, 8, 1> mean_;
    Eigen::Array<double, 8, 1> deviation_;
};

}  // namespace

double Moments::variance() const {
    if (count == 0.0) return 0.0;
    const double mean = sum / count;
    return std::max(0.0, sum_of_squares / count - mean * mean);
}

LaneFeatures lane_features(std::span<const Point> left, std::span<const Point> right, bool closed) {
    LaneFeatures features{};
    const std::array<std::span<const Point>, 2> boundaries{left, right};
    const LaneWidths widths = lane_widths(left, right, closed);
    Moments width;
    for (const Side side : {kLeft, kRight}) {
        for (const double width_m : widths.of_vertex_m[side]) width.add(width_m);
        for (const double width_m : widths.of_segment_m[side]) width.add(width_m);

        const std::span<const Point> boundary = boundaries[side];
        std::vector<Point> segments;
        for (std::size_t i = 1; i < boundary.size(); ++i) segments.push_back(boundary[i] - boundary[i - 1]);
        if (closed) segments.emplace_back(boundary.front() - boundary.back());
        Moments length;
        Moments turn;
        for (const Point& segment : segments) length.add(segment.norm());
        for (std::size_t i = 1; i < segments.size(); ++i) {
            turn.add(turning_angle(segments[i - 1], segments[i]));
        }
        if (closed) turn.add(turning_angle(segments.back(), segments.front()));
        features[0] += length.sum / 2.0;
        features[1 + side] = static_cast<double>(boundary.size());
        features[4 + side] = length.variance();
        features[6 + side] = turn.variance();
    }
    features[3] = width.variance();
    return features;
}

std::shared_ptr<const LaneRanking> make_rank_net(const RankNetWeights& weights) {
    const auto require = [](bool valid, const char* key, const char* reason) {
        if (!valid) throw InvalidInput(key, reason);
    };
    require(weights.hidden.rows() > 0, "hidden", "must have at least one unit");
    require(weights.hidden_bias.size() == weights.hidden.rows(), "hidden_bias", "must have one entry a unit");
    require(weights.output.size() == weights.hidden.rows(), "output", "must have one entry a unit");
    require(weights.hidden.allFinite(), "hidden", "must be finite");
    require(weights.hidden_bias.allFinite(), "hidden_bias", "must be finite");
    require(weights.output.allFinite(), "output", "must be finite");
    require(std::isfinite(weights.output_bias), "output_bias", "must be finite");
    for (std::size_t i = 0; i < weights.mean.size(); ++i) {
        require(std::isfinite(weights.mean[i]), "mean", "must be finite");
        require(std::isfinite(weights.deviation[i]) && weights.deviation[i] > 0.0, "deviation",
                "must be positive");
    }
    return std::make_shared<RankNet>(weights);
}

}  // namespace conelane
