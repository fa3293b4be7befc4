#include "evaluation/world/generated_tracks.hpp"
#include "evaluation/world/scene_generation.hpp"
#include "tests/support/drivable_checks.hpp"
#include "tests/support/recorded_tracks.hpp"

namespace conelane::tests {
namespace {

Course whole(const Track& track) {
    Course course;
    course.scene.cones = track.cones;
    for (const std::size_t i : track.left) course.lane.left.push_back(track.cones[i].id);
    for (const std::size_t i : track.right) course.lane.right.push_back(track.cones[i].id);
    course.lane.closed = track.closed;
    const std::vector<Point> left = course.left();
    const std::vector<Point> right = course.right();
    course.scene.pose.position = 0.5 * (left[0] + foot_on_polyline(left[0], right, track.closed).point);
    const Point ahead = left[1] - left[0];
    course.scene.pose.yaw_rad = std::atan2(ahead.y(), ahead.x());
    return course;
}

/// Expected properties of the scenes of a course.
struct DrivableBounds {
    double sharpest_1pm = 0.5;
    std::size_t short_lanes = 0;  ///< lanes that end long before the scene's boundaries do
    std::size_t one_sided = 0;    ///< scenes left out, because their runs end far from each other
};

/// The whole course and the ground truth of scenes along it.
void expect_drivable_track(const Track& track, const DrivableBounds& bounds = {}) {
    SCOPED_TRACE(track.name);
    const Course course = whole(track);
    const DrivableLane lap = course.driven();
    expect_drivable(course, lap);
    EXPECT_EQ(lap.closed, track.closed);
    EXPECT_LT(sharpest(lap), bounds.sharpest_1pm);
    const double mean_length_m = 0.5 * (polyline_length_m(course.left(), track.closed) +
                                        polyline_length_m(course.right(), track.closed));
    EXPECT_NEAR(lap.length_m, mean_length_m, 0.05 * mean_length_m);
    SceneOptions options{.false_positive_rates = {0.0}, .ranges_m = {30.0, 50.0}, .every_m = 3.3};
    constexpr double kEndsApart_m = 7.0;
    std::size_t one_sided = 0;
    std::size_t two_sided = 0;
    std::size_t short_lanes = 0;
    for (const AnnotatedScene& scene : generate_scenes(track, options)) {
        SCOPED_TRACE(scene.scene.id);
        const Course seen{scene.ground_truth.value(), scene.scene};
        // If another leg is near, evening the far ends may leave a run that continues there alone: this is
        // not a lane.
        if (bounds.one_sided > 0 && (seen.left().back() - seen.right().back()).norm() > kEndsApart_m) {
            ++one_sided;
            continue;
        }
        ++two_sided;
        const DrivableLane lane = seen.driven();
        expect_drivable(seen, lane);
        EXPECT_LT(sharpest(lane), bounds.sharpest_1pm);
        const double shorter_m = std::min(polyline_length_m(seen.left()), polyline_length_m(seen.right()));
        if (lane.length_m > 0.75 * shorter_m - 4.0) continue;
        ++short_lanes;
        EXPECT_LE(short_lanes, bounds.short_lanes) << lane.length_m << " of " << shorter_m << " m";
    }
    EXPECT_LE(one_sided, bounds.one_sided) << " of " << two_sided;
}

TEST(DrivableLane, DrivesEveryGeneratedTrack) {
    for (const std::string& name : generated_track_names()) {
        // The walls between legs are narrower than the widest lane, and hairpins of 8 m are wider.
        const DrivableBounds bounds{0.5, name == "wide_hairpins" ? 3U : 0U,
                                    name == "tight_hairpins" ? 23U : 0U};
        for (const std::uint64_t seed : {0U, 1U}) expect_drivable_track(generate_track(name, seed), bounds);
    }
}

TEST(DrivableLane, DrivesEveryRecordedTrack) {
    CONELANE_RECORDED_TRACKS_OR_SKIP(tracks);
    const std::map<std::string, DrivableBounds> peculiar{
        // Hairpins around a wall of 3 m that ends in a single cone, so the radii are below 2 m.
        {"eufs_comp_2021", {0.6, 0, 14}},
        // In one pose, the first right cone is behind the narrowest place of a bend.
        {"eufs_FSI", {0.5, 2, 0}},
    };
    for (const Track& track : tracks) {
        const auto bounds = peculiar.find(track.name);
        expect_drivable_track(track, bounds == peculiar.end() ? DrivableBounds{} : bounds->second);
    }
}

}  // namespace
}  // namespace conelane::tests
