// Properties in the table of detectors: the courses that each has learned from, whether it closes lanes, what
// it does with colors. They are compared with the detectors' answers.

#include "experiments/methods/method.hpp"
#include "tests/support/cones_at.hpp"
#include "tests/support/no_time_limit.hpp"
#include "tests/support/random_scenes.hpp"

namespace conelane {
namespace {

enum class Painted { not_at_all, as_drawn, the_other_way };

/// Random cones; those of even index are on the left if they bound the lane. Fewer cones for the printed
/// formulation, which takes seconds for twelve.
Scene painted_scene(std::uint64_t seed, Painted how) {
    Scene scene = tests::random_scene(seed, 9);
    if (how == Painted::not_at_all) return scene;
    for (std::size_t i = 0; i < scene.cones.size(); ++i) {
        const bool is_blue = (i % 2 == 0) == (how == Painted::as_drawn);
        scene.cones[i].color = is_blue ? ConeColor::blue : ConeColor::yellow;
    }
    return scene;
}

/// The number of scenes in which the lane differs from the lane without colors.
int lanes_changed_by_color(const DetectorRecipe& known, const DetectorOptions& options = {}) {
    int changed = 0;
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
        std::vector<Lane> lanes;
        for (const Painted how : {Painted::not_at_all, Painted::as_drawn, Painted::the_other_way}) {
            lanes.push_back(
                make_detector(known, options)->detect(painted_scene(seed, how), tests::kNoTimeLimit).lane);
        }
        if (lanes[0] != lanes[1] || lanes[0] != lanes[2]) ++changed;
    }
    return changed;
}

class DetectorRecipes : public testing::TestWithParam<const DetectorRecipe*> {};

TEST_P(DetectorRecipes, SayWhetherLanesAreClosed) {
    const LaneAnswer answer =
        make_detector(*GetParam())->detect(tests::circuit_seen_whole(), {.time_limit_ms = 2000.0});
    EXPECT_EQ(answer.lane.closed, GetParam()->closed_lanes == ClosedLanes::possible);
}

TEST_P(DetectorRecipes, SayWhatColorsDo) {
    const int changed = lanes_changed_by_color(*GetParam());
    switch (GetParam()->color_use) {
        case ColorUse::ignored:
            EXPECT_EQ(changed, 0);
            break;
        case ColorUse::by_weight: {
            EXPECT_EQ(changed, 0) << "by default they have no weight";
            DetectorOptions options;
            options.rld_parameters.emplace().w_color = 1000.0;
            EXPECT_GT(lanes_changed_by_color(*GetParam(), options), 0);
            break;
        }
        case ColorUse::used:
            EXPECT_GT(changed, 0);
            break;
    }
}

std::vector<const DetectorRecipe*> all() {
    return mapped(experiments::known_methods(), &experiments::Method::recipe);
}

INSTANTIATE_TEST_SUITE_P(Detectors, DetectorRecipes, testing::ValuesIn(all()),
                         [](const auto& test) { return case_name(test.param->name); });

TEST(TrainingCourses, AreThoseOfTheRecordsOfAllItsWeightsAndThoseInViewWhenParametersWereSet) {
    using experiments::training_courses;
    EXPECT_THAT(training_courses("front"), Contains("wide@1"));
    EXPECT_EQ(training_courses("front"), training_courses("front-warm"));
    EXPECT_THAT(training_courses("clc"), Contains("curvy@1")) << "of the network";
    EXPECT_THAT(training_courses("clc"), Contains("slalom@23")) << "of the step scores alone";
    EXPECT_THAT(training_courses("clc-paper"), Not(Contains("slalom@23")));
    EXPECT_THAT(training_courses("clc"), Not(Contains("circle")));
    EXPECT_THAT(training_courses("rld-shape"), Contains("fsd_6"));
    for (const char* learned : {"rld-learned", "rld-strip"})
        EXPECT_THAT(training_courses(learned), AllOf(Contains("fsd_6"), Contains("kidney@4")));
    for (const char* const none : {"rld-pair", "rld-context", "no detector"})
        EXPECT_THAT(training_courses(none), IsEmpty()) << none;
}

}  // namespace
}  // namespace conelane
