// Runs of ft-fsd, from the log to the scenes.

#include "evaluation/formats/frame_file.hpp"
#include "evaluation/world/scene_generation.hpp"
#include "tests/support/boundary_checks.hpp"
#include "tests/support/file_test.hpp"
#include "tests/support/recorded_tracks.hpp"
#include "tests/support/refusal.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace conelane {
namespace {

using Points = std::vector<Point>;

std::string list_of(const Points& points) {
    std::vector<std::string> texts =
        mapped(points, [](const Point& point) { return fmt::format("[{}, {}]", point.x(), point.y()); });
    return fmt::format("[{}]", fmt::join(texts, ", "));
}

struct LogMap {
    Points unknown;
    Points yellow;
    Points blue;
    Points big_orange;
};

std::string frame(const Point& position, const Point& direction, const LogMap& map) {
    return fmt::format(
        R"({{"car_position": [{}, {}], "car_direction": [{}, {}], "slam_cones": [{}, {}, {}, [], {}]}})",
        position.x(), position.y(), direction.x(), direction.y(), list_of(map.unknown), list_of(map.yellow),
        list_of(map.blue), list_of(map.big_orange));
}

std::string log_of(const std::vector<std::string>& frames) {
    return fmt::format("[{}]", fmt::join(frames, ",\n"));
}

const Point kEast(1.0, 0.0);

/// A straight lane from x = 2 to `end`, a cone each 4 m.
LogMap straight(double end) {
    LogMap map;
    for (double x = 2.0; x <= end; x += 4.0) {
        map.blue.emplace_back(x, 2.0);
        map.yellow.emplace_back(x, -2.0);
    }
    return map;
}

SceneOptions plain() {
    return SceneOptions{.false_positive_rates = {0.0}, .ranges_m = {30.0}};
}

std::vector<double> xs(const AnnotatedScene& scene, const std::vector<ConeId>& run) {
    return mapped(run, [&](const ConeId id) {
        return std::ranges::find(scene.scene.cones, id, &Cone::id)->position.x();
    });
}

std::vector<double> missed_xs(const AnnotatedScene& scene) {
    std::vector<double> result = mapped(scene.missed, [](const Cone& cone) { return cone.position.x(); });
    std::ranges::sort(result);
    return result;
}

class RunLog : public FileTest {
  protected:
    [[nodiscard]] Track read(const std::vector<std::string>& frames) const {
        return read_run_log(file_with(log_of(frames), "run.json"));
    }
};

/// A map that grows and drifts: three frames of a straight.
TEST_F(RunLog, ThreeFramesGiveOneTrackAndItsCones) {
    LogMap drifted = straight(10.0);
    for (Point& point : drifted.blue) point += Point(0.3, 0.1);
    const Track run = read({frame({0.0, 0.0}, kEast, straight(6.0)), frame({1.2, 0.0}, kEast, straight(10.0)),
                            frame({2.6, 0.0}, {1.0, 1.0}, drifted)});
    EXPECT_EQ(run.name, "ftlog_run");
    EXPECT_FALSE(run.closed);
    EXPECT_THAT(run.warnings, IsEmpty());
    EXPECT_THAT(run.driven, IsEmpty());
    ASSERT_THAT(run.cones, SizeIs(6));
    ASSERT_THAT(run.left, SizeIs(3));
    ASSERT_THAT(run.right, SizeIs(3));
    EXPECT_EQ(run.cones[run.left[0]].position, Point(2.3, 2.1)) << "the last map counts";
    EXPECT_EQ(run.cones[run.left[2]].position, Point(10.3, 2.1));
    EXPECT_EQ(run.cones[run.right[1]].position, Point(6.0, -2.0));
    ASSERT_THAT(run.frames, SizeIs(3));
    EXPECT_THAT(run.frames[0].map, SizeIs(4));
    EXPECT_EQ(run.frames[1].travelled_m, 1.2);
    EXPECT_NEAR(run.frames[2].travelled_m, 2.6, 1e-12);
    EXPECT_NEAR(run.frames[2].pose.yaw_rad, std::numbers::pi / 4.0, 1e-12);
}

TEST_F(RunLog, ScenesHoldWhatTheMapOfTheirFrameHoldsUnderOneId) {
    LogMap drifted = straight(10.0);
    for (Point& point : drifted.blue) point += Point(0.3, 0.0);
    const Track run = read({frame({0.0, 0.0}, kEast, straight(6.0)), frame({0.5, 0.0}, kEast, straight(6.0)),
                            frame({1.2, 0.0}, kEast, straight(10.0)), frame({1.5, 0.0}, kEast, drifted)});
    const auto scenes = generate_scenes(run, plain());
    ASSERT_THAT(scenes, SizeIs(2)) << "a frame every 1.1 m";
    EXPECT_EQ(scenes[1].scene.id, "ftlog_run/pose_0001/fp_0.00/range_30");
    EXPECT_EQ(scenes[1].scene.pose.position, Point(1.2, 0.0));
    EXPECT_EQ(scenes[1].travelled_m, 1.2);
    EXPECT_THAT(scenes[0].scene.cones, SizeIs(4));
    EXPECT_THAT(scenes[1].scene.cones, SizeIs(6));
    EXPECT_THAT(xs(scenes[0], scenes[0].ground_truth->left), ElementsAre(2, 6));
    EXPECT_THAT(xs(scenes[1], scenes[1].ground_truth->left), ElementsAre(2, 6, 10)) << "not yet drifted";
    EXPECT_THAT(missed_xs(scenes[0]), ElementsAre(10.0, 10.3)) << "not on the map yet";
    EXPECT_EQ(scenes[0].ground_truth->left[1], scenes[1].ground_truth->left[1]);
    for (const AnnotatedScene& scene : scenes) {
        for (const Cone& cone : scene.scene.cones) EXPECT_EQ(cone.color, ConeColor::unknown);
    }
    SceneOptions colored = plain();
    colored.with_color = true;
    const auto seen = generate_scenes(run, colored);
    EXPECT_EQ(std::ranges::count(seen[1].scene.cones, ConeColor::blue, &Cone::color), 3);
}

/// Of five cones the map lacks one, or two in a row.
TEST_F(RunLog, TheGroundTruthGoesPastOneConeThatTheMapLacksButNotPastTwo) {
    LogMap one = straight(18.0);
    one.blue.erase(one.blue.begin() + 2);
    LogMap two = straight(18.0);
    two.blue.erase(two.blue.begin() + 2, two.blue.begin() + 4);
    const Track run = read({frame({0.0, 0.0}, kEast, one), frame({1.2, 0.0}, kEast, two),
                            frame({4.0, 0.0}, kEast, straight(18.0))});
    const auto scenes = generate_scenes(run, plain());
    ASSERT_THAT(scenes, SizeIs(3));
    EXPECT_THAT(xs(scenes[0], scenes[0].ground_truth->left), ElementsAre(2, 6, 14, 18));
    EXPECT_THAT(missed_xs(scenes[0]), ElementsAre(10));
    EXPECT_THAT(xs(scenes[1], scenes[1].ground_truth->left), ElementsAre(2, 6));
    EXPECT_THAT(xs(scenes[1], scenes[1].ground_truth->right), ElementsAre(2, 6, 10)) << "evened";
}

TEST_F(RunLog, WithoutColorsTheDrivenPathIsKeptAndEveryFrameIsAScene) {
    LogMap map = straight(10.0);
    map.unknown = map.blue;
    map.unknown.insert(map.unknown.end(), map.yellow.begin(), map.yellow.end());
    map.blue.clear();
    map.yellow.clear();
    const Track run =
        read({frame({0.0, 0.0}, kEast, map), frame({1.2, 0.0}, kEast, map), frame({2.4, 0.0}, kEast, map)});
    EXPECT_THAT(run.left, IsEmpty());
    EXPECT_THAT(run.driven, ElementsAre(Point(0, 0), Point(1.2, 0), Point(2.4, 0)));
    EXPECT_THAT(boundaries(run).driven, SizeIs(3));
    SceneOptions options = plain();
    options.false_positive_rates = {0.5};
    options.persistent = true;
    const auto scenes = generate_scenes(run, options);
    ASSERT_THAT(scenes, SizeIs(3));
    for (const AnnotatedScene& scene : scenes) EXPECT_FALSE(scene.ground_truth.has_value());
    EXPECT_GT(scenes[0].scene.cones.size(), 6u) << "false positives join the cones of a run";
}

TEST_F(RunLog, TheDrivenPathEndsWhereTheCarRunsOverACone) {
    LogMap map;
    map.unknown = {{2, 2}, {2, -2}, {4.0, 0.3}, {9, 0}};
    const Track run = read({frame({0, 0}, kEast, map), frame({2, 0}, kEast, map), frame({5, 0}, kEast, map),
                            frame({7, 0}, kEast, map)});
    EXPECT_THAT(run.driven, ElementsAre(Point(0, 0), Point(2, 0)));
    EXPECT_THAT(run.frames, SizeIs(2));
    EXPECT_THAT(run.warnings, ElementsAre("the car runs over a cone after 5.0 m; 2 frames from there on are "
                                          "left out"));
}

/// Two laps of a ring; the gate is of big orange cones.
TEST_F(RunLog, ARunThatComesBackIsAClosedCourse) {
    LogMap ring;
    for (int k = 0; k < 24; ++k) {
        const double angle_rad = 2.0 * std::numbers::pi * (k + 0.5) / 24.0;
        const Point out(std::cos(angle_rad), std::sin(angle_rad));
        (k == 0 ? ring.big_orange : ring.blue).push_back(8.0 * out);
        (k == 0 ? ring.big_orange : ring.yellow).push_back(12.0 * out);
    }
    std::vector<std::string> frames;
    for (double angle_rad = 0.0; angle_rad < 4.1 * std::numbers::pi; angle_rad += 0.1) {
        frames.push_back(frame({10.0 * std::cos(angle_rad), 10.0 * std::sin(angle_rad)},
                               {-std::sin(angle_rad), std::cos(angle_rad)}, ring));
    }
    const Track run = read(frames);
    EXPECT_TRUE(run.closed);
    EXPECT_THAT(run.warnings, IsEmpty());
    ASSERT_THAT(run.left, SizeIs(24));
    ASSERT_THAT(run.right, SizeIs(24));
    for (std::size_t k = 0; k < 24; ++k) {
        const double angle_rad = 2.0 * std::numbers::pi * (static_cast<double>(k) + 0.5) / 24.0;
        const Point out(std::cos(angle_rad), std::sin(angle_rad));
        EXPECT_LT((run.cones[run.left[k]].position - 8.0 * out).norm(), 1e-9) << k;
        EXPECT_LT((run.cones[run.right[k]].position - 12.0 * out).norm(), 1e-9) << k;
    }
    EXPECT_EQ(run.cones[run.left[0]].color, ConeColor::orange);
    const auto scenes = generate_scenes(run, plain());
    EXPECT_THAT(scenes, SizeIs(AllOf(testing::Gt(100u), testing::Lt(125u)))) << "both laps";
}

/// Two loops that cross, as on a skidpad, are not a single lane.
TEST_F(RunLog, APathThatCrossesItselfBoundsNoLane) {
    LogMap map = straight(30.0);
    const std::vector<std::string> frames =
        mapped(Points{{0, 0}, {10, 0}, {10, 6}, {5, 6}, {5, -6}},
               [&](const Point& place) { return frame(place, kEast, map); });
    const Track run = read(frames);
    EXPECT_THAT(run.left, IsEmpty());
    ASSERT_THAT(run.warnings, testing::Not(IsEmpty()));
    EXPECT_THAT(run.warnings.front(), HasSubstr("bound no lane"));
    EXPECT_THAT(run.driven, testing::Not(IsEmpty()));
}

/// The recorded runs: two laps of a colored course, a car that leaves its lane, and a skidpad.
TEST(RecordedRuns, GiveBoundariesWhereTheyHaveColorsAndOneLane) {
    const std::filesystem::path folder = recorded_data() / "ft_fsd";
    if (!std::filesystem::is_directory(folder)) {
        GTEST_SKIP() << "no ft_fsd in CONELANE_DATA or in ../shared/data";
    }
    const Track laps = read_run_log(folder / "fsg_19_2_laps.json");
    EXPECT_TRUE(laps.closed);
    EXPECT_THAT(laps.warnings, IsEmpty());
    const TrackBoundaries both = boundaries(laps);
    EXPECT_TRUE(is_simple(both.left, true));
    EXPECT_TRUE(is_simple(both.right, true));
    EXPECT_EQ(laps.left.size() + laps.right.size(), laps.cones.size()) << "every cone bounds the lane";
    for (const double left_m : left_offsets_m(both.left, both.right, true)) {
        EXPECT_GT(left_m, 2.0);
        EXPECT_LT(left_m, 6.5);
    }
    EXPECT_NEAR(polyline_length_m(both.left, true), 267.0, 1.0);
    EXPECT_NEAR(laps.frames.back().travelled_m, 500.0, 1.0) << "two laps";
    std::set<ConeId> ids;
    for (const AnnotatedScene& scene : generate_scenes(laps, plain())) {
        ASSERT_TRUE(scene.ground_truth.has_value());
        for (const Cone& cone : scene.scene.cones) ids.insert(cone.id);
    }
    EXPECT_EQ(ids.size(), laps.cones.size()) << "one id for each cone in both laps";

    const Track turn = read_run_log(folder / "one_turn.json");
    EXPECT_THAT(turn.left, IsEmpty());
    EXPECT_THAT(turn.warnings, ElementsAre(HasSubstr("runs over a cone after 9.8 m")));
    EXPECT_THAT(generate_scenes(turn, plain()), SizeIs(9));

    const Track skidpad = read_run_log(folder / "skidpad.json");
    EXPECT_THAT(skidpad.warnings, ElementsAre(HasSubstr("bound no lane")));
    EXPECT_EQ(skidpad.driven.size(), skidpad.frames.size());
}

/// Of the cones of `truth`, the share that `found` has too, each within half a metre.
double share_found(const std::vector<Point>& truth, const std::vector<Point>& found) {
    const auto is_found = [&](const Point& cone) {
        return std::ranges::any_of(found, [&](const Point& other) { return (other - cone).norm() < 0.5; });
    };
    return static_cast<double>(std::ranges::count_if(truth, is_found)) / static_cast<double>(truth.size());
}

/// A car drives round courses among false cones that stay, with noise, missed cones and without colors: what
/// it drove through is the course.
TEST_F(RunLog, ADrivenPathLabelsWhatTheCarSaw) {
    for (const char* name : {"curvy", "hairpins", "kidney", "serpentine"}) {
        const Track course = load_tracks(fmt::format("generated:{}@5", name)).front();
        const SceneOptions seen{.false_positive_rates = {0.3},
                                .ranges_m = {20.0},
                                .every_m = 1.0,
                                .noise_sigma_m = 0.1,
                                .miss_rate = 0.05,
                                .persistent = true,
                                .seed = 3};
        std::string lines;
        for (const AnnotatedScene& scene : generate_scenes(course, seen)) {
            const auto cones = mapped(scene.scene.cones, [](const Cone& cone) {
                return fmt::format(
                    R"({{"x": {}, "y": {}, "confidence": 0.9, "color_probabilities": [1, 0, 0, 0, 0], "position_covariance": [[0.1, 0], [0, 0.1]]}})",
                    cone.position.x(), cone.position.y());
            });
            const Pose& pose = scene.scene.pose;
            lines += fmt::format(R"({{"pose": {{"x": {}, "y": {}, "yaw": {}}}, "cones": [{}]}})"
                                 "\n",
                                 pose.position.x(), pose.position.y(), pose.yaw_rad, fmt::join(cones, ", "));
        }
        const auto file = file_with(lines, "lap.frames.jsonl");
        EXPECT_EQ(load_tracks("run:" + file.parent_path().string()).size(), 1U) << "all files of its folder";
        const Track run = read_driven_run(file);
        for (const Cone& cone : run.cones) {
            const bool plain = !cone.color_probabilities && !cone.position_covariance;
            ASSERT_TRUE(plain && cone.confidence == 1.0) << "would show that no false positive was drawn";
        }
        EXPECT_EQ(run.name, "run_lap");
        EXPECT_EQ(run.closed, course.closed) << name;
        const TrackBoundaries truth = boundaries(course);
        const TrackBoundaries found = boundaries(run);
        EXPECT_GT(share_found(truth.left, found.left), 0.95) << name;
        EXPECT_GT(share_found(truth.right, found.right), 0.95) << name;
        EXPECT_GT(share_found(found.left, truth.left), 0.95) << name;
        EXPECT_GT(share_found(found.right, truth.right), 0.95) << name;
    }
}

TEST_F(RunLog, ADrivenPathWithoutALaneIsRefused) {
    const auto file = file_with(R"({"pose": {"x": 0, "y": 0, "yaw": 0}, "cones": [{"x": 5, "y": 2}]})",
                                "short.frames.jsonl");
    EXPECT_THAT(refusal<InputError>([&] { (void)read_driven_run(file); }),
                AllOf(HasSubstr("short.frames.jsonl"), HasSubstr("bound no lane")));
}

/// Its colors, which the driven path does without, say the same of a recorded run.
TEST(RecordedRuns, AreLabelledByTheDrivenPathAsByTheirColors) {
    const std::filesystem::path run = recorded_data() / "ft_fsd" / "fsg_19_2_laps.json";
    if (!std::filesystem::exists(run)) GTEST_SKIP() << "no ft_fsd in CONELANE_DATA or in ../shared/data";
    const Track colored = read_run_log(run);
    const Track driven = read_driven_run(run);
    EXPECT_TRUE(driven.closed);
    EXPECT_GT(share_found(boundaries(colored).left, boundaries(driven).left), 0.95);
    EXPECT_GT(share_found(boundaries(colored).right, boundaries(driven).right), 0.95);
    EXPECT_GT(share_found(boundaries(driven).left, boundaries(colored).left), 0.95);
    EXPECT_GT(share_found(boundaries(driven).right, boundaries(colored).right), 0.95);
}

}  // namespace
}  // namespace conelane
