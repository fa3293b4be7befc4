#pragma once

#include "conelane/planner.hpp"
#include "detectors/planner/rigid_shift.hpp"

#include <array>
#include <utility>

namespace conelane {

/// The cones of a run: their mean positions, and how certain each one is.
///
/// A cone is recognised by its id, or by its place if it has no id or a new one. If all cones have moved at
/// once, the memory moves with them and reports the shift.
class ConeMemory {
  public:
    explicit ConeMemory(const ConeMemorySettings& settings = {}, const ShiftSettings& shift_settings = {});

    /// Adds a frame. Precondition: it is valid. Returns the shift of the map that it shows.
    std::optional<RigidShift> observe(const Frame& frame);

    /// The cones for a detector: those seen in the last frame, and those seen at least twice that are ahead
    /// or a little behind. Their ids are the memory's own, all negative, and stay the same as long as the
    /// cone is remembered.
    [[nodiscard]] Scene scene(const Pose& pose) const;

    /// The id that the car gave a cone; the memory's own id if it gave none.
    [[nodiscard]] ConeId given_id(ConeId own) const;

    struct RememberedCone {
        ConeId id = 0;         ///< the memory's
        ConeId given = kNoId;  ///< the car's
        Point position{0.0, 0.0};
        int sightings = 1;
        double evidence = 1.0;
        std::int64_t last_seen = 0;   ///< number of the frame
        double confidence = 1.0;      ///< mean
        std::array<int, 5> colors{};  ///< sightings in each color
    };
    [[nodiscard]] const std::vector<RememberedCone>& cones() const { return cones_; }
    /// Null if it is forgotten.
    [[nodiscard]] const RememberedCone* find(ConeId own) const;
    /// In one of the last frames.
    [[nodiscard]] bool is_seen_lately(const RememberedCone& cone, int frames) const {
        return frame_ - cone.last_seen < frames;
    }

    /// Whether the last frame would have shown a cone at this place. Range and bearings of the sensor are not
    /// known. Assumption: it sees about as far and as wide as in that frame.
    [[nodiscard]] bool is_in_sure_view(const Point& place) const;

  private:
    using Indices = std::vector<std::size_t>;
    [[nodiscard]] Indices by_id(const Frame& frame, const Indices& near) const;
    [[nodiscard]] std::optional<RigidShift> shift_of(const Frame& frame, const Indices& near,
                                                     const Indices& remembered_of) const;
    void associate(const Frame& frame, const Indices& near, Indices& remembered_of);
    void see(const Cone& seen, std::size_t remembered);
    void miss_unseen(const Indices& near);
    void forget();

    ConeMemorySettings settings_;
    ShiftSettings shift_settings_;
    std::vector<RememberedCone> cones_;  ///< by id
    std::int64_t frame_ = 0;
    ConeId next_id_ = kNoId + 1;
    Pose pose_;                ///< of the last frame
    double range_m_ = 0.0;     ///< of that frame: distance of the farthest cone
    double widest_rad_ = 0.0;  ///< and the widest bearing of a cone
};

/// The color that was seen most often, both sizes of orange together; unknown if none was seen.
[[nodiscard]] ConeColor color_of(const ConeMemory::RememberedCone& cone);

}  // namespace conelane
