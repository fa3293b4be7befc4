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
    run_well("solve --nearest 12 --scenes s.scenes.jsonl --out s.solutions.jsonl");
    expect_end("check --scenes s.scenes.jsonl --solutions s.solutions.jsonl", 0, {" passed, 0 failed"});

    std::string forged = text_of(path("s.solutions.jsonl"));
    const std::size_t objective = forged.find("\"objective\":-");
    ASSERT_NE(objective, std::string::npos);
    forged.insert(objective + 13, "9");
    file_with(forged, "forged.solutions.jsonl");
    expect_end("check --scenes s.scenes.jsonl --solutions forged.solutions.jsonl", 1, {" passed, 1 failed"});
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
    void expect_check(const std::string& solutions, int exit_code, const std::vector<std::string>& words,
                      const std::string& options = "") {
        file_with(solutions, "c.solutions.jsonl");
        expect_end("check --scenes c.scenes.jsonl --solutions c.solutions.jsonl " + options, exit_code,
                   words);
    }
    /// The solution of the scenes in c.scenes.jsonl.
    std::string solved(const std::string& options = "") {
        run_well("solve --scenes c.scenes.jsonl --out solved.jsonl " + options);
        return text_of(path("solved.jsonl"));
    }
};

TEST_F(Claims, AnUnprovenInfeasibleFails) {
    file_with(scene("lane", 5).dump() + "\n", "c.scenes.jsonl");
    for (const std::string solver : {"cbc", "path-pair", "exhaustive", "stranger"}) {
        expect_check(infeasible("lane", solver), 1,
                     {"lane: " + solver + " claims infeasible, but", "0 passed, 1 failed"});
    }
    // Too many cones for the checker's own search: a solver finds the lane graph, and the checker accepts
    // it.
    make_scenes("--fp 0.3", "c");
    const std::vector<AnnotatedScene> scenes = read_scenes(path("c.scenes.jsonl"));
    std::string forged;
    for (const AnnotatedScene& scene : scenes) forged += infeasible(scene.scene.id, "cbc");
    expect_check(forged, 1, {"0 passed, " + std::to_string(scenes.size()) + " failed"});
}

TEST_F(Claims, AProvenInfeasiblePasses) {
    // A pair of cones is not a lane; far from the car, no edge counts in (9).
    nlohmann::json behind = scene("behind", 5);
    behind["pose"]["x"] = 100;
    file_with(scene("pair", 1).dump() + "\n" + behind.dump() + "\n", "c.scenes.jsonl");
    expect_check(infeasible("pair", "path-pair") + infeasible("behind", "path-pair"), 0,
                 {"2 passed, 0 failed"});
}

TEST_F(Claims, WhatNothingProvesIsUnverified) {
    file_with(scene("a", 30).dump() + "\n", "c.scenes.jsonl");
    const std::string optimum = solved();
    for (const std::string& claim : {infeasible("a", "cbc"), optimum}) {
        expect_check(claim, 1, {"neither confirmed nor refuted", "1 unverified\n0 passed, 0 failed"},
                     "--time-limit 1e-6");
    }
    expect_check(optimum, 0, {"1 claimed optima and infeasibilities are proven\n1 passed, 0 failed"});
}

/// A lane graph that is no optimum, claimed to be one with a bound to match: no other line of the file
/// refutes it.
TEST_F(Claims, AMadeUpOptimumIsWrong) {
    file_with(scene("lane", 5).dump() + "\n", "c.scenes.jsonl");
    nlohmann::json some = nlohmann::json::parse(solved("--nearest 8"));
    some.erase("nearest");
    for (const std::string claimant : {"cbc", "path-pair", "stranger"}) {
        some["solver"] = claimant;
        expect_check(some.dump() + "\n", 1,
                     {"lane: " + claimant + " claims the optimum", "0 passed, 1 failed"});
    }
}

TEST_F(Claims, AMissingAnswerFails) {
    std::string scenes;
    for (int i = 0; i < 22; ++i) scenes += scene("s" + std::to_string(i), 5).dump() + "\n";
    file_with(scenes, "c.scenes.jsonl");
    const std::string all = solved();
    const std::string one = all.substr(0, all.find('\n') + 1);
    expect_check(all, 0, {});
    expect_check(one, 1, {"s21: cbc (tight) gives no answer", "1 passed, 21 failed"});
    expect_check(one, 0, {"1 passed, 0 failed"}, "--partial");
}

