#include "model/deadline.hpp"
#include "solvers/core_entries.hpp"

namespace conelane {
namespace {

/// A simple path that no constraint within it forbids.
struct Path {
    std::uint64_t edges = 0;  ///< bit by problem edge; at most 36 of them
    double cost = 0.0;
    int along_heading = 0;
    std::size_t first_end = 0;
    std::size_t last_end = 0;
};

class Enumeration {
  public:
    Enumeration(const LaneGraphProblem& problem, const Deadline& deadline)
        : problem_(problem),
          deadline_(deadline),
          conflicts_(problem.edges.size(), 0),
          paths_(std::size_t{1} << problem.cone_count) {
        for (const auto& [first, second] : problem.conflicts) {
            conflicts_[first] |= bit(second);
            conflicts_[second] |= bit(first);
        }
        turn_.assign(problem.edges.size() * problem.edges.size(), nullptr);
        for (const ProblemTurn& turn : problem.turns) {
            if (turn.high_cost) continue;
            turn_[turn.edge_i * problem.edges.size() + turn.edge_k] = &turn;
            turn_[turn.edge_k * problem.edges.size() + turn.edge_i] = &turn;
        }
        far_apart_.assign(problem.cone_count * problem.cone_count, false);
        for (const auto& [i, j] : problem.far_apart) far_apart_[i * problem.cone_count + j] = true;
    }

    void run(RldReport& report) {
        for (std::size_t cone = 0; cone < problem_.cone_count; ++cone) {
            extend({0, 0.0, 0, cone, cone}, bit(cone), problem_.edges.size());
        }
        const std::uint64_t all = paths_.size() - 1;
        const Path* best_first = nullptr;
        const Path* best_second = nullptr;
        double best = 0.0;
        for (std::uint64_t cones = 1; cones <= all; ++cones) {
            if (out_of_time()) break;
            if (paths_[cones].empty()) continue;
            const std::uint64_t rest = all & ~cones;
            for (std::uint64_t other = rest; other > cones; other = (other - 1) & rest) {
                for (const Path& first : paths_[cones]) {
                    for (const Path& second : paths_[other]) {
                        ++report.nodes;
                        const double cost = first.cost + second.cost;
                        if ((best_first != nullptr && cost >= best) || !is_lane(first, second)) continue;
                        best = cost;
                        best_first = &first;
                        best_second = &second;
                    }
                }
            }
        }
        if (stopped_) report.stopped_by = StopReason::time;
        if (best_first == nullptr) {
            report.status = stopped_ ? SolveStatus::stopped : SolveStatus::infeasible;
            return;
        }
        report.status = stopped_ ? SolveStatus::feasible : SolveStatus::optimal;
        LaneGraph graph;
        for (std::size_t edge = 0; edge < problem_.edges.size(); ++edge) {
            if (((best_first->edges | best_second->edges) & bit(edge)) != 0) {
                graph.edges.push_back({problem_.edges[edge].i, problem_.edges[edge].j});
            }
        }
        report.objective = objective(problem_, graph);
        if (!stopped_) report.bound = report.objective;
        report.lane_graph = std::move(graph);
    }

  private:
    bool out_of_time() {
        stopped_ = stopped_ || deadline_.passed();
        return stopped_;
    }

    static std::uint64_t bit(std::size_t index) { return std::uint64_t{1} << index; }

    /// Records every path that extends this one at its last end. It is met from both ends, kept once.
    void extend(const Path& path, std::uint64_t cones, std::size_t arrived_by) {
        if (out_of_time()) return;
        for (const std::size_t edge : problem_.incident[path.last_end]) {
            const ProblemEdge& e = problem_.edges[edge];
            const std::size_t next = e.i == path.last_end ? e.j : e.i;
            if (e.high_cost || (cones & bit(next)) != 0 || (conflicts_[edge] & path.edges) != 0) continue;
            Path longer = path;
            longer.cost += e.cost;
            if (arrived_by != problem_.edges.size()) {
                const ProblemTurn* turn = turn_[arrived_by * problem_.edges.size() + edge];
                if (turn == nullptr) continue;
                longer.cost += turn->cost;
            }
            longer.edges |= bit(edge);
            longer.along_heading += e.along_heading ? 1 : 0;
            longer.last_end = next;
            if (longer.first_end < longer.last_end) paths_[cones | bit(next)].push_back(longer);
            extend(longer, cones | bit(next), edge);
        }
    }

    [[nodiscard]] bool is_lane(const Path& a, const Path& b) const {
        if (a.along_heading + b.along_heading < 2) return false;
        std::size_t far_ends[4];
        std::size_t far_count = 0;
        for (const std::size_t end : {a.first_end, a.last_end, b.first_end, b.last_end}) {
            if (!problem_.near[end]) far_ends[far_count++] = end;
        }
        if (far_count != 2) return false;
        if (far_apart_[std::min(far_ends[0], far_ends[1]) * problem_.cone_count +
                       std::max(far_ends[0], far_ends[1])]) {
            return false;
        }
        if (problem_.parameters.pairing == Pairing::near_far &&
            problem_.near[a.first_end] == problem_.near[a.last_end]) {
            return false;
        }
        for (std::size_t edge = 0; edge < problem_.edges.size(); ++edge) {
            if ((a.edges & bit(edge)) != 0 && (conflicts_[edge] & b.edges) != 0) return false;
        }
        return true;
    }

    const LaneGraphProblem& problem_;
    const Deadline& deadline_;
    std::vector<std::uint64_t> conflicts_;
    std::vector<const ProblemTurn*> turn_;  ///< by pair of edges; nullptr if no allowed turn joins them
    std::vector<bool> far_apart_;
    std::vector<std::vector<Path>> paths_;  ///< by set of cones
    bool stopped_ = false;
};

class ExhaustiveSolver : public RldSolver {
    void run(const LaneGraphProblem& problem, const SolveArguments& arguments, RldReport& report) override {
        const Deadline deadline(arguments.limits.time_limit_ms);
        if (problem.cone_count > kExhaustiveMostCones) {
            report.message = "exhaustive takes at most " + std::to_string(kExhaustiveMostCones) +
                             " cones, not " + std::to_string(problem.cone_count);
            return;
        }
        const Stopwatch watch;
        Enumeration(problem, deadline).run(report);
        report.rounds = 1;
        report.solve_ms = watch.elapsed_ms();
    }
};

}  // namespace

std::unique_ptr<RldSolver> make_exhaustive_solver() {
    return std::make_unique<ExhaustiveSolver>();
}

constexpr RldSolverEntry kExhaustive{.name = "exhaustive",
                                     .description = "every pair of paths, at most 9 cones",
                                     .traits = SolverTrait::exact,
                                     .make = [](Formulation) { return make_exhaustive_solver(); },
                                     .max_cones = kExhaustiveMostCones};

}  // namespace conelane
