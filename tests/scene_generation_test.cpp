#include "experiments/scenes/scene_generation.hpp"

#include "conelane/invalid_input.hpp"
#include "experiments/scenes/scene_file.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

namespace conelane::experiments {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::Ge;
using testing::IsEmpty;
using testing::Lt;
using testing::SizeIs;

/// Boundaries at y = +-1.5 m with a cone every 5 m from x = 0 to `left_end` and `right_end`, and a stray
/// point of the map at (12, 8).
Track straight(double left_end = 95.0, double right_end = 95.0) {
    Track track{"toy", {}, {}, {}, false};
    const auto add = [&](const Point& position) {
        track.cones.push_back({static_cast<ConeId>(track.cones.size()), position});
        return track.cones.size() - 1;
    };
    for (double x = 0.0; x <= left_end; x += 5.0) track.left.push_back(add({x, 1.5}));
    add({12.0, 8.0});
    for (double x = 0.0; x <= right_end; x += 5.0) track.right.push_back(add({x, -1.5}));
    return track;
}

/// A closed course around (0, 0), driven counter-clockwise: 12 cones a side, at radius 8.5 m (left) and 11.5
/// m.
Track circle() {
    Track track{"circle", {}, {}, {}, true};
    for (int i = 0; i < 12; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / 12.0;
        const Point direction(std::cos(angle), std::sin(angle));
        track.left.push_back(track.cones.size());
        track.cones.push_back({i, 8.5 * direction});
        track.right.push_back(track.cones.size());
        track.cones.push_back({100 + i, 11.5 * direction});
    }
    return track;
}

SceneOptions options(std::vector<double> rates, std::vector<double> ranges_m) {
    SceneOptions result;
    result.false_positive_rates = std::move(rates);
    result.ranges_m = std::move(ranges_m);
    return result;
}

std::vector<AnnotatedScene> generate(const Track& track, const std::vector<Pose>& poses,
                                     const SceneOptions& wanted) {
    return generate_scenes(track, poses, wanted);
}

const Cone& cone_of(const AnnotatedScene& scene, ConeId id) {
    return *std::ranges::find(scene.scene.cones, id, &Cone::id);
}

/// x of the cones of a run, which tells cones of a straight boundary apart.
std::vector<double> xs(const AnnotatedScene& scene, const std::vector<ConeId>& run) {
    std::vector<double> result;
    for (const ConeId id : run) result.push_back(cone_of(scene, id).position.x());
    return result;
}

/// The place in its boundary of each cone of a run.
std::vector<std::size_t> places(const AnnotatedScene& scene, const std::vector<ConeId>& run,
                                const Track& track, const std::vector<std::size_t>& side) {
    std::vector<std::size_t> result;
    for (const ConeId id : run) {
        const Point position = cone_of(scene, id).position;
        result.push_back(static_cast<std::size_t>(
            std::ranges::find_if(side, [&](std::size_t i) { return track.cones[i].position == position; }) -
            side.begin()));
    }
    return result;
}

/// The bytes of a scenes file.
std::string bytes(const std::vector<AnnotatedScene>& scenes) {
    const std::filesystem::path file =
        std::filesystem::path(testing::TempDir()) / ("conelane_" + std::to_string(::getpid()) + ".jsonl");
    write_scenes(file, scenes);
    std::ifstream stream(file, std::ios::binary);
    std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
    std::filesystem::remove(file);
    return text;
}

TEST(SceneGeneration, TheCarSeesTheHalfDiscAheadAndTheRunsOfItsBoundaries) {
    const auto scenes = generate(straight(), {{{7.0, 0.0}, 0.0}}, options({0.0}, {15.0}));
    ASSERT_THAT(scenes, SizeIs(1));
    const AnnotatedScene& scene = scenes.front();
    EXPECT_EQ(scene.scene.id, "toy/pose_0000/fp_0.00/range_15");
    EXPECT_EQ(scene.track, "toy");
    EXPECT_EQ(scene.false_positive_rate, 0.0);
    EXPECT_EQ(scene.range_m, 15.0);
    EXPECT_EQ(scene.seed, 0u);
    EXPECT_EQ(scene.scene.pose.position, Point(7.0, 0.0));
    // Cones from x = 10 to x = 20 on each side, and the stray point; x = 25 is 18 m ahead, x = 5 behind.
    EXPECT_THAT(scene.scene.cones, SizeIs(7));
    EXPECT_THAT(xs(scene, scene.ground_truth->left), ElementsAre(10, 15, 20));
    EXPECT_THAT(xs(scene, scene.ground_truth->right), ElementsAre(10, 15, 20));
    EXPECT_EQ(cone_of(scene, scene.ground_truth->left[0]).position.y(), 1.5);
    EXPECT_FALSE(scene.ground_truth->closed);
}

TEST(SceneGeneration, TheHalfDiscIsClosed) {
    // From (10, -1.5) the right cone at x = 10 is at the car itself, the left one exactly abeam, and the
    // right one at x = 25 exactly on the rim.
    const auto scenes = generate(straight(), {{{10.0, -1.5}, 0.0}}, options({0.0}, {15.0}));
    ASSERT_THAT(scenes, SizeIs(1));
    EXPECT_THAT(xs(scenes[0], scenes[0].ground_truth->left), ElementsAre(10, 15, 20));
    EXPECT_THAT(xs(scenes[0], scenes[0].ground_truth->right), ElementsAre(10, 15, 20, 25));
}

TEST(SceneGeneration, AVisibleConeBehindTheFootPointStartsNoRun) {
    // Turned left by 45 degrees at (11, 0), the car still sees the left cone at (10, 1.5), but has passed it.
    const auto scenes = generate(straight(), {{{11.0, 0.0}, std::numbers::pi / 4}}, options({0.0}, {12.0}));
    ASSERT_THAT(scenes, SizeIs(1));
    EXPECT_TRUE(std::ranges::any_of(scenes[0].scene.cones,
                                    [](const Cone& cone) { return cone.position == Point(10.0, 1.5); }));
    EXPECT_THAT(xs(scenes[0], scenes[0].ground_truth->left), ElementsAre(15, 20));
    EXPECT_THAT(xs(scenes[0], scenes[0].ground_truth->right), ElementsAre(15, 20));
}

TEST(SceneGeneration, FarEndsAreEvened) {
    // The right boundary ends at x = 20. The left cone at x = 25 is 5.8 m from there, the one at x = 30 10.4
    // m.
    const auto scenes = generate(straight(95.0, 20.0), {{{7.0, 0.0}, 0.0}}, options({0.0}, {40.0}));
    ASSERT_THAT(scenes, SizeIs(1));
    EXPECT_THAT(xs(scenes[0], scenes[0].ground_truth->left), ElementsAre(10, 15, 20, 25));
    EXPECT_THAT(xs(scenes[0], scenes[0].ground_truth->right), ElementsAre(10, 15, 20));
}

TEST(SceneGeneration, AnOpenCourseEndsAndShortRunsGiveNoScene) {
    std::vector<Pose> poses;
    for (const double x : {84.0, 86.0, 91.0, 99.0}) poses.push_back({{x, 0.0}, 0.0});
    const auto scenes = generate(straight(), poses, options({0.0}, {30.0}));
    // From x = 91 and beyond, less than two cones a side are ahead.
    ASSERT_THAT(scenes, SizeIs(2));
    EXPECT_THAT(xs(scenes[0], scenes[0].ground_truth->left), ElementsAre(85, 90, 95));
    EXPECT_THAT(xs(scenes[1], scenes[1].ground_truth->left), ElementsAre(90, 95));
    EXPECT_EQ(scenes[1].scene.id, "toy/pose_0001/fp_0.00/range_30");
}

TEST(SceneGeneration, RunsWrapOnAClosedCourse) {
    const Track track = circle();
    // At the angle of place 10.5, heading along the circle: places 11 and 0 lie ahead within 9 m.
    const double angle = 2.0 * std::numbers::pi * 10.5 / 12.0;
    const Pose pose{{10.0 * std::cos(angle), 10.0 * std::sin(angle)}, angle + std::numbers::pi / 2};
    const auto scenes = generate(track, {pose}, options({0.0}, {9.0}));
    ASSERT_THAT(scenes, SizeIs(1));
    EXPECT_THAT(places(scenes[0], scenes[0].ground_truth->left, track, track.left), ElementsAre(11, 0));
    EXPECT_THAT(places(scenes[0], scenes[0].ground_truth->right, track, track.right), ElementsAre(11, 0));
    EXPECT_FALSE(scenes[0].ground_truth->closed);
}

TEST(SceneGeneration, TheLaneIsClosedWhereBothRunsAreTheWholeBoundary) {
    const Track track = circle();
    // From (0, -20), looking along +y, all is ahead; the foot points lie at place 9, angle -90 degrees.
    const std::vector<Pose> poses{{{0.0, -20.0}, std::numbers::pi / 2}};
    SceneOptions wanted = options({0.0}, {40.0, 29.0});
    const auto scenes = generate(track, poses, wanted);
    ASSERT_THAT(scenes, SizeIs(2));
    const std::vector<std::size_t> all{9, 10, 11, 0, 1, 2, 3, 4, 5, 6, 7, 8};
    EXPECT_TRUE(scenes[0].ground_truth->closed);
    EXPECT_EQ(places(scenes[0], scenes[0].ground_truth->left, track, track.left), all);
    EXPECT_EQ(places(scenes[0], scenes[0].ground_truth->right, track, track.right), all);
    // At 29 m the far side of the outer boundary is out of view.
    EXPECT_FALSE(scenes[1].ground_truth->closed);

    // Missed cones do not open it: the boundary is whole without them.
    wanted.miss_rate = 0.3;
    const auto missed = generate(track, poses, wanted);
    ASSERT_THAT(missed, SizeIs(2));
    EXPECT_THAT(missed[0].scene.cones, SizeIs(AllOf(Ge(4u), Lt(24u))));
    EXPECT_TRUE(missed[0].ground_truth->closed);
    EXPECT_EQ(missed[0].ground_truth->left.size() + missed[0].ground_truth->right.size(),
              missed[0].scene.cones.size());

    // A set of the nearest cones does.
    wanted.miss_rate = 0.0;
    wanted.nearest = 14;
    const auto nearest = generate(track, poses, wanted);
    ASSERT_FALSE(nearest.empty());
    EXPECT_FALSE(nearest[0].ground_truth->closed);
}

TEST(SceneGeneration, TheNearestConesCutTheRuns) {
    SceneOptions wanted = options({0.0}, {30.0});
    wanted.nearest = 6;
    const auto scenes = generate(straight(), {{{7.0, -0.1}, 0.0}}, wanted);
    ASSERT_THAT(scenes, SizeIs(1));
    EXPECT_EQ(scenes[0].scene.id, "toy/pose_0000/fp_0.00/range_30/nearest_6");
    // Nearest: both at x = 10 (3 m), both at x = 15 (8 m), the stray point (9.5 m), the right one at x = 20.
    EXPECT_THAT(scenes[0].scene.cones, SizeIs(6));
    EXPECT_THAT(xs(scenes[0], scenes[0].ground_truth->left), ElementsAre(10, 15));
    EXPECT_THAT(xs(scenes[0], scenes[0].ground_truth->right), ElementsAre(10, 15, 20));
    wanted.nearest = 3;  // leaves one cone on a side
    EXPECT_THAT(generate(straight(), {{{7.0, -0.1}, 0.0}}, wanted), IsEmpty());
}

TEST(SceneGeneration, RatesGiveTheNumberOfFalsePositives) {
    // Seven points are seen: k / (7 + k) = rate.
    const std::vector<std::pair<double, std::size_t>> expected{{0.0, 0}, {0.1, 1}, {1.0 / 6.0, 1},
                                                               {0.3, 3}, {0.5, 7}, {0.99, 693}};
    for (const auto& [rate, count] : expected) {
        const auto scenes = generate(straight(), {{{7.0, 0.0}, 0.0}}, options({rate}, {15.0}));
        ASSERT_THAT(scenes, SizeIs(1));
        EXPECT_THAT(scenes[0].scene.cones, SizeIs(7 + count)) << rate;
        EXPECT_THAT(xs(scenes[0], scenes[0].ground_truth->left), ElementsAre(10, 15, 20)) << rate;
    }
}

TEST(SceneGeneration, IdsShowRateRangeAndDisturbances) {
    SceneOptions wanted = options({0.3, 1.0 / 6.0, 0.125}, {30.0, 12.5});
    wanted.noise_sigma_m = 0.1;
    wanted.pose_noise_lateral_m = 0.3;
    wanted.pose_noise_yaw_rad = 0.05;
    wanted.miss_rate = 0.05;
    wanted.nearest = 12;
    std::vector<std::string> ids;
    for (const auto& scene : generate(straight(), {{{30.0, 0.0}, 0.0}}, wanted))
        ids.push_back(scene.scene.id);
    const std::string rest = "/noise_0.1/pose_noise_0.3_0.05/miss_0.05/nearest_12";
    EXPECT_THAT(
        ids, ElementsAre("toy/pose_0000/fp_0.30/range_30" + rest,
                         "toy/pose_0000/fp_0.16666666666666666/range_30" + rest,
                         "toy/pose_0000/fp_0.125/range_30" + rest, "toy/pose_0000/fp_0.30/range_12.5" + rest,
                         "toy/pose_0000/fp_0.16666666666666666/range_12.5" + rest,
                         "toy/pose_0000/fp_0.125/range_12.5" + rest));
}

TEST(SceneGeneration, ColoursShowOnlyWhereAskedForAndFalsePositivesHaveAnyOfThem) {
    Track track = straight();
    track.cones[track.left[2]].color = ConeColor::orange;
    track.cones[track.left[3]].color = ConeColor::yellow;  // the recording was wrong
    SceneOptions wanted = options({0.9}, {15.0});
    const auto colorless = generate(track, {{{7.0, 0.0}, 0.0}}, wanted);
    for (const Cone& cone : colorless[0].scene.cones) {
        EXPECT_EQ(cone.color, ConeColor::unknown);
    }
    wanted.with_color = true;
    const auto scenes = generate(track, {{{7.0, 0.0}, 0.0}}, wanted);
    const Lane& lane = *scenes[0].ground_truth;
    EXPECT_EQ(cone_of(scenes[0], lane.left[0]).color, ConeColor::orange);
    EXPECT_EQ(cone_of(scenes[0], lane.left[1]).color, ConeColor::blue);
    EXPECT_EQ(cone_of(scenes[0], lane.right[0]).color, ConeColor::yellow);
    std::map<ConeColor, int> count;
    for (const Cone& cone : scenes[0].scene.cones) ++count[cone.color];
    EXPECT_EQ(count[ConeColor::orange], 1);
    for (const ConeColor color : {ConeColor::blue, ConeColor::yellow, ConeColor::unknown}) {
        EXPECT_GT(count[color], 10);  // of 63 false positives
    }
}

TEST(SceneGeneration, ColourErrorsPaintConesOfABoundaryLikeTheOtherOne) {
    const std::vector<Pose> poses(1000, Pose{{7.0, 0.0}, 0.0});
    SceneOptions wanted = options({0.3}, {15.0});
    wanted.with_color = true;
    const auto right = generate(straight(), poses, wanted);
    wanted.color_error_rate = 0.2;
    const auto scenes = generate(straight(), poses, wanted);
    ASSERT_THAT(scenes, SizeIs(1000));
    EXPECT_EQ(scenes[3].scene.id, "toy/pose_0003/fp_0.30/range_15/color_error_0.2");
    int wrong = 0;
    for (std::size_t i = 0; i < scenes.size(); ++i) {
        const auto count = [&](const std::vector<ConeId>& run, ConeColor own, ConeColor other) {
            for (const ConeId id : run) {
                const ConeColor color = cone_of(scenes[i], id).color;
                EXPECT_TRUE(color == own || color == other);
                if (color == other) ++wrong;
            }
        };
        count(scenes[i].ground_truth->left, ConeColor::blue, ConeColor::yellow);
        count(scenes[i].ground_truth->right, ConeColor::yellow, ConeColor::blue);
        // Nothing else has moved: the same false positives in the same order.
        ASSERT_EQ(scenes[i].scene.cones.size(), right[i].scene.cones.size());
        for (std::size_t c = 0; c < right[i].scene.cones.size(); ++c) {
            EXPECT_EQ(scenes[i].scene.cones[c].position, right[i].scene.cones[c].position);
        }
    }
    EXPECT_NEAR(wrong / 6000.0, 0.2, 0.02);  // three cones a side in each scene
}

/// Means and spreads of the two distributions by the Beta's formulas, and the share of pairs in which the
/// real cone has the higher confidence.
TEST(SceneGeneration, ConfidencesOfConesAndFalsePositivesOverlap) {
    const std::vector<Pose> poses(1000, Pose{{7.0, 0.0}, 0.0});
    SceneOptions wanted = options({0.5}, {15.0});
    const auto plain = generate(straight(), poses, wanted);
    wanted.with_confidence = true;
    const auto scenes = generate(straight(), poses, wanted);
    std::vector<double> real;
    std::vector<double> others;
    for (std::size_t i = 0; i < scenes.size(); ++i) {
        const Lane& lane = *scenes[i].ground_truth;
        for (std::size_t c = 0; c < scenes[i].scene.cones.size(); ++c) {
            const Cone& cone = scenes[i].scene.cones[c];
            EXPECT_EQ(plain[i].scene.cones[c].confidence, 1.0);
            EXPECT_EQ(plain[i].scene.cones[c].position, cone.position);
            ASSERT_TRUE(cone.confidence >= 0.0 && cone.confidence <= 1.0);
            const bool on_lane =
                std::ranges::count(lane.left, cone.id) + std::ranges::count(lane.right, cone.id) > 0;
            (on_lane ? real : others).push_back(cone.confidence);
        }
    }
    const auto expect_beta = [](const std::vector<double>& values, double a, double b) {
        const auto count = static_cast<double>(values.size());
        double sum = 0.0;
        double squares = 0.0;
        for (const double value : values) {
            sum += value;
            squares += value * value;
        }
        const double mean = sum / count;
        EXPECT_NEAR(mean, a / (a + b), 0.01);
        EXPECT_NEAR(squares / count - mean * mean, a * b / ((a + b) * (a + b) * (a + b + 1.0)), 0.002);
    };
    ASSERT_THAT(real, SizeIs(6000));
    ASSERT_THAT(others, SizeIs(8000));  // the stray point of the map and seven false positives
    expect_beta(real, 5.0, 2.0);
    expect_beta(others, 2.0, 4.0);
    int higher = 0;
    for (std::size_t i = 0; i < real.size(); ++i) {
        if (real[i] > others[i]) ++higher;
    }
    EXPECT_NEAR(higher / 6000.0, 0.93, 0.01);
}

TEST(SceneGeneration, DisturbancesHaveTheSpreadAskedFor) {
    const std::vector<Pose> poses(1000, Pose{{7.0, 0.0}, 0.0});
    SceneOptions wanted = options({0.0}, {15.0});
    wanted.pose_noise_lateral_m = 0.3;
    wanted.pose_noise_yaw_rad = 0.05;
    double squared_lateral = 0.0;
    double squared_yaw = 0.0;
    const auto displaced = generate(straight(), poses, wanted);
    ASSERT_THAT(displaced, SizeIs(1000));
    for (const auto& scene : displaced) {
        EXPECT_EQ(scene.scene.pose.position.x(), 7.0);
        squared_lateral += std::pow(scene.scene.pose.position.y(), 2);
        squared_yaw += std::pow(scene.scene.pose.yaw_rad, 2);
    }
    EXPECT_NEAR(std::sqrt(squared_lateral / 1000), 0.3, 0.03);
    EXPECT_NEAR(std::sqrt(squared_yaw / 1000), 0.05, 0.005);

    wanted = options({0.0}, {15.0});
    wanted.noise_sigma_m = 0.1;
    double squared = 0.0;
    for (const auto& scene : generate(straight(), poses, wanted)) {
        EXPECT_THAT(scene.scene.cones, SizeIs(7)) << "which cones are visible does not depend on the noise";
        squared += (cone_of(scene, scene.ground_truth->left[0]).position - Point(10.0, 1.5)).squaredNorm();
    }
    EXPECT_NEAR(std::sqrt(squared / 2000), 0.1, 0.01);

    wanted = options({0.0}, {40.0});
    wanted.miss_rate = 0.2;
    std::size_t seen = 0;
    for (const auto& scene : generate(straight(), poses, wanted)) seen += scene.scene.cones.size();
    // From x = 7 to x = 47: eight cones a side and the stray point.
    EXPECT_NEAR(static_cast<double>(seen) / 17000.0, 0.8, 0.01);
}

TEST(SceneGeneration, RunsGoOnPastMissedCones) {
    SceneOptions wanted = options({0.0}, {40.0});
    wanted.miss_rate = 0.2;
    bool gap = false;
    const std::vector<Pose> poses(50, Pose{{7.0, 0.0}, 0.0});
    for (const auto& scene : generate(straight(), poses, wanted)) {
        for (const auto* run : {&scene.ground_truth->left, &scene.ground_truth->right}) {
            const std::vector<double> x = xs(scene, *run);
            const double y = cone_of(scene, run->front()).position.y();
            // Every seen cone of the side up to the run's end is in the run.
            const auto up_to_end = std::ranges::count_if(scene.scene.cones, [&](const Cone& cone) {
                return cone.position.y() == y && cone.position.x() <= x.back();
            });
            EXPECT_EQ(static_cast<std::size_t>(up_to_end), x.size()) << scene.scene.id;
            EXPECT_TRUE(std::ranges::is_sorted(x));
            for (std::size_t i = 1; i < x.size(); ++i) gap = gap || x[i] - x[i - 1] > 5.0;
        }
    }
    EXPECT_TRUE(gap) << "no run had a missed cone inside";
}

TEST(SceneGeneration, FalsePositivesFillTheHalfDiscAndOnlyIt) {
    int scenes_made = 0;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        SCOPED_TRACE(seed);
        SceneOptions wanted = options({0.99}, {15.0});
        wanted.seed = seed;
        const double yaw_rad = 0.3 * static_cast<double>(seed) - 3.0;
        const Track track = circle();
        const auto scenes = generate(track, {{{0.5, 0.25}, yaw_rad}}, wanted);
        if (scenes.empty()) continue;  // fewer than two cones of a side are ahead
        ++scenes_made;
        const Scene& scene = scenes[0].scene;
        double ahead_m = 0.0;
        double left_m = 0.0;
        std::size_t count = 0;
        for (const Cone& cone : scene.cones) {
            const bool of_track = std::ranges::any_of(
                track.cones, [&](const Cone& other) { return other.position == cone.position; });
            EXPECT_GE(scene.pose.ahead_m(cone.position), 0.0);
            EXPECT_LE((cone.position - scene.pose.position).norm(), 15.0 + 1e-12);
            if (of_track) continue;
            ++count;
            ahead_m += scene.pose.ahead_m(cone.position);
            left_m += scene.pose.left_m(cone.position);
        }
        // Centroid of a half disc: 4 r / (3 pi) ahead, on the axis. About 1200 points: 5 standard errors.
        ASSERT_GT(count, 900u);
        EXPECT_NEAR(ahead_m / static_cast<double>(count), 4.0 * 15.0 / (3.0 * std::numbers::pi), 0.7);
        EXPECT_NEAR(left_m / static_cast<double>(count), 0.0, 1.2);
    }
    EXPECT_GE(scenes_made, 10);
}

