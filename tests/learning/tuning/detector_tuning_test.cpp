// `conelane tune --method`: parameters of detectors that are not RLD, found by random search.

#include "learning/tuning/detector_tuning.hpp"

#include "experiments/methods/method.hpp"
#include "graph_search/baselines/delaunay_beam/delaunay_beam_detector.hpp"
#include "tests/support/program_fixture.hpp"
#include "tests/support/refusal.hpp"

namespace conelane::learning {
namespace {

using experiments::find_tunable;
using experiments::tunable_names;

SceneSet few_scenes() {
    SceneOptions options{.false_positive_rates = {0.0, 0.3}, .ranges_m = {30.0}, .every_m = 60.0, .seed = 1};
    return make_scene_set({"generated:curvy"}, options);
}

TEST(DetectorTuning, FindsBetterParametersAndTheSameOnesAgain) {
    const SceneSet set = few_scenes();
    for (const std::string_view name : tunable_names()) {
        SCOPED_TRACE(name);
        const DetectorRecipe& recipe = find_tunable(name);
        const std::vector<TunableParameter> parameters = recipe.tuned()->parameters();
        // A bad start: the highest end of each range.
        DetectorTuningOptions options{.evaluations = 8, .seed = 2, .threads = 2};
        for (const TunableParameter& parameter : parameters) options.start.push_back(parameter.highest);
        const TuningResult tuned = tune_detector(recipe, set, options);
        EXPECT_GE(tuned.figure.value(), tuned.figure_of_start.value());
        EXPECT_GT(tuned.figure.usable, 0.0);
        EXPECT_EQ(tuned.figure.scenes, set.scenes.size());
        options.threads = 1;
        const TuningResult again = tune_detector(recipe, set, options);
        EXPECT_EQ(again.values, tuned.values);
        EXPECT_EQ(again.figure.iou, tuned.figure.iou);
        for (std::size_t i = 0; i < tuned.values.size(); ++i) {
            EXPECT_GE(tuned.values[i], parameters[i].lowest) << parameters[i].key;
            EXPECT_LE(tuned.values[i], parameters[i].highest) << parameters[i].key;
        }
    }
}

/// A value for each parameter: one of its members.
std::vector<double> values_of(const DetectorRecipe& recipe, double TunableParameter::*member) {
    return mapped(recipe.tuned()->parameters(),
                  [&](const TunableParameter& parameter) { return parameter.*member; });
}

TEST(DetectorTuning, ShippedParametersAreInTheirRanges) {
    for (const std::string_view name : tunable_names()) {
        const DetectorRecipe& recipe = find_tunable(name);
        EXPECT_NO_THROW((void)recipe.tuned()->make(shipped_values(recipe))) << name;
    }
    std::vector<double> values = shipped_values(find_tunable("delaunay-beam"));
    values.front() = -1.0;
    EXPECT_THROW((void)find_tunable("delaunay-beam").tuned()->make(values), InvalidInput);
}

TEST(DetectorTuning, ValuesAreInTheOrderOfTheParameters) {
    const std::vector<double> shipped = shipped_values(find_tunable("delaunay-beam"));
    EXPECT_EQ(shipped.front(), 0.2449) << "w_turn";
    EXPECT_EQ(shipped.back(), 9.616) << "start_radius_m";
    EXPECT_EQ(values_of(find_tunable("delaunay-beam"), &TunableParameter::start).back(),
              DelaunayBeamParameters{}.start_radius_m);
}

TEST(DetectorTuning, FilesHoldWhatWasFound) {
    const DetectorRecipe& recipe = find_tunable("delaunay-beam");
    const std::vector<double> values = values_of(recipe, &TunableParameter::lowest);
    EXPECT_EQ(parse_values(recipe, to_json_text(recipe, values), "p.json"), values);
}

TEST(DetectorTuning, FilesThatAreWrongAreNamed) {
    const DetectorRecipe& recipe = find_tunable("delaunay-beam");
    const auto fault = [&](const std::string& text) {
        return refusal<InputError>([&] { (void)parse_values(recipe, text, "p.json"); });
    };
    std::vector<double> values = values_of(recipe, &TunableParameter::start);
    EXPECT_EQ(fault(to_json_text(recipe, values)), "accepted");
    EXPECT_EQ(fault("{\"w_turns\": 1," + to_json_text(recipe, values).substr(1)),
              "p.json: w_turns: is not a key here; w_turn is");
    EXPECT_THAT(fault("{}"), HasSubstr("p.json: w_turn"));
    values[0] = -1.0;
    EXPECT_THAT(fault(to_json_text(recipe, values)), HasSubstr("p.json: w_turn"));
    EXPECT_THAT(fault("nonsense"), HasSubstr("p.json"));
}

class TuneDetector : public ProgramFixture {};

TEST_F(TuneDetector, WritesParametersAndTheirRecord) {
    const Outcome outcome = run_well(
        "tune-method --method delaunay-beam --tracks generated:circle --fp 0.3 --every 60 --evaluations 3 "
        "--seed 4 --out p.json");
    EXPECT_THAT(outcome.output, HasSubstr("delaunay-beam on "));
    EXPECT_NO_THROW(
        (void)parse_values(find_tunable("delaunay-beam"), text_of(path("p.json")), path("p.json")));
    const std::string record = text_of(path("p.record.json"));
    for (const char* key : {R"("method": "delaunay-beam")", "generated:circle", R"("evaluations": 3)"})
        EXPECT_THAT(record, HasSubstr(key));
}

TEST_F(TuneDetector, BadOptionsAreRefused) {
    expect_refused("tune-method --method clc --tracks generated:circle --out p.json",
                   {"clc", "delaunay-beam"});
    expect_refused("tune-method --method delaunay-beam --tracks generated:nowhere --out p.json", {"nowhere"});
}

}  // namespace
}  // namespace conelane::learning
