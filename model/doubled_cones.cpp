#include "model/doubled_cones.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace conelane {
namespace {

/// Cells are a power of two wide, so that dividing by it does not round, and wider than any radius, so that
/// doubles are in the same or in neighbouring cells.
constexpr double kCellsPerMetre = 2.0;
static_assert(DoubledCones::kMaxRadius_m * kCellsPerMetre < 1.0);
/// Positions farther away share the last cell.
constexpr double kLastCell = 1e15;

}  // namespace

const Scene& DoubledCones::merge(const Scene& scene) {
    const std::vector<Cone>& cones = scene.cones;
    outward_.resize(cones.size());
    for (std::size_t i = 0; i < cones.size(); ++i) outward_[i] = i;
    std::ranges::sort(outward_, {}, [&](std::size_t i) {
        return std::pair((cones[i].position - scene.pose.position).norm(), cones[i].id);
    });
    const std::size_t far_doubles = merge_within(radius_m_, cones);
    const std::size_t left = cones.size() - merged_.size();
    const bool by_chance = far_doubles < kMinFarDoubles || far_doubles * kMaxConesPerFarDouble < left;
    if (far_doubles > 0 && by_chance) merge_within(kDoubledCone_m, cones);
    std::ranges::sort(merged_, {}, &MergedCone::cone);
    if (merged_.empty()) return scene;
    once_.id = scene.id;
    once_.pose = scene.pose;
    once_.cones.clear();
    for (std::size_t i = 0; i < cones.size(); ++i) {
        if (kept_[i]) once_.cones.push_back(cones[i]);
    }
    return once_;
}

std::size_t DoubledCones::merge_within(double radius_m, const std::vector<Cone>& cones) {
    std::size_t far_doubles = 0;
    merged_.clear();
    slots_.assign(std::bit_ceil(2 * cones.size() + 1), Slot{{0, 0}, kNone});
    kept_.assign(cones.size(), true);
    for (const std::size_t cone : outward_) {
        const Point& position = cones[cone].position;
        const std::size_t into = kept_near(radius_m, cones, position);
        if (into == kNone) {
            keep(position, cone);
            continue;
        }
        kept_[cone] = false;
        merged_.push_back({cones[cone].id, cones[into].id});
        if ((cones[into].position - position).norm() > kDoubledCone_m) ++far_doubles;
    }
    return far_doubles;
}

DoubledCones::Cell DoubledCones::cell_of(const Point& position) {
    const auto of = [](double coordinate_m) {
        const double cell = std::floor(coordinate_m * kCellsPerMetre);
        return static_cast<std::int64_t>(std::clamp(cell, -kLastCell, kLastCell));
    };
    return {of(position.x()), of(position.y())};
}

std::size_t DoubledCones::first_slot(const Cell& cell) const {
    std::uint64_t hash = static_cast<std::uint64_t>(cell.x) * 0x9E3779B97F4A7C15U;
    hash = (hash ^ (hash >> 32U) ^ static_cast<std::uint64_t>(cell.y)) * 0xD6E8FEB86659FD93U;
    return static_cast<std::size_t>(hash ^ (hash >> 32U)) & (slots_.size() - 1);
}

std::size_t DoubledCones::kept_near(double radius_m, const std::vector<Cone>& cones,
                                    const Point& position) const {
    const Cell centre = cell_of(position);
    std::size_t nearest = kNone;
    double nearest_m = radius_m;
    for (std::int64_t dx = -1; dx <= 1; ++dx) {
        for (std::int64_t dy = -1; dy <= 1; ++dy) {
            const Cell cell{centre.x + dx, centre.y + dy};
            for (std::size_t at = first_slot(cell); slots_[at].cone != kNone;
                 at = (at + 1) & (slots_.size() - 1)) {
                if (slots_[at].cell != cell) continue;
                const Cone& kept = cones[slots_[at].cone];
                const double distance_m = (kept.position - position).norm();
                if (distance_m > nearest_m) continue;
                if (distance_m == nearest_m && nearest != kNone && cones[nearest].id < kept.id) continue;
                nearest = slots_[at].cone;
                nearest_m = distance_m;
            }
        }
    }
    return nearest;
}

void DoubledCones::keep(const Point& position, std::size_t cone) {
    const Cell cell = cell_of(position);
    std::size_t at = first_slot(cell);
    while (slots_[at].cone != kNone) at = (at + 1) & (slots_.size() - 1);
    slots_[at] = {cell, cone};
}

}  // namespace conelane
