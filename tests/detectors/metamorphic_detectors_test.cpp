// Transformed scenes have the same lane, for every detector of the library.

#include "detectors/recipe.hpp"
#include "evaluation/formats/scene_set.hpp"
#include "tests/support/detector_names.hpp"
#include "tests/support/metamorphic.hpp"
#include "tests/support/no_time_limit.hpp"

namespace conelane {
namespace {

using tests::Change;

constexpr double kObjectiveTolerance = 1e-9;

/// Views of generated courses at four rates of false positives, one after another along a lap.
const std::vector<Scene>& scenes() {
    static const std::vector<Scene> kScenes = [] {
        SceneOptions options{.false_positive_rates = {0.0, 0.1, 0.3, 0.5},
                             .ranges_m = {20.0},
                             .every_m = 17.0,
                             .noise_sigma_m = 0.05,
                             .pose_noise_lateral_m = 0.2,
                             .pose_noise_yaw_rad = 0.05,
                             .miss_rate = 0.03,
                             .seed = 3};
        std::vector<Scene> all;
        for (AnnotatedScene& made :
             make_scene_set({"generated:kidney", "generated:hairpins"}, options).scenes) {
            all.push_back(tests::on_grid(std::move(made.scene)));
        }
        return all;
    }();
    return kScenes;
}

bool is_rld(std::string_view name) {
    return name.starts_with("rld") && name != "rld-strip";
}

/// RLD proves its optimum, which takes too long with all cones of the hardest of these scenes.
Scene scene_for(std::string_view name, const Scene& scene) {
    return is_rld(name) ? nearest_ahead(scene, 26) : scene;
}

void expect_near(const std::optional<double>& a, const std::optional<double>& b, double tolerance) {
    ASSERT_EQ(a.has_value(), b.has_value());
    if (a) {
        EXPECT_NEAR(*a, *b, tolerance);
    }
}

/// The number of scenes with a lane, and of those whose lane differs after the transformation.
struct Outcome {
    std::size_t scenes = 0;
    std::size_t found = 0;
    std::size_t different = 0;
};

/// Warm detectors see the scenes as a lap, so both keep the same lanes.
Outcome compare(LaneDetector& detector, LaneDetector& other, std::string_view name, const Change& original,
                const Change& change, bool compares_confidence) {
    // Moved far, positions are multiples of a micrometre, and the midpoints of edges are rounded. In a scene
    // that is larger by a billionth, learned costs of lengths differ by about as much.
    const double tolerance = change.name == "MovedFar" ? 1e-5
                             : change.name == "Larger" ? 1e-7
                                                       : kObjectiveTolerance;
    Outcome outcome;
    for (const Scene& any : scenes()) {
        const Scene scene = scene_for(name, any);
        SCOPED_TRACE(scene.id);
        ++outcome.scenes;
        const LaneAnswer answer = detector.detect(original.apply(scene), tests::kNoTimeLimit);
        const LaneAnswer changed = other.detect(change.apply(scene), tests::kNoTimeLimit);
        EXPECT_NE(answer.status, LaneStatus::error) << answer.message;
        EXPECT_EQ(changed.status, answer.status) << changed.message;
        if (answer.status == LaneStatus::found) ++outcome.found;
        EXPECT_EQ(answer.optimality.has_value(), changed.optimality.has_value());
        if (answer.optimality && changed.optimality) {
            EXPECT_NEAR(changed.optimality->objective, answer.optimality->objective, tolerance);
        }
        if (changed.lane != change.apply_to(answer.lane)) {
            ++outcome.different;
        } else if (compares_confidence) {
            // Features are single precision.
            expect_near(changed.confidence, answer.confidence, 1e-4);
            expect_near(changed.trusted_m, answer.trusted_m, 1e-4);
        }
    }
    return outcome;
}

const Change kAsItIs{"AsItIs", [](Scene scene) { return scene; }};

class DetectorMetamorphic : public testing::TestWithParam<std::tuple<std::string, Change>> {};

TEST_P(DetectorMetamorphic, FindsTheSameLane) {
    const auto& [name, change] = GetParam();
    const bool adds_a_cone = change.name.starts_with("With");
    const auto detector = make_detector(name);
    const auto other = make_detector(name);
    // The number of cones is an input of the confidence.
    const Outcome outcome = compare(*detector, *other, name, kAsItIs, change, !adds_a_cone);
    EXPECT_GT(outcome.found, outcome.scenes * 3 / 4);
    EXPECT_EQ(outcome.different, 0U) << "of " << outcome.scenes;
}

class DetectorScale : public testing::TestWithParam<std::string> {};

/// The RLD detector alone, without drivable: whether its lanes can be driven depends on metres.
std::unique_ptr<LaneDetector> bare_rld_detector(std::string_view name, const DetectorOptions& options) {
    const DetectorRecipe& recipe = *std::ranges::find(detector_recipes(), name, &DetectorRecipe::name);
    return make_rld_detector(
        std::get<RldRecipe>(recipe.how).make_solver(),
        {.parameters = rld_parameters(recipe, options), .cones = cone_set(recipe, options)});
}

/// Scenes twice as large, with the lengths of the parameters.
TEST(RldMetamorphic, FindsTheSameLaneAtAnotherScale) {
    const Change larger{"Larger", [](Scene scene) { return tests::scaled(std::move(scene), 2.0); }};
    for (const std::string& name : tests::detector_names()) {
        if (!is_rld(name)) continue;
        SCOPED_TRACE(name);
        DetectorOptions options;
        options.rld_parameters =
            name.starts_with("rld-shape") ? with_shape_costs(RldParameters{}) : RldParameters{};
        const auto detector = bare_rld_detector(name, options);
        for (const auto& fields : {rld_parameter_fields(), rld_extra_fields()}) {
            for (const RldParameterField& field : fields) {
                if (field.unit == "m") *options.rld_parameters.*field.value *= 2.0;
            }
        }
        const auto other = bare_rld_detector(name, options);
        const Outcome outcome = compare(*detector, *other, name, kAsItIs, larger, false);
        EXPECT_GT(outcome.found, outcome.scenes * 3 / 4);
        EXPECT_EQ(outcome.different, 0U);
    }
}

/// Learned detectors have lengths in metres among their inputs: their lanes may change with the scale. A
/// scale that is off by a billionth, as from a survey, changes no lane.
TEST_P(DetectorScale, AlmostTheSameIsAsGood) {
    const Change larger{"Larger", [](Scene scene) { return tests::scaled(std::move(scene), 1.0 + 1e-9); }};
    const auto detector = make_detector(GetParam());
    const auto other = make_detector(GetParam());
    const Outcome outcome = compare(*detector, *other, GetParam(), kAsItIs, larger, true);
    EXPECT_EQ(outcome.different, 0U);
}

INSTANTIATE_TEST_SUITE_P(InMetres, DetectorScale,
                         testing::Values("front", "front-warm", "clc", "clc-warm", "clc-paper", "rld-strip"),
                         [](const auto& test) { return case_name(test.param); });

INSTANTIATE_TEST_SUITE_P(Detectors, DetectorMetamorphic,
                         testing::Combine(testing::ValuesIn(tests::detector_names()),
                                          testing::ValuesIn(tests::changes())),
                         [](const auto& test) {
                             return case_name(std::get<0>(test.param)) + "_" +
                                    std::string(std::get<1>(test.param).name);
                         });

}  // namespace
}  // namespace conelane