SceneOptions in_conditions(std::vector<std::string> names, double rate = 0.0) {
    SceneOptions result = options({rate}, {15.0});
    result.conditions = std::move(names);
    return result;
}

TEST(SceneConditions, LapsFollowOneAnotherAndNameTheirCondition) {
    SceneOptions wanted = options({0.0, 0.3}, {15.0, 20.0});
    wanted.conditions = {"car", "paper"};
    std::vector<std::string> ids;
    std::vector<std::string> conditions;
    for (const auto& scene : generate(straight(), {{{7.0, 0.0}, 0.0}}, wanted)) {
        ids.push_back(scene.scene.id);
        conditions.push_back(scene.condition);
    }
    EXPECT_THAT(ids, ElementsAre("toy/pose_0000/fp_0.00/range_15/car", "toy/pose_0000/fp_0.30/range_15/car",
                                 "toy/pose_0000/fp_0.00/range_20/car", "toy/pose_0000/fp_0.30/range_20/car",
                                 "toy/pose_0000/fp_0.00/range_15", "toy/pose_0000/fp_0.30/range_15",
                                 "toy/pose_0000/fp_0.00/range_20", "toy/pose_0000/fp_0.30/range_20"));
    EXPECT_THAT(conditions, ElementsAre("car", "car", "car", "car", "paper", "paper", "paper", "paper"));
}

