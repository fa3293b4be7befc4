// `conelane tune --method`: parameters of detectors that are not RLD, found by random search.

#include "experiments/tuning/detector_tuning.hpp"

#include "detectors/baseline_parameters.hpp"
#include "evaluation/files/detector_parameter_file.hpp"
#include "evaluation/files/input_error.hpp"
#include "tests/support/program_fixture.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/testing.hpp"

namespace conelane::experiments {
namespace {

using testing::HasSubstr;

SceneSet few_scenes() {
    SceneOptions options;
    options.false_positive_rates = {0.0, 0.3};
    options.ranges_m = {30.0};
    options.every_m = 60.0;
    options.seed = 1;
    return make_scene_set({"generated:curvy"}, options);
}

TEST(DetectorTuning, FindsBetterParametersAndTheSameOnesAgain) {
    const SceneSet set = few_scenes();
    for (const TunableDetector& known : tunable_detectors()) {
        SCOPED_TRACE(known.name);
        // A bad start: the highest end of each range.
        TunableDetector detector = known;
        for (TunableParameter& parameter : detector.parameters) parameter.start = parameter.highest;
        const TunedDetector tuned = tune_detector(detector, set, {.evaluations = 8, .seed = 2, .threads = 2});
        EXPECT_GE(tuned.figure.value(), tuned.figure_of_start.value());
        EXPECT_GT(tuned.figure.usable, 0.0);
        EXPECT_EQ(tuned.figure.scenes, set.scenes.size());
        const TunedDetector again = tune_detector(detector, set, {.evaluations = 8, .seed = 2, .threads = 1});
        EXPECT_EQ(again.values, tuned.values);
        EXPECT_EQ(again.figure.iou, tuned.figure.iou);
        for (std::size_t i = 0; i < tuned.values.size(); ++i) {
            EXPECT_GE(tuned.values[i], detector.parameters[i].lowest) << detector.parameters[i].key;
            EXPECT_LE(tuned.values[i], detector.parameters[i].highest) << detector.parameters[i].key;
        }
    }
}

TEST(DetectorTuning, ShippedParametersAreInTheirRanges) {
    EXPECT_NO_THROW(validate(tuned_delaunay_beam_parameters()));
    EXPECT_NO_THROW(validate(tuned_astar_lane_parameters()));
}

TEST(DetectorTuning, FilesHoldWhatWasFound) {
    const TunableDetector& detector = find_tunable_detector("astar-lane");
    std::vector<double> values;
    for (const TunableParameter& parameter : detector.parameters) values.push_back(parameter.lowest);
    const AstarLaneParameters read = parse_astar_lane_parameters(to_json_text(detector, values), "p.json");
    EXPECT_EQ(read.least_radius_m, values[0]);
    EXPECT_EQ(read.heuristic, values.back());
    EXPECT_EQ(read.max_steps, AstarLaneParameters{}.max_steps);
}

TEST(DetectorTuning, FilesThatAreWrongAreNamed) {
    const auto fault = [](const std::string& text) {
        return refusal<InputError>([&] { (void)parse_delaunay_beam_parameters(text, "p.json"); });
    };
    const TunableDetector& detector = find_tunable_detector("delaunay-beam");
    std::vector<double> values;
    for (const TunableParameter& parameter : detector.parameters) values.push_back(parameter.start);
    EXPECT_EQ(fault(to_json_text(detector, values)), "accepted");
    EXPECT_EQ(fault("{\"w_turns\": 1," + to_json_text(detector, values).substr(1)),
              "p.json: w_turns: is not a key here; w_turn is");
    EXPECT_THAT(fault("{}"), HasSubstr("p.json: w_turn"));
    values[0] = -1.0;
    EXPECT_THAT(fault(to_json_text(detector, values)), HasSubstr("p.json: w_turn"));
    EXPECT_THAT(fault("nonsense"), HasSubstr("p.json"));
}

class TuneDetector : public ProgramFixture {};

TEST_F(TuneDetector, WritesParametersAndTheirRecord) {
    const Outcome outcome = run_well(
        "tune-method --method delaunay-beam --tracks generated:circle --fp 0.3 --every 60 --evaluations 3 "
        "--seed 4 --out p.json");
    EXPECT_THAT(outcome.output, HasSubstr("delaunay-beam on "));
    EXPECT_NO_THROW((void)parse_delaunay_beam_parameters(text_of(path("p.json")), path("p.json")));
    const std::string record = text_of(path("p.record.json"));
    for (const char* key : {R"("method": "delaunay-beam")", "generated:circle", R"("evaluations": 3)"}) {
        EXPECT_THAT(record, HasSubstr(key));
    }
}

TEST_F(TuneDetector, BadOptionsAreRefused) {
    expect_refused("tune-method --method clc --tracks generated:circle --out p.json", {"clc", "astar-lane"});
    expect_refused("tune-method --method astar-lane --tracks generated:nowhere --out p.json", {"nowhere"});
}

}  // namespace
}  // namespace conelane::experiments
