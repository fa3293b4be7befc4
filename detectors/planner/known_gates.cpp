#include "detectors/planner/known_gates.hpp"

#include <array>

namespace conelane {
namespace {

constexpr double kReach_m = 7.0;  ///< the lines are this near to where they are expected
constexpr double kStep_m = 0.25;
constexpr double kAlong_m = 0.85;        ///< cones of a gate are this near to its middle
constexpr double kInside_m = 0.5;        ///< of the boundary
constexpr double kOutside_m = 0.8;       ///< big cones may stand farther outside
constexpr double kColor = 0.25;          ///< of a cone: gained by orange, lost by blue or yellow
constexpr double kKept = 0.93;           ///< from frame to frame: the map may have moved
constexpr double kMinBearing_rad = 0.7;  ///< that every car sees
constexpr double kMinWeight = 1.5;       ///< two frames
constexpr double kViewKept = 0.995;      ///< of range and bearing, from frame to frame

// Log likelihoods.
constexpr double kStartSigma_m = 1.6;  ///< of the start line where no gate has been seen
constexpr double kPerStartCone = 2.0;
constexpr double kPerFinishCone = 4.0;
constexpr double kUndecidedCones = 3.0;  ///< speak neither for a gate nor against it
constexpr double kMinCones = 1.5;        ///< fewer say no more
constexpr double kDrift_m = 0.75;        ///< of the map between start and finish
constexpr double kSeenCones = 2.6;

double square(double value) {
    return value * value;
}

}  // namespace

bool GateEvidence::Place::is_known() const {
    return weight >= kMinWeight;
}

GateEvidence::GateEvidence(double finish_m) : finish_m_(finish_m) {
    const int steps = static_cast<int>(std::lround(kReach_m / kStep_m));
    for (int i = -steps; i <= steps; ++i) {
        start_.push_back({i * kStep_m});
        finish_.push_back({finish_m + i * kStep_m});
    }
}

void GateEvidence::observe(const Registration& registration, const Frame& frame, const SeenView& seen) {
    range_m_ = std::max(seen.range_m, kViewKept * range_m_);
    bearing_rad_ = std::max({seen.bearing_rad, kViewKept * bearing_rad_, kMinBearing_rad});
    const SeenView view{seen.pose, range_m_, bearing_rad_};
    struct OnBoundary {
        double x_m;
        std::size_t side;
        ConeColor color;
    };
    const double half_m = kKnownHalfWidth_m + registration.widening_m;
    std::vector<OnBoundary> cones;
    for (const Cone& cone : frame.cones) {
        const Point place = registration.to_course(cone.position);
        const double outside_m = std::abs(place.y()) - half_m;
        if (outside_m < -kInside_m || outside_m > kOutside_m) continue;
        cones.push_back({place.x(), place.y() > 0.0 ? 0U : 1U, cone.color});
    }
    for (std::vector<Place>* places : {&start_, &finish_}) {
        for (Place& place : *places) {
            if (!view.covers(registration.to_map({place.x_m, half_m})) ||
                !view.covers(registration.to_map({place.x_m, -half_m}))) {
                continue;
            }
            std::array<double, 2> count{};
            double color = 0.0;
            double sum_m = 0.0;
            int all = 0;
            for (const OnBoundary& cone : cones) {
                const double off_m = cone.x_m - place.x_m;
                if (std::abs(off_m) > kAlong_m) continue;
                count[cone.side] = std::min(count[cone.side] + 1.0, 2.0);
                if (is_orange(cone.color)) color += kColor;
                if (cone.color == ConeColor::blue || cone.color == ConeColor::yellow) color -= kColor;
                sum_m += off_m;
                ++all;
            }
            place.cones = kKept * place.cones + std::clamp(count[0] + count[1] + color, 0.0, 4.5);
            place.weight = kKept * place.weight + 1.0;
            place.off_m = kKept * place.off_m + (all > 0 ? sum_m / all : 0.0);
        }
    }
    decide();
}

void GateEvidence::decide() {
    const auto speaks = [](const Place& place, double per_cone) {
        if (!place.is_known()) return 0.0;
        // A gate whose middle is elsewhere is better explained from there.
        const double aside = square(place.off_m / place.weight / kAlong_m);
        return per_cone * (std::max(place.mean_cones() - aside, kMinCones) - kUndecidedCones);
    };
    const auto reach = static_cast<std::size_t>(std::lround(kDrift_m / kStep_m));
    double best = -std::numeric_limits<double>::infinity();
    std::size_t chosen = 0;
    std::size_t chosen_start = 0;
    for (std::size_t i = 0; i < start_.size(); ++i) {
        double total = -0.5 * square(start_[i].x_m / kStartSigma_m) + speaks(finish_[i], kPerFinishCone);
        double at_start = -std::numeric_limits<double>::infinity();
        std::size_t nearby = i;
        for (std::size_t k = i - std::min(i, reach); k <= std::min(i + reach, start_.size() - 1); ++k) {
            const double apart_m = start_[k].x_m - start_[i].x_m;
            const double log_likelihood =
                speaks(start_[k], kPerStartCone) - 0.5 * square(apart_m / (0.5 * kDrift_m));
            if (log_likelihood <= at_start) continue;
            at_start = log_likelihood;
            nearby = k;
        }
        total += at_start;
        if (total <= best) continue;
        best = total;
        chosen = i;
        chosen_start = nearby;
    }
    const auto is_gate = [](const Place& place) {
        return place.is_known() && place.mean_cones() >= kSeenCones;
    };
    has_seen_finish_ = is_gate(finish_[chosen]);
    if (has_seen_finish_) {
        start_line_m_ = finish_[chosen].x_m + finish_[chosen].off_m / finish_[chosen].weight - finish_m_;
    } else if (is_gate(start_[chosen_start])) {
        start_line_m_ = start_[chosen_start].x_m + start_[chosen_start].off_m / start_[chosen_start].weight;
    } else {
        start_line_m_ = start_[chosen].x_m;
    }
}

}  // namespace conelane
