// The program as a user or a script calls it: its help, and one line and exit code 2 for bad input.

#include "tests/support/program_on_scenes.hpp"
#include "tests/support/testing.hpp"

namespace conelane::experiments {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST_F(Program, HelpIsEverywhere) {
    run_well("--help");
    for (const char* command : {"scenes", "detect", "methods", "solve", "solvers", "check", "score",
                                "compare", "sweep", "merge", "study", "study formulations",
                                "study optimality", "study backends", "study relaxations", "study front-beam", "report", "tune"}) {
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
}

TEST_F(Program, TheVersionNamesCommitCompilerAndSolvers) {
    const std::string version = run("--version").output;
    EXPECT_THAT(version,
                testing::MatchesRegex("conelane [0-9.]+\ncommit .+\ncompiler .+\nsolvers .*path-pair.*\n"));
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