/// A claimed optimum is refuted by a better lane graph in the file.
TEST_F(Claims, ABetterLaneGraphRefutesAnOptimum) {
    file_with(scene("lane", 5).dump() + "\n", "c.scenes.jsonl");
    const std::string best = solved();
    nlohmann::json some = nlohmann::json::parse(solved("--nearest 8"));
    EXPECT_EQ(some["nearest"], 8);
    expect_check(some.dump() + "\n", 0, {});  // the optimum of its cone set
    some.erase("nearest");
    some["solver"] = "hasty";
    expect_check(some.dump() + "\n" + best, 1, {"lane: hasty claims the bound", "1 passed, 1 failed"});
}

TEST_F(Claims, StoppedSolutionsSayWhyAndClaimNothing) {
    file_with(scene("lane", 8).dump() + "\n", "c.scenes.jsonl");
    const std::string solutions = solved("--solver cbc --time-limit 1e-6");
    const nlohmann::json record = nlohmann::json::parse(solutions);
    EXPECT_EQ(record["status"], "stopped");
    EXPECT_EQ(record["stopped_by"], "time");
    expect_check(solutions, 0, {"1 claim nothing", "0 passed, 0 failed"});
}

/// Claims made with other parameters, another pairing or other cones are refused in one line, before they are
/// checked. Claims that do not say how they were made are checked as they are.
TEST_F(Program, ClaimsWithOtherParametersAreNamed) {
    make_scenes("--fp 0.2");
    const std::string on = " --nearest 12 --params shape --scenes s.scenes.jsonl ";
    run_well("solve --solver path-pair" + on + "--out c.jsonl");
    std::string old;
    for (nlohmann::json record : json_lines("c.jsonl")) {
        EXPECT_EQ(record.at("parameters"), "shape");
        EXPECT_EQ(record.at("pairing"), "near_far");
        EXPECT_EQ(record.at("parameters_hash").get<std::string>().size(), 16U);
        for (const char* key : {"parameters", "parameters_hash", "pairing"}) record.erase(key);
        old += record.dump() + "\n";
    }
    file_with(old, "old.jsonl");
    run_well("certify" + on + "--out root.jsonl");
    run_well("certify --whole" + on + "--out whole.jsonl");
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
    run_well(on_scenes + "--out s.certificates.jsonl");
    expect_end(on_scenes + "--verify s.certificates.jsonl", 0, {" verified, 0 failed"});

    // A bound that is higher by 1, a multiplier below zero, a clique of edges that do not exclude each other.
    const nlohmann::json certificate = json_lines("s.certificates.jsonl").front();
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
        expect_end(on_scenes + "--verify forged.certificates.jsonl", 1, {"0 verified, 1 failed"});
    }
}

/// A start from outside changes no optimum: lanes of another method, with cones that are not there, and none.
TEST_F(Program, SolvesFromLanesOfAnotherMethod) {
    make_scenes("--fp 0.3");
    run_well("detect --method front --scenes s.scenes.jsonl --out front.lanes.jsonl");
    const std::string solve = "solve --solver path-pair --time-limit inf --scenes s.scenes.jsonl --out ";
    run_well(solve + "cold.jsonl");
    const Outcome started = run(solve + "started.jsonl --start front.lanes.jsonl");
    ASSERT_EQ(started.exit_code, 0) << started.errors;
    EXPECT_THAT(started.output, HasSubstr(" started from a lane of front.lanes.jsonl\n"));
    EXPECT_THAT(started.output, testing::Not(HasSubstr("\n0 started")));
    const auto objectives = [&](const std::string& file) {
        std::vector<std::string> all;
        for (const nlohmann::json& record : json_lines(file)) {
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
    run_well(on_scenes + "--out learned.certificates.jsonl");
    expect_end(on_scenes + "--verify learned.certificates.jsonl", 0, {" verified, 0 failed"});
    nlohmann::json forgery = json_lines("learned.certificates.jsonl").front();
    forgery["bound"] = forgery["bound"].get<double>() + 1e-3;
    file_with(forgery.dump() + "\n", "forged.certificates.jsonl");
    expect_end(on_scenes + "--verify forged.certificates.jsonl", 1, {"0 verified, 1 failed"});
}

TEST_F(Program, CertificatesCoverShapeCosts) {
    make_scenes("--fp 0.5");
    const std::string on_scenes = "certify --nearest 20 --scenes s.scenes.jsonl ";
    run_well(on_scenes + "--params shape --out shape.certificates.jsonl");
    expect_end(on_scenes + "--params shape --verify shape.certificates.jsonl", 0, {" verified, 0 failed"});
    // They are about these costs and this cone set, even if they do not say so.
    std::string unnamed;
    for (nlohmann::json record : json_lines("shape.certificates.jsonl")) {
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
    run_well("certify --whole --nearest 16 --scenes s.scenes.jsonl --out c.jsonl");
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
