// Solutions and certificates that the program checks; forged ones are found.

#include "evaluation/formats/scene_file.hpp"
#include "tests/support/program_on_scenes.hpp"

#include <cstddef>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace conelane::experiments {
namespace {

using testing::HasSubstr;

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

TEST_F(Program, SolveCountsTheAnswersByStatus) {
    file_with(R"({"id":"a","pose":{"x":0,"y":0,"yaw":0},"cones":[{"id":1,"x":1,"y":1}]})"
              "\n"
              R"({"id":"b","pose":{"x":0,"y":0,"yaw":0},"cones":[{"id":1,"x":1,"y":1}]})",
              "e.scenes.jsonl");
    EXPECT_EQ(run("solve --solver path-pair --scenes e.scenes.jsonl --out e.solutions.jsonl").output,
              "2 scenes: 2 infeasible, in e.solutions.jsonl\n");
}

/// One line for each claim of any solver; the scene has ten cones in two rows, or too few.
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
    // Too many cones for the checker's own search: a solver finds the lane graph, and the checker accepts
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
    // A pair of cones is not a lane; far from the car, no edge counts in (9).
    nlohmann::json behind = scene("behind", 5);
    behind["pose"]["x"] = 100;
    file_with(scene("pair", 1).dump() + "\n" + behind.dump() + "\n", "c.scenes.jsonl");
    const Outcome outcome = check(infeasible("pair", "path-pair") + infeasible("behind", "path-pair"));
    EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
    EXPECT_THAT(outcome.output, HasSubstr("2 passed, 0 failed"));
}

TEST_F(Claims, WhatNothingProvesIsUnverified) {
    file_with(scene("a", 30).dump() + "\n", "c.scenes.jsonl");
    ASSERT_EQ(run("solve --scenes c.scenes.jsonl --out best.solutions.jsonl").exit_code, 0);
    const std::string optimum = text_of(path("best.solutions.jsonl"));
    for (const std::string& claim : {infeasible("a", "cbc"), optimum}) {
        const Outcome outcome = check(claim, "--time-limit 1e-6");
        EXPECT_EQ(outcome.exit_code, 1) << outcome.output;
        EXPECT_THAT(outcome.output, HasSubstr("neither confirmed nor refuted"));
        EXPECT_THAT(outcome.output, HasSubstr("1 unverified\n0 passed, 0 failed"));
    }
    const Outcome proven = check(optimum);
    EXPECT_EQ(proven.exit_code, 0) << proven.output;
    EXPECT_THAT(proven.output,
                HasSubstr("1 claimed optima and infeasibilities are proven\n1 passed, 0 failed"));
}

/// A lane graph that is no optimum, claimed to be one with a bound to match: no other line of the file
/// refutes it.
TEST_F(Claims, AMadeUpOptimumIsWrong) {
    file_with(scene("lane", 5).dump() + "\n", "c.scenes.jsonl");
    ASSERT_EQ(run("solve --nearest 8 --scenes c.scenes.jsonl --out some.solutions.jsonl").exit_code, 0);
    nlohmann::json some = nlohmann::json::parse(text_of(path("some.solutions.jsonl")));
    some.erase("nearest");
    for (const char* const claimant : {"cbc", "path-pair", "stranger"}) {
        some["solver"] = claimant;
        const Outcome outcome = check(some.dump() + "\n");
        EXPECT_EQ(outcome.exit_code, 1);
        EXPECT_THAT(outcome.output, HasSubstr("lane: " + std::string(claimant) + " claims the optimum"));
        EXPECT_THAT(outcome.output, HasSubstr("0 passed, 1 failed"));
    }
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

/// A claimed optimum is refuted by a better lane graph in the file.
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
    EXPECT_EQ(record["status"], "stopped");
    EXPECT_EQ(record["stopped_by"], "time");
    const Outcome outcome = check(solutions);
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_THAT(outcome.output, HasSubstr("1 claim nothing"));
    EXPECT_THAT(outcome.output, HasSubstr("0 passed, 0 failed"));
}

/// Which edges face an edge depends on the cone set.
TEST_F(Program, ShapeCostsAreCheckedOnTheirConeSet) {
    make_scenes("--fp 0.5");
    const std::string on = "--nearest 12 --params shape --scenes s.scenes.jsonl ";
    ASSERT_EQ(run("solve --solver path-pair " + on + "--out n.solutions.jsonl").exit_code, 0);
    const Outcome good = run("check " + on + "--solutions n.solutions.jsonl");
    EXPECT_EQ(good.exit_code, 0) << good.output;
    EXPECT_THAT(good.output, HasSubstr(" passed, 0 failed"));
    const std::string shape = "check --params shape --scenes s.scenes.jsonl --solutions n.solutions.jsonl ";
    EXPECT_EQ(run(shape).exit_code, 0) << "the solutions say it";
    expect_refused(shape + "--nearest 20", {"n.solutions.jsonl:1", "nearest"});
}

