#include "detectors/planner/boundary_memory.hpp"

#include "detectors/planner/lane_stretch.hpp"
#include "model/geometry.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

namespace conelane {
namespace {

constexpr double kBehind_m = 6.0;      ///< of the car: cones farther back are forgotten
constexpr double kBeside_m = 1.0;      ///< outside a lane, a cone is still of its boundary
constexpr double kLongest_m = 5.8;     ///< from cone to cone; 5 m by the rules, and noise
constexpr double kShortest_m = 0.5;    ///< nearer cones are one cone twice
constexpr double kLargestRatio = 2.5;  ///< of successive distances
constexpr double kUsualRatio = 1.5;
constexpr double kLargestTurn_rad = 1.0;
constexpr double kLargestTurnOver_rad = 0.5;
constexpr double kStraight_rad = 0.2;  ///< a boundary that turns less is straight
constexpr std::size_t kMaxContinued = 12;
constexpr int kMinAhead = 2;
constexpr int kLately_frames = 2;  ///< a cone in view may be missed once

/// Puts the cones of a newer lane into those known before. What was known beyond both ends stays, if the two
/// meet there.
void merge(std::vector<ConeId>& known, const std::vector<ConeId>& seen) {
    if (seen.empty()) return;
    const auto is_seen = [&](ConeId id) { return std::ranges::find(seen, id) != seen.end(); };
    const auto first = std::ranges::find_if(known, is_seen);
    std::vector<ConeId> merged(known.begin(), first);
    merged.insert(merged.end(), seen.begin(), seen.end());
    const auto last = std::ranges::find(known, seen.back());
    if (last != known.end()) {
        std::copy_if(last + 1, known.end(), std::back_inserter(merged),
                     [&](ConeId id) { return !is_seen(id); });
    }
    known = std::move(merged);
}

bool has(const std::vector<ConeId>& ids, ConeId id) {
    return std::ranges::find(ids, id) != ids.end();
}

/// The cone of the scene that continues a boundary: near and straight on; null if there is none.
const Cone* continuation(const Scene& scene, const Point& before, const Point& last,
                         const std::vector<ConeId>& own, const std::vector<ConeId>& other) {
    const Cone* best = nullptr;
    const double longest_m = std::min(kLongest_m, kLargestRatio * (last - before).norm());
    double least_m = std::numeric_limits<double>::infinity();
    for (const Cone& cone : scene.cones) {
        const Point step = cone.position - last;
        const double length_m = step.norm();
        if (length_m < kShortest_m || length_m > longest_m) continue;
        const double turn_rad = std::abs(turning_angle(last - before, step));
        // A longer step than the last one steps over a missed cone, or to another boundary.
        const bool is_longer = length_m > kUsualRatio * (last - before).norm();
        if (turn_rad > (is_longer ? kLargestTurnOver_rad : kLargestTurn_rad) || has(own, cone.id) ||
            has(other, cone.id))
            continue;
        if (length_m * (1.0 + turn_rad) >= least_m) continue;
        least_m = length_m * (1.0 + turn_rad);
        best = &cone;
    }
    return best;
}

}  // namespace

void BoundaryMemory::learn(const Lane& lane, const DrivableLane& path, const ConeMemory& cones) {
    const double trusted_m = path.trusted_m.value_or(0.0);
    for (const std::size_t side : {0U, 1U}) {
        std::vector<ConeId> trusted;
        for (const ConeId id : side == 0 ? lane.left : lane.right) {
            const ConeMemory::RememberedCone* const cone = cones.find(id);
            if (cone != nullptr && arc_length_beside(path, cone->position, kBeside_m) <= trusted_m)
                trusted.push_back(id);
        }
        std::erase_if(known_[1 - side], [&](ConeId id) { return has(trusted, id); });
        merge(known_[side], trusted);
    }
}

void BoundaryMemory::pass(const Pose& pose, const ConeMemory& cones) {
    for (std::vector<ConeId>& side : known_) {
        std::erase_if(side, [&](ConeId id) { return cones.find(id) == nullptr; });
        const auto first = std::ranges::find_if(side, [&](ConeId id) {
            const Point& place = cones.find(id)->position;
            return pose.ahead_m(place) >= 0.0 || (place - pose.position).norm() <= kBehind_m;
        });
        side.erase(side.begin(), first);
    }
}

std::optional<Lane> BoundaryMemory::alone(const Scene& scene, const ConeMemory& cones) const {
    const auto in_view = [&](const std::vector<ConeId>& side) {
        return static_cast<std::size_t>(std::ranges::count_if(side, [&](ConeId id) {
            const ConeMemory::RememberedCone* const cone = cones.find(id);
            return cone != nullptr && cones.is_seen_lately(*cone, kLately_frames);
        }));
    };
    const auto place_of = [&](ConeId id) { return cones.find(id)->position; };
    for (const std::size_t side : {0U, 1U}) {
        const std::vector<ConeId>& other = known_[1 - side];
        std::vector<ConeId> own;
        for (const ConeId id : known_[side]) {
            if (std::ranges::find(scene.cones, id, &Cone::id) != scene.cones.end()) own.push_back(id);
        }
        if (own.size() < 2 || in_view(other) > 0) continue;
        for (std::size_t i = 0; i < kMaxContinued; ++i) {
            const Cone* const next =
                continuation(scene, place_of(own.end()[-2]), place_of(own.back()), own, other);
            if (next == nullptr) break;
            own.push_back(next->id);
        }
        const auto ahead =
            std::ranges::count_if(own, [&](ConeId id) { return scene.pose.ahead_m(place_of(id)) > 0.0; });
        if (ahead < kMinAhead) continue;
        // The boundary that stays in view is the outer one: it turns to the other side.
        const Point end = place_of(own.back()) - place_of(own.end()[-2]);
        const double to_left_rad = turning_angle(scene.pose.heading(), end);
        if ((side == 0 ? -to_left_rad : to_left_rad) < kStraight_rad) continue;
        Lane lane;
        (side == 0 ? lane.left : lane.right) = std::move(own);
        return lane;
    }
    return std::nullopt;
}

}  // namespace conelane
