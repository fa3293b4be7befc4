// The program as a user or a script calls it: files in, files out, one line and exit code 2 on bad input.

#include "experiments/files/folder_lock.hpp"
#include "experiments/files/lane_file.hpp"
#include "experiments/files/parameter_file.hpp"
#include "experiments/scenes/scene_file.hpp"
#include "tests/program_fixture.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <functional>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>
#include <unistd.h>

namespace conelane::experiments {
namespace {

using testing::HasSubstr;
using testing::Not;

class Program : public ProgramFixture {
  protected:
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
          "study confidence-and-colour", "study front-beam", "report", "tune"}) {
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
    expect_refused("scenes --tracks generated:circle --condition car,rain --out a.scenes.jsonl",
                   {"condition", "rain"});
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
    expect_refused("train front --tracks generated:circle --draws 0 --out f.json", {"--draws"});
    expect_refused("train front --tracks generated:circle --trusted 1.5 --out f.json", {"trusted"});
    expect_refused("train front --tracks generated:nowhere --out f.json", {"nowhere"});
    expect_refused("train front --tracks generated:circle --hold-out generated:circle --out f.json",
                   {"circle"});
}

TEST_F(Program, TrainsFrontAndGoesOnWhereItWasStopped) {
    const std::string command =
        "train front --tracks generated:slalom@1 --hold-out generated:kidney@2 --hold-out-every 80 --fp 0.3 "
        "--draws 1 --trust-draws 4 --imitation-steps 4 --search-steps 4 --judge-steps 4 --figures-every 6 "
        "--seed 3 --out ";
    const Outcome whole = run(command + "whole.json");
    ASSERT_EQ(whole.exit_code, 0) << whole.errors;
    EXPECT_THAT(whole.output, HasSubstr("step 12 of 12, judging"));
    EXPECT_THAT(whole.output, HasSubstr("usable"));
    ASSERT_EQ(run(command + "first.json --checkpoint c.json").exit_code, 0);
    const Outcome again = run(command + "again.json --checkpoint c.json --threads 2");
    ASSERT_EQ(again.exit_code, 0) << again.errors;
    EXPECT_THAT(again.output, Not(HasSubstr("step"))) << "nothing is left to do";
    const auto weights = [&](const std::string& file) {
        auto json = nlohmann::json::parse(text_of(path(file)));
        json.erase("training");  // the figures of a run that has nothing left to do are missing
        return json;
    };
    EXPECT_EQ(weights("again.json"), weights("whole.json"));
    const Outcome other = run(command + "other.json --checkpoint c.json --beam 7");
    EXPECT_EQ(other.exit_code, 2);
    EXPECT_THAT(other.errors, HasSubstr("c.json"));
    EXPECT_FALSE(std::filesystem::exists(path("other.json")));
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

/// Verified, tampered with, of another cone, and more than may be looked at: the exit code tells the first
/// from the others.
TEST_F(Program, CertifiesWholeSearches) {
    make_scenes("--fp 0.2");
    ASSERT_EQ(run("certify --whole --nearest 16 --scenes s.scenes.jsonl --out c.jsonl").exit_code, 0);
    const std::string verify = "certify --nearest 16 --scenes s.scenes.jsonl --verify ";
    const Outcome good = run(verify + "c.jsonl");
    EXPECT_EQ(good.exit_code, 0);
    EXPECT_THAT(good.output, testing::AllOf(HasSubstr("0 refused"), HasSubstr("0 not verified")));
    const std::string text = text_of(path("c.jsonl"));
    std::string forged = text;
    const std::size_t digit = forged.find("\"objective\":-") + 14;
    forged[digit] = forged[digit] == '9' ? '8' : static_cast<char>(forged[digit] + 1);
    file_with(forged, "forged.jsonl");
    const Outcome bad = run(verify + "forged.jsonl");
    EXPECT_EQ(bad.exit_code, 1);
    EXPECT_THAT(bad.output, testing::AllOf(HasSubstr("does not cost"), HasSubstr("1 refused")));
    EXPECT_EQ(run("certify --nearest 4 --scenes s.scenes.jsonl --verify c.jsonl").exit_code, 1);
    expect_refused(verify + "c.jsonl --most-steps 0", {"--most-steps"});
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

/// Under another name, through links, by the companion: nothing that is read is written.
TEST_F(Program, AnOutputIsNoInput) {
    make_scenes("--fp 0.2");
    const std::string scenes = text_of(path("s.scenes.jsonl"));
    std::filesystem::create_symlink(path("s.scenes.jsonl"), path("link"));
    std::filesystem::create_hard_link(path("s.scenes.jsonl"), path("hard"));
    std::filesystem::create_directory(path("sub"));
    for (const char* command : {"detect --method clc", "solve", "certify", "export --id a"}) {
        for (const char* out :
             {"s.scenes.jsonl", "./sub/../s.scenes.jsonl", "link", "hard", "s.tracks.json"}) {
            expect_refused(std::string(command) + " --scenes s.scenes.jsonl --out " + out,
                           {"--out", out, "--scenes"});
        }
        expect_refused(std::string(command) + " --scenes link --out s.scenes.jsonl", {"--out", "--scenes"});
    }
    ASSERT_EQ(run("detect --method clc --scenes s.scenes.jsonl --out l.lanes.jsonl").exit_code, 0);
    expect_refused("score --scenes s.scenes.jsonl --lanes l.lanes.jsonl --json l.lanes.jsonl",
                   {"--json", "l.lanes.jsonl", "--lanes"});
    ASSERT_EQ(run("certify --scenes s.scenes.jsonl --out c.certificates.jsonl").exit_code, 0);
    write_rld_parameters(path("p.json"), RldParameters{});
    expect_refused("solve --scenes s.scenes.jsonl --params p.json --out p.json", {"--out", "--params"});
    file_with("tag,x,y,direction,x_variance,y_variance,xy_covariance\n", "t.csv");
    expect_refused("scenes --tracks eufs:t.csv --out t.csv", {"--out", "--tracks"});
    std::filesystem::create_directory(path("r"));
    file_with("", "r/results.jsonl");
    expect_refused("report --results r --out r/results.jsonl", {"--out", "--results"});
    EXPECT_EQ(text_of(path("s.scenes.jsonl")), scenes);
    // What is no file may have a file's name.
    EXPECT_EQ(run("detect --method clc --scenes s.scenes.jsonl --out clc").exit_code, 0);
    EXPECT_EQ(run("detect --method clc --scenes s.scenes.jsonl --out clc").exit_code, 0);
}

TEST_F(Program, AnOutputThatIsNotWrittenIsAFailure) {
    make_scenes("--fp 0.2");
    ASSERT_EQ(run("detect --method clc --scenes s.scenes.jsonl --out l.lanes.jsonl").exit_code, 0);
    const auto exit_code = [&](const std::string& arguments) {
        const std::string command = "cd " + path("").string() + " && " CONELANE_PROGRAM " " + arguments +
                                    " 2>" + path("stderr").string();
        return WEXITSTATUS(std::system(command.c_str()));
    };
    for (const char* command :
         {"methods", "--version", "--help", "score --scenes s.scenes.jsonl --lanes l.lanes.jsonl"}) {
        for (const char* stream : {" >/dev/full", " >&-"}) {
            EXPECT_EQ(exit_code(std::string(command) + stream), 2) << command << stream;
            EXPECT_EQ(text_of(path("stderr")), "conelane: standard output cannot be written to its end\n");
        }
    }
    // A closed output is not given to the next file that is opened.
    EXPECT_EQ(exit_code("scenes --tracks generated:circle --every 40 --out c.scenes.jsonl >&-"), 2);
    EXPECT_THAT(text_of(path("c.scenes.jsonl")), Not(HasSubstr("boundaries in")));
    EXPECT_EQ(exit_code("detect --method clc --scenes s.scenes.jsonl --out m.lanes.jsonl >&-"), 0)
        << "it has nothing to say";
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
        EXPECT_EQ(row.at("usable_share"), 1.0);
        EXPECT_LT(row.at("lateral_p95_m").get<double>(), 1e-6);
        EXPECT_LT(row.at("heading_p95_rad").get<double>(), 1e-6);
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

/// One line for each claim, whoever makes it; the scene has ten cones in two rows, or too few.
class Claims : public Program {
  protected:
    static nlohmann::json scene(const std::string& id, int pairs) {
        nlohmann::json scene{{"id", id}, {"pose", {{"x", -1}, {"y", 0}, {"yaw", 0}}}};
        for (int i = 0; i < pairs; ++i) {
            scene["cones"].push_back({{"id", 1 + i}, {"x", 4.0 * i}, {"y", 1.75}});
            scene["cones"].push_back({{"id", 101 + i}, {"x", 4.0 * i}, {"y", -1.75}});
        }
        return scene;
    }
    static std::string infeasible(const std::string& id, const std::string& solver) {
        return nlohmann::json{{"scene", id},
                              {"solver", solver},
                              {"formulation", "tight"},
                              {"status", "infeasible"},
                              {"edges", nlohmann::json::array()},
                              {"build_ms", 1},
                              {"solve_ms", 1}}
                   .dump() +
               "\n";
    }
    Outcome check(const std::string& solutions, const std::string& options = "") {
        file_with(solutions, "c.solutions.jsonl");
        return run("check --scenes c.scenes.jsonl --solutions c.solutions.jsonl " + options);
    }
};

TEST_F(Claims, AnUnprovenInfeasibleFails) {
    file_with(scene("lane", 5).dump() + "\n", "c.scenes.jsonl");
    for (const char* solver : {"cbc", "path-pair", "exhaustive", "stranger"}) {
        const Outcome outcome = check(infeasible("lane", solver));
        EXPECT_EQ(outcome.exit_code, 1) << solver;
        EXPECT_THAT(outcome.output, HasSubstr("lane: " + std::string(solver) + " claims infeasible, but"));
        EXPECT_THAT(outcome.output, HasSubstr("0 passed, 1 failed"));
    }
    // Too many cones for a search of the checker's own: a solver finds the lane graph, the checker accepts
    // it.
    make_scenes("--fp 0.3", "c");
    const std::vector<AnnotatedScene> scenes = read_scenes(path("c.scenes.jsonl"));
    std::string forged;
    for (AnnotatedScene scene : scenes) forged += infeasible(scene.scene.id, "cbc");
    const Outcome outcome = check(forged);
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.output, HasSubstr("0 passed, " + std::to_string(scenes.size()) + " failed"));
}

TEST_F(Claims, AProvenInfeasiblePasses) {
    // A pair of cones is no lane; far away ones have no edge that counts in (9).
    nlohmann::json behind = scene("behind", 5);
    behind["pose"]["x"] = 100;
    file_with(scene("pair", 1).dump() + "\n" + behind.dump() + "\n", "c.scenes.jsonl");
    const Outcome outcome = check(infeasible("pair", "path-pair") + infeasible("behind", "path-pair"));
    EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
    EXPECT_THAT(outcome.output, HasSubstr("2 passed, 0 failed"));
}

TEST_F(Claims, AnInfeasibleThatNothingConfirmsFails) {
    file_with(scene("a", 30).dump() + "\n", "c.scenes.jsonl");
    const Outcome outcome = check(infeasible("a", "cbc"), "--time-limit 1e-6");
    EXPECT_EQ(outcome.exit_code, 1) << outcome.output;
    EXPECT_THAT(outcome.output, HasSubstr("neither confirmed nor refuted"));
}

TEST_F(Claims, AMissingAnswerFails) {
    std::string scenes;
    for (int i = 0; i < 22; ++i) scenes += scene("s" + std::to_string(i), 5).dump() + "\n";
    file_with(scenes, "c.scenes.jsonl");
    ASSERT_EQ(run("solve --scenes c.scenes.jsonl --out all.solutions.jsonl").exit_code, 0);
    const std::string all = text_of(path("all.solutions.jsonl"));
    EXPECT_EQ(check(all).exit_code, 0);
    const Outcome one = check(all.substr(0, all.find('\n') + 1));
    EXPECT_EQ(one.exit_code, 1);
    EXPECT_THAT(one.output, HasSubstr("s21: cbc (tight) gives no answer"));
    EXPECT_THAT(one.output, HasSubstr("1 passed, 21 failed"));
    const Outcome partial = check(all.substr(0, all.find('\n') + 1), "--partial");
    EXPECT_EQ(partial.exit_code, 0);
    EXPECT_THAT(partial.output, HasSubstr("1 passed, 0 failed"));
}

/// An optimum is none where another lane graph of the file is better.
TEST_F(Claims, ABetterLaneGraphRefutesAnOptimum) {
    file_with(scene("lane", 5).dump() + "\n", "c.scenes.jsonl");
    ASSERT_EQ(run("solve --scenes c.scenes.jsonl --out best.solutions.jsonl").exit_code, 0);
    ASSERT_EQ(run("solve --nearest 8 --scenes c.scenes.jsonl --out some.solutions.jsonl").exit_code, 0);
    nlohmann::json some = nlohmann::json::parse(text_of(path("some.solutions.jsonl")));
    EXPECT_EQ(some["nearest"], 8);
    EXPECT_EQ(check(some.dump() + "\n").exit_code, 0) << "the optimum of its cone set";
    some.erase("nearest");
    some["solver"] = "hasty";
    const Outcome outcome = check(some.dump() + "\n" + text_of(path("best.solutions.jsonl")));
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.output, HasSubstr("lane: hasty claims the bound"));
    EXPECT_THAT(outcome.output, HasSubstr("1 passed, 1 failed"));
}

TEST_F(Claims, StoppedSolutionsSayWhyAndClaimNothing) {
    file_with(scene("lane", 8).dump() + "\n", "c.scenes.jsonl");
    ASSERT_EQ(
        run("solve --solver cbc --time-limit 1e-6 --scenes c.scenes.jsonl --out c.solutions.jsonl").exit_code,
        0);
    const std::string solutions = text_of(path("c.solutions.jsonl"));
    const nlohmann::json record = nlohmann::json::parse(solutions);
    EXPECT_EQ(record["status"], "time_limit");
    EXPECT_EQ(record["stopped_by"], "time");
    const Outcome outcome = check(solutions);
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_THAT(outcome.output, HasSubstr("1 claim nothing"));
    EXPECT_THAT(outcome.output, HasSubstr("0 passed, 0 failed"));
}

/// What faces an edge is a matter of the cone set.
TEST_F(Program, ShapeCostsAreCheckedOnTheirConeSet) {
    make_scenes("--fp 0.5");
    const std::string on = "--nearest 12 --params shape --scenes s.scenes.jsonl ";
    ASSERT_EQ(run("solve --solver path-pair " + on + "--out n.solutions.jsonl").exit_code, 0);
    const Outcome good = run("check " + on + "--solutions n.solutions.jsonl");
    EXPECT_EQ(good.exit_code, 0) << good.output;
    EXPECT_THAT(good.output, HasSubstr(" passed, 0 failed"));
    const std::string shape = "check --params shape --scenes s.scenes.jsonl --solutions n.solutions.jsonl ";
    EXPECT_EQ(run(shape).exit_code, 0) << "the solutions say it";
    EXPECT_EQ(run(shape + "--nearest 20").exit_code, 1);
}

TEST_F(Program, CertificatesAreVerifiedAndForgeriesAreNot) {
    make_scenes("--fp 0.2");
    const std::string on_scenes = "certify --nearest 20 --scenes s.scenes.jsonl ";
    ASSERT_EQ(run(on_scenes + "--out s.certificates.jsonl").exit_code, 0);
    const Outcome good = run(on_scenes + "--verify s.certificates.jsonl");
    EXPECT_EQ(good.exit_code, 0) << good.output;
    EXPECT_THAT(good.output, HasSubstr(" verified, 0 failed"));

    // A bound that is higher by 1, a multiplier below zero, a clique of edges that may go together.
    std::string first_line = text_of(path("s.certificates.jsonl"));
    first_line.resize(first_line.find('\n'));
    const nlohmann::json certificate = nlohmann::json::parse(first_line);
    std::vector<nlohmann::json> forgeries(4, certificate);
    forgeries[0]["bound"] = certificate["bound"].get<double>() + 1.0;
    forgeries[1]["heading_price"] = -0.1;
    const nlohmann::json& multipliers = certificate["cone_prices"];
    ASSERT_GE(multipliers.size(), 2U);
    const nlohmann::json edge{multipliers[0][0], multipliers[1][0]};  // which does not exclude itself
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
            "results/rld-pair.lanes.jsonl results/rld-shape.lanes.jsonl results/front.lanes.jsonl "
            "results/clc.lanes.jsonl "
            "results/clc-paper.lanes.jsonl results/delaunay-beam.lanes.jsonl results/astar-lane.lanes.jsonl");
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
    EXPECT_EQ(results_in(path("stopped")).size(), 8U * 2U * 2U);  // methods, conditions, rates
}

TEST_F(Program, OtherOptionsInTheSameDirectoryAreRefusedUnlessToOverwrite) {
    const std::string clc = "compare --tracks generated:circle --every 15 --methods clc --out results ";
    ASSERT_EQ(run(clc + "--fp 0").exit_code, 0);
    const std::string lanes = text_of(path("results") / "clc.lanes.jsonl");
    const std::string record = text_of(path("results") / "run.json");
    expect_refused(clc + "--fp 0,0.3", {"results", "differs in fp", "--overwrite"});
    expect_refused(clc + "--fp 0 --time-limit 77", {"results", "time_limit_ms", "--overwrite"});
    expect_refused("sweep --tracks generated:circle --sizes 8 --out results", {"results", "--overwrite"});
    EXPECT_EQ(text_of(path("results") / "clc.lanes.jsonl"), lanes);
    EXPECT_EQ(text_of(path("results") / "run.json"), record);
    ASSERT_EQ(run(clc + "--fp 0").exit_code, 0);
    EXPECT_EQ(text_of(path("results") / "clc.lanes.jsonl"), lanes)
        << "times of the first run: it has resumed";
    const std::size_t before = lanes_in(path("results") / "clc.lanes.jsonl").size();
    ASSERT_EQ(run(clc + "--fp 0,0.3 --overwrite").exit_code, 0);
    EXPECT_EQ(lanes_in(path("results") / "clc.lanes.jsonl").size(), 2 * before);
    std::filesystem::remove(path("results") / "run.json");
    expect_refused(clc + "--fp 0", {"results", "run.json", "--overwrite"});
}

TEST_F(Program, OneComparisonAtATimeWritesIntoAFolder) {
    const std::string clc =
        "compare --tracks generated:circle --every 15 --methods clc --fp 0 --out results ";
    std::filesystem::create_directory(path("results"));
    {
        const FolderLock lock(path("results"));
        expect_refused(clc, {"results", "another conelane is writing there"});
        expect_refused(clc + "--overwrite", {"results", "another conelane is writing there"});
    }
    EXPECT_EQ(run(clc).exit_code, 0);
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
    const std::string part = text_of(path("part1") / "run.json");
    expect_refused("merge part0 part1 part2 --overwrite --out part1", {"part1", "one of the shards"});
    EXPECT_EQ(text_of(path("part1") / "run.json"), part);
    expect_refused("merge part0 part1 part2 --out other", {"other", "--overwrite"});
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
    const Outcome beams = run("study front-beam --scenes s.scenes.jsonl --beams 5,15 --reference-beam 40");
    EXPECT_THAT(beams.output, HasSubstr("best score"));
    expect_refused("study front-beam --scenes s.scenes.jsonl --beams 0", {"beam_width"});
    expect_refused("study front-beam --scenes s.scenes.jsonl --weights s.scenes.jsonl", {"s.scenes.jsonl"});
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

/// Work that is begun, and a signal to all of it, as Ctrl-C gives.
class Interruption : public Program {
  protected:
    /// Runs the program until `begun` says so, then ends it by the signal. Its temporary files go to `tmp`.
    void interrupt(const std::string& arguments, int signal, const std::function<bool()>& begun) {
        std::filesystem::create_directories(path("tmp"));
        const std::string command = "cd " + path("").string() + " && TMPDIR=tmp exec " CONELANE_PROGRAM " " +
                                    arguments + " >stdout 2>stderr";
        const pid_t child = ::fork();
        if (child == 0) {
            ::setpgid(0, 0);
            ::execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
            ::_exit(127);
        }
        ::setpgid(child, child);
        int status = 0;
        bool ready = false;
        for (int wait = 0; wait < 6000 && !(ready = begun()); ++wait) {
            ASSERT_EQ(::waitpid(child, &status, WNOHANG), 0) << text_of(path("stderr"));
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
        EXPECT_TRUE(ready);
        ::kill(-child, signal);
        ASSERT_EQ(::waitpid(child, &status, 0), child);
        EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == signal) << "status " << status;
        EXPECT_EQ(text_of(path("stderr")), "conelane: interrupted\n");
        EXPECT_EQ(text_of(path("stdout")), "");
        EXPECT_TRUE(std::filesystem::is_empty(path("tmp")));
        for (const auto& entry : std::filesystem::recursive_directory_iterator(path(""))) {
            EXPECT_THAT(entry.path().string(), Not(HasSubstr(".tmp")));
        }
    }
    /// Seconds of work.
    void make_dense_scenes() {
        ASSERT_EQ(run("scenes --tracks generated:kidney --every 1.1 --fp 0,0.1,0.2,0.3,0.4,0.5 --out "
                      "s.scenes.jsonl")
                      .exit_code,
                  0);
    }
    [[nodiscard]] bool has_a_temporary_file(const std::string& folder) const {
        for (const auto& entry : std::filesystem::recursive_directory_iterator(path(folder))) {
            if (entry.path().string().find(".tmp") != std::string::npos) return true;
        }
        return false;
    }
};

TEST_F(Interruption, OfADetectionLeavesTheOldAnswers) {
    make_dense_scenes();
    file_with("old\n", "l.lanes.jsonl");
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
        const auto start = std::chrono::steady_clock::now();
        interrupt("detect --method rld-cbc --nearest 30 --scenes s.scenes.jsonl --out l.lanes.jsonl", signal,
                  [&] { return std::chrono::steady_clock::now() - start > std::chrono::milliseconds(400); });
        EXPECT_EQ(text_of(path("l.lanes.jsonl")), "old\n");
    }
}

TEST_F(Interruption, OfAComparisonLeavesWhatItAnsweredAndTheNextOneGoesOn) {
    const std::string compare =
        "compare --tracks generated:circle generated:kidney --every 4 --fp 0,0.1,0.2,0.3 --methods "
        "clc,rld-cbc "
        "--nearest 20 --out results";
    const auto part = path("results") / "rld-cbc.n020.lanes.jsonl.part";
    interrupt(compare, SIGINT, [&] { return !text_of(part).empty(); });
    const std::string answered = text_of(part);
    const std::string whole_laps = answered.substr(0, answered.rfind('\n') + 1);
    const std::string clc = text_of(path("results") / "clc.n020.lanes.jsonl");
    ASSERT_FALSE(std::filesystem::exists(path("results") / "rld-cbc.n020.lanes.jsonl"))
        << "it was done too early";
    ASSERT_EQ(run(compare).exit_code, 0);
    EXPECT_EQ(text_of(path("results") / "clc.n020.lanes.jsonl"), clc);
    EXPECT_TRUE(text_of(path("results") / "rld-cbc.n020.lanes.jsonl").starts_with(whole_laps.substr(0, 200)));
}

TEST_F(Interruption, OfAReportLeavesNoPage) {
    ASSERT_EQ(run("compare --tracks generated:circle --every 15 --methods clc --out results").exit_code, 0);
    if (!std::filesystem::exists(path("results") / "report.html"))
        GTEST_SKIP() << "no Python with matplotlib";
    for (const int signal : {SIGINT, SIGTERM}) {
        interrupt("report --results results --out page.html --png pictures", signal, [&] {
            for (const auto& entry : std::filesystem::recursive_directory_iterator(path("tmp"))) {
                if (entry.path().filename() == "report.zip") return true;
            }
            return false;
        });
        EXPECT_FALSE(std::filesystem::exists(path("page.html")));
        EXPECT_FALSE(std::filesystem::exists(path("pictures")));
    }
}

/// A file that is open all the time: a stream of scenes that has not ended.
TEST_F(Interruption, OfAStreamLeavesNoTemporaryFile) {
    ASSERT_EQ(std::system(("mkfifo " + path("scenes").string()).c_str()), 0);
    const int held_open = ::open(path("scenes").c_str(), O_RDWR);
    interrupt("detect --method clc --scenes - --out l.lanes.jsonl <scenes", SIGINT, [&] {
        return std::ranges::any_of(std::filesystem::directory_iterator(path("")), [](const auto& entry) {
            return entry.path().filename().string().starts_with("l.lanes.jsonl.tmp");
        });
    });
    ::close(held_open);
    EXPECT_FALSE(std::filesystem::exists(path("l.lanes.jsonl")));
}

/// Each line is answered before the next one is sent.
TEST_F(Program, AStreamIsAnsweredLineByLine) {
    make_scenes("--fp 0.2");
    const std::vector<Lane> expected = [&] {
        EXPECT_EQ(run("detect --method clc --scenes s.scenes.jsonl --out l.lanes.jsonl").exit_code, 0);
        return lanes_in(path("l.lanes.jsonl"));
    }();
    const std::string in = path("in").string();
    const std::string out = path("out").string();
    ASSERT_EQ(std::system(("mkfifo " + in + " " + out).c_str()), 0);
    ASSERT_EQ(std::system(("(timeout 60 " CONELANE_PROGRAM " detect --method clc --scenes - --out - <" + in +
                           " >" + out + "; echo $? >" + path("code").string() + ") &")
                              .c_str()),
              0);
    std::ofstream scenes(in);
    std::ifstream lanes(out);
    std::ifstream file(path("s.scenes.jsonl"));
    std::size_t count = 0;
    for (std::string scene, lane; std::getline(file, scene); ++count) {
        scenes << "{\"reset\": true}\n" << scene << std::endl;
        ASSERT_TRUE(std::getline(lanes, lane));
        const nlohmann::json answer = nlohmann::json::parse(lane);
        EXPECT_EQ(answer["scene"], nlohmann::json::parse(scene)["id"]);
        EXPECT_EQ(answer["left"].get<std::vector<ConeId>>(), expected.at(count).left);
        EXPECT_EQ(answer["right"].get<std::vector<ConeId>>(), expected.at(count).right);
    }
    scenes << "{\"id\": 3}" << std::endl;
    std::string lane;
    ASSERT_TRUE(std::getline(lanes, lane));
    const nlohmann::json wrong = nlohmann::json::parse(lane);
    EXPECT_EQ(wrong["status"], "error");
    EXPECT_EQ(wrong["scene"], std::to_string(2 * count + 1));
    EXPECT_THAT(wrong["message"].get<std::string>(), HasSubstr("id"));
    scenes.close();
    EXPECT_FALSE(std::getline(lanes, lane)) << "it ends with its input";
    for (int wait = 0; wait < 200 && text_of(path("code")).empty(); ++wait) {
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    EXPECT_EQ(text_of(path("code")), "0\n");
    const Outcome whole = run("detect --method clc --scenes s.scenes.jsonl --out -");
    EXPECT_EQ(static_cast<std::size_t>(std::ranges::count(whole.output, '\n')), expected.size());
    expect_refused("detect --method clc --scenes - --out - --threads 2", {"--threads", "stream"});
}

TEST_F(Program, MethodsForUsersComeFirstAndAblationsOnRequest) {
    const std::string some = run("methods").output;
    const std::string all = run("methods --all").output;
    EXPECT_THAT(some, HasSubstr("rld-pair "));
    EXPECT_THAT(some, Not(HasSubstr("clc-no-beam")));
    EXPECT_THAT(all, HasSubstr("clc-no-beam"));
    EXPECT_THAT(all, testing::StartsWith(some));
}

TEST_F(Program, TheVersionNamesCommitCompilerAndSolvers) {
    const std::string version = run("--version").output;
    EXPECT_THAT(version,
                testing::MatchesRegex("conelane [0-9.]+\ncommit .+\ncompiler .+\nsolvers .*path-pair.*\n"));
}

}  // namespace
}  // namespace conelane::experiments
