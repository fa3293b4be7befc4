#pragma once

#include "conelane/lane_detector.hpp"

namespace conelane {

/// Finds the cones of a scene that a map holds twice: cones at most kDoubledCone_m apart. Cones at most
/// `radius_m` apart are doubles, too, if the scene has many of them: at least kMinFarDoubles, and at least
/// one for each kMaxConesPerFarDouble cones that are left. Fewer may be chance: of 1036 scenes with 50 %
/// false positives none had one for each 18 cones. Keeps memory from call to call: once it is warm, it
/// allocates nothing.
///
/// Cones are visited from the car outward (ties: by id). A cone within the radius of a kept cone is merged
/// into the nearest one (ties: the smallest id); otherwise it is kept. So the order of the scene's cones does
/// not matter, their ids matter for ties alone, kept cones are farther apart than the radius, and their
/// positions stay unchanged.
class DoubledCones {
  public:
    static constexpr double kMaxRadius_m = 0.4;
    static constexpr std::size_t kMinFarDoubles = 3;
    static constexpr std::size_t kMaxConesPerFarDouble = 10;

    /// Precondition: `radius_m` is from 0 to kMaxRadius_m.
    explicit DoubledCones(double radius_m) : radius_m_(radius_m) {}

    [[nodiscard]] double radius_m() const { return radius_m_; }
    /// The scene with each cone once: `scene` itself if no cone is doubled, else a copy without the merged
    /// cones, valid until the next call. Time n log n. Precondition: the scene is valid.
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
    /// Sorts cones into kept and merged ones; returns the number of merged cones that are farther than
    /// kDoubledCone_m from the cone that they were merged into.
    std::size_t merge_within(double radius_m, const std::vector<Cone>& cones);
    /// The kept cone that a cone is merged into; kNone if there is none.
    [[nodiscard]] std::size_t kept_near(double radius_m, const std::vector<Cone>& cones,
                                        const Point& position) const;
    void keep(const Point& position, std::size_t cone);

    double radius_m_;
    std::vector<std::size_t> outward_;  ///< indices of the cones
    std::vector<Slot> slots_;           ///< open addressing, a power of two, at most half full
    std::vector<bool> kept_;
    std::vector<MergedCone> merged_;
    Scene once_;
};

}  // namespace conelane
