// Every answer of a solver is verified before it is returned.

#include "model/answer_verification.hpp"

#include "conelane/lane_graph_problem.hpp"
#include "conelane/rld_solver.hpp"
#include "solvers/core_entries.hpp"
#include "tests/support/agreement.hpp"
#include "tests/support/random_scenes.hpp"
#include "tests/support/six_cone_lane.hpp"
#include "tests/support/solver_cases.hpp"
#include "tests/support/testing.hpp"

namespace conelane {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

const LaneGraph kLane{{{0, 1}, {1, 2}, {3, 4}, {4, 5}}};

std::string violation(const LaneGraphProblem& problem, const LaneGraph& graph) {
    return verify_answer(problem, graph).violation;
}

TEST(AnswerVerification, AcceptsTheLaneAndKnowsItsCost) {
    const VerifiedAnswer answer = verify_answer(make_problem(tests::six_cone_lane(), {}), kLane);
    EXPECT_THAT(answer.violation, IsEmpty());
    EXPECT_NEAR(answer.objective, -4.0, 1e-9);
}

TEST(AnswerVerification, NamesTheBrokenConstraint) {
    RldParameters wide;
    wide.t_crit = 1e6;
    wide.d_min = 1.0;
    const LaneGraphProblem lane = make_problem(tests::six_cone_lane(), {});
    EXPECT_THAT(violation(lane, {}), HasSubstr("not two paths but 0"));
    EXPECT_THAT(violation(lane, {{{0, 1}, {1, 2}}}), HasSubstr("not two paths but 1"));
    EXPECT_THAT(violation(lane, {{{0, 1}, {3, 4}}}), HasSubstr("4 near and 0 far ends"));
    EXPECT_THAT(violation(lane, {{{0, 1}, {0, 1}}}), HasSubstr("ascending"));
    EXPECT_THAT(violation(lane, {{{0, 1}, {1, 6}}}), HasSubstr("not in the problem"));
    EXPECT_THAT(violation(lane, {{{0, 5}, {1, 2}}}), HasSubstr("not in the problem"));
    EXPECT_THAT(violation(make_problem(tests::six_cone_lane(), wide), {{{0, 1}, {1, 2}, {1, 4}}}),
                HasSubstr("more than two edges"));
    RldParameters parameters;
    parameters.d_max = 3.4;
    EXPECT_THAT(violation(make_problem(tests::six_cone_lane(), parameters), kLane), HasSubstr("(17)"));
    parameters = {};
    parameters.d_min = 3.6;
    EXPECT_THAT(violation(make_problem(tests::six_cone_lane(1.6), parameters), kLane), HasSubstr("(7)"));
    parameters = {};
    parameters.d_h = 0.1;
    EXPECT_THAT(violation(make_problem(tests::six_cone_lane(), parameters), kLane), HasSubstr("(9)"));
    const LaneGraphProblem every = make_problem(tests::six_cone_lane(), {}, EdgeExtent::all_pairs);
    EXPECT_THAT(violation(every, {{{0, 2}, {3, 5}}}), HasSubstr("(27)"));
    EXPECT_THAT(violation(lane, {{{0, 1}, {1, 4}, {3, 4}}}), HasSubstr("(28)"));
}

/// Two independent checks agree on random edge sets, many of them lane graphs: which are feasible, and which
/// are not.
TEST(AnswerVerification, AgreesWithTheSearchesOnDrawnEdges) {
    int feasible = 0;
    int infeasible = 0;
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        for (const Pairing pairing : {Pairing::near_far, Pairing::paper}) {
            RldParameters parameters;
            parameters.pairing = pairing;
            const LaneGraphProblem problem = make_problem(tests::random_scene(seed, 9), parameters);
            const RldReport best = make_exhaustive_solver()->solve(problem, {});
            if (!best.lane_graph) continue;
            boost::random::mt19937_64 random(seed);
            for (int trial = 0; trial < 20; ++trial) {
                LaneGraph graph;
                for (const ProblemEdge& edge : problem.edges) {
                    const bool in_best = std::ranges::find(best.lane_graph->edges, Edge{edge.i, edge.j}) !=
                                         best.lane_graph->edges.end();
                    const int draw = boost::random::uniform_int_distribution<int>(0, 29)(random);
                    if (in_best ? draw > 3 : draw == 0) graph.edges.push_back({edge.i, edge.j});
                }
                const VerifiedAnswer answer = verify_answer(problem, graph);
                EXPECT_EQ(answer.violation.empty(), is_feasible(problem, graph)) << answer.violation;
                if (answer.violation.empty()) {
                    EXPECT_NEAR(answer.objective, objective(problem, graph), 1e-9);
                }
                ++(answer.violation.empty() ? feasible : infeasible);
            }
        }
    }
    EXPECT_GT(feasible, 20);
    EXPECT_GT(infeasible, 200);
}

/// A solver that answers what the test says.
class Liar : public RldSolver {
  public:
    explicit Liar(RldReport report) : report_(std::move(report)) {}

  private:
    void run(const LaneGraphProblem&, const SolveArguments&, RldReport& report) override { report = report_; }
    RldReport report_;
};

