#include "solvers/symphony_solver.hpp"

#include "model/deadline.hpp"
#include "solvers/detail/child_process.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include <coin/symphony.h>

namespace conelane {
namespace {

struct CloseEnvironment {
    void operator()(sym_environment* environment) const { sym_close_environment(environment); }
};
using Environment = std::unique_ptr<sym_environment, CloseEnvironment>;

/// Keeps the program and loads it anew for each solve: an environment that has solved once does not start
/// over reliably after rows were added.
class SymphonySession : public MilpSession {
  public:
    explicit SymphonySession(BinaryProgram program) : program_(std::move(program)) {}

    /// Each solve runs in a process of its own: 5.6.17 aborts at times on crossed bounds inside Clp, mostly
    /// with 30 cones and more, and more often with a cutoff, which is therefore not passed on.
    MilpReport solve(const MilpLimits& limits) override {
        const Deadline deadline(limits.time_limit_ms);
        const auto answer = detail::run_in_child([&] { return numbers_of(solve_here(deadline)); });
        if (answer) return report_of(*answer);
        MilpReport report;
        report.message = "SYMPHONY aborted";
        return report;
    }

    void add_rows(std::span<const ProgramRow> rows) override {
        for (const ProgramRow& row : rows) {
            program_.rows.push_back({row.label, row.lower, row.upper});
            for (const auto& [column, coefficient] : row.terms) {
                program_.entry_columns.push_back(column);
                program_.entry_values.push_back(coefficient);
            }
            program_.row_starts.push_back(static_cast<int>(program_.entry_columns.size()));
        }
    }

  private:
    static std::vector<double> numbers_of(const MilpReport& report) {
        std::vector<double> numbers{static_cast<double>(report.status), static_cast<double>(report.nodes),
                                    report.bound.value_or(std::numeric_limits<double>::quiet_NaN())};
        numbers.insert(numbers.end(), report.point.begin(), report.point.end());
        return numbers;
    }

    static MilpReport report_of(const std::vector<double>& numbers) {
        MilpReport report;
        report.status = static_cast<SolveStatus>(static_cast<int>(numbers[0]));
        report.nodes = static_cast<std::int64_t>(numbers[1]);
        if (!std::isnan(numbers[2])) report.bound = numbers[2];
        report.point.assign(numbers.begin() + 3, numbers.end());
        if (report.status == SolveStatus::error) report.message = "SYMPHONY stopped without a result";
        return report;
    }

    [[nodiscard]] MilpReport solve_here(const Deadline& deadline) const {
        MilpReport report;
        const Environment environment(sym_open_environment());
        sym_environment* env = environment.get();
        sym_set_int_param(env, "verbosity", -2);
        sym_set_dbl_param(env, "granularity", 1e-7);
        sym_set_dbl_param(env, "gap_limit", 0.0);
        load(env);
        if (std::isfinite(deadline.remaining_ms())) {
            sym_set_dbl_param(env, "time_limit", std::max(deadline.remaining_ms(), 0.01) / 1e3);
        }
        sym_solve(env);
        read(env, deadline, report);
        return report;
    }

    /// SYMPHONY takes the matrix by columns, and rows as sense, right-hand side and range.
    void load(sym_environment* env) const {
        const std::size_t columns = program_.columns.size();
        std::vector<int> starts(columns + 1, 0);
        for (const int column : program_.entry_columns) ++starts[static_cast<std::size_t>(column) + 1];
        for (std::size_t c = 0; c < columns; ++c) starts[c + 1] += starts[c];
        std::vector<int> next(starts), indices(program_.entry_columns.size());
        std::vector<double> values(indices.size());
        std::vector<char> senses;
        std::vector<double> sides, ranges;
        for (std::size_t r = 0; r < program_.rows.size(); ++r) {
            for (auto entry = static_cast<std::size_t>(program_.row_starts[r]);
                 entry < static_cast<std::size_t>(program_.row_starts[r + 1]); ++entry) {
                const auto column = static_cast<std::size_t>(program_.entry_columns[entry]);
                const auto place = static_cast<std::size_t>(next[column]++);
                indices[place] = static_cast<int>(r);
                values[place] = program_.entry_values[entry];
            }
            const auto& [label, lower, upper] = program_.rows[r];
            const bool has_lower = lower > -kInfinity;
            const bool has_upper = upper < kInfinity;
            senses.push_back(lower == upper ? 'E' : has_lower && has_upper ? 'R' : has_upper ? 'L' : 'G');
            sides.push_back(has_upper ? upper : lower);
            ranges.push_back(senses.back() == 'R' ? upper - lower : 0.0);
        }
        std::vector<double> lowers, uppers, costs;
        std::vector<char> integer;
        for (const BinaryProgram::Column& column : program_.columns) {
            lowers.push_back(column.lower);
            uppers.push_back(column.upper);
            costs.push_back(column.objective);
            integer.push_back(column.integer ? 1 : 0);
        }
        sym_explicit_load_problem(env, static_cast<int>(columns), static_cast<int>(program_.rows.size()),
                                  starts.data(), indices.data(), values.data(), lowers.data(), uppers.data(),
                                  integer.data(), costs.data(), nullptr, senses.data(), sides.data(),
                                  ranges.data(), 1);
    }

    void read(sym_environment* env, const Deadline& deadline, MilpReport& report) const {
        int nodes = 0;
        sym_get_iteration_count(env, &nodes);
        report.nodes = std::max(nodes, 0);
        if (sym_is_proven_primal_infeasible(env)) {
            report.status = SolveStatus::infeasible;
            return;
        }
        // Asked for a solution that it does not have, SYMPHONY complains on stdout: its primal bound tells.
        double value = sym_get_infinity();
        sym_get_primal_bound(env, &value);
        std::vector<double> point(program_.columns.size());
        const bool has_point = (sym_is_proven_optimal(env) || value < sym_get_infinity()) &&
                               sym_get_col_solution(env, point.data()) == FUNCTION_TERMINATED_NORMALLY;
        if (sym_is_proven_optimal(env) && has_point) {
            sym_get_obj_val(env, &value);
            report.status = SolveStatus::optimal;
            report.bound = value;
        } else if (sym_is_time_limit_reached(env) || deadline.passed()) {
            report.status = has_point ? SolveStatus::feasible : SolveStatus::stopped;
            report.stopped_by = StopReason::time;
        } else {
            report.status = SolveStatus::error;
            return;
        }
        if (has_point) report.point = std::move(point);
    }

    BinaryProgram program_;
};

class SymphonySolver : public MilpSolver {
  public:
    std::unique_ptr<MilpSession> load(const BinaryProgram& program) const override {
        return std::make_unique<SymphonySession>(program);
    }
};

}  // namespace

std::unique_ptr<MilpSolver> make_symphony_solver() {
    return std::make_unique<SymphonySolver>();
}

}  // namespace conelane
