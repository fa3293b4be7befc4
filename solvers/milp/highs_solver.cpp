#include "solvers/milp/milp_solver.hpp"

#include <stdexcept>

#include <interfaces/highs_c_api.h>

namespace conelane {
namespace {

/// HiGHS takes a larger cost for infinite.
constexpr double kMostCost = 1e20;
constexpr double kMsPerS = 1000.0;

class HighsSession : public MilpSession {
  public:
    explicit HighsSession(const BinaryProgram& program)
        : highs_(Highs_create(), Highs_destroy),
          columns_(program.columns.size()),
          rows_(program.rows.size()) {
        std::vector<double> cost, lower, upper, row_lower, row_upper;
        std::vector<HighsInt> kind;
        for (const BinaryProgram::Column& column : program.columns) {
            if (!(std::abs(column.objective) < kMostCost))
                throw std::runtime_error("the cost of column " + to_string(column.label) +
                                         " is too large for HiGHS");
            cost.push_back(column.objective);
            lower.push_back(column.lower);
            upper.push_back(column.upper);
            kind.push_back(column.integer ? kHighsVarTypeInteger : kHighsVarTypeContinuous);
        }
        for (const BinaryProgram::RowBounds& row : program.rows) {
            row_lower.push_back(row.lower);
            row_upper.push_back(row.upper);
        }
        Highs_setBoolOptionValue(highs_.get(), "output_flag", 0);
        Highs_setIntOptionValue(highs_.get(), "threads", 1);
        Highs_setDoubleOptionValue(highs_.get(), "mip_rel_gap", 0.0);
        require(Highs_passMip(highs_.get(), size_of(cost), size_of(row_lower), size_of(program.entry_values),
                              kHighsMatrixFormatRowwise, kHighsObjSenseMinimize, 0.0, cost.data(),
                              lower.data(), upper.data(), row_lower.data(), row_upper.data(),
                              program.row_starts.data(), program.entry_columns.data(),
                              program.entry_values.data(), kind.data()));
    }

    MilpReport solve(const MilpLimits& limits) override {
        const Deadline deadline(limits.time_limit_ms);
        Highs_zeroAllClocks(highs_.get());  // or the limit would hold for all rounds together
        Highs_setDoubleOptionValue(highs_.get(), "mip_abs_gap", limits.absolute_gap);
        Highs_setDoubleOptionValue(highs_.get(), "objective_bound", limits.cutoff);
        Highs_setDoubleOptionValue(highs_.get(), "time_limit", deadline.remaining_ms() / kMsPerS);
        const bool failed = Highs_run(highs_.get()) == kHighsStatusError;
        MilpReport report;
        std::int64_t nodes = 0;
        Highs_getInt64InfoValue(highs_.get(), "mip_node_count", &nodes);
        report.nodes = std::max<std::int64_t>(0, nodes);  // -1 if presolve has solved it
        double bound = -std::numeric_limits<double>::infinity();
        Highs_getDoubleInfoValue(highs_.get(), "mip_dual_bound", &bound);
        if (std::isfinite(bound)) report.bound = bound;
        read_point(report);
        conclude(failed ? kHighsModelStatusSolveError : Highs_getModelStatus(highs_.get()), report);
        return report;
    }

    void add_rows(std::span<const ProgramRow> rows) override {
        for (const ProgramRow& row : rows) {
            std::vector<HighsInt> columns;
            std::vector<double> values;
            for (const auto& [column, coefficient] : row.terms) {
                columns.push_back(column);
                values.push_back(coefficient);
            }
            require(Highs_addRow(highs_.get(), row.lower, row.upper, size_of(columns), columns.data(),
                                 values.data()));
            ++rows_;
        }
    }

  private:
    template <typename Values>
    static HighsInt size_of(const Values& values) {
        return static_cast<HighsInt>(values.size());
    }

    static void require(HighsInt status) {
        if (status == kHighsStatusError) throw std::runtime_error("HiGHS does not take the program");
    }

    void read_point(MilpReport& report) const {
        HighsInt point = 0;
        Highs_getIntInfoValue(highs_.get(), "primal_solution_status", &point);
        if (point != kHighsSolutionStatusFeasible) return;
        report.point.resize(columns_);
        std::vector<double> duals(columns_), activity(rows_), row_duals(rows_);
        Highs_getSolution(highs_.get(), report.point.data(), duals.data(), activity.data(), row_duals.data());
    }

    /// With a cutoff, HiGHS calls a program without a better point infeasible, or names the objective bound.
    static void conclude(HighsInt status, MilpReport& report) {
        if (status == kHighsModelStatusOptimal && !report.point.empty()) {
            report.status = SolveStatus::optimal;
        } else if (status == kHighsModelStatusInfeasible || status == kHighsModelStatusObjectiveBound ||
                   status == kHighsModelStatusUnboundedOrInfeasible) {  // every column has bounds
            report.status = SolveStatus::infeasible;
            report.point.clear();
            report.bound.reset();
        } else if (status == kHighsModelStatusTimeLimit) {
            report.status = report.point.empty() ? SolveStatus::stopped : SolveStatus::feasible;
            report.stopped_by = StopReason::time;
        } else {
            report.message = "HiGHS stopped without a result, status " + std::to_string(status);
            report.point.clear();
        }
    }

    std::unique_ptr<void, void (*)(void*)> highs_;
    std::size_t columns_;
    std::size_t rows_;
};

#define CONELANE_TEXT_OF(number) #number
#define CONELANE_VALUE_OF(macro) CONELANE_TEXT_OF(macro)

}  // namespace

/// HiGHS with its defaults, without a relative gap, on one thread. A start is a cutoff. Each round of rows
/// on demand begins again.
constexpr MilpBackend kHighs = milp_backend<HighsSession>(
    {.name = "highs",
     .description = "HiGHS with its defaults, in process",
     .traits = SolverTrait::refuses_huge_costs,
     .library = "HiGHS " CONELANE_VALUE_OF(HIGHS_VERSION_MAJOR) "." CONELANE_VALUE_OF(
         HIGHS_VERSION_MINOR) "." CONELANE_VALUE_OF(HIGHS_VERSION_PATCH)});

}  // namespace conelane
