// The program as a user or a script calls it: files in, files out, one line and exit code 2 on bad input.

#include "experiments/files/lane_file.hpp"
#include "experiments/files/parameter_file.hpp"
#include "experiments/scenes/scene_file.hpp"
#include "tests/file_test.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>

namespace conelane::experiments {
namespace {

using testing::HasSubstr;

class Program : public FileTest {
  protected:
    struct Outcome {
        int exit_code;
        std::string output;
        std::string errors;
    };

    /// Runs `conelane ARGUMENTS` in the test's folder.
    Outcome run(const std::string& arguments) {
        const std::string command = "cd " + path("").string() + " && " CONELANE_PROGRAM " " + arguments +
                                    " >" + path("stdout").string() + " 2>" + path("stderr").string();
        const int status = std::system(command.c_str());
        Outcome outcome{WIFEXITED(status) ? WEXITSTATUS(status) : -1, text_of(path("stdout")),
                        text_of(path("stderr"))};
        std::filesystem::remove(path("stdout"));
        std::filesystem::remove(path("stderr"));
        return outcome;
    }

    /// Bad input: exit code 2, one line on stderr that holds every one of `names`, and no new file.
    void expect_refused(const std::string& arguments, const std::vector<std::string>& names) {
        SCOPED_TRACE("conelane " + arguments);
        const std::size_t files_before = files_in_folder();
        const Outcome outcome = run(arguments);
        EXPECT_EQ(outcome.exit_code, 2);
        EXPECT_EQ(std::ranges::count(outcome.errors, '\n'), 1) << outcome.errors;
        for (const std::string& name : names) EXPECT_THAT(outcome.errors, HasSubstr(name));
        EXPECT_EQ(files_in_folder(), files_before);
    }

