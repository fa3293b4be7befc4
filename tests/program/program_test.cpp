// The program as a user or a script calls it: its help, and one line and exit code 2 for bad input.

#include "tests/support/program_on_scenes.hpp"
#include "tests/support/testing.hpp"

namespace conelane::experiments {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST_F(Program, HelpIsEverywhere) {
    run_well("--help");
    for (const char* command :
         {"scenes", "detect", "methods", "solve", "solvers", "check", "score", "compare", "sweep", "merge",
          "study", "study formulations", "study optimality", "study backends", "study relaxations",
          "study confidence-and-colour", "study front-beam", "report", "tune"}) {
        const Outcome help = run_well(std::string(command) + " --help");
        EXPECT_THAT(help.output, HasSubstr("--help")) << command;
    }
}

/// What has become a part of another command is called by its old name, too.
TEST_F(Program, OldNamesOfCommandsWork) {
    EXPECT_EQ(run("solvers").output, run("methods --solvers").output);
    EXPECT_EQ(run("cross-check --help").output, run("study cross-check --help").output);
    EXPECT_EQ(run("import-solution --help").output, run("export --help").output);
    EXPECT_EQ(run("tune-method --help").output, run("tune --help").output);
    EXPECT_EQ(run("solvers").errors, "");
    expect_refused("sweep --nearest 6 --out r", {"--nearest", "--by-size"});
    expect_refused("compare --sizes 6,8 --out r", {"--sizes", "--by-size"});
    expect_refused("compare --merge --out r", {"shards"});
    expect_refused("compare part0 --out r", {"shards", "--merge"});
    expect_refused("export --solver x --scenes s --id a --out x.mps", {"--solver", "--sol"});
    expect_refused("tune --method astar-lane --rounds 2 --tracks generated:circle --out p.json",
                   {"--rounds", "--method"});
}

TEST_F(Program, TheVersionNamesCommitCompilerAndSolvers) {
    const std::string version = run("--version").output;
    EXPECT_THAT(version,
                testing::MatchesRegex("conelane [0-9.]+\ncommit .+\ncompiler .+\nsolvers .*path-pair.*\n"));
}

TEST_F(Program, DetectorsForUsersComeFirstAndAblationsOnRequest) {
    const std::string some = run("methods").output;
    const std::string all = run("methods --all").output;
    EXPECT_THAT(some, HasSubstr("rld-pair "));
    EXPECT_THAT(some, Not(HasSubstr("clc-no-beam")));
    EXPECT_THAT(all, HasSubstr("clc-no-beam"));
    EXPECT_THAT(all, testing::StartsWith(some));
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
    // As from scripts with an unset variable.
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

TEST_F(Program, TimeLimitsAreAboveZero) {
    file_with(std::string(kScene) + "\n", "a.scenes.jsonl");
    for (const char* limit : {"0", "-1", "nan", "soon", "400ms"}) {
        expect_refused("detect --method clc --scenes a.scenes.jsonl --out l.lanes.jsonl --time-limit " +
                           std::string(limit),
                       {"--time-limit", "not a number above 0"});
    }
    expect_refused("tune --tracks generated:circle --out p.json --time-limit inf", {"--time-limit"});
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

/// No scene is an error, and line numbers count blank lines.
TEST_F(Program, RecordsAreNamedByTheirLine) {
    file_with(std::string(kScene) + "\n", "a.scenes.jsonl");
    run_well("detect --method clc --scenes a.scenes.jsonl --out a.lanes.jsonl");
    run_well("solve --scenes a.scenes.jsonl --out a.solutions.jsonl");
    run_well("certify --scenes a.scenes.jsonl --out a.certificates.jsonl");
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

}  // namespace
}  // namespace conelane::experiments
