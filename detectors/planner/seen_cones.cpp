#include "detectors/planner/seen_cones.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace conelane {
namespace {

constexpr double kSameCone_m = 0.45;
constexpr int kAveragedSightings = 20;
constexpr double kForgotten_s = 3.0;
constexpr std::size_t kMaxCones = 600;
constexpr double kMaxDistance_m = 45.0;  ///< cones of a map that are farther from the car are left out
constexpr double kSureShare = 0.8;       ///< of range and bearing: a cone within is in view
constexpr double kBlind_m = 2.0;

}  // namespace

bool SeenView::covers(const Point& place) const {
    const double ahead_m = pose.ahead_m(place);
    const double left_m = pose.left_m(place);
    const double distance_m = std::hypot(ahead_m, left_m);
    return distance_m > kBlind_m && distance_m < kSureShare * range_m &&
           std::abs(std::atan2(left_m, ahead_m)) < kSureShare * bearing_rad;
}

SeenView view_of(const Frame& frame) {
    SeenView view{frame.pose};
    for (const Cone& cone : frame.cones) {
        const double ahead_m = frame.pose.ahead_m(cone.position);
        const double left_m = frame.pose.left_m(cone.position);
        view.range_m = std::max(view.range_m, std::hypot(ahead_m, left_m));
        view.bearing_rad = std::max(view.bearing_rad, std::abs(std::atan2(left_m, ahead_m)));
    }
    return view;
}

void SeenCones::observe(const Frame& frame) {
    std::erase_if(cones_, [&](const SeenCone& cone) { return cone.last_s < frame.time_s - kForgotten_s; });
    for (const Cone& cone : frame.cones) {
        if (!((cone.position - frame.pose.position).norm() < kMaxDistance_m)) continue;
        SeenCone* same = nullptr;
        double nearest_m = kSameCone_m;
        for (SeenCone& seen : cones_) {
            const double distance_m = (seen.position - cone.position).norm();
            if (distance_m >= nearest_m) continue;
            nearest_m = distance_m;
            same = &seen;
        }
        if (same == nullptr) {
            if (cones_.size() < kMaxCones) cones_.push_back({cone.position, cone.color, 1, frame.time_s});
            continue;
        }
        same->sightings = std::min(same->sightings + 1, kAveragedSightings);
        same->position += (cone.position - same->position) / same->sightings;
        if (cone.color != ConeColor::unknown) same->color = cone.color;
        same->last_s = frame.time_s;
    }
}

}  // namespace conelane
