#pragma once

#include "conelane/lane_detector.hpp"
#include "conelane/scene.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace conelane {

/// Finds the cones of a scene that a map holds twice, see kDoubledCone_m. Keeps memory from call to call:
/// once it is warm, it allocates nothing.
///
/// Cones are visited in the order of their ids. A cone within kDoubledCone_m of a kept cone is merged into
/// the nearest one (ties: the smallest id); otherwise it is kept. So the order of the scene's cones does not
/// matter, kept cones are farther apart than that, and their positions stay unchanged.
class DoubledCones {
  public:
    /// The scene with each cone once: `scene` itself if no cone is doubled, else a copy without the merged
    /// cones, valid until the next call. Time n log n. Precondition: the scene is valid.
    [[nodiscard]] const Scene& merge(const Scene& scene);
    /// The cones that the last call merged, by their ids.
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
    /// The kept cone that a cone is merged into; kNone if there is none.
    [[nodiscard]] std::size_t kept_near(const Scene& scene, const Point& position) const;
    void keep(const Point& position, std::size_t cone);

    std::vector<std::size_t> by_id_;  ///< indices of the cones
    std::vector<Slot> slots_;         ///< open addressing, a power of two, at most half full
    std::vector<bool> kept_;
    std::vector<MergedCone> merged_;
    Scene once_;
};

}  // namespace conelane
