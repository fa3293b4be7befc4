#include "solvers/cbc_main_solver.hpp"

#include "model/deadline.hpp"
#include "solvers/detail/cbc_deadline.hpp"
#include "solvers/detail/osi_program.hpp"
#include "solvers/detail/turn.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string>
#include <vector>

#include <coin/CbcModel.hpp>
#include <coin/CbcSolver.hpp>
#include <coin/OsiClpSolverInterface.hpp>

namespace conelane {
namespace {

std::timed_mutex one_at_a_time;

int no_callback(CbcModel*, int) {
    return 0;
}

class CbcMainSession : public MilpSession {
  public:
    explicit CbcMainSession(const BinaryProgram& program) {
        lp_.messageHandler()->setLogLevel(0);
        lp_.getModelPtr()->setLogLevel(0);
        detail::load_into(lp_, program);
    }

    /// The cutoff is not passed on: where nothing is below it, CBC 2.10.8's preprocessing was seen to return
    /// a point that violates rows, and without preprocessing the printed rows take twice as long.
    MilpReport solve(const MilpLimits& limits) override {
        const Deadline deadline(limits.time_limit_ms);
        MilpReport report;
        report.status = SolveStatus::stopped;
        report.stopped_by = StopReason::time;
        const auto turn = detail::take_turn(one_at_a_time, deadline);
        if (!turn.owns_lock()) return report;

        CbcModel model(lp_);
        CbcSolverUsefulData data;
        data.noPrinting_ = true;
        data.useSignalHandler_ = false;
        CbcMain0(model, data);
        model.setLogLevel(0);
        model.messageHandler()->setLogLevel(0);
        const detail::CbcDeadline handler(&deadline);
        std::vector<std::string> words{"conelane",
                                       "-log",
                                       "0",
                                       "-slog",
                                       "0",
                                       "-increment",
                                       "1e-7",
                                       "-allowableGap",
                                       fixed(limits.absolute_gap),
                                       "-ratioGap",
                                       "0",
                                       "-timeMode",
                                       "elapsed"};
        if (std::isfinite(limits.time_limit_ms)) {
            model.passInEventHandler(&handler);
            words.insert(words.end(), {"-seconds", fixed(std::max(deadline.remaining_ms(), 0.01) / 1e3)});
        }
        words.insert(words.end(), {"-solve", "-quit"});
        std::vector<const char*> arguments;
        for (const std::string& word : words) arguments.push_back(word.c_str());
        CbcMain1(static_cast<int>(arguments.size()), arguments.data(), model, no_callback, data);
        read(model, deadline, report);
        return report;
    }

    void add_rows(std::span<const ProgramRow> rows) override { detail::append_rows(lp_, rows); }

  private:
    static std::string fixed(double value) {
        std::array<char, 400> text{};
        const auto end =
            std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed);
        return {text.data(), end.ptr};
    }

    /// Preprocessing that runs out of time calls the program infeasible, so that claim counts in the first
    /// half of the time alone.
    void read(const CbcModel& model, const Deadline& deadline, MilpReport& report) const {
        report.nodes = model.getNodeCount();
        const bool has_point = model.bestSolution() != nullptr;
        if (has_point) report.point.assign(model.bestSolution(), model.bestSolution() + lp_.getNumCols());
        const bool stopped = deadline.passed() || model.isSecondsLimitReached();
        if (model.isProvenOptimal() && has_point && !stopped) {
            report.status = SolveStatus::optimal;
            report.bound = model.getObjValue();
        } else if (model.isProvenInfeasible() && !deadline.half_passed()) {
            report.status = SolveStatus::infeasible;
        } else if (stopped || model.isProvenInfeasible()) {
            report.status = has_point ? SolveStatus::feasible : SolveStatus::stopped;
            report.stopped_by = StopReason::time;
        } else {
            report.status = SolveStatus::error;
            report.message = "CBC stopped without a result, status " + std::to_string(model.status()) + "/" +
                             std::to_string(model.secondaryStatus());
            report.point.clear();
        }
    }

    OsiClpSolverInterface lp_;
};

class CbcMainSolver : public MilpSolver {
  public:
    std::unique_ptr<MilpSession> load(const BinaryProgram& program) const override {
        return std::make_unique<CbcMainSession>(program);
    }
};

}  // namespace

std::unique_ptr<MilpSolver> make_cbc_main_solver() {
    return std::make_unique<CbcMainSolver>();
}

}  // namespace conelane