RldReport optimum() {
    RldReport report;
    report.status = SolveStatus::optimal;
    report.lane_graph = kLane;
    report.objective = report.bound = -4.0;
    return report;
}

RldReport told(const std::function<void(RldReport&)>& falsify, const LaneGraph* start = nullptr) {
    RldReport report = optimum();
    falsify(report);
    return Liar(report).solve(make_problem(tests::six_cone_lane(), {}), {.start = start});
}

TEST(VerifiedSolver, PassesTrueClaims) {
    const RldReport report = told([](RldReport&) {});
    EXPECT_EQ(report.status, SolveStatus::optimal);
    EXPECT_EQ(report.message, "");
    EXPECT_EQ(told([](RldReport&) {}, &kLane).status, SolveStatus::optimal);
}

TEST(VerifiedSolver, MakesAnErrorOfEveryWrongClaim) {
    const std::vector<std::pair<std::string, std::function<void(RldReport&)>>> lies{
        {"fails its check: there are not two paths", [](RldReport& r) { r.lane_graph->edges.resize(2); }},
        {"the objective is not", [](RldReport& r) { r.objective = r.bound = -5.0; }},
        {"the objective is not", [](RldReport& r) { r.objective = std::nan(""); }},
        {"the objective is not", [](RldReport& r) { r.objective.reset(); }},
        {"the bound", [](RldReport& r) { r.bound = -3.9; }},
        {"the bound is not a number", [](RldReport& r) { r.bound = std::nan(""); }},
        {"no lane graph", [](RldReport& r) { r.lane_graph.reset(); }},
        {"without such a status", [](RldReport& r) { r.status = SolveStatus::infeasible; }},
        {"without such a status", [](RldReport& r) { r.status = SolveStatus::stopped; }},
    };
    for (const auto& [message, falsify] : lies) {
        SCOPED_TRACE(message);
        const RldReport report = told(falsify);
        EXPECT_EQ(report.status, SolveStatus::error);
        EXPECT_THAT(report.message, HasSubstr(message));
        EXPECT_FALSE(report.lane_graph);
        EXPECT_FALSE(report.objective);
        EXPECT_FALSE(report.bound);
    }
}

/// A feasible start refutes claims, and is then the answer.
TEST(VerifiedSolver, ComparesClaimsWithTheStart) {
    const LaneGraph shorter{{{1, 2}, {3, 4}, {4, 5}}};
    const std::vector<std::pair<std::string, std::function<void(RldReport&)>>> lies{
        {"the start is one",
         [](RldReport& r) {
             r = {};
             r.status = SolveStatus::infeasible;
         }},
        {"the bound",
         [](RldReport& r) {
             r = {};
             r.status = SolveStatus::stopped;
             r.bound = -3.9;
         }},
        {"the start is cheaper",
         [&](RldReport& r) {
             r.lane_graph = shorter;
             r.objective = r.bound = -3.0;
         }},
    };
    for (const auto& [message, falsify] : lies) {
        SCOPED_TRACE(message);
        const RldReport report = told(falsify, &kLane);
        EXPECT_EQ(report.status, SolveStatus::error);
        EXPECT_THAT(report.message, HasSubstr(message));
        EXPECT_EQ(report.lane_graph, kLane);
        EXPECT_FALSE(report.bound);
    }
}

/// Its own optimum, another optimum, a lane graph that costs more, invalid edges, and edges of cones that are
/// not in the scene.
TEST(VerifiedSolver, NoStartChangesAnOptimum) {
    int with_lane = 0;
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
        for (const Pairing pairing : {Pairing::near_far, Pairing::paper}) {
            RldParameters parameters;
            parameters.pairing = pairing;
            const Scene scene = tests::random_scene(seed, 8);
            const RldReport best = make_exhaustive_solver()->solve(make_problem(scene, parameters), {});
            std::vector<LaneGraph> starts{LaneGraph{}, {{{0, 1}, {2, 30}}}, {{{0, 1}, {1, 2}, {0, 2}}}};
            if (best.lane_graph) {
                ++with_lane;
                starts.push_back(*best.lane_graph);
                for (std::size_t k = 0; k < 2; ++k) {
                    starts.push_back(*best.lane_graph);
                    starts.back().edges.erase(starts.back().edges.begin() + static_cast<std::ptrdiff_t>(k));
                }
            }
            for (const tests::SolverCase& tried : tests::solver_cases()) {
                // The printed program takes a hundred times as long, in the same code.
                if (!tried.entry->has(SolverTrait::exact) || tried.formulation == Formulation::paper)
                    continue;
                SCOPED_TRACE(testing::Message() << "seed " << seed << ", " << tried.entry->name);
                const auto solver = tried.entry->make(tried.formulation);
                const LaneGraphProblem problem = make_problem(scene, parameters, solver->extent());
                for (const LaneGraph& start : starts) {
                    (void)tests::agrees(solver->solve(problem, {.start = &start}), best);
                }
            }
        }
    }
    EXPECT_GT(with_lane, 5);
}

}  // namespace
}  // namespace conelane
