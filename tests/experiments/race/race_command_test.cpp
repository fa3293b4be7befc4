// `conelane race` as a user or a script calls it.

#include "evaluation/formats/weights_file.hpp"
#include "graph_search/front/front_detector.hpp"
#include "tests/support/front_fixture.hpp"
#include "tests/support/program_fixture.hpp"

namespace conelane::experiments {
namespace {

using testing::ContainsRegex, testing::HasSubstr;

class RaceCommand : public ProgramFixture {};

TEST_F(RaceCommand, AnyNumberOfThreadsGivesTheSameFiles) {
    for (const char* const threads : {"1", "2"}) {
        run_well("race --tracks generated:kidney,circle --methods front,truth --fp 0,0.3 --seed 1,2 --out t" +
                 std::string(threads) + " --replay all --threads " + threads);
    }
    for (const char* const file : {"race.json", "table.txt", "replay.jsonl"}) {
        EXPECT_EQ(text_of(path("t1") / file), text_of(path("t2") / file)) << file;
        EXPECT_FALSE(text_of(path("t1") / file).empty()) << file;
    }
    const nlohmann::json json = nlohmann::json::parse(text_of(path("t1") / "race.json"));
    EXPECT_EQ(json.at("races").size(), 16U);
    for (const char* const key : {"commit", "compiler", "machine", "condition", "fp", "seeds", "speed_mps"}) {
        EXPECT_TRUE(json.contains(key)) << key;
    }
}

TEST_F(RaceCommand, MissionsNeedNoTracks) {
    for (const char* const mission : {"acceleration", "skidpad"}) {
        run_well("race --mission " + std::string(mission) + " --methods truth --overwrite --out out");
        const nlohmann::json json = nlohmann::json::parse(text_of(path("out") / "race.json"));
        EXPECT_EQ(json.at("races").at(0).at("end"), "finished");
    }
    expect_refused("race --mission skidpad --out out", {"out: holds race.json", "--overwrite"});
    EXPECT_THAT(run("race --mission acceleration --methods clc --out alone").errors, HasSubstr("--planner"));
    EXPECT_THAT(run("race --help").output, ContainsRegex("--methods.*front(.|\n)*--fp.*0(.|\n)*--seed.*1"));
}

TEST_F(RaceCommand, BySafeSpeedFirstAndLaterLapsAreCompared) {
    run_well(
        "race --tracks generated:kidney --methods truth --speed safe --laps 2 --condition paper --out out");
    EXPECT_THAT(text_of(path("out") / "table.txt"),
                ContainsRegex("truth +0 first +1.000(.|\n)*truth +0 later +1.000"));
    const nlohmann::json json = nlohmann::json::parse(text_of(path("out") / "race.json"));
    EXPECT_EQ(json.at("speed_mps"), "safe");
    EXPECT_GT(json.at("races").at(0).at("later_laps").at("time_s"), 5.0);
    expect_refused("race --tracks generated:kidney --speed fast --out out2", {"--speed", "safe"});
    expect_refused("race --tracks generated:kidney --methods truth --fov 200 --out out2", {"--fov"});
}

TEST_F(RaceCommand, ACarWithSlipAndSmootherNoiseDriveToo) {
    const std::string kidney = "race --tracks generated:kidney --methods truth ";
    run_well(kidney + "--car dynamic --condition paper --out slip");
    run_well(kidney + "--range-noise 0.02 --pose-time-s 2 --condition car --out noise");
    for (const char* const out : {"slip", "noise"}) {
        const nlohmann::json json = nlohmann::json::parse(text_of(path(out) / "race.json"));
        EXPECT_EQ(json.at("races").at(0).at("end"), "finished") << out;
        EXPECT_EQ(json.at("car"), out == std::string("slip") ? "dynamic" : "kinematic");
    }
    expect_refused(kidney + "--car flying --out out", {"--car"});
    expect_refused(kidney + "--range-noise 1 --out out", {"--range-noise"});
}

// Weights of zeros give other lanes than the shipped ones, so the driven path shows which were used.
TEST_F(RaceCommand, AFamilyIsDrivenByTheWeightsOfItsFold) {
    std::filesystem::create_directories(path("folds") / "a");
    std::filesystem::create_directories(path("folds") / "b");
    const std::string shipped = front_weights_json(shipped_front_options().weights, "{}");
    const std::string other = front_weights_json(tests::random_front_weights(7), "{}");
    file_with(shipped, "folds/a/front.json");
    file_with(other, "folds/b/front.json");
    const auto races = [&](const std::string& options, const std::string& out) {
        run_well("race " + options + " --methods front --both --fp 0.3 --condition car --out " + out);
        return nlohmann::json::parse(text_of(path(out) / "race.json")).at("races");
    };
    const nlohmann::json by_shipped = races("--tracks generated:kidney,circle", "shipped");
    const nlohmann::json by_other =
        races("--tracks generated:kidney,circle --weights folds/b/front.json", "other");
    const nlohmann::json by_folds =
        races("--family a=generated:kidney --family b=generated:circle --folds folds", "folded");
    ASSERT_EQ(by_shipped.size(), 4U);
    ASSERT_EQ(by_folds.size(), 4U);
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_NE(by_shipped.at(i), by_other.at(i)) << i;
        EXPECT_EQ(by_folds.at(i), i < 2 ? by_shipped.at(i) : by_other.at(i)) << i;
    }
}

TEST_F(RaceCommand, UnusedOrInvalidWeightsAreRefused) {
    file_with(front_weights_json(shipped_front_options().weights, "{}"), "front.json");
    file_with("{}", "wrong.json");
    const std::string kidney = "race --tracks generated:kidney --out out ";
    expect_refused(kidney + "--methods truth,clc --weights front.json", {"--weights", "front-warm"});
    expect_refused(kidney + "--methods front --weights nowhere.json", {"nowhere.json"});
    expect_refused(kidney + "--methods front --weights wrong.json", {"wrong.json"});
    expect_refused(kidney + "--methods front --folds .", {"--family"});
    expect_refused("race --family a=generated:kidney --folds . --methods front --out out", {"a/front.json"});
    expect_refused(kidney + "--methods front,rld-strip --weights front.json", {"front.json"});
    expect_refused("race --family a=generated:kidney --folds . --methods rld-strip --out out",
                   {"a/rld-strip.json"});
    std::filesystem::create_directories(path("a"));
    file_with(front_weights_json(shipped_front_options().weights, R"({"tracks": ["circle", "kidney"]})"),
              "a/front.json");
    expect_refused("race --family a=generated:kidney --folds . --methods front --out out",
                   {"a/front.json", "learned from 'kidney'"});
    expect_refused("race --family generated:kidney --methods front --out out", {"--family", "NAME=SPEC"});
    expect_refused("race --mission skidpad --family a=generated:kidney --methods front --out out",
                   {"--family"});
}

TEST_F(RaceCommand, BadInputIsRefusedInOneLine) {
    const std::string kidney = "race --tracks generated:kidney --methods truth --out out ";
    expect_refused("race --methods truth --out out", {"--tracks: is required, except"});
    expect_refused("race --tracks generated:nowhere --methods truth --out out", {"nowhere"});
    expect_refused("race --tracks generated:kidney --methods nobody --out out", {"nobody"});
    expect_refused(kidney + "--condition rain", {"condition", "rain"});
    expect_refused(kidney + "--fp 1", {"fp"});
    expect_refused(kidney + "--fp 0.3,0.3", {"fp", "twice"});
    expect_refused(kidney + "--seed 1,1", {"--seed", "twice"});
    expect_refused(kidney + "--seed -1", {"--seed", "-1"});
    expect_refused(kidney + "--mission acceleration", {"--tracks", "kidney", "acceleration"});
    expect_refused(kidney + "--mission autocross --laps 2", {"--laps", "autocross"});
    expect_refused(kidney + "--fault rain", {"--fault"});
    expect_refused(kidney + "--speed 0", {"--speed"});
    expect_refused(kidney + "--start-error nan", {"--start-error"});
    file_with("", "taken");
    expect_refused("race --tracks generated:kidney --methods truth --out taken", {"taken"});
}

TEST_F(RaceCommand, IfOneFileCannotBeWrittenNoneIs) {
    std::filesystem::create_directories(path("out") / "times.txt");
    const Outcome outcome = run("race --tracks generated:kidney --methods truth --out out");
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.errors, HasSubstr("times.txt"));
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(path("out")), {}), 1);
}

}  // namespace
}  // namespace conelane::experiments
