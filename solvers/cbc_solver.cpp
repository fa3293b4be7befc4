#include "solvers/cbc_solver.hpp"

#include "solvers/deadline.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <coin/CbcEventHandler.hpp>
#include <coin/CbcModel.hpp>
#include <coin/CoinPackedMatrix.hpp>
#include <coin/OsiClpSolverInterface.hpp>

namespace conelane {
namespace {

constexpr double kIntegrality = 1e-7;

/// CBC overruns its own limit; this stops it at the next node.
class DeadlineHandler : public CbcEventHandler {
  public:
    explicit DeadlineHandler(const Deadline* deadline) : deadline_(deadline) {}
    CbcAction event(CbcEvent) override { return deadline_->passed() ? stop : noAction; }
    CbcEventHandler* clone() const override { return new DeadlineHandler(*this); }

  private:
    const Deadline* deadline_;
};

class CbcSession : public MilpSession {
  public:
    explicit CbcSession(const BinaryProgram& program) {
        lp_.messageHandler()->setLogLevel(0);
        lp_.getModelPtr()->setLogLevel(0);
        const auto columns = static_cast<int>(program.columns.size());
        const auto rows = static_cast<int>(program.rows.size());
        std::vector<double> lower(program.columns.size()), upper(lower), costs(lower);
        for (std::size_t c = 0; c < program.columns.size(); ++c) {
            lower[c] = program.columns[c].lower;
            upper[c] = program.columns[c].upper;
            costs[c] = program.columns[c].objective;
            if (program.columns[c].integer) integers_.push_back(static_cast<int>(c));
        }
        std::vector<double> row_lower(program.rows.size()), row_upper(row_lower);
        for (std::size_t r = 0; r < program.rows.size(); ++r) {
            row_lower[r] = program.rows[r].lower <= -kInfinity ? -COIN_DBL_MAX : program.rows[r].lower;
            row_upper[r] = program.rows[r].upper >= kInfinity ? COIN_DBL_MAX : program.rows[r].upper;
        }
        const CoinPackedMatrix matrix(false, columns, rows, static_cast<int>(program.entry_values.size()),
                                      program.entry_values.data(), program.entry_columns.data(),
                                      program.row_starts.data(), nullptr);
        lp_.loadProblem(matrix, lower.data(), upper.data(), costs.data(), row_lower.data(), row_upper.data());
        for (const int column : integers_) lp_.setInteger(column);
    }

    MilpReport solve(const SolveLimits& limits) override {
        const Deadline deadline(limits.time_limit_ms);
        MilpReport report;
        if (std::isfinite(limits.time_limit_ms))
            lp_.getModelPtr()->setMaximumWallSeconds(limits.time_limit_ms / 1e3);
        if (solved_once_) {
            lp_.resolve();
        } else {
            lp_.initialSolve();
            solved_once_ = true;
        }
        if (lp_.isProvenPrimalInfeasible()) {
            report.status = SolveStatus::infeasible;
            return report;
        }
        if (!lp_.isProvenOptimal()) {
            report.status = deadline.passed() ? SolveStatus::time_limit : SolveStatus::error;
            if (report.status == SolveStatus::error) report.message = "Clp could not solve the relaxation";
            return report;
        }
        const double* x = lp_.getColSolution();
        if (std::ranges::all_of(integers_,
                                [&](int c) { return std::abs(x[c] - std::round(x[c])) <= kIntegrality; })) {
            report.status = SolveStatus::optimal;
            report.bound = lp_.getObjValue();
            report.point.assign(x, x + lp_.getNumCols());
            return report;
        }
        report.bound = lp_.getObjValue();
        branch(limits, deadline, report);
        return report;
    }

    void add_rows(std::span<const ProgramRow> rows) override {
        for (const ProgramRow& row : rows) {
            CoinPackedVector terms;
            for (const auto& [column, coefficient] : row.terms) terms.insert(column, coefficient);
            lp_.addRow(terms, row.lower <= -kInfinity ? -COIN_DBL_MAX : row.lower,
                       row.upper >= kInfinity ? COIN_DBL_MAX : row.upper);
        }
    }

  private:
    void branch(const SolveLimits& limits, const Deadline& deadline, MilpReport& report) {
        CbcModel model(lp_);
        model.setLogLevel(0);
        model.messageHandler()->setLogLevel(0);
        model.solver()->messageHandler()->setLogLevel(0);
        model.setNumberStrong(0);
        model.setNumberBeforeTrust(0);
        model.setAllowableGap(limits.absolute_gap);
        model.setAllowableFractionGap(0.0);
        // The default increment would cut off solutions that are better by less than 1e-5.
        model.setDblParam(CbcModel::CbcCutoffIncrement, 1e-7);
        const DeadlineHandler handler(&deadline);
        if (std::isfinite(limits.time_limit_ms)) {
            model.setUseElapsedTime(true);
            model.setMaximumSeconds(std::max(deadline.remaining_ms(), 0.0) / 1e3);
            model.passInEventHandler(&handler);
        }
        model.branchAndBound(0);

        report.nodes = model.getNodeCount();
        report.bound = std::max(*report.bound, model.getBestPossibleObjValue());
        const bool has_point = model.bestSolution() != nullptr;
        if (has_point) report.point.assign(model.bestSolution(), model.bestSolution() + lp_.getNumCols());
        if (model.isProvenOptimal()) {
            report.status = SolveStatus::optimal;
        } else if (model.isProvenInfeasible()) {
            report.status = SolveStatus::infeasible;
            report.bound.reset();
        } else if (deadline.passed() || model.isSecondsLimitReached()) {
            report.status = has_point ? SolveStatus::feasible : SolveStatus::time_limit;
        } else {
            report.message = "CBC stopped without a result, status " + std::to_string(model.status());
            report.status = SolveStatus::error;
            report.point.clear();
        }
    }

    OsiClpSolverInterface lp_;
    std::vector<int> integers_;
    bool solved_once_ = false;
};

class CbcSolver : public MilpSolver {
  public:
    std::unique_ptr<MilpSession> load(const BinaryProgram& program) const override {
        return std::make_unique<CbcSession>(program);
    }
};

}  // namespace

std::unique_ptr<MilpSolver> make_cbc_solver() {
    return std::make_unique<CbcSolver>();
}

}  // namespace conelane
