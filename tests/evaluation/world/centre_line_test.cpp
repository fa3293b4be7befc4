#include "evaluation/world/centre_line.hpp"

#include "conelane/invalid_input.hpp"
#include "evaluation/world/generated_tracks.hpp"
#include "tests/support/cones_at.hpp"
#include "tests/support/recorded_tracks.hpp"

namespace conelane {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kEvery_m = 1.1;

TEST(BoundaryMatching, IsMonotoneAndMatchesWhatFacesEachOther) {
    const std::vector<Point> left{{0, 1}, {1, 1}, {2, 1}, {3, 1}};
    const std::vector<Point> right{{0, -1}, {3, -1}};
    const auto pairs = mapped(match_boundaries(left, right),
                              [](const FacingPlaces& pair) { return std::pair(pair.left, pair.right); });
    EXPECT_EQ(pairs, (std::vector<std::pair<std::size_t, std::size_t>>{{0, 0}, {1, 0}, {2, 1}, {3, 1}}));
}

TEST(CentreLine, OfAStraightIsItsMiddle) {
    const TrackBoundaries straight{{{0, 2}, {5, 2}, {10, 2}}, {{0, -2}, {3, -2}, {10, -2}}, false};
    const std::vector<Pose> poses = centre_line_poses(straight, 2.0);
    ASSERT_EQ(poses.size(), 6u);
    for (std::size_t i = 0; i < poses.size(); ++i) {
        EXPECT_NEAR(poses[i].position.x(), 2.0 * static_cast<double>(i), 1e-6);
        EXPECT_NEAR(poses[i].position.y(), 0.0, 1e-6);
        EXPECT_NEAR(poses[i].yaw_rad, 0.0, 1e-9);
    }
}

TEST(CentreLine, OfAnOpenTrackRunsWhereBothBoundariesDo) {
    const TrackBoundaries uneven{{{-8, 2}, {5, 2}, {20, 2}}, {{0, -2}, {10, -2}, {31, -2}}, false};
    const std::vector<Pose> poses = centre_line_poses(uneven, 1.0);
    EXPECT_NEAR(poses.front().position.x(), 0.0, 0.5);
    EXPECT_NEAR(poses.back().position.x(), 20.0, 1.0);
    EXPECT_NEAR(poses.front().position.y(), 0.0, 1e-6);
    EXPECT_NEAR(poses.back().position.y(), 0.0, 1e-6);
}

/// The right boundary starts half a lap from the left one.
TEST(CentreLine, OfARingIsACircleThoughItsBoundariesStartApart) {
    for (const double turn : {1.0, -1.0}) {
        const auto inner = tests::ring(18, 60, turn > 0 ? 0.0 : 2.5, turn * 2 * kPi);
        const auto outer = tests::ring(22, 70, turn > 0 ? 3.0 : 0.0, turn * 2 * kPi);
        const TrackBoundaries lane =
            turn > 0 ? TrackBoundaries{inner, outer, true} : TrackBoundaries{outer, inner, true};
        const std::vector<Pose> poses = centre_line_poses(lane, kEvery_m);
        EXPECT_NEAR(static_cast<double>(poses.size()) * kEvery_m, 2 * kPi * 20, 2 * kEvery_m);
        EXPECT_NEAR(poses[0].position.x(), 20.0, 0.1);
        EXPECT_NEAR(poses[0].position.y(), 0.0, 0.5);
        for (const Pose& pose : poses) {
            EXPECT_NEAR(pose.position.norm(), 20.0, 0.1);
            const Point tangent = turn * Point(-pose.position.y(), pose.position.x());
            EXPECT_NEAR(turning_angle(tangent, pose.heading()), 0.0, 0.05);
        }
    }
}

TEST(CentreLine, RefusesWhatIsNoLane) {
    const TrackBoundaries straight{{{0, 2}, {10, 2}}, {{0, -2}, {10, -2}}, false};
    const auto key_of = [](const TrackBoundaries& boundaries, double every_m) -> std::string {
        try {
            static_cast<void>(centre_line_poses(boundaries, every_m));
        } catch (const InvalidInput& error) {
            return error.key();
        }
        return "no error";
    };
    for (const double every_m : {0.0, -1.0, 1e-300, std::nan(""), std::numeric_limits<double>::infinity()})
        EXPECT_EQ(key_of(straight, every_m), "every_m") << every_m;
    EXPECT_EQ(key_of(straight, 1000.0), "no error");
    EXPECT_EQ(key_of({{{0, 2}}, straight.right, false}, 1), "left");
    EXPECT_EQ(key_of({straight.left, {}, false}, 1), "right");
    EXPECT_EQ(key_of({straight.left, {{1, 1}, {1, 1}}, false}, 1), "right");
    EXPECT_EQ(key_of({straight.left, straight.right, true}, 1), "left");
    EXPECT_EQ(key_of({{{0, 0}, {1e7, 0}}, straight.right, false}, 1), "left");
}

/// Expects every pose between its boundaries, with a heading along them, at constant spacing, once round the
/// lap. `bend_rad` limits the turn from pose to pose.
void expect_driven_lane(const Track& track, double bend_rad = 0.5) {
    SCOPED_TRACE(track.name);
    const TrackBoundaries both = boundaries(track);
    const std::vector<Pose> poses = centre_line_poses(both, kEvery_m);
    const double mean_length_m =
        (polyline_length_m(both.left, track.closed) + polyline_length_m(both.right, track.closed)) / 2;
    EXPECT_NEAR(static_cast<double>(poses.size()) * kEvery_m, mean_length_m, 0.04 * mean_length_m);
    EXPECT_LT((poses[0].position - both.left[0]).norm(), 5.0);
    for (std::size_t i = 0; i < poses.size(); ++i) {
        SCOPED_TRACE(i);
        const Pose& pose = poses[i];
        const PolylineFoot left = foot_on_polyline(pose.position, both.left, track.closed);
        const PolylineFoot right = foot_on_polyline(pose.position, both.right, track.closed);
        EXPECT_GT(pose.left_m(left.point), 0.9);
        EXPECT_LT(pose.left_m(right.point), -0.9);
        EXPECT_NEAR(left.distance_m, right.distance_m, 0.8);
        const auto along = [](const std::vector<Point>& boundary, std::size_t segment) {
            return Point((boundary[(segment + 1) % boundary.size()] - boundary[segment]).normalized());
        };
        const Point lane_direction = along(both.left, left.segment) + along(both.right, right.segment);
        // Near a corner, or a cone that is out of line, the two boundaries have different directions.
        if (lane_direction.norm() > 2.0 * std::cos(20.0 / 180.0 * kPi)) {
            EXPECT_LT(std::abs(turning_angle(lane_direction, pose.heading())),
                      35.0 / 180.0 * kPi + bend_rad - 0.5);
        }
        if (i > 0) {
            const double step_m = (pose.position - poses[i - 1].position).norm();
            EXPECT_LT(step_m, kEvery_m + 1e-5);
            EXPECT_GT(step_m, 0.97 * kEvery_m * std::cos((bend_rad - 0.5) / 2.0));
            EXPECT_LT(std::abs(turning_angle(poses[i - 1].heading(), pose.heading())), bend_rad);
        }
    }
    const double last_gap_m = (poses.back().position - poses.front().position).norm();
    if (track.closed) {
        EXPECT_LT(last_gap_m, kEvery_m + 1e-5);
    }
}

TEST(CentreLine, StaysInTheLaneOfEveryGeneratedTrack) {
    for (const std::string& name : generated_track_names()) {
        for (std::uint64_t seed = 0; seed < 5; ++seed)
            expect_driven_lane(generate_track(name, seed), name == "sharp" ? 0.8 : 0.5);
    }
}

TEST(CentreLine, DoesNotDependOnWhereAClosedBoundaryStarts) {
    const Track track = generate_track("serpentine", 0);
    TrackBoundaries both = boundaries(track);
    const std::vector<Pose> poses = centre_line_poses(both, kEvery_m);
    std::rotate(both.right.begin(), both.right.begin() + 31, both.right.end());
    const std::vector<Pose> rotated = centre_line_poses(both, kEvery_m);
    ASSERT_EQ(rotated.size(), poses.size());
    for (std::size_t i = 0; i < poses.size(); ++i)
        EXPECT_LT((rotated[i].position - poses[i].position).norm(), 0.3) << i;
}

TEST(CentreLine, StaysInTheLaneOfEveryRecordedTrack) {
    CONELANE_RECORDED_TRACKS_OR_SKIP(tracks);
    // Hairpins around a wall of 3 m, and a rectangle with right angles.
    const std::map<std::string, double> tight_rad{{"eufs_comp_2021", 0.55}, {"eufs_rectangle", 0.85}};
    for (const Track& track : tracks) {
        const auto tight = tight_rad.find(track.name);
        expect_driven_lane(track, tight == tight_rad.end() ? 0.5 : tight->second);
    }
}

}  // namespace
}  // namespace conelane
