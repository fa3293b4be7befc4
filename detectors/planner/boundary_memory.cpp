#include "detectors/planner/boundary_memory.hpp"

#include "detectors/planner/lane_stretch.hpp"
#include "model/geometry.hpp"

#include <iterator>

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

bool has(const std::vector<ConeId>& ids, ConeId id) {
    return std::ranges::find(ids, id) != ids.end();
}

/// Puts the cones of a newer lane into those known before. What was known beyond both ends stays, if the two
/// meet there.
void merge(std::vector<ConeId>& known, std::vector<ConeId> seen) {
    if (seen.empty()) return;
    const auto first = std::ranges::find_if(known, [&](ConeId id) { return has(seen, id); });
    const auto last = std::ranges::find(known, seen.back());
    const std::vector<ConeId> beyond(last == known.end() ? last : last + 1, known.end());
    known.erase(first, known.end());
    std::ranges::copy_if(beyond, std::back_inserter(seen), [&](ConeId id) { return !has(seen, id); });
    known.insert(known.end(), seen.begin(), seen.end());
}

/// The cone of the scene that continues a boundary: near and straight on; null if there is none.
const Cone* continuation(const Scene& scene, const Point& before, const Point& last,
                         const std::vector<ConeId>& own, const std::vector<ConeId>& other) {
    const Cone* best = nullptr;
    const double before_m = (last - before).norm();
    double least_m = std::numeric_limits<double>::infinity();
    for (const Cone& cone : scene.cones) {
        const Point step = cone.position - last;
        const double length_m = step.norm();
        const double turn_rad = std::abs(turning_angle(last - before, step));
        // A longer step than the last one steps over a missed cone, or to another boundary.
        const double most_rad = length_m > kUsualRatio * before_m ? kLargestTurnOver_rad : kLargestTurn_rad;
        const bool is_near =
            length_m >= kShortest_m && length_m <= std::min(kLongest_m, kLargestRatio * before_m);
        const double cost_m = length_m * (1.0 + turn_rad);
        if (!is_near || turn_rad > most_rad || cost_m >= least_m) continue;
        if (has(own, cone.id) || has(other, cone.id)) continue;
        least_m = cost_m;
        best = &cone;
    }
    return best;
}

}  // namespace

void BoundaryMemory::learn(const Lane& lane, const DrivableLane& path, double until_m,
                           const ConeMemory& cones) {
    for (const std::size_t side : {0U, 1U}) {
        std::vector<ConeId> learned;
        for (const ConeId id : side == 0 ? lane.left : lane.right) {
            const ConeMemory::RememberedCone* const cone = cones.find(id);
            if (cone != nullptr && arc_length_beside(path, cone->position, kBeside_m) <= until_m)
                learned.push_back(id);
        }
        std::erase_if(known_[1 - side], [&](ConeId id) { return has(learned, id); });
        merge(known_[side], std::move(learned));
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
    const auto is_in_view = [&](ConeId id) { return cones.is_seen_lately(*cones.find(id), kLately_frames); };
    const auto place_of = [&](ConeId id) { return cones.find(id)->position; };
    for (const std::size_t side : {0U, 1U}) {
        const std::vector<ConeId>& other = known_[1 - side];
        std::vector<ConeId> own;
        std::ranges::copy_if(known_[side], std::back_inserter(own), [&](ConeId id) {
            return std::ranges::find(scene.cones, id, &Cone::id) != scene.cones.end();
        });
        if (own.size() < 2 || std::ranges::any_of(other, is_in_view)) continue;
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
