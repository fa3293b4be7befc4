// All exact solvers on generated cases agree; a wrong one is found, and its case shrunk and stored.

#include "experiments/cross_check/cross_check.hpp"

#include "conelane/solve_scene.hpp"
#include "evaluation/formats/scene_file.hpp"
#include "solvers/registry.hpp"
#include "tests/support/program_fixture.hpp"
#include "tests/support/random_scenes.hpp"
#include "tests/support/six_cone_lane.hpp"

namespace conelane::experiments {
namespace {

/// Two straight boundaries of three cones, 3.2 m apart along them and 3.5 m across, and a cone behind:
///     0 ----- 1 ----- 2
/// 6  car >
///     3 ----- 4 ----- 5
/// Each of the four edges costs -1, so the optimum is -4.
CrossCheckCase straight_case() {
    CrossCheckCase drawn{.kind = "by hand", .scene = tests::six_cone_lane()};
    drawn.scene.cones.push_back({6, {-9.0, 0.3}});
    return drawn;
}

RldReport by_path_pair(const Scene& scene, const RldParameters& parameters) {
    return solve_scene(*find_rld_solver("path-pair")->make(Formulation::tight), scene, parameters, {}).report;
}

using Falsify = std::function<void(RldReport&, const Scene&, double time_limit_ms)>;

/// path-pair, and a solver that changes path-pair's answers.
std::vector<CheckedSolver> with_a_wrong_one(const Falsify& falsify) {
    return {{"right", [](const Scene& scene, const RldParameters& parameters,
                         const SolveArguments&) { return by_path_pair(scene, parameters); }},
            {"wrong",
             [falsify](const Scene& scene, const RldParameters& parameters, const SolveArguments& arguments) {
                 RldReport report = by_path_pair(scene, parameters);
                 falsify(report, scene, arguments.limits.time_limit_ms);
                 return report;
             }}};
}

CrossCheckVerdict judge_with(const Falsify& falsify) {
    return judge(straight_case(), with_a_wrong_one(falsify), 1000.0);
}

TEST(CrossCheckJudge, RightAnswersAgree) {
    const CrossCheckVerdict verdict = judge_with([](RldReport&, const Scene&, double) {});
    EXPECT_EQ(verdict.outcome, CrossCheckOutcome::same_optimum);
    EXPECT_THAT(verdict.findings, testing::IsEmpty());
    EXPECT_NEAR(verdict.objective.value(), -4.0, 1e-12);
    EXPECT_TRUE(verdict.certified);
    EXPECT_EQ(verdict.tight_answers, 2U);
    EXPECT_EQ(verdict.tight_proofs, 2U);
}

/// A solver with starts also gets the answer of the first solver from 1 m behind, whatever that is.
TEST(CrossCheckJudge, TheAnswerOfThePreviousFrameIsAStart) {
    const LaneGraph of_previous_frame{{{0, 2}, {3, 5}}};
    std::vector<LaneGraph> starts;
    const auto solve = [&](const Scene& scene, const RldParameters& parameters,
                           const SolveArguments& arguments) {
        if (arguments.start != nullptr) starts.push_back(*arguments.start);
        RldReport report = by_path_pair(scene, parameters);
        if (scene.pose.position.x() < -0.5) report.lane_graph = of_previous_frame;
        return report;
    };
    const CheckedSolver solver{"right", solve, {}, true};
    const CrossCheckVerdict verdict = judge(straight_case(), std::array{solver}, 1000.0);
    EXPECT_THAT(verdict.findings, testing::IsEmpty());
    EXPECT_TRUE(std::ranges::any_of(
        starts, [&](const LaneGraph& start) { return start.edges == of_previous_frame.edges; }));
    EXPECT_GT(starts.size(), 3U);
}

TEST(CrossCheckJudge, NoLaneGraphIsAgreedOnAndCertified) {
    CrossCheckCase drawn = straight_case();
    drawn.scene.cones.resize(2);
    const CrossCheckVerdict verdict =
        judge(drawn, make_checked_solvers(exact_solver_names(), Formulation::tight), 1000.0);
    EXPECT_EQ(verdict.outcome, CrossCheckOutcome::infeasible);
    EXPECT_TRUE(verdict.certified);
}

/// Each entry is an error that a solver may have, and the finding about it.
TEST(CrossCheckJudge, EveryWrongClaimIsFound) {
    const std::map<std::string, Falsify> lies{
        {"objective -5.000000 is claimed", [](RldReport& r, const Scene&, double) { *r.objective = -5.0; }},
        {"the bound is above the objective", [](RldReport& r, const Scene&, double) { *r.bound += 0.01; }},
        {"optimal is claimed without a bound within the gap",
         [](RldReport& r, const Scene&, double) { *r.bound -= 0.01; }},
        {"optimal without a bound", [](RldReport& r, const Scene&, double) { r.bound.reset(); }},
        {"a bound that is not a number", [](RldReport& r, const Scene&, double) { r.bound = std::nan(""); }},
        {"infeasible with a lane graph",
         [](RldReport& r, const Scene&, double) { r.status = SolveStatus::infeasible; }},
        {"stopped with a lane graph",
         [](RldReport& r, const Scene&, double) { r.status = SolveStatus::stopped; }},
        {"optimal without a lane graph", [](RldReport& r, const Scene&, double) { r.lane_graph.reset(); }},
        {"error, out of paper",
         [](RldReport& r, const Scene&, double) {
             r = {};
             r.message = "out of paper";
         }},
        {"endpoints instead of 4", [](RldReport& r, const Scene&, double) { r.lane_graph->edges.resize(2); }},
        {"wrong within 1000 ms: infeasible, bound inf; but right",
         [](RldReport& r, const Scene&, double) {
             r = {};
             r.status = SolveStatus::infeasible;
         }},
        // A bound without a lane graph, which only the other solver's answer contradicts.
        {"wrong within 1000 ms: stopped, bound -3.9; but right within",
         [](RldReport& r, const Scene&, double) {
             r = {};
             r.status = SolveStatus::stopped;
             r.bound = -3.9;
         }},
        // Wrong with the tight limit only.
        {"wrong within 1 ms: infeasible, bound inf; but wrong within 1000 ms: optimal",
         [](RldReport& r, const Scene&, double limit_ms) {
             if (limit_ms > 1.0) return;
             r = {};
             r.status = SolveStatus::infeasible;
         }},
    };
    for (const auto& [said, lie] : lies) {
        const CrossCheckVerdict verdict = judge_with(lie);
        EXPECT_EQ(verdict.outcome, CrossCheckOutcome::differ) << said;
        EXPECT_THAT(verdict.findings, testing::Contains(HasSubstr(said)));
    }
}

/// A lane graph at its true cost, called optimal: only the other solver's better one refutes it.
TEST(CrossCheckJudge, AFalseOptimumIsFound) {
    const CrossCheckVerdict verdict = judge_with([](RldReport& report, const Scene& scene, double) {
        Scene fewer = scene;
        std::erase_if(fewer.cones, [](const Cone& cone) { return cone.id == 2 || cone.id == 5; });
        const RldReport worse = by_path_pair(fewer, {.d_near = 4.0});
        ASSERT_TRUE(worse.lane_graph);
        report.lane_graph = map_by_cone_id(fewer, *worse.lane_graph, scene);
        report.objective = worse.objective;
        report.bound = worse.bound;
    });
    EXPECT_EQ(verdict.outcome, CrossCheckOutcome::differ);
}

/// An answer without a proof contradicts nothing, but the case stays undecided.
TEST(CrossCheckJudge, AnswersWithoutAProofAreUndecided) {
    const CrossCheckVerdict verdict = judge_with([](RldReport& report, const Scene&, double) {
        report.status = SolveStatus::feasible;
        report.bound = -100.0;
    });
    EXPECT_EQ(verdict.outcome, CrossCheckOutcome::undecided);
    EXPECT_THAT(verdict.findings, testing::IsEmpty());
}

TEST(Shrinking, KeepsTheConesAndTheParametersThatMatter) {
    CrossCheckCase drawn{.scene = tests::random_scene(5, 24), .parameters = with_shape_costs({})};
    drawn.parameters.d_near = 7.5;
    drawn.parameters.forbid_crossing = true;
    int asked = 0;
    const auto has = [](const CrossCheckCase& c, ConeId id) {
        return std::ranges::any_of(c.scene.cones, [id](const Cone& cone) { return cone.id == id; });
    };
    const CrossCheckCase shrunk = shrink(drawn, [&](const CrossCheckCase& smaller) {
        ++asked;
        return has(smaller, 103) && has(smaller, 117) && smaller.parameters.d_near > 7.0;
    });
    ASSERT_EQ(shrunk.scene.cones.size(), 2U);
    EXPECT_EQ(shrunk.parameters.d_near, 7.5);
    EXPECT_EQ(shrunk.parameters.facing_weight, 0.0);
    EXPECT_FALSE(shrunk.parameters.forbid_crossing);
    EXPECT_LT(asked, 200);
}

TEST(Shrinking, EndsWithItsTrials) {
    CrossCheckCase drawn{.scene = tests::random_scene(5, 24)};
    int asked = 0;
    const auto always = [&](const CrossCheckCase&) { return ++asked > 0; };
    // Half of the cones are removed three times.
    EXPECT_EQ(shrink(drawn, always, 3).scene.cones.size(), 3U);
    EXPECT_EQ(asked, 3);
}

TEST(DrawnCases, DependOnSeedAndNumberAloneAndAreOfEveryKind) {
    std::map<std::string, int> kinds;
    std::set<std::string> scenes;
    for (std::size_t number = 0; number < 400; ++number) {
        const CrossCheckCase drawn = draw_cross_check_case({}, 7, number);
        ++kinds[drawn.kind];
        EXPECT_NO_THROW(validate(drawn.scene));
        EXPECT_NO_THROW(validate(drawn.parameters)) << number;
        EXPECT_GE(drawn.scene.cones.size(), 1U);
        EXPECT_GE(drawn.tight_limit_ms, 0.5);
        EXPECT_LE(drawn.tight_limit_ms, 50.0);
        scenes.insert(scene_line(drawn.scene));
        EXPECT_EQ(scene_line(drawn.scene), scene_line(draw_cross_check_case({}, 7, number).scene));
    }
    EXPECT_EQ(scenes.size(), 400U);
    EXPECT_EQ(kinds.size(), cross_check_kinds().size());
    for (const auto& [kind, count] : kinds) EXPECT_GT(count, 15) << kind;
    EXPECT_NE(scene_line(draw_cross_check_case({}, 8, 0).scene),
              scene_line(draw_cross_check_case({}, 7, 0).scene));
}

class CrossCheckRun : public ProgramFixture {
  protected:
    [[nodiscard]] CrossCheckOptions options(std::size_t cases) const {
        return CrossCheckOptions{.seed = 3, .cases = cases};
    }
    [[nodiscard]] std::string lines(const std::string& folder) const {
        return text_of(path(folder) / "cases.jsonl");
    }
};

// The part that runs in every build; `conelane study cross-check --cases 100000` runs all.
TEST_F(CrossCheckRun, AllExactSolversAgree) {
    const CrossCheckSummary summary = cross_check(options(120), path("cases"));
    EXPECT_EQ(summary.cases, 120U);
    EXPECT_EQ(summary.added, 120U);
    EXPECT_FALSE(summary.outcomes.contains(CrossCheckOutcome::differ)) << lines("cases");
    EXPECT_GT(summary.outcomes.at(CrossCheckOutcome::same_optimum), 15U);
    EXPECT_GT(summary.outcomes.at(CrossCheckOutcome::infeasible), 15U);
    EXPECT_GT(summary.certified, 40U);
    EXPECT_GT(summary.tight_proofs, 100U);
    EXPECT_EQ(files_in_folder(), 1U);
}

TEST_F(CrossCheckRun, GivenScenesAreDrawnFromToo) {
    std::vector<AnnotatedScene> given(1);
    given[0].scene = tests::random_scene(5, 24);
    write_scenes(path("g.scenes.jsonl"), given);
    CrossCheckOptions some = options(20);
    some.scenes = {path("g.scenes.jsonl")};
    some.solvers = {"path-pair"};
    EXPECT_EQ(cross_check(some, path("cases")).cases, 20U);
    EXPECT_THAT(lines("cases"), HasSubstr("\"kind\":\"given\""));
}

/// Solvers that never reach the limit here, so the lines depend only on the cases.
TEST_F(CrossCheckRun, SameBytesOnAnyNumberOfThreadsInPartsAndResumed) {
    CrossCheckOptions one = options(70);
    one.solvers = {"path-pair", "exhaustive"};
    ASSERT_EQ(cross_check(one, path("one")).cases, 70U);
    CrossCheckOptions two = one;
    two.threads = 2;
    ASSERT_EQ(cross_check(two, path("two")).cases, 70U);
    EXPECT_EQ(lines("two"), lines("one"));

    // As if the program was killed in the middle of a line.
    std::filesystem::copy(path("one"), path("killed"));
    file_with(lines("one").substr(0, lines("one").size() / 2), "killed/cases.jsonl");
    const CrossCheckSummary resumed = cross_check(one, path("killed"));
    EXPECT_EQ(lines("killed"), lines("one"));
    EXPECT_EQ(resumed.cases, 70U);
    EXPECT_LT(resumed.added, 50U);
    EXPECT_GT(resumed.added, 20U);

    // A later run adds cases, or judges the last cases alone.
    one.cases = 80;
    ASSERT_EQ(cross_check(one, path("one")).added, 10U);
    CrossCheckOptions last = one;
    last.first = 70;
    last.cases = 10;
    ASSERT_EQ(cross_check(last, path("last")).cases, 10U);
    const auto without_record = [&](const std::string& folder) {
        return lines(folder).substr(lines(folder).find('\n') + 1);
    };
    EXPECT_THAT(without_record("one"), testing::EndsWith(without_record("last")));
}

TEST_F(CrossCheckRun, AnotherRunInTheFolderIsRefusedAndStays) {
    CrossCheckOptions some = options(5);
    some.solvers = {"path-pair"};
    ASSERT_EQ(cross_check(some, path("cases")).cases, 5U);
    const std::string before = lines("cases");
    some.seed = 4;
    EXPECT_EQ(error_of([&] { (void)cross_check(some, path("cases")); }),
              "cases/cases.jsonl:1: holds a run with other options or of another program");
    EXPECT_EQ(lines("cases"), before);
    some.solvers = {"magic"};
    EXPECT_THROW((void)cross_check(some, path("other")), InvalidInput);
    EXPECT_FALSE(std::filesystem::exists(path("other")));
}

/// It ignores cone 3 and proves the optimum of the rest. If the cone matters, the two solvers differ.
std::vector<CheckedSolver> with_a_blind_one(Formulation /*formulation*/) {
    std::vector<CheckedSolver> both = with_a_wrong_one([](RldReport&, const Scene&, double) {});
    both[1].solve = [](const Scene& scene, const RldParameters& parameters, const SolveArguments&) {
        Scene seen = scene;
        std::erase_if(seen.cones, [](const Cone& cone) { return cone.id == 3; });
        RldReport report = by_path_pair(seen, parameters);
        if (report.lane_graph) report.lane_graph = map_by_cone_id(seen, *report.lane_graph, scene);
        return report;
    };
    return both;
}

TEST_F(CrossCheckRun, AWrongSolverIsFoundShrunkAndWrittenToBeReplayed) {
    CrossCheckOptions some = options(40);
    some.make_solvers = with_a_blind_one;
    some.solvers = {"path-pair", "cbc"};  // the solvers of a replay
    const CrossCheckSummary summary = cross_check(some, path("cases"));
    ASSERT_TRUE(summary.outcomes.contains(CrossCheckOutcome::differ));
    std::size_t stored = 0;
    for (const auto& entry : std::filesystem::directory_iterator(path("cases"))) {
        if (!entry.path().string().ends_with(".case.json")) continue;
        ++stored;
        SCOPED_TRACE(entry.path());
        const StoredCase read = read_case(entry.path());
        const auto differs = [&](const CrossCheckCase& c) {
            return judge(c, with_a_blind_one(c.formulation), read.time_limit_ms).outcome ==
                   CrossCheckOutcome::differ;
        };
        EXPECT_TRUE(differs(read.drawn)) << "what is on file is what was judged";
        for (std::size_t k = 0; k < read.drawn.scene.cones.size(); ++k) {
            CrossCheckCase smaller = read.drawn;
            smaller.scene.cones.erase(smaller.scene.cones.begin() + static_cast<std::ptrdiff_t>(k));
            EXPECT_FALSE(differs(smaller)) << "cone " << smaller.scene.cones[k].id << " can go";
        }
        const std::string name = entry.path().string().substr(0, entry.path().string().size() - 10);
        EXPECT_THAT(text_of(name + ".mps"), HasSubstr("ENDATA"));
        // A replay without that solver finds no difference.
        const Outcome replayed = run_well("cross-check --replay " + entry.path().string());
        EXPECT_EQ(replayed.output, "same optimum\n");
    }
    EXPECT_EQ(stored, summary.outcomes.at(CrossCheckOutcome::differ));
    for (const auto& entry : std::filesystem::directory_iterator(path("cases")))
        EXPECT_THAT(entry.path().string(), testing::Not(HasSubstr(".tmp")));
}

/// A third solver fails with fewer than five cones. The other solver's case must not be shrunk to these.
TEST_F(CrossCheckRun, AnotherDifferenceDoesNotReplaceTheOneThatWasFound) {
    CrossCheckOptions some = options(40);
    some.make_solvers = [](Formulation formulation) {
        std::vector<CheckedSolver> all = with_a_blind_one(formulation);
        all.push_back(
            {"weak", [](const Scene& scene, const RldParameters& parameters, const SolveArguments&) {
                 if (scene.cones.size() >= 5) return by_path_pair(scene, parameters);
                 return RldReport{.message = "too few cones"};
             }});
        return all;
    };
    (void)cross_check(some, path("cases"));
    std::size_t about_the_blind = 0;
    for (const auto& entry : std::filesystem::directory_iterator(path("cases"))) {
        if (!entry.path().string().ends_with(".case.json")) continue;
        const bool weak_failed_at_first =
            read_case(entry.path()).drawn.scene.cones.size() < 5 &&
            draw_cross_check_case({}, some.seed, read_case(entry.path()).drawn.number).scene.cones.size() < 5;
        if (weak_failed_at_first) continue;
        EXPECT_THAT(text_of(entry.path()), HasSubstr("\"wrong within")) << entry.path();
        ++about_the_blind;
    }
    EXPECT_GT(about_the_blind, 0U);
}

}  // namespace
}  // namespace conelane::experiments
