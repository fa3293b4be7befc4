#pragma once

#include "conelane/planner.hpp"
#include "conelane/scene.hpp"
#include "detectors/planner/lap_planner_settings.hpp"
#include "detectors/planner/rigid_shift.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace conelane {

/// The cones of a run: where they stand on the average of what was seen, and how sure they are.
///
/// A cone is known again by its id, or by its place where it has none or a new one. Where all cones have
/// moved at once, the memory moves with them and says so.
class ConeMemory {
  public:
    explicit ConeMemory(const ConeMemorySettings& settings = {}, const ShiftSettings& shift_settings = {});

    /// Takes a frame in. Precondition: it is valid. Returns the shift of the map that it shows.
    std::optional<RigidShift> observe(const Frame& frame);

    /// What a detector is given: the cones seen in the last frame, and those seen twice at least that stand
    /// ahead or little behind. Their ids are the memory's own, all negative, the same as long as the cone is
    /// remembered.
    [[nodiscard]] Scene scene(const Pose& pose) const;

    /// The id that the car gave a cone; the memory's own where it gave none.
    [[nodiscard]] ConeId given_id(ConeId own) const;

    struct RememberedCone {
        ConeId id = 0;         ///< the memory's
        ConeId given = kNoId;  ///< the car's
        Point position{0.0, 0.0};
        int sightings = 1;
        double evidence = 1.0;
        std::int64_t last_seen = 0;   ///< frame
        double confidence = 1.0;      ///< mean
        std::array<int, 4> colors{};  ///< sightings in each color
    };
    [[nodiscard]] const std::vector<RememberedCone>& cones() const { return cones_; }

    void clear();

  private:
    std::optional<RigidShift> shift_of(const Frame& frame, const std::vector<std::size_t>& near) const;
    void associate(const Frame& frame, const std::vector<std::size_t>& near);
    void see(RememberedCone& cone, const Cone& seen) const;
    void miss_unseen(const Frame& frame, const std::vector<std::size_t>& near);
    void forget();

    ConeMemorySettings settings_;
    ShiftSettings shift_settings_;
    std::vector<RememberedCone> cones_;  ///< by id
    std::int64_t frame_ = 0;
    ConeId next_id_ = kNoId + 1;
    double range_m_ = 0.0;  ///< of the last frame: the farthest cone
};

/// The color that was seen most; unknown where none was.
[[nodiscard]] ConeColor color_of(const ConeMemory::RememberedCone& cone);

}  // namespace conelane
