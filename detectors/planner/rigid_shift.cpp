#include "detectors/planner/rigid_shift.hpp"

#include "detectors/planner/lane_stretch.hpp"
#include "model/geometry.hpp"

namespace conelane {
namespace {

double median(std::vector<double>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::ranges::nth_element(values, middle);
    return *middle;
}

Point median_step(std::span<const PlacePair> pairs) {
    std::vector<double> x_m;
    std::vector<double> y_m;
    for (const PlacePair& pair : pairs) {
        x_m.push_back(pair.seen.x() - pair.remembered.x());
        y_m.push_back(pair.seen.y() - pair.remembered.y());
    }
    return {median(x_m), median(y_m)};
}

/// Least squares.
RigidShift fitted(std::span<const PlacePair> pairs) {
    Point from{0.0, 0.0};
    Point to{0.0, 0.0};
    for (const PlacePair& pair : pairs) {
        from += pair.remembered;
        to += pair.seen;
    }
    const auto count = static_cast<double>(pairs.size());
    from /= count;
    to /= count;
    double along = 0.0;
    double across = 0.0;
    for (const PlacePair& pair : pairs) {
        along += (pair.remembered - from).dot(pair.seen - to);
        across += cross(pair.remembered - from, pair.seen - to);
    }
    return {from, std::atan2(across, along), to - from};
}

}  // namespace

Point RigidShift::operator()(const Point& point) const {
    const Point arm = point - about;
    const double c = std::cos(turn_rad);
    const double s = std::sin(turn_rad);
    return about + by + Point(c * arm.x() - s * arm.y(), s * arm.x() + c * arm.y());
}

void move(std::span<DrivablePoint> points, const RigidShift& shift) {
    for (DrivablePoint& point : points) {
        point.position = shift(point.position);
        point.heading_rad = turn_rad(0.0, point.heading_rad + shift.turn_rad);
    }
}

std::optional<RigidShift> common_shift(std::span<const PlacePair> pairs, const ShiftSettings& settings) {
    if (pairs.size() < settings.min_cones) return std::nullopt;
    RigidShift shift{{0.0, 0.0}, 0.0, median_step(pairs)};
    std::vector<PlacePair> inliers;
    // A turn moves far cones farther: the second round takes those in.
    for (const double slack : {2.0, 1.0}) {
        inliers.clear();
        for (const PlacePair& pair : pairs) {
            if ((shift(pair.remembered) - pair.seen).norm() <= slack * settings.inlier_m)
                inliers.push_back(pair);
        }
        if (inliers.size() < settings.min_cones) return std::nullopt;
        shift = fitted(inliers);
    }
    const double share = static_cast<double>(inliers.size()) / static_cast<double>(pairs.size());
    if (share < settings.min_share || shift.by.norm() < settings.min_shift_m) return std::nullopt;
    return shift;
}

std::optional<RigidShift> common_shift(std::span<const Point> remembered, std::span<const Point> seen,
                                       const ShiftSettings& settings) {
    if (seen.size() < settings.min_cones) return std::nullopt;
    struct Reach {
        std::size_t seen;
        Point by;
    };
    std::vector<Reach> steps;
    for (std::size_t i = 0; i < seen.size(); ++i) {
        for (const Point& place : remembered) {
            const Point by = seen[i] - place;
            if (by.squaredNorm() <= settings.reach_m * settings.reach_m) steps.push_back({i, by});
        }
    }
    const auto brought = [&](const Point& by) {
        std::size_t count = 0;
        std::size_t last = seen.size();
        for (const Reach& step : steps) {  // in the order of the seen cones: each counts once
            if (step.seen == last || (step.by - by).norm() > settings.inlier_m) continue;
            last = step.seen;
            ++count;
        }
        return count;
    };
    const std::size_t unmoved = brought({0.0, 0.0});
    std::size_t most = unmoved;
    Point best{0.0, 0.0};
    for (const Reach& step : steps) {
        const std::size_t count = brought(step.by);
        if (count > most || (count == most && step.by.squaredNorm() < best.squaredNorm())) {
            most = count;
            best = step.by;
        }
    }
    const auto needed = static_cast<std::size_t>(settings.min_share * static_cast<double>(seen.size()));
    if (most < std::max({settings.min_cones, needed, unmoved + unmoved / 3 + 1})) return std::nullopt;
    Point mean{0.0, 0.0};
    std::size_t count = 0;
    for (const Reach& step : steps) {
        if ((step.by - best).norm() > settings.inlier_m) continue;
        mean += step.by;
        ++count;
    }
    mean /= static_cast<double>(count);
    if (mean.norm() < settings.min_shift_m) return std::nullopt;
    return RigidShift{{0.0, 0.0}, 0.0, mean};
}

}  // namespace conelane
