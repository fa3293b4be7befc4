#include "solvers/cbc_solver.hpp"

#include "model/deadline.hpp"
#include "solvers/detail/cbc_deadline.hpp"
#include "solvers/detail/osi_program.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <coin/CbcModel.hpp>
#include <coin/OsiClpSolverInterface.hpp>

namespace conelane {
namespace {

class CbcSession : public MilpSession {
  public:
    explicit CbcSession(const BinaryProgram& program) {
        lp_.messageHandler()->setLogLevel(0);
        lp_.getModelPtr()->setLogLevel(0);
        integers_ = detail::load_into(lp_, program);
        for (const int column : integers_) {
            priorities_.push_back(program.columns[static_cast<std::size_t>(column)].branch_first ? 1 : 2);
        }
    }

    MilpReport solve(const MilpLimits& limits) override {
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
            report.status = deadline.passed() ? SolveStatus::stopped : SolveStatus::error;
            if (deadline.passed()) report.stopped_by = StopReason::time;
            if (report.status == SolveStatus::error) report.message = "Clp could not solve the relaxation";
            return report;
        }
        if (lp_.getObjValue() >= limits.cutoff) {
            report.status = SolveStatus::infeasible;
            return report;
        }
        report.bound = lp_.getObjValue();
        const double* x = lp_.getColSolution();
        if (detail::is_integral(x, integers_)) {
            report.status = SolveStatus::optimal;
            report.point.assign(x, x + lp_.getNumCols());
            return report;
        }
        branch(limits, deadline, report);
        return report;
    }

    void add_rows(std::span<const ProgramRow> rows) override { detail::append_rows(lp_, rows); }

  private:
    void branch(const MilpLimits& limits, const Deadline& deadline, MilpReport& report) {
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
        model.passInPriorities(priorities_.data(), false);
        if (std::isfinite(limits.cutoff)) model.setCutoff(limits.cutoff);
        const detail::CbcDeadline handler(&deadline);
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
            report.status = has_point ? SolveStatus::feasible : SolveStatus::stopped;
            report.stopped_by = StopReason::time;
        } else {
            report.message = "CBC stopped without a result, status " + std::to_string(model.status());
            report.status = SolveStatus::error;
            report.point.clear();
        }
    }

    OsiClpSolverInterface lp_;
    std::vector<int> integers_;
    std::vector<int> priorities_;  ///< of the integer columns, smaller ones are branched on first
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