/// Claims made with other parameters, another pairing or other cones are refused in one line, before they are
/// checked. Claims that do not say how they were made are checked as they are.
TEST_F(Program, ClaimsWithOtherParametersAreNamed) {
    make_scenes("--fp 0.2");
    const std::string on = " --nearest 12 --params shape --scenes s.scenes.jsonl ";
    ASSERT_EQ(run("solve --solver path-pair" + on + "--out c.jsonl").exit_code, 0);
    std::string old;
    std::istringstream lines(text_of(path("c.jsonl")));
    for (std::string line; std::getline(lines, line);) {
        nlohmann::json record = nlohmann::json::parse(line);
        EXPECT_EQ(record.at("parameters"), "shape");
        EXPECT_EQ(record.at("pairing"), "near_far");
        EXPECT_EQ(record.at("parameters_hash").get<std::string>().size(), 16U);
        for (const char* key : {"parameters", "parameters_hash", "pairing"}) record.erase(key);
        old += record.dump() + "\n";
    }
    file_with(old, "old.jsonl");
    ASSERT_EQ(run("certify" + on + "--out root.jsonl").exit_code, 0);
    ASSERT_EQ(run("certify --whole" + on + "--out whole.jsonl").exit_code, 0);
    for (const auto& [file, verify] : {std::pair<std::string, std::string>{"c.jsonl", "check --solutions "},
                                       {"root.jsonl", "certify --verify "},
                                       {"whole.jsonl", "certify --verify "}}) {
        const std::string this_file = verify + file + " --scenes s.scenes.jsonl ";
        const Outcome good = run(this_file + "--params shape");
        EXPECT_EQ(good.exit_code, 0) << "the file names its cone set: " << good.output << good.errors;
        expect_refused(this_file, {file + ":1", "parameters", "'shape'", "'default'", "--params shape"});
        expect_refused(this_file + "--params shape --pairing paper", {file + ":1", "pairing"});
        expect_refused(this_file + "--params shape --nearest 20", {file + ":1", "nearest", "12", "20"});
    }
    const std::string old_file = "check --solutions old.jsonl --scenes s.scenes.jsonl ";
    EXPECT_EQ(run(old_file + "--params shape").exit_code, 0);
    EXPECT_EQ(run(old_file).exit_code, 1) << "their objectives are others, and nobody can say why";
}

