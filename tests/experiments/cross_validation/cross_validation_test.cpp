#include "experiments/cross_validation/cross_validation.hpp"

#include "evaluation/formats/file_text.hpp"
#include "evaluation/formats/parameter_file.hpp"
#include "evaluation/formats/weights_file.hpp"
#include "learning/tuning/rld_tuning.hpp"
#include "tests/support/program_fixture.hpp"

namespace conelane::experiments {
namespace {

using namespace learning;

/// Two families of one course each, and a course that is always learned from, with little work.
const std::string kFolds =
    "cross-validate --family a=generated:circle --family b=generated:curvy --always generated:straight "
    "--learn-condition paper --learn-every 60 --variants 0 --evaluations 2 --condition paper --fp 0.3 "
    "--range 30 --every 40 --front-steps 0.002 --rld-steps 0.002 --time-limit 30000 --out cv --methods ";

std::vector<std::string> courses_learned(const std::string& weights) {
    return nlohmann::json::parse(weights).at("training").at("tracks").get<std::vector<std::string>>();
}

class CrossValidation : public ProgramFixture {};

TEST_F(CrossValidation, AFoldHasNotSeenTheFamilyThatItIsScoredOn) {
    const Outcome outcome = run_well(kFolds + "front,clc,rld-pair,rld-learned,rld-strip");
    EXPECT_THAT(courses_learned(text_of(path("cv/folds/a/step_scores.json"))),
                testing::ElementsAre("curvy", "straight"));
    EXPECT_THAT(courses_learned(text_of(path("cv/folds/a/rank_net_extended.json"))),
                testing::ElementsAre("curvy", "straight"));
    EXPECT_THAT(courses_learned(text_of(path("cv/folds/b/rank_net_extended.json"))),
                testing::ElementsAre("circle", "straight"));
    EXPECT_THAT(courses_learned(text_of(path("cv/folds/a/front.json"))),
                testing::UnorderedElementsAre("curvy", "straight"));
    EXPECT_THAT(courses_learned(text_of(path("cv/folds/a/rld-learned.weights.json"))),
                testing::UnorderedElementsAre("curvy", "straight"));
    const auto costs = nlohmann::json::parse(text_of(path("cv/folds/a/rld-learned.weights.json")));
    EXPECT_EQ(costs.at("training").at("start_hash"), tag_of("", with_shape_costs({})).hash.value())
        << "the set `shape` was tuned on courses that folds hold out";
    EXPECT_THAT(outcome.output, Not(HasSubstr("learned from"))) << "nothing in the table was learned from";

    // Each course is driven with the weights of the fold that holds it out, and with no others.
    const std::vector<AnnotatedScene> scenes = read_scenes(path("cv/scenes.scenes.jsonl"));
    RunOptions options;
    options.limits.time_limit_ms = 30'000.0;
    for (const std::string detector : {"clc", "front", "rld-learned", "rld-strip"}) {
        const std::vector<LaneRecord> lanes = read_lanes(path("cv/" + detector + ".lanes.jsonl"));
        ASSERT_EQ(lanes.size(), scenes.size());
        for (std::size_t i = 0; i < scenes.size(); ++i) {
            const std::string fold = scenes[i].track == "circle" ? "a" : "b";
            const DetectorMaker maker =
                find_method(detector).learned_maker(path("cv/folds/" + fold), options);
            EXPECT_EQ(maker(scenes[i].track)->answer(scenes[i].scene).answer.lane, lanes[i].answer.lane)
                << scenes[i].scene.id;
            EXPECT_EQ(lanes[i].answer.status == LaneStatus::found, lanes[i].answer.trusted_m.has_value())
                << "checked to be drivable, as in a comparison";
        }
    }
}

TEST_F(CrossValidation, LearnsColorsAfterWhatAnotherLearnedWithoutThem) {
    const std::string methods = "front,rld-learned,rld-shape";
    run_well(kFolds + methods);
    const std::string colors =
        "cross-validate --family a=generated:circle --family b=generated:curvy --always generated:straight "
        "--learn-condition paper --learn-every 60 --condition paper --fp 0.3 --range 30 --every 40 "
        "--front-steps 0.002 --rld-steps 0.002 --colors-from cv/folds ";
    run_well(colors + "--color --color-wrong 0.05 --out colored --methods " + methods);
    for (const std::string fold : {"a", "b"}) {
        const std::string first = text_of(path("cv/folds/" + fold + "/front.json"));
        const std::string second = text_of(path("colored/folds/" + fold + "/front.json"));
        const FrontWeights before = parse_front_weights(first);
        FrontWeights after = parse_front_weights(second);
        ASSERT_FALSE(before.colored);
        ASSERT_TRUE(after.colored);
        EXPECT_NE(after.colored->extend, before.extend) << "colors were learned";
        after.colored.reset();
        EXPECT_EQ(after, before) << "nothing else was";
        EXPECT_EQ(courses_learned(second), courses_learned(first));
        const auto training = nlohmann::json::parse(second).at("training");
        EXPECT_EQ(training.at("begins_with"), file_hash(path("cv/folds/" + fold + "/front.json")));

        const auto rld = [&](const std::string& run, const std::string& method) {
            return read_rld_parameters(path(run + "/folds/" + fold + "/" + method + ".json"));
        };
        EXPECT_NE(*rld("colored", "rld-learned").learned_costs, *rld("cv", "rld-learned").learned_costs);
        const std::string costs = text_of(path("colored/folds/" + fold + "/rld-learned.weights.json"));
        EXPECT_GT(nlohmann::json::parse(costs).at("training").at("scenes").at("colored_share"), 0.0);
        EXPECT_THAT(kColorWeights, testing::Contains(rld("colored", "rld-shape").w_color));
        const auto without_w_color = [&](const std::string& run) {
            auto shape = nlohmann::json::parse(text_of(path(run + "/folds/" + fold + "/rld-shape.json")));
            shape.erase("w_color");
            return shape;
        };
        EXPECT_EQ(without_w_color("colored"), without_w_color("cv"));
    }
    const auto record = nlohmann::json::parse(text_of(path("colored/run.json"))).at("cross_validation");
    EXPECT_EQ(record.at("colors_from").at("a").at("front.json"), file_hash(path("cv/folds/a/front.json")));

    const auto refused = [&](const std::string& options) {
        const Outcome wrong = run(colors + "--out refused " + options);
        EXPECT_EQ(wrong.exit_code, 2) << options;
        return wrong.errors;
    };
    EXPECT_THAT(refused("--methods front"), HasSubstr("needs scenes with colour"));
    EXPECT_THAT(refused("--color --methods front,clc"), HasSubstr("'clc' ignores colours"));
    EXPECT_THAT(refused("--color --methods front --folds cv/folds"), HasSubstr("--folds"));
    EXPECT_THAT(run("cross-validate --family b=generated:circle --family a=generated:curvy --methods front "
                    "--folds cv/folds --out swapped")
                    .errors,
                AllOf(HasSubstr("cv/folds/b/"), HasSubstr("training.tracks: has learned from 'circle'")));
    std::filesystem::remove(path("cv/folds/b/rld-shape.json"));
    EXPECT_THAT(refused("--color --methods rld-shape"), HasSubstr("rld-shape.json"));
    std::filesystem::remove_all(path("cv/folds/b"));
    EXPECT_THAT(refused("--color --methods front --overwrite"), HasSubstr("--colors-from"));
}

}  // namespace
}  // namespace conelane::experiments
