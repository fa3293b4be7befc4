#include "solvers/milp/milp_solver.hpp"

#include <stdexcept>

#include <glpk.h>

namespace conelane {
namespace {

/// Input and result of the callback of branch and bound.
struct Watch {
    const Deadline& deadline;
    double absolute_gap;
    double cutoff;
    double bound = -std::numeric_limits<double>::infinity();
    bool interrupted = false;  ///< the deadline ended the search
};

/// Once the bound is as high, no more search is needed: no point is below the cutoff, or better by the gap.
double sufficient_bound(const Watch& watch, double best_value) {
    return best_value < watch.cutoff ? best_value - watch.absolute_gap : watch.cutoff;
}

void check_node(glp_tree* tree, void* data) {
    auto& watch = *static_cast<Watch*>(data);
    const int best = glp_ios_best_node(tree);
    if (best != 0) watch.bound = glp_ios_node_bound(tree, best);
    glp_prob* problem = glp_ios_get_prob(tree);
    const bool has_point = glp_mip_status(problem) == GLP_FEAS;
    const double best_value = has_point ? glp_mip_obj_val(problem) : watch.cutoff;
    if (watch.bound >= sufficient_bound(watch, best_value)) {
        glp_ios_terminate(tree);
    } else if (watch.deadline.passed()) {
        watch.interrupted = true;
        glp_ios_terminate(tree);
    }
}

/// GLPK has absolute tolerances of values and reduced costs. Next to a cost of 1e13, a rounding error of
/// 1e-13 weighs as much as a lane, and the optimum is lost. So columns above this cost wait, fixed at 0,
/// until no better point can use them: see solve().
constexpr double kMaxCostAtFirst = 1e3;
constexpr double kCostStep = 1e3;
/// A search that needs a column of this cost or more ends with an error.
constexpr double kMaxCostTaken = 1e25;

/// GLPK keeps an environment for each thread that has used it, and never frees it.
struct ThreadEnvironment {
    ThreadEnvironment() = default;
    ~ThreadEnvironment() { glp_free_env(); }
    ThreadEnvironment(const ThreadEnvironment&) = delete;
    ThreadEnvironment& operator=(const ThreadEnvironment&) = delete;
    void use() const {}
};

class GlpkSession : public MilpSession {
  public:
    explicit GlpkSession(const BinaryProgram& program) : problem_(glp_create_prob()) {
        static const thread_local ThreadEnvironment environment;
        environment.use();  // creates the environment
        glp_term_out(GLP_OFF);
        glp_set_obj_dir(problem_, GLP_MIN);
        if (!program.columns.empty()) glp_add_cols(problem_, static_cast<int>(program.columns.size()));
        for (std::size_t c = 0; c < program.columns.size(); ++c) {
            const BinaryProgram::Column& column = program.columns[c];
            const int index = static_cast<int>(c) + 1;
            if (column.integer) glp_set_col_kind(problem_, index, GLP_IV);
            min_of_rest_ += std::min(0.0, column.objective) * column.upper;
            if (column.objective > kMaxCostAtFirst && column.lower == 0.0) {
                waiting_.push_back({index, column.objective, column.upper});
                glp_set_col_bnds(problem_, index, GLP_FX, 0.0, 0.0);
            } else {
                glp_set_obj_coef(problem_, index, column.objective);
                glp_set_col_bnds(problem_, index, column.lower < column.upper ? GLP_DB : GLP_FX, column.lower,
                                 column.upper);
            }
        }
        std::ranges::sort(waiting_, {}, &WaitingColumn::cost);
        if (!program.rows.empty()) glp_add_rows(problem_, static_cast<int>(program.rows.size()));
        std::vector<int> columns(1);
        std::vector<double> values(1);
        for (std::size_t r = 0; r < program.rows.size(); ++r) {
            columns.resize(1);
            values.resize(1);
            for (auto entry = static_cast<std::size_t>(program.row_starts[r]);
                 entry < static_cast<std::size_t>(program.row_starts[r + 1]); ++entry) {
                columns.push_back(program.entry_columns[entry] + 1);
                values.push_back(program.entry_values[entry]);
            }
            set_row(static_cast<int>(r) + 1, columns, values, program.rows[r].lower, program.rows[r].upper);
        }
    }
    ~GlpkSession() override { glp_delete_prob(problem_); }
    GlpkSession(const GlpkSession&) = delete;
    GlpkSession& operator=(const GlpkSession&) = delete;