TEST(SceneConditions, PaperIsNotDisturbed) {
    const std::vector<Pose> poses{{{7.0, 0.0}, 0.0}, {{9.0, 0.0}, 0.1}};
    auto named = generate(straight(), poses, in_conditions({"paper"}, 0.3));
    for (AnnotatedScene& scene : named) {
        EXPECT_EQ(scene.condition, "paper");
        scene.condition.clear();
    }
    EXPECT_EQ(bytes(named), bytes(generate(straight(), poses, options({0.3}, {15.0}))));
}

TEST(SceneConditions, AnOptionReplacesItsPartAndTheNameSaysSo) {
    const auto names = [](const std::function<void(SceneOptions&)>& change) {
        SceneOptions wanted = in_conditions({"paper", "car"});
        change(wanted);
        return condition_names(wanted);
    };
    EXPECT_THAT(names([](SceneOptions&) {}), ElementsAre("paper", "car"));
    EXPECT_THAT(names([](SceneOptions& o) { o.noise_sigma_m = 0.1; }), ElementsAre("paper+noise_0.1", "car"));
    EXPECT_THAT(names([](SceneOptions& o) { o.miss_rate = 0.0; }), ElementsAre("paper", "car+miss_0"));
    EXPECT_THAT(names([](SceneOptions& o) { o.persistent = false; }), ElementsAre("paper", "car+no_persist"));
    EXPECT_THAT(names([](SceneOptions& o) { o.persistent = true; }), ElementsAre("paper+persist", "car"));
    EXPECT_THAT(names([](SceneOptions& o) {
                    o.pose_noise_lateral_m = 0.5;
                    o.pose_noise_yaw_rad = 0.0;
                    o.miss_rate = 0.2;
                }),
                ElementsAre("paper+pose_noise_0.5_0+miss_0.2", "car+pose_noise_0.5_0+miss_0.2"));
    EXPECT_THAT(condition_names(options({0.0}, {15.0})), IsEmpty());

    SceneOptions wanted = in_conditions({"car"});
    wanted.miss_rate = 0.0;
    const auto scenes = generate(straight(), {{{7.0, 0.0}, 0.0}}, wanted);
    ASSERT_THAT(scenes, SizeIs(1));
    EXPECT_EQ(scenes[0].scene.id, "toy/pose_0000/fp_0.00/range_15/car+miss_0");
    EXPECT_THAT(scenes[0].missed, IsEmpty());
}