    void make_scenes(const std::string& options, const std::string& name = "s") {
        const Outcome outcome = run("scenes --tracks generated:kidney --every 20 --seed 3 " + options +
                                    " --out " + name + ".scenes.jsonl");
        ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
    }
};

constexpr const char* kScene =
    R"({"id": "a", "pose": {"x": 0, "y": 0, "yaw": 0}, "cones": [{"id": 1, "x": 1, "y": 2}, {"id": 2, "x": 4, "y": 2}]})";

TEST_F(Program, HelpIsEverywhere) {
    EXPECT_EQ(run("--help").exit_code, 0);
    for (const char* command :
         {"scenes", "detect", "methods", "solve", "solvers", "check", "score", "compare", "sweep", "merge",
          "study", "study formulations", "study optimality", "study backends", "study relaxations",
          "study confidence-and-colour", "report", "tune"}) {
        const Outcome help = run(std::string(command) + " --help");
        EXPECT_EQ(help.exit_code, 0);
        EXPECT_THAT(help.output, HasSubstr("--help")) << command;
    }
}

TEST_F(Program, BadOptionsAreNamed) {
    expect_refused("", {"subcommand"});
    expect_refused("fly", {"fly"});
    expect_refused("scenes --out a.scenes.jsonl", {"--tracks"});
    expect_refused("scenes --tracks generated:nowhere --out a.scenes.jsonl", {"nowhere"});
    expect_refused("scenes --tracks generated:circle --fp 1.5 --out a.scenes.jsonl", {"fp"});
    expect_refused("scenes --tracks generated:circle --fp nan --out a.scenes.jsonl", {"fp"});
    expect_refused("scenes --tracks generated:circle --every 0 --out a.scenes.jsonl", {"every"});
    expect_refused("scenes --tracks generated:circle --range -3 --out a.scenes.jsonl", {"range"});
    expect_refused("scenes --tracks generated:circle --nearest 0 --out a.scenes.jsonl", {"--nearest"});
    expect_refused("scenes --tracks generated:circle --wings 2 --out a.scenes.jsonl", {"--wings"});
    file_with(std::string(kScene) + "\n", "a.scenes.jsonl");
    expect_refused("detect --method magic --scenes a.scenes.jsonl --out l.lanes.jsonl", {"method", "magic"});
    expect_refused("solve --solver magic --scenes a.scenes.jsonl --out l.solutions.jsonl",
                   {"--solver", "magic"});
    expect_refused("solve --formulation loose --scenes a.scenes.jsonl --out l.solutions.jsonl",
                   {"--formulation"});
    expect_refused("compare --methods magic --out results", {"method", "magic"});
    expect_refused("tune --tracks generated:circle --context 24 --out p.json", {"--context", "--nearest"});
    expect_refused("export --scenes a.scenes.jsonl --id a --out a.txt", {"--out", "a.txt", ".mps"});
    expect_refused("compare --tracks generated:circle --methods clc,clc --out results", {"method", "'clc'"});
    expect_refused("sweep --tracks generated:circle --methods clc --sizes 6,6 --out results",
                   {"clc", "6 cones"});
    for (const char* seed : {"-1", "1.5", "x", "99999999999999999999"}) {
        expect_refused("scenes --tracks generated:circle --out a.scenes.jsonl --seed " + std::string(seed),
                       {"--seed", seed});
    }
    // As a script leaves them whose variable is not set.
    expect_refused("scenes --tracks generated:circle --out ''", {"--out", "empty"});
    expect_refused("compare --tracks generated:circle --fp '' --out results", {"--fp", "empty"});
    expect_refused("study formulations --scenes a.scenes.jsonl --out ''", {"--out", "empty"});
    expect_refused("certify --scenes a.scenes.jsonl --verify ''", {"--verify", "empty"});
    expect_refused("solve --scenes a.scenes.jsonl --params '' --out l.solutions.jsonl",
                   {"--params", "empty"});
    expect_refused("train --tracks generated:circle --step-scores s.json --out n.json",
                   {"--step-scores", "--extended"});
    expect_refused("train --tracks generated:circle --steps --extended --out n.json",
                   {"--steps", "--extended"});
    expect_refused("train --tracks generated:circle --steps --step-scores s.json --out n.json",
                   {"--step-scores"});
    expect_refused("train --tracks generated:circle --steps --variants 2 --out n.json",
                   {"--steps", "--variants"});
    expect_refused("train --tracks generated:circle generated:circle --out n.json", {"circle", "twice"});
    for (const char* option :
         {"--epochs", "--step-epochs", "--units", "--scenes-a-step", "--candidates", "--variants"}) {
        expect_refused("train --tracks generated:circle --out n.json " + std::string(option) + " -1",
                       {option});
    }
    expect_refused("train --tracks generated:circle --out n.json --iterations 0", {"--iterations"});
    expect_refused("train --tracks generated:nowhere --out nowhere/n.json", {"nowhere/n.json"});
}

TEST_F(Program, TimeLimitsAreAboveZero) {
    file_with(std::string(kScene) + "\n", "a.scenes.jsonl");
    for (const char* limit : {"0", "-1", "nan", "soon", "400ms"}) {
        expect_refused("detect --method clc --scenes a.scenes.jsonl --out l.lanes.jsonl --time-limit " +
                           std::string(limit),
                       {"--time-limit", "no number above 0"});
    }
    expect_refused("tune --tracks generated:circle --out p.json --time-limit inf", {"--time-limit"});
}

/// 132 cones of which most edges are possible keep an exact search busy for hours.
TEST_F(Program, DetectionEndsInRealTimeUnlessToldOtherwise) {
    nlohmann::json scene{{"id", "lattice"}, {"pose", {{"x", 0}, {"y", 0}, {"yaw", 0}}}};
    for (int id = 0; id < 132; ++id) {
        const int row = id / 11;
        const int column = id % 11;
        scene["cones"].push_back({{"id", id},
                                  {"x", 1.0 + 2.6 * row + 0.06 * (id * 37 % 11)},
                                  {"y", -13.0 + 2.6 * column + 0.05 * (id * 53 % 13)}});
    }
    file_with(scene.dump() + "\n", "lattice.scenes.jsonl");
    const auto answer = [&](const std::string& options) {
        const Outcome outcome =
            run("detect --method rld-pair --scenes lattice.scenes.jsonl --out l.lanes.jsonl " + options);
        EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
        return read_lanes(path("l.lanes.jsonl")).at(0).answer;
    };
    EXPECT_FALSE(answer("").optimality.value().optimal);
    EXPECT_TRUE(answer("--nearest 12 --time-limit inf").optimality.value().optimal);
    EXPECT_THAT(run("detect --help").output, HasSubstr("--time-limit FLOAT:POSITIVE=400"));
    EXPECT_THAT(run("solve --help").output, HasSubstr("--time-limit FLOAT:POSITIVE=inf"));
}

TEST_F(Program, BadScenesAreNamedByFileLineAndKey) {
    const std::string good = std::string(kScene) + "\n";
    const auto refuse = [&](const std::string& text, const std::vector<std::string>& names) {
        file_with(text, "bad.scenes.jsonl");
        std::vector<std::string> all = names;
        all.emplace_back("bad.scenes.jsonl");
        expect_refused("detect --method clc --scenes bad.scenes.jsonl --out x.lanes.jsonl", all);
        expect_refused("detect --method rld-cbc --scenes bad.scenes.jsonl --out x.lanes.jsonl", all);
        expect_refused("solve --scenes bad.scenes.jsonl --out x.solutions.jsonl", all);
    };
    refuse(good + good.substr(0, 60), {":2:"});
    refuse(R"({"id": "a", "pose": {"x": NaN, "y": 0, "yaw": 0}, "cones": [{"id": 1, "x": 1, "y": 2}]})",
           {":1:", "x"});
    refuse(R"({"id": "a", "pose": {"x": 0, "y": 0, "yaw": 0}, "cones": [{"id": 1, "x": 1e999, "y": 2}]})",
           {":1:", "x"});
    refuse(R"({"id": "a", "pose": {"x": 0, "y": 0, "yaw": 0}, "cones": [{"id": 1, "x": "1", "y": 2}]})",
           {":1:", "cones[0].x"});
    refuse(R"({"id": "a", "pose": {"x": 0, "y": 0}, "cones": [{"id": 1, "x": 1, "y": 2}]})",
           {":1:", "pose.yaw"});
    refuse(
        R"({"id": "a", "pose": {"x": 0, "y": 0, "yaw": 0}, "cones": [{"id": 1, "x": 1, "y": 2}, {"id": 1, "x": 3, "y": 2}]})",
        {":1:", "cones[1].id"});
    refuse(
        R"({"id": "a", "pose": {"x": 0, "y": 0, "yaw": 0}, "cones": [{"id": 1, "x": 1, "y": 2}], "ground_truth": {"left": [1], "right": [7]}})",
        {":1:", "ground_truth.right[0]", "7"});
    refuse(R"({"id": "a", "pose": {"x": 0, "y": 0, "yaw": 0}, "cones": []})", {":1:", "cones"});
    refuse("", {"no scene"});
}

TEST_F(Program, BadFilesAreNamed) {
    file_with(std::string(kScene) + "\n", "a.scenes.jsonl");
    expect_refused("detect --method clc --scenes nowhere.scenes.jsonl --out x.lanes.jsonl",
                   {"nowhere.scenes.jsonl"});
    expect_refused("detect --method clc --scenes a.scenes.jsonl --out nowhere/x.lanes.jsonl",
                   {"nowhere/x.lanes.jsonl"});
    expect_refused("score --scenes a.scenes.jsonl --lanes nowhere.lanes.jsonl", {"nowhere.lanes.jsonl"});
    expect_refused("solve --scenes a.scenes.jsonl --params nowhere.json --out x.solutions.jsonl",
                   {"nowhere.json"});
    file_with(R"({"d_e": 3})", "p.json");
    expect_refused("solve --scenes a.scenes.jsonl --params p.json --out x.solutions.jsonl",
                   {"p.json", "d_t"});
    file_with("track: [1, 2\n", "t.yaml");
    expect_refused("scenes --tracks pacsim:t.yaml --out x.scenes.jsonl", {"t.yaml"});
    file_with("tag,x,y\nblue,1,zwei\n", "t.csv");
    expect_refused("scenes --tracks eufs:t.csv --out x.scenes.jsonl", {"t.csv"});
    file_with(R"({"scene": "b", "method": "m", "status": "none", "left": [], "right": [], "latency_ms": 1})"
              "\n",
              "b.lanes.jsonl");
    expect_refused("score --scenes a.scenes.jsonl --lanes b.lanes.jsonl", {"b.lanes.jsonl", ":1:", "scene"});
}

/// Long work is not begun whose result has no place: the scenes would come first, and are bad.
TEST_F(Program, OutputsAreTriedBeforeTheWork) {
    file_with("{", "bad.scenes.jsonl");
    std::filesystem::create_directory(path("folder"));
    for (const char* command :
         {"detect --method clc", "solve", "certify", "study formulations", "study backends",
          "study optimality", "study relaxations", "export --id a", "import-solution --id a --sol a.sol"}) {
        const std::string begun = std::string(command) + " --scenes bad.scenes.jsonl --out ";
        expect_refused(begun + "nowhere/x.lp", {"--out", "nowhere/x.lp"});
        expect_refused(begun + "folder", {"--out", "folder"});
    }
    expect_refused("score --scenes bad.scenes.jsonl --lanes x.lanes.jsonl --json nowhere/x",
                   {"--json", "nowhere/x"});
    expect_refused("tune --tracks generated:nowhere --out nowhere/p.json", {"--out", "nowhere/p.json"});
    expect_refused("scenes --tracks generated:circle --every 60 --out folder", {"--out", "folder"});
}

/// What is tried and not written stays; a pipe is not tried, since that would end it.
TEST_F(Program, TryingAnOutputLeavesItAsItWas) {
    file_with("old\n", "x.lanes.jsonl");
    expect_refused("detect --method clc --scenes nowhere.scenes.jsonl --out x.lanes.jsonl", {"nowhere"});
    EXPECT_EQ(text_of(path("x.lanes.jsonl")), "old\n");
    file_with(std::string(kScene) + "\n", "a.scenes.jsonl");
    const std::string pipe = path("pipe").string();
    ASSERT_EQ(
        std::system(("mkfifo " + pipe + " && (timeout 60 cat " + pipe + " >" + path("read").string() + " &)")
                        .c_str()),
        0);
    EXPECT_EQ(run("detect --method clc --scenes a.scenes.jsonl --out pipe").exit_code, 0);
    for (int wait = 0; wait < 100 && text_of(path("read")).empty(); ++wait) {
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    EXPECT_THAT(text_of(path("read")), HasSubstr("\"scene\":\"a\""));
}

/// Nothing is not right, and lines are counted with the blank ones.
TEST_F(Program, RecordsAreNamedByTheirLine) {
    file_with(std::string(kScene) + "\n", "a.scenes.jsonl");
    ASSERT_EQ(run("detect --method clc --scenes a.scenes.jsonl --out a.lanes.jsonl").exit_code, 0);
    ASSERT_EQ(run("solve --scenes a.scenes.jsonl --out a.solutions.jsonl").exit_code, 0);
    ASSERT_EQ(run("certify --scenes a.scenes.jsonl --out a.certificates.jsonl").exit_code, 0);
    file_with("\n", "empty");
    for (const auto& [command, name] : std::map<std::string, std::string>{
             {"score --scenes a.scenes.jsonl --lanes ", "a.lanes.jsonl"},
             {"check --scenes a.scenes.jsonl --solutions ", "a.solutions.jsonl"},
             {"certify --scenes a.scenes.jsonl --verify ", "a.certificates.jsonl"}}) {
        expect_refused(command + "empty", {"empty: holds no"});
        std::string line = text_of(path(name));
        line.replace(line.find("\"a\""), 3, "\"b\"");
        file_with("\n\n" + line, "b.jsonl");
        expect_refused(command + "b.jsonl", {"b.jsonl:3: scene", "'b'"});
    }
    expect_refused("score --scenes a.scenes.jsonl --lanes a.lanes.jsonl a.lanes.jsonl",
                   {"a.lanes.jsonl:1: method", "'clc'"});
}

TEST_F(Program, AFileThatCannotBeReadLeavesTheOldResult) {
    file_with("old\n", "x.lanes.jsonl");
    file_with("{", "bad.scenes.jsonl");
    EXPECT_EQ(run("detect --method clc --scenes bad.scenes.jsonl --out x.lanes.jsonl").exit_code, 2);
    EXPECT_EQ(text_of(path("x.lanes.jsonl")), "old\n");
}

TEST_F(Program, SameSeedSameBytesWithAnyNumberOfThreads) {
    const std::string options = "--fp 0,0.3 --noise 0.1 --miss 0.05 --pose-noise 0.2,0.05 --color ";
    make_scenes(options + "--threads 1", "one");
    make_scenes(options + "--threads 4", "four");
    make_scenes(options, "again");
    EXPECT_EQ(text_of(path("one.scenes.jsonl")), text_of(path("four.scenes.jsonl")));
    EXPECT_EQ(text_of(path("one.scenes.jsonl")), text_of(path("again.scenes.jsonl")));
    EXPECT_GT(read_scenes(path("one.scenes.jsonl")).size(), 10U);
}

TEST_F(Program, LanesDoNotDependOnThreads) {
    make_scenes("--fp 0,0.3");
    const auto lanes = [&](const std::string& method, const std::string& threads) {
        EXPECT_EQ(run("detect --method " + method + " --scenes s.scenes.jsonl --threads " + threads +
                      " --out " + threads + ".lanes.jsonl")
                      .exit_code,
                  0);
        std::vector<Lane> found;
        for (const LaneRecord& record : read_lanes(path(threads + ".lanes.jsonl")))
            found.push_back(record.answer.lane);
        return found;
    };
    EXPECT_EQ(lanes("clc", "1"), lanes("clc", "3"));
    EXPECT_EQ(lanes("rld-cbc", "1"), lanes("rld-cbc", "3"));
}

/// The ground truth, handed in as a method's lanes, is the best there can be.
TEST_F(Program, GroundTruthAsLanesScoresFull) {
    make_scenes("--fp 0,0.3,0.5 --range 30,50");
    const std::vector<AnnotatedScene> scenes = read_scenes(path("s.scenes.jsonl"));
    std::vector<LaneRecord> records;
    for (const AnnotatedScene& scene : scenes) {
        LaneRecord record{scene.scene.id, "truth", {}, 1.0, {}};
        record.answer.status = LaneStatus::found;
        record.answer.lane = *scene.ground_truth;
        records.push_back(record);
    }
    write_lanes(path("truth.lanes.jsonl"), records);
    const Outcome outcome = run("score --scenes s.scenes.jsonl --lanes truth.lanes.jsonl --json truth.json");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
    std::ifstream lines(path("truth.json"));
    std::size_t rows = 0;
    for (std::string line; std::getline(lines, line); ++rows) {
        const auto row = nlohmann::json::parse(line);
        EXPECT_EQ(row.at("mean_iou"), 1.0);
        EXPECT_EQ(row.at("success_share"), 1.0);
        EXPECT_EQ(row.at("share").at("ground_truth"), 1.0) << line;
        for (const char* key : {"commit", "compiler", "machine", "run"})
            EXPECT_TRUE(row.contains(key)) << key;
    }
    EXPECT_EQ(rows, 6U);
}

TEST_F(Program, SolutionsPassTheCheckerAndForgeriesDoNot) {
    make_scenes("--fp 0.2");
    ASSERT_EQ(run("solve --nearest 12 --scenes s.scenes.jsonl --out s.solutions.jsonl").exit_code, 0);
    const Outcome good = run("check --scenes s.scenes.jsonl --solutions s.solutions.jsonl");
    EXPECT_EQ(good.exit_code, 0) << good.output;
    EXPECT_THAT(good.output, HasSubstr(" passed, 0 failed"));

    std::string forged = text_of(path("s.solutions.jsonl"));
    const std::size_t objective = forged.find("\"objective\":-");
    ASSERT_NE(objective, std::string::npos);
    forged.insert(objective + 13, "9");
    file_with(forged, "forged.solutions.jsonl");
    const Outcome bad = run("check --scenes s.scenes.jsonl --solutions forged.solutions.jsonl");
    EXPECT_EQ(bad.exit_code, 1);
    EXPECT_THAT(bad.output, HasSubstr(" passed, 1 failed"));
}

/// What faces an edge is a matter of the cone set.
TEST_F(Program, ShapeCostsAreCheckedOnTheirConeSet) {
    make_scenes("--fp 0.5");
    const std::string on = "--nearest 12 --params shape --scenes s.scenes.jsonl ";
    ASSERT_EQ(run("solve --solver path-pair " + on + "--out n.solutions.jsonl").exit_code, 0);
    const Outcome good = run("check " + on + "--solutions n.solutions.jsonl");
    EXPECT_EQ(good.exit_code, 0) << good.output;
    EXPECT_THAT(good.output, HasSubstr(" passed, 0 failed"));
    EXPECT_EQ(run("check --params shape --scenes s.scenes.jsonl --solutions n.solutions.jsonl").exit_code, 1);
}

TEST_F(Program, CertificatesAreVerifiedAndForgeriesAreNot) {
    make_scenes("--fp 0.2");
    const std::string on_scenes = "certify --nearest 20 --scenes s.scenes.jsonl ";
    ASSERT_EQ(run(on_scenes + "--out s.certificates.jsonl").exit_code, 0);
    const Outcome good = run(on_scenes + "--verify s.certificates.jsonl");
    EXPECT_EQ(good.exit_code, 0) << good.output;
    EXPECT_THAT(good.output, HasSubstr(" verified, 0 failed"));

    // A bound that is higher by 1, a price below zero, a clique of edges that may go together.
    std::string first_line = text_of(path("s.certificates.jsonl"));
    first_line.resize(first_line.find('\n'));
    const nlohmann::json certificate = nlohmann::json::parse(first_line);
    std::vector<nlohmann::json> forgeries(4, certificate);
    forgeries[0]["bound"] = certificate["bound"].get<double>() + 1.0;
    forgeries[1]["heading_price"] = -0.1;
    const nlohmann::json& prices = certificate["cone_prices"];
    ASSERT_GE(prices.size(), 2U);
    const nlohmann::json edge{prices[0][0], prices[1][0]};  // which does not exclude itself
    forgeries[2]["cliques"].push_back({{"price", 0.1}, {"edges", {edge, edge}}});
    forgeries[3]["cone_prices"][0][0] = 123456;
    for (const nlohmann::json& forgery : forgeries) {
        file_with(forgery.dump() + "\n", "forged.certificates.jsonl");
        const Outcome bad = run(on_scenes + "--verify forged.certificates.jsonl");
        EXPECT_EQ(bad.exit_code, 1) << forgery;
        EXPECT_THAT(bad.output, HasSubstr("0 verified, 1 failed"));
    }
    expect_refused(on_scenes + "--pairing paper --out x.certificates.jsonl", {"near_far"});
    expect_refused(on_scenes, {"--out", "--verify"});
    file_with("{\"scene\": 3}\n", "bad.certificates.jsonl");
    expect_refused(on_scenes + "--verify bad.certificates.jsonl", {"bad.certificates.jsonl:1", "scene"});
}

TEST_F(Program, CertificatesCoverShapeCosts) {
    make_scenes("--fp 0.5");
    const std::string on_scenes = "certify --nearest 20 --scenes s.scenes.jsonl ";
    ASSERT_EQ(run(on_scenes + "--params shape --out shape.certificates.jsonl").exit_code, 0);
    const Outcome good = run(on_scenes + "--params shape --verify shape.certificates.jsonl");
    EXPECT_EQ(good.exit_code, 0) << good.output;
    EXPECT_THAT(good.output, HasSubstr(" verified, 0 failed"));
    // They are about these costs and this cone set.
    EXPECT_EQ(run(on_scenes + "--verify shape.certificates.jsonl").exit_code, 1);
    EXPECT_EQ(
        run("certify --scenes s.scenes.jsonl --params shape --verify shape.certificates.jsonl").exit_code, 1);
}

TEST_F(Program, CompareWritesATableAndEverythingBehindIt) {
    const Outcome outcome = run("compare --tracks generated:circle --every 15 --fp 0,0.3 --out results");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
    EXPECT_THAT(outcome.output, HasSubstr("rld-cbc n=12"));
    EXPECT_THAT(outcome.output, HasSubstr("CLC paper"));
    for (const char* file : {"scenes.scenes.jsonl", "scenes.tracks.json", "rld-cbc.lanes.jsonl",
                             "clc.lanes.jsonl", "results.jsonl", "table.txt"}) {
        EXPECT_TRUE(std::filesystem::exists(path("results") / file)) << file;
    }
    // Scoring the stored lanes again gives the same table.
    const Outcome again =
        run("score --scenes results/scenes.scenes.jsonl --lanes results/rld-cbc.lanes.jsonl "
            "results/rld-pair.lanes.jsonl results/rld-shape.lanes.jsonl results/clc.lanes.jsonl");
    EXPECT_EQ(again.output, text_of(path("results") / "table.txt"));
    expect_refused("report --results results --out page.html --png results/table.txt", {"results/table.txt"});
}

TEST_F(Program, TuneWithContextAndShapeLeavesARecordThatTheColourStudyUses) {
    const std::string tune =
        "tune --tracks generated:circle generated:straight --nearest 8 --context 16 --fp 0.3 --every 30 "
        "--shape --folds 2 --rounds 1 --evaluations 3 --time-limit 1000 --log p.jsonl --out p.json";
    const Outcome tuned = run(tune);
    ASSERT_EQ(tuned.exit_code, 0) << tuned.errors;
    EXPECT_THAT(tuned.output, HasSubstr("held out circle"));
    const nlohmann::json record = nlohmann::json::parse(text_of(path("p.record.json")));
    EXPECT_EQ(record["nearest"], 8);
    EXPECT_EQ(record["context"], 16);
    EXPECT_EQ(record["shape"], true);
    EXPECT_EQ(record["rounds"], 1);
    EXPECT_TRUE(has_shape_costs(read_rld_parameters(path("p.json"))));
    std::size_t counted = 0;
    for (const auto& [cause, scenes] : record["losses"]["0.3"].items()) counted += scenes.get<std::size_t>();
    EXPECT_GT(counted, 5U);
    EXPECT_TRUE(record.contains("wrong_cones"));
    EXPECT_EQ(run(tune).output, tuned.output) << "from its log";

    const Outcome study = run("study confidence-and-colour --record p.record.json --out study.jsonl");
    ASSERT_EQ(study.exit_code, 0) << study.errors;
    EXPECT_THAT(study.output, HasSubstr("colours, 20 % wrong"));
    // Geometry alone, on the held-out tracks: what the tuning says.
    std::ifstream lines(path("study.jsonl"));
    std::string first;
    std::getline(lines, first);
    const nlohmann::json geometry = nlohmann::json::parse(first);
    EXPECT_EQ(geometry["known"], "geometry alone");
    EXPECT_EQ(geometry["context"], 16);
    EXPECT_NEAR(geometry["accurate"].get<double>(), record["held_out_figures"]["mean"].get<double>(), 1e-12);
    expect_refused("study confidence-and-colour --record p.json", {"p.json"});
    expect_refused("study confidence-and-colour --record p.record.json --tracks generated:circle",
                   {"--tracks", "straight"});
}

/// The rows of results.jsonl without what depends on the clock, and without the record of the run, in which a
/// merged one names no shard.
std::vector<nlohmann::json> results_in(const std::filesystem::path& directory) {
    std::vector<nlohmann::json> rows;
    std::ifstream lines(directory / "results.jsonl");
    for (std::string line; std::getline(lines, line);) {
        rows.push_back(nlohmann::json::parse(line));
        for (const char* key : {"latency_ms", "within_budget_share", "solved_share", "run"})
            rows.back().erase(key);
    }
    return rows;
}

/// Lanes files hold the same but for the times.
std::vector<Lane> lanes_in(const std::filesystem::path& file) {
    std::vector<Lane> lanes;
    for (const LaneRecord& record : read_lanes(file)) lanes.push_back(record.answer.lane);
    return lanes;
}

constexpr const char* kTwoTracks =
    "compare --tracks generated:circle generated:kidney --every 15 --fp 0,0.3 --time-limit 60000 ";

TEST_F(Program, AStoppedComparisonGoesOn) {
    ASSERT_EQ(run(std::string(kTwoTracks) + "--out whole").exit_code, 0);
    // What a run leaves that is killed while it writes: some lines, the last one torn.
    std::filesystem::copy(path("whole"), path("stopped"));
    const std::string lines = text_of(path("whole") / "clc.lanes.jsonl");
    for (const char* file : {"clc.lanes.jsonl", "scores.jsonl", "results.jsonl", "table.txt"}) {
        std::filesystem::remove(path("stopped") / file);
    }
    file_with(lines.substr(0, lines.size() / 2), "stopped/clc.lanes.jsonl.part");
    ASSERT_EQ(run(std::string(kTwoTracks) + "--out stopped").exit_code, 0);
    EXPECT_EQ(lanes_in(path("stopped") / "clc.lanes.jsonl"), lanes_in(path("whole") / "clc.lanes.jsonl"));
    EXPECT_FALSE(std::filesystem::exists(path("stopped") / "clc.lanes.jsonl.part"));
    EXPECT_EQ(results_in(path("stopped")), results_in(path("whole")));
    EXPECT_EQ(results_in(path("stopped")).size(), 4U * 2U);  // methods, rates
}

TEST_F(Program, OtherOptionsInTheSameDirectoryStartAnew) {
    ASSERT_EQ(
        run("compare --tracks generated:circle --every 15 --methods clc --fp 0 --out results").exit_code, 0);
    const std::size_t before = lanes_in(path("results") / "clc.lanes.jsonl").size();
    ASSERT_EQ(
        run("compare --tracks generated:circle --every 15 --methods clc --fp 0,0.3 --out results").exit_code,
        0);
    EXPECT_EQ(lanes_in(path("results") / "clc.lanes.jsonl").size(), 2 * before);
}

TEST_F(Program, MergedShardsEqualOneRun) {
    ASSERT_EQ(run(std::string(kTwoTracks) + "--out whole").exit_code, 0);
    for (const char* shard : {"0", "1", "2"}) {
        ASSERT_EQ(run(std::string(kTwoTracks) + "--shard " + shard + "/3 --out part" + shard).exit_code, 0);
    }
    ASSERT_EQ(run("merge part2 part0 part1 --out merged").exit_code, 0);
    EXPECT_EQ(text_of(path("merged") / "scenes.scenes.jsonl"),
              text_of(path("whole") / "scenes.scenes.jsonl"));
    for (const char* method : {"clc.lanes.jsonl", "rld-cbc.lanes.jsonl"}) {
        EXPECT_EQ(lanes_in(path("merged") / method), lanes_in(path("whole") / method));
    }
    EXPECT_EQ(results_in(path("merged")), results_in(path("whole")));
    expect_refused("merge part0 part1 --out again", {"2/3 is missing"});
    expect_refused("merge part0 part1 part1 part2 --out again", {"1/3 is there twice"});
    expect_refused("merge part0 whole part2 --out again", {"whole", "shard"});
    ASSERT_EQ(
        run("compare --tracks generated:circle --shard 1/3 --every 15 --fp 0,0.3 --out other").exit_code, 0);
    expect_refused("merge part0 other part2 --out again", {"other", "tracks"});
    expect_refused("compare --shard 3/3 --out again", {"--shard"});
}

TEST_F(Program, RldAnswersOfAComparisonAreChecked) {
    ASSERT_EQ(run("compare --tracks generated:circle --every 15 --fp 0.3 --out results").exit_code, 0);
    for (const char* method : {"rld-cbc", "rld-pair", "rld-shape", "clc"}) {
        for (const LaneRecord& record :
             read_lanes(path("results") / (std::string(method) + ".lanes.jsonl"))) {
            EXPECT_EQ(record.checked,
                      std::string(method) != "clc" && record.answer.status == LaneStatus::found);
        }
    }
    for (const nlohmann::json& row : results_in(path("results"))) EXPECT_EQ(row.at("errors"), 0);
}

TEST_F(Program, ExactnessIsMeasuredOnStoredScenes) {
    make_scenes("--fp 0.2");
    const Outcome optimality = run("study optimality --scenes s.scenes.jsonl --out optimality.jsonl");
    ASSERT_EQ(optimality.exit_code, 0) << optimality.errors;
    EXPECT_THAT(optimality.output, HasSubstr("equal %"));
    std::ifstream lines(path("optimality.jsonl"));
    std::size_t rows = 0;
    for (std::string line; std::getline(lines, line); ++rows) {
        const auto row = nlohmann::json::parse(line);
        if (!row.contains("gap")) continue;
        const double optimum = row.at("optimum").at("objective");
        const double candidate = row.at("candidate").at("objective");
        EXPECT_DOUBLE_EQ(row.at("gap"),
                         std::max(0.0, candidate - optimum) / std::max(1.0, std::abs(optimum)));
    }
    EXPECT_EQ(rows, read_scenes(path("s.scenes.jsonl")).size());
    const Outcome backends = run("study backends --scenes s.scenes.jsonl --sizes 6 --out backends.jsonl");
    ASSERT_EQ(backends.exit_code, 0) << backends.errors;
    EXPECT_THAT(backends.output, HasSubstr("cbc-main/tight"));
    EXPECT_THAT(backends.output, HasSubstr("exhaustive"));
    const Outcome printed =
        run("study backends --scenes s.scenes.jsonl --sizes 6,10 --solvers all,cbc-main/paper");
    ASSERT_EQ(printed.exit_code, 0) << printed.errors;
    EXPECT_THAT(printed.output, HasSubstr("cbc-main/paper"));
    EXPECT_THAT(printed.output, HasSubstr("exhaustive takes at most 9 cones: left out at n = 10"));
    expect_refused("study optimality --scenes s.scenes.jsonl --method rld-cbc --out x.jsonl",
                   {"method", "enumerate"});
    expect_refused("study optimality --scenes nowhere.scenes.jsonl --out x.jsonl", {"nowhere.scenes.jsonl"});
    expect_refused("study backends --scenes s.scenes.jsonl --sizes 0 --out x.jsonl", {"--sizes"});
    expect_refused("study backends --scenes s.scenes.jsonl --solvers magic --out x.jsonl",
                   {"--solvers", "magic"});
    const Outcome list = run("study");
    EXPECT_EQ(list.exit_code, 0);
    EXPECT_THAT(list.output, HasSubstr("confidence-and-colour  how much more accurate"));
    expect_refused("study magic", {"magic"});
}

TEST_F(Program, SweepComparesConeSetSizes) {
    const Outcome outcome = run("sweep --tracks generated:circle --sizes 8,12 --every 30 --out sweep");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
    EXPECT_THAT(outcome.output, HasSubstr("clc n=8"));
    for (const LaneRecord& record : read_lanes(path("sweep") / "rld-cbc.n008.lanes.jsonl")) {
        EXPECT_EQ(record.nearest, 8U);
        EXPECT_LE(record.answer.lane.left.size() + record.answer.lane.right.size(), 8U);
    }
}

}  // namespace
}  // namespace conelane::experiments
