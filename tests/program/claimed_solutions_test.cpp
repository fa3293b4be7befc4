// Solutions of a program that others claim: what contradicts itself, the program or a proof is refused.

#include "tests/support/program_on_scenes.hpp"
#include "tests/support/recorded_tracks.hpp"
#include "tests/support/testing.hpp"

#include <nlohmann/json.hpp>

namespace conelane::experiments {
namespace {

using testing::HasSubstr;

class ClaimedSolutions : public ProgramFixture {
  protected:
    void SetUp() override {
        ProgramFixture::SetUp();
        if (std::system("command -v cbc >/dev/null 2>&1") != 0)
            GTEST_SKIP() << "CBC's program is not installed";
        ASSERT_EQ(
            run("scenes --tracks generated:hairpins@3 --fp 0.3 --every 40 --seed 3 --out s.scenes.jsonl")
                .exit_code,
            0);
        const std::string scenes = text_of(path("s.scenes.jsonl"));
        program_ = " --scenes s.scenes.jsonl --nearest 20 --all-rows --id " +
                   nlohmann::json::parse(scenes.substr(0, scenes.find('\n'))).at("id").get<std::string>();
        ASSERT_EQ(run("export" + program_ + " --out p.mps").exit_code, 0);
        optimum_ = solved_by_cbc("");
    }

    std::string solved_by_cbc(const std::string& options) {
        const std::string command =
            "cd " + path("").string() + " && cbc p.mps " + options + " solve solution cbc.sol >/dev/null";
        EXPECT_EQ(std::system(command.c_str()), 0);
        return text_of(path("cbc.sol"));
    }

    /// What the import makes of a solution file.
    nlohmann::json imported(const std::string& solution, const std::string& options = "") {
        file_with(solution, "x.sol");
        const Outcome outcome = run("import-solution" + program_ + " --sol x.sol --out x.jsonl " + options);
        EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
        printed_ = outcome.output;
        return outcome.exit_code == 0 ? nlohmann::json::parse(text_of(path("x.jsonl"))) : nlohmann::json{};
    }

    void expect_no_import(const std::string& solution, const std::vector<std::string>& names) {
        file_with(solution, "x.sol");
        std::vector<std::string> all = names;
        all.emplace_back("x.sol");
        expect_refused("import-solution" + program_ + " --sol x.sol --out y.jsonl", all);
        // As the answer of a program from outside, the same file is an error of that solve.
        const std::string answers =
            "solve --scenes s.scenes.jsonl --nearest 20 --all-rows --out z.jsonl --solver "
            "'exec:other=cp " +
            path("x.sol").string() + " {sol} # {mps}'";
        EXPECT_EQ(run(answers).exit_code, 1);
        const std::string records = text_of(path("z.jsonl"));
        const nlohmann::json record = nlohmann::json::parse(records.substr(0, records.find('\n')));
        EXPECT_EQ(record.at("status"), "error");
        for (const std::string& name : names) EXPECT_THAT(record.at("message"), HasSubstr(name));
    }

    /// The optimum with this text in place of the first line that has `mark`.
    [[nodiscard]] std::string changed(const std::string& mark, const std::string& text) const {
        std::string solution = optimum_;
        const std::size_t begin = solution.rfind('\n', solution.find(mark)) + 1;
        return solution.replace(begin, solution.find('\n', begin) - begin, text);
    }