/// The standard deviations and the share of missed cones that metrics.md states.
TEST(SceneConditions, CarAndHarshDisturbAsMuchAsTheySay) {
    struct Expected {
        const char* name;
        double noise_m;
        double lateral_m;
        double yaw_degrees;
        double missed;
    };
    const std::vector<Pose> poses(4000, Pose{{7.0, 0.0}, 0.0});
    const Track track = straight();
    for (const Expected& expected :
         {Expected{"car", 0.1, 0.3, 5.0, 0.05}, Expected{"harsh", 0.2, 0.5, 8.0, 0.1}}) {
        SCOPED_TRACE(expected.name);
        SceneOptions wanted = in_conditions({expected.name});
        wanted.ranges_m = {40.0};
        double noise_m2 = 0.0;
        double lateral_m2 = 0.0;
        double yaw_rad2 = 0.0;
        double boundary_cones = 0.0;
        double seen = 0.0;
        double missed = 0.0;
        const auto scenes = generate(track, poses, wanted);
        ASSERT_GT(scenes.size(), 3990u);  // a few miss all but one cone of a side
        for (const auto& scene : scenes) {
            lateral_m2 += std::pow(scene.scene.pose.position.y(), 2);
            yaw_rad2 += std::pow(scene.scene.pose.yaw_rad, 2);
            seen += static_cast<double>(scene.scene.cones.size());
            missed += static_cast<double>(scene.missed.size());
            for (const ConeId id : scene.ground_truth->left) {
                const Point position = cone_of(scene, id).position;
                noise_m2 += std::pow(position.y() - 1.5, 2);  // the spacing is far above the noise
                noise_m2 += std::pow(position.x() - 5.0 * std::round(position.x() / 5.0), 2);
                boundary_cones += 1.0;
            }
            for (const Cone& cone : scene.missed) {
                EXPECT_TRUE(std::ranges::any_of(
                    track.cones, [&](const Cone& other) { return other.position == cone.position; }));
                EXPECT_TRUE(std::ranges::none_of(scene.scene.cones,
                                                 [&](const Cone& other) { return other.id == cone.id; }));
            }
        }
        const auto count = static_cast<double>(scenes.size());
        EXPECT_NEAR(std::sqrt(noise_m2 / (2.0 * boundary_cones)), expected.noise_m, 0.02 * expected.noise_m);
        EXPECT_NEAR(std::sqrt(lateral_m2 / count), expected.lateral_m, 0.05 * expected.lateral_m);
        EXPECT_NEAR(std::sqrt(yaw_rad2 / count) * 180.0 / std::numbers::pi, expected.yaw_degrees,
                    0.05 * expected.yaw_degrees);
        EXPECT_NEAR(missed / (seen + missed), expected.missed, 0.004);
    }
}