    /// A point that uses a waiting column costs at least `min_of_waiting`, so a cheaper point is optimal.
    /// Otherwise the columns that may be in a better point join. Without any point, the cheapest columns
    /// join, up to a factor of 1000, so that costs stay within a factor of 1000 of the objective.
    MilpReport solve(const MilpLimits& limits) override {
        const Deadline deadline(limits.time_limit_ms);
        MilpReport earlier;
        double earlier_value = limits.cutoff;
        while (true) {
            MilpReport report = solve_without_waiting(limits, deadline);
            const double min_of_waiting = waiting_.empty() ? std::numeric_limits<double>::infinity()
                                                           : waiting_.front().cost + min_of_rest_;
            if (report.bound) report.bound = std::min(*report.bound, min_of_waiting);
            const double value = report.point.empty() ? limits.cutoff : glp_mip_obj_val(problem_);
            const bool decided =
                report.status == SolveStatus::optimal || report.status == SolveStatus::infeasible;
            if (!decided) return with_earlier(std::move(report), value, earlier, earlier_value);
            if (min_of_waiting >= value) return report;
            join(std::isfinite(value) ? value - min_of_rest_ : kCostStep * waiting_.front().cost);
            if (!report.point.empty()) {
                earlier = std::move(report);
                earlier_value = value;
            }
        }
    }

    void add_rows(std::span<const ProgramRow> rows) override {
        for (const ProgramRow& row : rows) {
            std::vector<int> columns{0};
            std::vector<double> values{0.0};
            for (const auto& [column, coefficient] : row.terms) {
                columns.push_back(column + 1);
                values.push_back(coefficient);
            }
            set_row(glp_add_rows(problem_, 1), columns, values, row.lower, row.upper);
        }
    }

  private:
    struct WaitingColumn {
        int index;
        double cost;
        double upper;
    };

    /// A solve that was stopped without a better point keeps the point from before the columns joined.
    static MilpReport with_earlier(MilpReport report, double value, MilpReport& earlier,
                                   double earlier_value) {
        const bool was_stopped =
            report.status == SolveStatus::stopped || report.status == SolveStatus::feasible;
        if (was_stopped && !earlier.point.empty() && earlier_value <= value) {
            report.status = SolveStatus::feasible;
            report.point = std::move(earlier.point);
        }
        return report;
    }

    /// Columns up to this cost no longer wait. The cheapest column joins in any case.
    void join(double max_cost) {
        const auto stay = std::ranges::upper_bound(waiting_, std::max(max_cost, waiting_.front().cost), {},
                                                   &WaitingColumn::cost);
        for (auto column = waiting_.begin(); column != stay; ++column) {
            if (!(column->cost < kMaxCostTaken)) throw std::runtime_error("a cost is too large for GLPK");
            glp_set_obj_coef(problem_, column->index, column->cost);
            glp_set_col_bnds(problem_, column->index, GLP_DB, 0.0, column->upper);
        }
        waiting_.erase(waiting_.begin(), stay);
    }

    MilpReport solve_without_waiting(const MilpLimits& limits, const Deadline& deadline) {
        MilpReport report;
        if (!solve_relaxation(deadline, report)) return report;
        report.bound = glp_get_obj_val(problem_);
        if (*report.bound >= limits.cutoff) {
            report.status = SolveStatus::infeasible;
            report.bound.reset();
            return report;
        }
        branch(limits, deadline, report);
        return report;
    }

    void set_row(int index, const std::vector<int>& columns, const std::vector<double>& values, double lower,
                 double upper) {
        const bool has_lower = lower > -kInfinity;
        const bool has_upper = upper < kInfinity;
        const int kind = has_lower && has_upper ? (lower < upper ? GLP_DB : GLP_FX)
                         : has_lower            ? GLP_LO
                         : has_upper            ? GLP_UP
                                                : GLP_FR;
        glp_set_row_bnds(problem_, index, kind, lower, upper);
        glp_set_mat_row(problem_, index, static_cast<int>(columns.size()) - 1, columns.data(), values.data());
    }

    /// GLPK counts whole milliseconds and stops one before its limit.
    static int milliseconds(const Deadline& deadline) {
        return static_cast<int>(std::clamp(std::ceil(deadline.remaining_ms()) + 1.0, 1.0, 2e9));
    }