    std::string program_;
    std::string optimum_;  ///< CBC's file
    std::string printed_;
};

TEST_F(ClaimedSolutions, AnOptimumIsOneAfterAProof) {
    const nlohmann::json proven = imported(optimum_);
    EXPECT_EQ(proven.at("status"), "optimal");
    EXPECT_EQ(proven.at("bound"), proven.at("objective"));
    EXPECT_THAT(printed_, testing::StartsWith("optimal: optimum proven by "));
    const nlohmann::json unverified = imported(optimum_, "--time-limit 1e-6");
    EXPECT_EQ(unverified.at("status"), "feasible");
    EXPECT_FALSE(unverified.contains("bound"));
    EXPECT_THAT(printed_, testing::StartsWith("feasible: optimum unverified"));
    EXPECT_EQ(imported(solved_by_cbc("printingOptions all")).at("status"), "optimal");
    EXPECT_EQ(imported(optimum_, "--solver path-pair").at("solver"), "path-pair");
}

TEST_F(ClaimedSolutions, WhatIsNotCalledOptimalIsFeasible) {
    const std::string value = optimum_.substr(0, optimum_.find('\n')).substr(10);
    for (const char* const head : {"Optimal (within gap tolerance) - ", "Stopped on time - "}) {
        const nlohmann::json record = imported(head + value + optimum_.substr(optimum_.find('\n')));
        EXPECT_EQ(record.at("status"), "feasible") << head;
        EXPECT_FALSE(record.contains("bound")) << head;
    }
    const nlohmann::json bounded =
        imported("Stopped on time - " + value + optimum_.substr(optimum_.find('\n')) + "=bound= -1000\n");
    EXPECT_EQ(bounded.at("status"), "feasible");
    EXPECT_EQ(bounded.at("bound"), -1000.0);
}

TEST_F(ClaimedSolutions, ContradictionsAreRefused) {
    expect_no_import(changed("Optimal", "Optimal - objective value -99"),
                     {"claims the objective -99", "its point has"});
    const std::string column =
        optimum_.substr(optimum_.find("a_"), optimum_.find(' ', optimum_.find("a_")) - optimum_.find("a_"));
    expect_no_import(changed(column + " ", " 0 " + column + " 0.6 0"), {column + " is 0.6, not integral"});
    expect_no_import(changed(column + " ", " 0 " + column + " 3 0"), {column + " is 3, outside 0 to 1"});
    expect_no_import(changed(column + " ", ""), {"row "});
    expect_no_import(optimum_ + "=bound= 0\n", {"claims the bound 0", "its point has"});
    expect_no_import(optimum_ + "=obj= -99\n", {"=obj= says -99"});
    expect_no_import(changed("Optimal", "Stopped on time - objective value -1") + "=status= optimal\n",
                     {"=status= says optimal"});
}

/// The columns of the flow are missing: a row of the program says so.
TEST_F(ClaimedSolutions, EdgesAloneAreRefused) {
    std::string edges;
    std::istringstream lines(optimum_);
    for (std::string line; std::getline(lines, line);) {
        if (line.find(" y_") == std::string::npos && line.find(" s_") == std::string::npos)
            edges += line + "\n";
    }
    expect_no_import(edges, {"row ", "of the program"});
}

/// The dearest point of the program is claimed to be optimal: an own search says what is cheaper.
TEST_F(ClaimedSolutions, AWrongOptimumIsRefusedWithBothFigures) {
    std::istringstream lines(solved_by_cbc("-max"));
    std::string head, index, name, value, rest;
    std::getline(lines, head);
    std::string solution = "=status= optimal\n";
    while (lines >> index >> name >> value && std::getline(lines, rest))
        solution += name + ' ' + value + '\n';
    file_with(solution, "x.sol");
    expect_refused("import-solution" + program_ + " --sol x.sol --out y.jsonl",
                   {"x.sol", "claims that nothing is below", "found a lane graph of"});
}

TEST_F(ClaimedSolutions, InfeasibilityIsProvenOrRefused) {
    file_with("Infeasible - objective value 0.00000000\n", "x.sol");
    expect_refused("import-solution" + program_ + " --sol x.sol --out y.jsonl",
                   {"x.sol", "no solution", "found"});
    file_with(
        R"({"id":"pair","pose":{"x":0,"y":0,"yaw":0},"cones":[{"id":1,"x":1,"y":2},{"id":2,"x":1,"y":-2},)"
        R"({"id":3,"x":4,"y":2}]})",
        "none.scenes.jsonl");
    const std::string import =
        "import-solution --scenes none.scenes.jsonl --id pair --sol x.sol --out y.jsonl";
    EXPECT_THAT(run(import).output, testing::StartsWith("infeasible: proven by "));
    EXPECT_EQ(nlohmann::json::parse(text_of(path("y.jsonl"))).at("solver"), "import");
}

/// Files as other people changed them.
TEST_F(ProgramFixture, RecordedClaims) {
    const std::filesystem::path folder = recorded_data() / "use" / "solutions";
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << "there is no " << folder;
    const std::string import =
        "import-solution --scenes " + (folder / "scene.scenes.jsonl").string() +
        " --id kidney/pose_0001/fp_0.30/range_25 --nearest 16 --all-rows --out x.jsonl --sol " +
        folder.string() + "/";
    for (const auto& [file, status] :
         {std::pair{"optimal", "optimal"}, {"within_gap", "feasible"}, {"stopped_on_time", "feasible"}}) {
        ASSERT_EQ(run(import + file + ".sol").exit_code, 0) << file;
        EXPECT_EQ(nlohmann::json::parse(text_of(path("x.jsonl"))).at("status"), status) << file;
        std::filesystem::remove(path("x.jsonl"));
    }
    for (const char* const file :
         {"other_objective", "fractional", "three", "bound_above", "wrong_obj", "edges_alone"}) {
        expect_refused(import + file + ".sol", {std::string(file) + ".sol"});
    }
}

}  // namespace
}  // namespace conelane::experiments