TEST_F(Program, CertificatesAreVerifiedAndForgeriesAreNot) {
    make_scenes("--fp 0.2");
    const std::string on_scenes = "certify --nearest 20 --scenes s.scenes.jsonl ";
    ASSERT_EQ(run(on_scenes + "--out s.certificates.jsonl").exit_code, 0);
    const Outcome good = run(on_scenes + "--verify s.certificates.jsonl");
    EXPECT_EQ(good.exit_code, 0) << good.output;
    EXPECT_THAT(good.output, HasSubstr(" verified, 0 failed"));

    // A bound that is higher by 1, a multiplier below zero, a clique of edges that do not exclude each other.
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

/// A start from outside changes no optimum: lanes of another method, with cones that are not there, and none.
TEST_F(Program, SolvesFromLanesOfAnotherMethod) {
    make_scenes("--fp 0.3");
    ASSERT_EQ(run("detect --method front --scenes s.scenes.jsonl --out front.lanes.jsonl").exit_code, 0);
    const std::string solve = "solve --solver path-pair --time-limit inf --scenes s.scenes.jsonl --out ";
    ASSERT_EQ(run(solve + "cold.jsonl").exit_code, 0);
    const Outcome started = run(solve + "started.jsonl --start front.lanes.jsonl");
    ASSERT_EQ(started.exit_code, 0) << started.errors;
    EXPECT_THAT(started.output, HasSubstr(" started from a lane of front.lanes.jsonl\n"));
    EXPECT_THAT(started.output, testing::Not(HasSubstr("\n0 started")));
    const auto objectives = [&](const std::string& file) {
        std::vector<std::string> all;
        std::istringstream lines(text_of(path(file)));
        for (std::string line; std::getline(lines, line);) {
            const nlohmann::json record = nlohmann::json::parse(line);
            EXPECT_EQ(record.at("status"), "optimal");
            all.push_back(std::to_string(record.at("objective").get<double>()));
        }
        return all;
    };
    EXPECT_EQ(objectives("started.jsonl"), objectives("cold.jsonl"));

    std::string lanes = text_of(path("front.lanes.jsonl"));
    nlohmann::json first = nlohmann::json::parse(lanes.substr(0, lanes.find('\n')));
    ASSERT_EQ(first.at("status"), "found");
    nlohmann::json strange = first;
    strange["left"][0] = 123456;
    file_with(strange.dump() + "\n", "strange.lanes.jsonl");
    const Outcome none = run(solve + "none.jsonl --start strange.lanes.jsonl");
    EXPECT_EQ(none.exit_code, 0) << none.errors;
    EXPECT_THAT(none.output, testing::StartsWith("0 started from a lane of strange.lanes.jsonl\n"));
    EXPECT_EQ(objectives("none.jsonl"), objectives("cold.jsonl"));

    nlohmann::json other = first;
    other["method"] = "other";
    file_with(first.dump() + "\n" + other.dump() + "\n", "two.lanes.jsonl");
    expect_refused(solve + "x.jsonl --start two.lanes.jsonl", {"two.lanes.jsonl:2", "scene", "two lanes"});
    expect_refused(solve + "x.jsonl --start nowhere.lanes.jsonl", {"nowhere.lanes.jsonl"});
    expect_refused(solve + "x.jsonl --start front.lanes.jsonl --warm-start", {"--start", "--warm-start"});
    expect_refused("solve --scenes s.scenes.jsonl --start front.lanes.jsonl --out front.lanes.jsonl",
                   {"--out", "--start"});
}

TEST_F(Program, CertificatesCoverLearnedCosts) {
    make_scenes("--fp 0.5");
    const std::string on_scenes = "certify --params learned --scenes s.scenes.jsonl ";
    ASSERT_EQ(run(on_scenes + "--out learned.certificates.jsonl").exit_code, 0);
    const Outcome good = run(on_scenes + "--verify learned.certificates.jsonl");
    EXPECT_EQ(good.exit_code, 0) << good.output;
    EXPECT_THAT(good.output, HasSubstr(" verified, 0 failed"));
    std::string first_line = text_of(path("learned.certificates.jsonl"));
    first_line.resize(first_line.find('\n'));
    nlohmann::json forgery = nlohmann::json::parse(first_line);
    forgery["bound"] = forgery["bound"].get<double>() + 1e-3;
    file_with(forgery.dump() + "\n", "forged.certificates.jsonl");
    const Outcome bad = run(on_scenes + "--verify forged.certificates.jsonl");
    EXPECT_EQ(bad.exit_code, 1) << bad.output;
    EXPECT_THAT(bad.output, HasSubstr("0 verified, 1 failed"));
}

TEST_F(Program, CertificatesCoverShapeCosts) {
    make_scenes("--fp 0.5");
    const std::string on_scenes = "certify --nearest 20 --scenes s.scenes.jsonl ";
    ASSERT_EQ(run(on_scenes + "--params shape --out shape.certificates.jsonl").exit_code, 0);
    const Outcome good = run(on_scenes + "--params shape --verify shape.certificates.jsonl");
    EXPECT_EQ(good.exit_code, 0) << good.output;
    EXPECT_THAT(good.output, HasSubstr(" verified, 0 failed"));
    // They are about these costs and this cone set, even if they do not say so.
    std::string unnamed;
    std::istringstream lines(text_of(path("shape.certificates.jsonl")));
    for (std::string line; std::getline(lines, line);) {
        nlohmann::json record = nlohmann::json::parse(line);
        for (const char* key : {"nearest", "parameters", "parameters_hash", "pairing"}) record.erase(key);
        unnamed += record.dump() + "\n";
    }
    file_with(unnamed, "unnamed.certificates.jsonl");
    EXPECT_EQ(run(on_scenes + "--verify unnamed.certificates.jsonl").exit_code, 1);
    EXPECT_EQ(
        run("certify --scenes s.scenes.jsonl --params shape --verify unnamed.certificates.jsonl").exit_code,
        1);
}

/// Verified, changed, with another cone, and with too many steps: the exit code distinguishes the first case
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
    expect_refused("certify --nearest 4 --scenes s.scenes.jsonl --verify c.jsonl", {"c.jsonl:1", "nearest"});
    expect_refused(verify + "c.jsonl --most-steps 0", {"--most-steps"});
}

}  // namespace
}  // namespace conelane::experiments