    /// True if the relaxation has an optimum.
    bool solve_relaxation(const Deadline& deadline, MilpReport& report) {
        glp_smcp options;
        glp_init_smcp(&options);
        options.msg_lev = GLP_MSG_OFF;
        options.meth = GLP_DUALP;
        if (std::isfinite(deadline.remaining_ms())) options.tm_lim = milliseconds(deadline);
        // The last basis is used again, with the slacks of added rows; an invalid basis is rebuilt.
        int failure = glp_simplex(problem_, &options);
        if (failure == GLP_EBADB || failure == GLP_ESING || failure == GLP_ECOND) {
            glp_std_basis(problem_);
            failure = glp_simplex(problem_, &options);
        }
        const int status = glp_get_status(problem_);
        if (failure == 0 && status == GLP_OPT) return true;
        if (failure == 0 && status == GLP_NOFEAS) {
            report.status = SolveStatus::infeasible;  // an interrupted simplex counts as a failure
        } else if (failure == GLP_ETMLIM || deadline.passed()) {
            report.status = SolveStatus::stopped;
            report.stopped_by = StopReason::time;
        } else {
            report.message = "GLPK could not solve the relaxation, " + std::to_string(failure);
        }
        return false;
    }

    void branch(const MilpLimits& limits, const Deadline& deadline, MilpReport& report) {
        Watch watch{deadline, limits.absolute_gap, limits.cutoff};
        glp_iocp options;
        glp_init_iocp(&options);
        options.msg_lev = GLP_MSG_OFF;
        options.tol_int = 1e-7;
        options.tol_obj = 1e-9;
        options.cb_func = check_node;
        options.cb_info = &watch;
        const int failure = glp_intopt(problem_, &options);
        const int status = glp_mip_status(problem_);
        // GLPK has no cutoff: a point that is not below the cutoff is dropped here.
        const bool has_point =
            (status == GLP_FEAS || status == GLP_OPT) && glp_mip_obj_val(problem_) < limits.cutoff;
        if (has_point) {
            report.point.resize(static_cast<std::size_t>(glp_get_num_cols(problem_)));
            for (std::size_t c = 0; c < report.point.size(); ++c) {
                report.point[c] = glp_mip_col_val(problem_, static_cast<int>(c) + 1);
            }
        }
        report.bound = std::max(*report.bound, watch.bound);
        const double best_value = has_point ? glp_mip_obj_val(problem_) : limits.cutoff;
        const bool finished = failure == 0 && (status == GLP_OPT || status == GLP_NOFEAS);
        if (finished || *report.bound >= sufficient_bound(watch, best_value)) {
            report.status = has_point ? SolveStatus::optimal : SolveStatus::infeasible;
            if (finished) report.bound = best_value;
            if (!has_point) report.bound.reset();
        } else if (watch.interrupted) {
            report.status = has_point ? SolveStatus::feasible : SolveStatus::stopped;
            report.stopped_by = StopReason::time;
        } else {
            report.status = SolveStatus::error;
            report.message = "GLPK stopped without a result, " + std::to_string(failure);
            report.point.clear();
        }
    }

    glp_prob* problem_;
    std::vector<WaitingColumn> waiting_;  ///< fixed at 0 and without a cost, cheapest first
    double min_of_rest_ = 0.0;            ///< sum of all negative costs
};

}  // namespace

#define CONELANE_TEXT_OF(number) #number
#define CONELANE_VALUE_OF(macro) CONELANE_TEXT_OF(macro)

/// GLPK's simplex and branch and bound without cuts and presolve. GLPK is under the GPL, and so is a program
/// linked with it: CONELANE_GLPK=OFF leaves it out. Only the thread that made a session may use it. Costs of
/// very different size are handled one after the other, since GLPK's tolerances would otherwise lose the
/// optimum. The relaxation of a node cannot be stopped: a limit is overrun by up to one relaxation. An
/// internal error of GLPK ends the process.
constexpr MilpBackend kGlpk = milp_backend<GlpkSession>(
    {.name = "glpk",
     .description = "GLPK's branch and bound",
     .traits = SolverTrait::reads_time_of_day | SolverTrait::refuses_huge_costs,
     .library = "GLPK " CONELANE_VALUE_OF(GLP_MAJOR_VERSION) "." CONELANE_VALUE_OF(GLP_MINOR_VERSION)});

}  // namespace conelane
