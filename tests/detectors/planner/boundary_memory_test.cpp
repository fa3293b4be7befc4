// The outer boundary of a corner that a narrow view shows alone.

#include "detectors/planner/boundary_memory.hpp"

#include "tests/support/testing.hpp"

namespace conelane {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// A left bend about (0, 8): outer cones 1 to 9 at a radius of 9.75 m, inner cones 11 to 19 at 6.25 m, each
/// 15 degrees after the one before; the first ones are beside the origin.
Cone bend_cone(ConeId id) {
    const double radius_m = id < 10 ? 9.75 : 6.25;
    const double angle_rad = static_cast<double>(id % 10 - 1) * std::numbers::pi / 12.0;
    return {id, {radius_m * std::sin(angle_rad), 8.0 - radius_m * std::cos(angle_rad)}};
}

class Bend : public testing::Test {
  protected:
    Bend() {
        // Twice from the beginning of the bend, where both boundaries are in view.
        for (int i = 0; i < 2; ++i) look(0.0, {1, 2, 3, 4, 11, 12, 13, 14});
        DrivableLane path;
        for (double s_m = 0.0; s_m <= 6.0; s_m += 0.5) {
            const double angle_rad = s_m / 8.0;
            path.points.push_back({.s_m = s_m,
                                   .position = {8.0 * std::sin(angle_rad), 8.0 - 8.0 * std::cos(angle_rad)},
                                   .heading_rad = angle_rad,
                                   .width_left_m = 1.75,
                                   .width_right_m = 1.75});
            path.length_m = s_m;
        }
        boundaries_.learn({own({11, 12, 13, 14}), own({1, 2, 3, 4})}, path, 5.0, cones_);
    }
    /// The car has driven along so many degrees of the bend, and sees these cones.
    void look(double driven_deg, const std::vector<ConeId>& ids, std::vector<Cone> others = {}) {
        const double angle_rad = driven_deg * std::numbers::pi / 180.0;
        const Pose pose{{8.0 * std::sin(angle_rad), 8.0 - 8.0 * std::cos(angle_rad)}, angle_rad};
        Frame frame{time_s_ += 0.1, pose, std::move(others)};
        for (const ConeId id : ids) frame.cones.push_back(bend_cone(id));
        cones_.observe(frame);
        scene_ = cones_.scene(pose);
        boundaries_.pass(pose, cones_);
    }
    /// The memory's ids of the cones that the car calls so.
    [[nodiscard]] std::vector<ConeId> own(const std::vector<ConeId>& given) const {
        std::vector<ConeId> ids;
        for (const ConeId id : given) {
            for (const auto& cone : cones_.cones()) {
                if (cone.given == id) ids.push_back(cone.id);
            }
        }
        return ids;
    }
    /// The car's ids of the boundary that is in view alone, on the right, from cone 2 on; none if there is
    /// none.
    [[nodiscard]] std::vector<ConeId> alone() const {
        const std::optional<Lane> lane = boundaries_.alone(scene_, cones_);
        std::vector<ConeId> ids;
        if (!lane) return ids;
        EXPECT_THAT(lane->left, IsEmpty());
        for (const ConeId id : lane->right) ids.push_back(cones_.given_id(id));
        std::erase(ids, 1);
        return ids;
    }

    ConeMemory cones_;
    BoundaryMemory boundaries_;
    Scene scene_;
    double time_s_ = 0.0;
};

TEST_F(Bend, TheOuterBoundaryGoesOnFromTheKnownConesWhenTheInnerOneIsOutOfView) {
    for (int i = 0; i < 2; ++i) look(20.0, {3, 4, 5, 6});
    EXPECT_THAT(alone(), ElementsAre(2, 3, 4, 5, 6));
}

TEST_F(Bend, NeitherBoundaryIsAloneWhileAKnownConeOfTheOtherIsSeen) {
    for (int i = 0; i < 2; ++i) look(20.0, {3, 4, 5, 6, 13});
    EXPECT_THAT(alone(), IsEmpty());
}

TEST_F(Bend, TheBoundaryDoesNotTurnAsideOverAGap) {
    // Cone 5 is missed: cone 6 is a longer step straight on, the other one a longer step to the side.
    const Cone aside{30, bend_cone(4).position + Point(-1.5, 4.0)};
    for (int i = 0; i < 2; ++i) look(20.0, {3, 4, 6}, {aside});
    EXPECT_THAT(alone(), ElementsAre(2, 3, 4, 6));
}

TEST_F(Bend, ABoundaryThatGoesStraightOnIsNotTheOuterOne) {
    std::vector<Cone> straight;
    for (int i = 0; i < 3; ++i)
        straight.push_back({40 + i, bend_cone(3).position + Point(2.5 * (i + 1), 0.3)});
    for (int i = 0; i < 2; ++i) look(20.0, {}, straight);
    EXPECT_THAT(boundaries_.alone(scene_, cones_).has_value(), false);
}

}  // namespace
}  // namespace conelane
