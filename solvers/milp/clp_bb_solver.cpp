#include "solvers/milp/detail/osi_program.hpp"
#include "solvers/milp/milp_solver.hpp"

#include <coin/ClpConfig.h>
#include <coin/ClpSimplex.hpp>

namespace conelane {
namespace {

/// A branching decision on the path from the root to the current node.
struct Branching {
    int column;
    double lower;  ///< bounds before the decision
    double upper;
    double value;  ///< the value at which the column is fixed
    bool other_side_open;
    double bound;  ///< objective of the relaxation that was branched on
};

class ClpBranchAndBound : public MilpSession {
  public:
    explicit ClpBranchAndBound(const BinaryProgram& program) : lp_(*interface_.getModelPtr()) {
        detail::with_std_errors([&] {
            detail::prepare(interface_, watch_);
            for (const int column : detail::load_into(interface_, program)) {
                (program.columns[static_cast<std::size_t>(column)].branch_first ? first_ : others_)
                    .push_back(column);
            }
        });
    }

    MilpReport solve(const MilpLimits& limits) override {
        watch_ = {Deadline(limits.time_limit_ms)};
        MilpReport report;
        detail::with_std_errors([&] { search(limits, report); });
        unwind();
        return report;
    }

    void add_rows(std::span<const ProgramRow> rows) override {
        detail::with_std_errors([&] { detail::append_rows(interface_, rows); });
    }

  private:
    void search(const MilpLimits& limits, MilpReport& report) {
        double limit = limits.cutoff;  // only nodes below it are searched
        bound_of_pruned_ = COIN_DBL_MAX;
        lp_.setDualObjectiveLimit(COIN_DBL_MAX);
        bool node_is_open = true;  // whether the relaxation of the current node has yet to be solved
        while (true) {
            if (node_is_open) {
                if (!solve_relaxation()) {
                    stop(report);
                    return;
                }
                const bool inside = lp_.isProvenOptimal() && !prune(lp_.objectiveValue(), limit);
                if (!path_.empty()) ++report.nodes;
                const int column = inside ? most_fractional() : -1;
                if (inside && column < 0) {
                    bound_of_pruned_ = std::min(bound_of_pruned_, lp_.objectiveValue());
                    limit = std::min(limit, lp_.objectiveValue() - limits.absolute_gap);
                    report.point.assign(lp_.primalColumnSolution(),
                                        lp_.primalColumnSolution() + lp_.numberColumns());
                }
                if (column >= 0) {
                    const double x = lp_.primalColumnSolution()[column];
                    path_.push_back({.column = column,
                                     .lower = lp_.columnLower()[column],
                                     .upper = lp_.columnUpper()[column],
                                     .value = std::round(x),
                                     .other_side_open = true,
                                     .bound = lp_.objectiveValue()});
                    fix(path_.back());
                    continue;
                }
            }
            // The node is done. Go to the other side of the last decision that has one, unless the bound
            // rules that side out.
            if (path_.empty()) {
                finish(report);
                return;
            }
            Branching& last = path_.back();
            node_is_open = last.other_side_open && !prune(last.bound, limit);
            if (node_is_open) {
                last.other_side_open = false;
                last.value = last.value > 0.5 ? 0.0 : 1.0;
                fix(last);
            } else {
                lp_.setColumnBounds(last.column, last.lower, last.upper);
                path_.pop_back();
            }
        }
    }

    /// Whether a node of this bound is not searched. It may hold points within the gap of the best one.
    bool prune(double bound, double limit) {
        if (bound < limit) return false;
        bound_of_pruned_ = std::min(bound_of_pruned_, bound);
        return true;
    }

    void fix(const Branching& branching) {
        lp_.setColumnBounds(branching.column, branching.value, branching.value);
    }

    void unwind() {
        for (; !path_.empty(); path_.pop_back()) {
            lp_.setColumnBounds(path_.back().column, path_.back().lower, path_.back().upper);
        }
    }

    /// False if Clp reached no conclusion.
    bool solve_relaxation() {
        if (watch_.must_stop()) return false;
        lp_.dual();
        if (watch_.interrupted) return false;
        if (lp_.isProvenOptimal() || lp_.isProvenPrimalInfeasible()) return true;
        lp_.allSlackBasis(true);
        lp_.primal();
        return !watch_.interrupted && (lp_.isProvenOptimal() || lp_.isProvenPrimalInfeasible());
    }

    /// The column to branch on; -1 if all are integral.
    [[nodiscard]] int most_fractional() const {
        const int column = most_fractional(first_);
        return column >= 0 ? column : most_fractional(others_);
    }

    [[nodiscard]] int most_fractional(std::span<const int> columns) const {
        const double* x = lp_.primalColumnSolution();
        int column = -1;
        double largest = detail::kIntegrality;
        for (const int c : columns) {
            const double distance = std::abs(x[c] - std::round(x[c]));
            if (distance > largest) {
                largest = distance;
                column = c;
            }
        }
        return column;
    }

    void finish(MilpReport& report) const {
        report.status = report.point.empty() ? SolveStatus::infeasible : SolveStatus::optimal;
        if (!report.point.empty()) report.bound = bound_of_pruned_;
    }

    /// Every open side belongs to a decision on the path, whose bound holds for it. The current node belongs
    /// to the last decision.
    void stop(MilpReport& report) const {
        if (!watch_.interrupted) {
            report.status = SolveStatus::error;
            report.message = "Clp could not solve a relaxation";
            report.point.clear();
            return;
        }
        report.status = report.point.empty() ? SolveStatus::stopped : SolveStatus::feasible;
        report.stopped_by = StopReason::time;
        if (path_.empty()) return;
        double bound = std::min(bound_of_pruned_, path_.back().bound);
        for (const Branching& branching : path_) {
            if (branching.other_side_open) bound = std::min(bound, branching.bound);
        }
        report.bound = bound;
    }

    detail::DeadlineWatch watch_;
    OsiClpSolverInterface interface_;
    ClpSimplex& lp_;
    std::vector<int> first_;  ///< integer columns, by branching priority
    std::vector<int> others_;
    std::vector<Branching> path_;
    double bound_of_pruned_ = COIN_DBL_MAX;  ///< of nodes that are not searched, and of points
};

}  // namespace

/// Branches on the most fractional column, the nearer side first. No cuts, no heuristics; made for the tight
/// formulation. It uses the absolute gap unchanged.
constexpr MilpBackend kClpBb =
    milp_backend<ClpBranchAndBound>({.name = "clp-bb",
                                     .description = "depth-first branch and bound on a warm Clp",
                                     .traits = SolverTrait::refuses_huge_costs | SolverTrait::tuned,
                                     .library = "Clp " CLP_VERSION});

}  // namespace conelane
