// Every answer of a solver is verified before it is returned.

#include "model/answer_verification.hpp"

#include "conelane/rld_solver.hpp"
#include "tests/support/six_cone_lane.hpp"
#include "tests/support/testing.hpp"

namespace conelane {
namespace {

const LaneGraph kLane{{{0, 1}, {1, 2}, {3, 4}, {4, 5}}};

std::string violation(const LaneGraphProblem& problem, const LaneGraph& graph) {
    return verify_answer(problem, graph).violation;
}

TEST(AnswerVerification, AcceptsTheLaneAndKnowsItsCost) {
    const VerifiedAnswer answer = verify_answer(make_problem(tests::six_cone_lane(), {}), kLane);
    EXPECT_THAT(answer.violation, IsEmpty());
    EXPECT_NEAR(answer.objective, -4.0, 1e-9);
}

/// check_test has the others.
TEST(AnswerVerification, NamesEdgesThatTheProblemDoesNotList) {
    const LaneGraphProblem lane = make_problem(tests::six_cone_lane(), {});
    EXPECT_THAT(violation(lane, {{{0, 1}, {0, 1}}}), HasSubstr("ascending"));
    EXPECT_THAT(violation(lane, {{{0, 1}, {1, 6}}}), HasSubstr("not in the problem"));
    EXPECT_THAT(violation(lane, {{{0, 5}, {1, 2}}}), HasSubstr("not in the problem"));
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
    RldReport report{.status = SolveStatus::optimal, .lane_graph = kLane};
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

}  // namespace
}  // namespace conelane