TEST(SceneConditions, MissedConesAreKeptOnlyWhereAConditionIsNamed) {
    SceneOptions wanted = options({0.0}, {40.0});
    wanted.miss_rate = 0.2;
    for (const auto& scene : generate(straight(), std::vector<Pose>(20, Pose{{7.0, 0.0}, 0.0}), wanted)) {
        EXPECT_THAT(scene.missed, IsEmpty());
    }
}

/// The false positives of a scene: what is no cone of the track.
std::vector<Cone> false_positives(const AnnotatedScene& scene, const Track& track) {
    std::vector<Cone> result;
    for (const Cone& cone : scene.scene.cones) {
        if (std::ranges::find(track.cones, cone.position, &Cone::position) == track.cones.end())
            result.push_back(cone);
    }
    return result;
}

TEST(PersistentFalsePositives, KeepIdAndPlaceAlongALap) {
    const Track track = circle();
    SceneOptions wanted = options({0.5}, {15.0});
    wanted.persistent = true;
    wanted.with_color = true;
    const auto scenes = generate_scenes(track, wanted);
    ASSERT_GT(scenes.size(), 50u);
    EXPECT_EQ(scenes[3].scene.id, "circle/pose_0003/fp_0.50/range_15/persist");
    std::map<ConeId, Cone> known;
    std::map<ConeId, int> views;
    for (const auto& scene : scenes) {
        const std::vector<Cone> seen = false_positives(scene, track);
        for (const Cone& cone : seen) {
            const auto [first, is_new] = known.try_emplace(cone.id, cone);
            EXPECT_EQ(first->second.position, cone.position);
            EXPECT_EQ(first->second.color, cone.color);
            ++views[cone.id];
        }
        // Whatever of them is in view is seen.
        for (const auto& [id, cone] : known) {
            const bool in_view = scene.scene.pose.ahead_m(cone.position) >= 0.0 &&
                                 (cone.position - scene.scene.pose.position).norm() <= 15.0;
            EXPECT_EQ(in_view, std::ranges::find(seen, id, &Cone::id) != seen.end()) << id;
        }
    }
    EXPECT_GT(known.size(), 20u);
    EXPECT_TRUE(std::ranges::any_of(views, [](const auto& entry) { return entry.second > 10; }));
    for (const Cone& cone : scenes[0].scene.cones) EXPECT_THAT(cone.id, AllOf(Ge(0), Lt(10'000)));
}

TEST(PersistentFalsePositives, AreAsDenseAsFreshOnes) {
    const Track track = circle();
    for (const auto& [rate, miss_rate] : {std::pair{0.1, 0.0}, std::pair{0.3, 0.1}, std::pair{0.5, 0.0}}) {
        SCOPED_TRACE(rate);
        double fresh = 0.0;
        double persistent = 0.0;
        for (std::uint64_t seed = 0; seed < 400; ++seed) {
            SceneOptions wanted = options({rate}, {15.0});
            wanted.seed = seed;
            wanted.miss_rate = miss_rate;
            for (const auto& scene : generate_scenes(track, wanted))
                fresh += static_cast<double>(false_positives(scene, track).size());
            wanted.persistent = true;
            for (const auto& scene : generate_scenes(track, wanted))
                persistent += static_cast<double>(false_positives(scene, track).size());
        }
        EXPECT_NEAR(persistent / fresh, 1.0, 0.05);
    }
}

TEST(PersistentFalsePositives, BytesDependNeitherOnThreadsNorOnOtherScenes) {
    SceneOptions wanted = in_conditions({"paper", "harsh"}, 0.3);
    wanted.persistent = true;
    wanted.ranges_m = {15.0, 20.0};
    const Track track = circle();
    const auto scenes = generate_scenes(track, wanted);
    wanted.threads = 2;
    EXPECT_EQ(bytes(generate_scenes(track, wanted)), bytes(scenes));
    // One pose alone, of one lap.
    wanted.conditions = {"harsh"};
    wanted.ranges_m = {20.0};
    wanted.every_m = 2.2;
    const auto alone = generate_scenes(track, wanted);
    const auto same = std::ranges::find(scenes, alone.front().scene.id,
                                        [](const AnnotatedScene& scene) { return scene.scene.id; });
    ASSERT_NE(same, scenes.end());
    EXPECT_EQ(bytes({alone.front()}), bytes({*same}));
}

TEST(PersistentFalsePositives, MoreThanThereAreIdsAreRefused) {
    SceneOptions wanted = options({0.99}, {30.0});
    wanted.persistent = true;
    try {
        static_cast<void>(generate_scenes(straight(), wanted));
        FAIL() << "not refused";
    } catch (const InvalidInput& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("fp: 0.99 gives"));
    }
}

TEST(SceneGeneration, IdsAndOrderTellNothing) {
    std::vector<Pose> poses;
    for (double x = 3.0; x < 60.0; x += 1.1) poses.push_back({{x, 0.0}, 0.0});
    SceneOptions wanted = options({0.0, 0.5}, {30.0});
    const Track track = straight();
    const auto scenes = generate(track, poses, wanted);
    std::map<std::pair<double, double>, ConeId> id_at;
    std::set<ConeId> ids_of_track;
    for (const auto& scene : scenes) {
        std::set<ConeId> ids;
        for (const Cone& cone : scene.scene.cones) {
            EXPECT_TRUE(ids.insert(cone.id).second) << "id " << cone.id << " twice in " << scene.scene.id;
            EXPECT_THAT(cone.id, AllOf(Ge(0), Lt(10'000)));
            const bool of_track = std::ranges::any_of(
                track.cones, [&](const Cone& other) { return other.position == cone.position; });
            if (!of_track) continue;
            const auto [known, is_new] = id_at.try_emplace({cone.position.x(), cone.position.y()}, cone.id);
            EXPECT_EQ(known->second, cone.id) << "a cone of the track changes its id along the lap";
            ids_of_track.insert(cone.id);
        }
    }
    EXPECT_EQ(ids_of_track.size(), id_at.size());
    // Neither ids nor order follow the boundary.
    const auto& scene = scenes.front();
    EXPECT_FALSE(std::ranges::is_sorted(scene.ground_truth->left));
    EXPECT_FALSE(std::ranges::is_sorted(scene.scene.cones, {}, [](const Cone& c) { return c.position.x(); }));
    EXPECT_FALSE(std::ranges::is_sorted(scene.scene.cones, {}, &Cone::id));
    wanted.seed = 1;
    EXPECT_NE(generate(track, poses, wanted).front().ground_truth->left, scene.ground_truth->left);
}

TEST(SceneGeneration, BytesDependNeitherOnThreadsNorOnOtherScenes) {
    std::vector<Pose> poses;
    for (double x = 3.0; x < 40.0; x += 1.1) poses.push_back({{x, 0.1}, 0.02});
    for (std::uint64_t seed = 0; seed < 5; ++seed) {
        SCOPED_TRACE(seed);
        SceneOptions wanted = options({0.1, 0.3}, {30.0, 50.0});
        wanted.seed = seed;
        wanted.noise_sigma_m = 0.1;
        wanted.pose_noise_lateral_m = 0.2;
        wanted.miss_rate = 0.05;
        wanted.with_color = true;
        wanted.color_error_rate = 0.1;
        wanted.with_confidence = true;
        const auto scenes = generate(straight(), poses, wanted);
        ASSERT_EQ(scenes.size(), 4 * poses.size());
        wanted.threads = 4;
        EXPECT_EQ(bytes(generate(straight(), poses, wanted)), bytes(scenes));

        // One lap alone, and of it the first poses alone.
        wanted.false_positive_rates = {0.3};
        wanted.ranges_m = {50.0};
        const std::vector<AnnotatedScene> last_lap(scenes.end() - static_cast<std::ptrdiff_t>(poses.size()),
                                                   scenes.end());
        EXPECT_EQ(bytes(generate(straight(), poses, wanted)), bytes(last_lap));
        EXPECT_EQ(bytes(generate_scenes(straight(), std::span(poses).first(3), wanted)),
                  bytes({last_lap.begin(), last_lap.begin() + 3}));

        wanted.seed = seed + 1;
        EXPECT_NE(bytes(generate(straight(), poses, wanted)), bytes(last_lap));
    }
}

TEST(SceneGeneration, BytesAreTheSameOnEveryMachine) {
    // A change of the generator, of a distribution or of the order of draws shows here.
    SceneOptions wanted = options({0.3}, {15.0});
    wanted.seed = 7;
    const auto scenes = generate(straight(), {{{7.0, 0.0}, 0.0}}, wanted);
    EXPECT_EQ(bytes(scenes),
              R"({"id":"toy/pose_0000/fp_0.30/range_15","pose":{"x":7.0,"y":0.0,"yaw":0.0},"cones":[)"
              R"({"id":8612,"x":12.0,"y":8.0,"color":"unknown","confidence":1.0},)"
              R"({"id":4623,"x":15.0,"y":1.5,"color":"unknown","confidence":1.0},)"
              R"({"id":1593,"x":20.0,"y":1.5,"color":"unknown","confidence":1.0},)"
              R"({"id":4136,"x":15.0,"y":-1.5,"color":"unknown","confidence":1.0},)"
              R"({"id":3095,"x":10.0,"y":1.5,"color":"unknown","confidence":1.0},)"
              R"({"id":7358,"x":8.944551,"y":-7.229613,"color":"unknown","confidence":1.0},)"
              R"({"id":4440,"x":10.0,"y":-1.5,"color":"unknown","confidence":1.0},)"
              R"({"id":3073,"x":15.577195,"y":4.455415,"color":"unknown","confidence":1.0},)"
              R"({"id":3140,"x":18.965502,"y":5.995767,"color":"unknown","confidence":1.0},)"
              R"({"id":3961,"x":20.0,"y":-1.5,"color":"unknown","confidence":1.0}],)"
              R"("ground_truth":{"left":[3095,4623,1593],"right":[4440,4136,3961],"closed":false},)"
              R"("track":"toy","false_positive_rate":0.3,"range":15.0,"seed":7})"
              "\n");
}

TEST(SceneGeneration, WithoutPosesTheCarDrivesTheCentreLine) {
    SceneOptions wanted = options({0.0, 0.3}, {30.0});
    wanted.every_m = 2.0;
    const auto scenes = generate_scenes(straight(), wanted);
    // From x = 0 to x = 90, where the last two cones of each side are at or ahead of the car; twice.
    ASSERT_THAT(scenes, SizeIs(92));
    for (std::size_t i = 0; i < scenes.size(); ++i) {
        const Pose& pose = scenes[i].scene.pose;
        EXPECT_NEAR(pose.position.x(), 2.0 * static_cast<double>(i % 46), 1e-6);
        EXPECT_NEAR(pose.position.y(), 0.0, 1e-6);
        EXPECT_NEAR(pose.yaw_rad, 0.0, 1e-6);
        EXPECT_EQ(scenes[i].false_positive_rate, i < 46 ? 0.0 : 0.3);
    }
    wanted.every_m = 0.0;
    EXPECT_THROW(static_cast<void>(generate_scenes(straight(), wanted)), InvalidInput);
}

TEST(SceneGeneration, NamesOptionsOutOfRange) {
    const auto error = [](const std::function<void(SceneOptions&)>& change) -> std::string {
        SceneOptions wanted = options({0.0}, {30.0});
        change(wanted);
        try {
            validate(wanted);
        } catch (const InvalidInput& invalid) {
            return invalid.what();
        }
        return "no error";
    };
    static constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(error([](SceneOptions&) {}), "no error");
    EXPECT_EQ(error([](SceneOptions& o) { o.false_positive_rates = {}; }),
              "fp: must hold at least one value");
    EXPECT_EQ(error([](SceneOptions& o) { o.false_positive_rates = {1.0}; }), "fp: must be in [0, 0.99]");
    EXPECT_EQ(error([](SceneOptions& o) { o.false_positive_rates = {kNan}; }), "fp: must be in [0, 0.99]");
    EXPECT_EQ(error([](SceneOptions& o) { o.false_positive_rates = {0.3, 0.3}; }), "fp: 0.3 is there twice");
    EXPECT_EQ(error([](SceneOptions& o) { o.ranges_m = {0.0}; }), "range: must be in [0.1, 1000]");
    EXPECT_EQ(error([](SceneOptions& o) { o.every_m = 0.0; }), "every: must be in [0.01, 1000]");
    EXPECT_EQ(error([](SceneOptions& o) { o.nearest = 0; }), "nearest: must be at least 1");
    EXPECT_EQ(error([](SceneOptions& o) { o.noise_sigma_m = -1.0; }), "noise: must be in [0, 1000]");
    EXPECT_EQ(error([](SceneOptions& o) { o.pose_noise_yaw_rad = kNan; }),
              "pose-noise: must be in [0, 1000]");
    EXPECT_EQ(error([](SceneOptions& o) { o.miss_rate = 1.0; }), "miss: must be in [0, 1)");
    EXPECT_EQ(error([](SceneOptions& o) {
                  o.with_color = true;
                  o.color_error_rate = 1.5;
              }),
              "color-error: must be in [0, 1]");
    EXPECT_EQ(error([](SceneOptions& o) { o.color_error_rate = 0.1; }),
              "color-error: needs scenes with colour");
    EXPECT_EQ(error([](SceneOptions& o) { o.threads = 0; }), "threads: must be in [1, 1024]");
    EXPECT_EQ(error([](SceneOptions& o) { o.conditions = {"rain"}; }),
              "condition: 'rain' is none of paper, car, harsh");
    EXPECT_EQ(error([](SceneOptions& o) { o.conditions = {"car", "car"}; }), "condition: car is there twice");

    const SceneOptions good = options({0.5}, {30.0});
    EXPECT_THROW(generate(straight(), {{{kNan, 0.0}, 0.0}}, good), InvalidInput);
    EXPECT_THROW(generate(straight(), {{{0.0, 0.0}, kNan}}, good), InvalidInput);
    EXPECT_THROW(generate(straight(), {{{1e12, 0.0}, 0.0}}, good), InvalidInput);
    EXPECT_THAT(generate(straight(), {}, good), IsEmpty());
    EXPECT_THAT(generate(Track{"empty", {}, {}, {}, true}, {{{0.0, 0.0}, 0.0}}, good), IsEmpty());
}

}  // namespace
}  // namespace conelane::experiments
