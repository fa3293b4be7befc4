#pragma once

#include "conelane/lane_detector.hpp"
#include "conelane/scene.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace conelane {

/// Finds the cones of a scene that are held twice: those that stand at most `radius_m` apart. Keeps memory
/// from call to call: once it is warm, nothing is allocated.
///
/// Cones are looked at from the car outward, equally far ones by their ids. A cone that stands within the
/// radius of one that was kept is merged into it, of several into the nearest, of equally near ones into the
/// one with the smallest id; else it is kept. So neither the order nor, but for ties, the ids of the scene's
/// cones count, kept cones stand farther apart than that, and what is kept is a part of the scene: the cones
/// that are left stay as they are.
class DoubledCones {
  public:
    static constexpr double kMaxRadius_m = 0.4;

    /// Precondition: `radius_m` is from 0 to kMaxRadius_m.
    explicit DoubledCones(double radius_m) : radius_m_(radius_m) {}

    [[nodiscard]] double radius_m() const { return radius_m_; }
    /// The scene with each cone once: `scene` itself where no cone is doubled, else a copy without the merged
    /// ones, valid until the next call. Time n log n. Precondition: the scene is valid.
    [[nodiscard]] const Scene& merge(const Scene& scene);
    /// The cones that the last call merged, in the order of their ids.
    [[nodiscard]] const std::vector<MergedCone>& merged() const { return merged_; }

  private:
    struct Cell {
        std::int64_t x;
        std::int64_t y;
        bool operator==(const Cell&) const = default;
    };
    /// A kept cone in the hash table.
    struct Slot {
        Cell cell;
        std::size_t cone;  ///< index in the scene; kNone for an empty slot
    };
    static constexpr std::size_t kNone = ~std::size_t{0};

    [[nodiscard]] static Cell cell_of(const Point& position);
    [[nodiscard]] std::size_t first_slot(const Cell& cell) const;
    /// The kept cone that a cone is merged into; kNone where there is none.
    [[nodiscard]] std::size_t kept_near(const Scene& scene, const Point& position) const;
    void keep(const Point& position, std::size_t cone);

    double radius_m_;
    std::vector<std::size_t> outward_;  ///< indices of the cones
    std::vector<Slot> slots_;           ///< open addressing, a power of two, at most half full
    std::vector<bool> kept_;
    std::vector<MergedCone> merged_;
    Scene once_;
};

}  // namespace conelane
