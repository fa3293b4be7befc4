// The warm start of section IV-F along the lap of a generated track.

#include "evaluation/formats/scene_set.hpp"
#include "evaluation/scoring/score.hpp"
#include "experiments/methods/method.hpp"
#include "graph_search/clc/clc_detector.hpp"
#include "tests/support/no_time_limit.hpp"
#include "tests/support/testing.hpp"

namespace conelane::experiments {
namespace {

SceneSet lap(double rate, double range_m) {
    SceneOptions options{.false_positive_rates = {rate}, .ranges_m = {range_m}, .every_m = 2.2};
    return make_scene_set({"generated:kidney@5"}, options);
}

std::size_t successes(const char* name, const SceneSet& set) {
    const std::unique_ptr<LaneDetector> detector = make_detector(name);
    std::size_t count = 0;
    for (const AnnotatedScene& scene : set.scenes) {
        const LaneAnswer answer = detector->detect(scene.scene, tests::kNoTimeLimit);
        if (score(scene, answer, 0.0, std::nullopt, &set.tracks.at(scene.track)).success()) ++count;
    }
    return count;
}

TEST(WarmStart, KeepsTheLaneAlongALapWithoutFalsePositives) {
    const SceneSet set = lap(0.0, 30.0);
    ASSERT_GT(set.scenes.size(), 50u);
    EXPECT_EQ(successes("clc-warm", set), set.scenes.size());
}

TEST(WarmStart, LosesTheLaneNoMoreOftenThanAColdOneAmongFalsePositives) {
    const SceneSet set = lap(0.4, 40.0);
    EXPECT_GE(successes("clc-warm", set), successes("clc", set));
}

TEST(WarmStart, GoesAlongTheLastLaneFirst) {
    const SceneSet set = lap(0.3, 40.0);
    ClcOptions options = extended_clc_options();
    options.warm_start = true;
    options.iteration_limit = 200;  // too few to find much without a start
    const std::unique_ptr<LaneDetector> detector = make_clc_detector(options);
    // The same scene twice: the earlier answer is met again and kept.
    const AnnotatedScene& scene = set.scenes[10];
    const auto length_m = [&] {
        return score(scene, detector->detect(scene.scene, tests::kNoTimeLimit), 0.0, std::nullopt, nullptr)
            .lane_length_m;
    };
    const double first_m = length_m();
    const double second_m = length_m();
    EXPECT_GT(first_m, 10.0);
    EXPECT_GE(second_m, 0.9 * first_m);
}

}  // namespace
}  // namespace conelane::experiments
