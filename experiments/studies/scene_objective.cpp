#include "experiments/studies/scene_objective.hpp"

#include "conelane/check.hpp"
#include "conelane/invalid_input.hpp"
#include "conelane/solve_scene.hpp"
#include "evaluation/proofs/answer_check.hpp"
#include "evaluation/proofs/strip_check.hpp"
#include "experiments/studies/beams.hpp"
#include "solvers/registry.hpp"
#include "solvers/strip/strip_solver.hpp"

#include <fmt/format.h>

namespace conelane::experiments {
namespace {

void require_accepted(const Scene& cones, const CheckReport& report, const char* what) {
    if (report.violations.empty()) return;
    throw InvalidInput(cones.id, fmt::format("the checker rejects the {}: {}", what, report.violations[0]));
}

class RldObjective : public SceneObjective {
  public:
    RldObjective(const Scene& cones, const RldParameters& parameters)
        : cones_(cones), parameters_(parameters) {}

    ProvenLane optimum(double time_limit_ms) override {
        const std::unique_ptr<RldSolver> solver = find_rld_solver("path-pair")->make(Formulation::tight);
        SolvedScene solved = solve_scene(*solver, cones_, parameters_, {.limits = {time_limit_ms}});
        problem_ = std::move(solved.problem);
        const RldReport& report = solved.report;
        if (report.status == SolveStatus::error) throw InvalidInput(cones_.id, report.message);
        ProvenLane best{report.status, report.bound, {}};
        if (!report.lane_graph) return best;
        const Claim claim{report.status == SolveStatus::optimal, *report.objective, report.bound};
        require_accepted(cones_, conelane::check(cones_, parameters_, *report.lane_graph, claim), "optimum");
        if (const auto lane = to_lane(*report.lane_graph, cones_))
            best.lane = PricedLane{*lane, *report.objective};
        return best;
    }

    [[nodiscard]] std::optional<double> cost(const Lane& lane) const override {
        const auto graph = lane_graph_of(lane, cones_);
        if (!graph || !is_feasible(problem_, *graph)) return std::nullopt;
        return objective(problem_, *graph);
    }

    [[nodiscard]] std::optional<Lane> beam(std::size_t width) const override {
        if (parameters_.pairing != Pairing::near_far) return std::nullopt;
        const auto graph = beam_lane_graph(problem_, width);
        return graph ? to_lane(*graph, cones_) : std::nullopt;
    }

    void check(const PricedLane& lane, const char* what) const override {
        const LaneGraph graph = *lane_graph_of(lane.lane, cones_);
        require_accepted(cones_, conelane::check(cones_, parameters_, graph, Claim{false, lane.cost, {}}),
                         what);
    }

  private:
    const Scene& cones_;
    const RldParameters& parameters_;
    LaneGraphProblem problem_;
};

class StripObjective : public SceneObjective {
  public:
    StripObjective(const Scene& cones, const StripParameters& parameters)
        : cones_(cones), index_of_(index_by_id(cones)), problem_(make_strip_problem(cones, parameters)) {}

    ProvenLane optimum(double time_limit_ms) override {
        const StripReport report = StripSolver().solve(problem_, {.limits = {time_limit_ms}});
        if (report.status == SolveStatus::error) throw InvalidInput(cones_.id, report.message);
        ProvenLane best{report.status, report.bound, {}};
        if (report.lanes.empty()) return best;
        best.lane = PricedLane{lane_of(report.lanes.front()), *report.objective};
        const Claim claim{report.status == SolveStatus::optimal, *report.objective, report.bound};
        require_accepted(cones_, check_strip(cones_, problem_.parameters, best.lane->lane, claim), "optimum");
        return best;
    }

    [[nodiscard]] std::optional<double> cost(const Lane& lane) const override {
        StripLane strip;
        for (const ConeId id : lane.left) strip.left.push_back(index_of_.at(id));
        for (const ConeId id : lane.right) strip.right.push_back(index_of_.at(id));
        if (strip.left.empty() || strip.right.empty()) return std::nullopt;
        const auto cheapest = cheapest_strip(problem_, strip);
        if (!cheapest) return std::nullopt;
        return cheapest->cost;
    }

    [[nodiscard]] std::optional<Lane> beam(std::size_t width) const override {
        const auto lane = beam_strip(problem_, width);
        if (!lane) return std::nullopt;
        return lane_of(*lane);
    }

    void check(const PricedLane& lane, const char* what) const override {
        const Claim claim{false, lane.cost, {}};
        require_accepted(cones_, check_strip(cones_, problem_.parameters, lane.lane, claim), what);
    }

  private:
    [[nodiscard]] Lane lane_of(const StripLane& strip) const {
        Lane lane;
        for (const std::size_t cone : strip.left) lane.left.push_back(cones_.cones[cone].id);
        for (const std::size_t cone : strip.right) lane.right.push_back(cones_.cones[cone].id);
        return lane;
    }

    const Scene& cones_;
    std::unordered_map<ConeId, std::size_t> index_of_;
    StripProblem problem_;
};

}  // namespace

std::unique_ptr<SceneObjective> objective_of(const Scene& cones, const NamedCosts& costs) {
    if (const auto* const rld = std::get_if<RldParameters>(&costs.costs))
        return std::make_unique<RldObjective>(cones, *rld);
    return std::make_unique<StripObjective>(cones, std::get<StripParameters>(costs.costs));
}

}  // namespace conelane::experiments
