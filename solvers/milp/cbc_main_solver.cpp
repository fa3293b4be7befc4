#include "solvers/detail/exclusive_section.hpp"
#include "solvers/milp/detail/invented_point.hpp"
#include "solvers/milp/detail/osi_program.hpp"
#include "solvers/milp/detail/own_process.hpp"

#include <array>
#include <charconv>

#include <coin/CbcConfig.h>
#include <coin/CbcSolver.hpp>
#include <coin/ClpConfig.h>

namespace conelane {
namespace {

std::timed_mutex one_at_a_time;

int no_callback(CbcModel*, int) {
    return 0;
}

class CbcMainSession : public MilpSession {
  public:
    explicit CbcMainSession(const BinaryProgram& program) {
        detail::with_std_errors([&] {
            detail::prepare(lp_, watch_);
            detail::load_into(lp_, program);
        });
    }

    /// The cutoff is not passed on. If no point is below it, the preprocessing of CBC 2.10.8 may return a
    /// point that violates rows; without preprocessing the `paper` formulation takes twice as long.
    MilpReport solve(const MilpLimits& limits) override {
        watch_ = {Deadline(limits.time_limit_ms)};
        MilpReport report;
        const auto lock = detail::lock_until(one_at_a_time, watch_.deadline);
        if (!lock.owns_lock()) {
            report.status = SolveStatus::stopped;
            report.stopped_by = StopReason::time;
            return report;
        }
        // Assertions of Clp 1.17 fail on some programs, and end the process.
        return detail::in_own_process([&] {
            detail::with_std_errors([&] {
                run(limits, true, report);
                // On infeasible programs, the preprocessing of CBC 2.10.8 may return an invalid solution.
                if (verdict_on(report) != detail::PointVerdict::search_anew) return;
                run(limits, false, report);
                if (verdict_on(report) == detail::PointVerdict::search_anew)
                    report.message = "CBC returned a point that violates rows";
            });
            return report;
        });
    }

    void add_rows(std::span<const ProgramRow> rows) override {
        detail::with_std_errors([&] { detail::append_rows(lp_, rows); });
    }

  private:
    /// CBC gets no limit of its own. If its preprocessing runs out of time, it calls the program infeasible
    /// and does not report that it was interrupted.
    void run(const MilpLimits& limits, bool preprocess, MilpReport& report) {
        CbcModel model(lp_);
        CbcSolverUsefulData data;
        data.noPrinting_ = true;
        data.useSignalHandler_ = false;
        CbcMain0(model, data);
        model.setLogLevel(0);
        model.messageHandler()->setLogLevel(0);
        const detail::CbcDeadline handler(&watch_);
        model.passInEventHandler(&handler);
        const std::string gap = fixed(limits.absolute_gap);
        // The feasibility pump changes the objective, which fails an assertion of Clp 1.17.6 and ends the
        // process.
        std::vector<const char*> arguments{"conelane",  "-log",       "0",    "-slog",
                                           "0",         "-increment", "1e-7", "-allowableGap",
                                           gap.c_str(), "-ratioGap",  "0",    "-feasibilityPump",
                                           "off"};
        if (!preprocess) arguments.insert(arguments.end(), {"-preprocess", "off"});
        arguments.insert(arguments.end(), {"-solve", "-quit"});
        CbcMain1(static_cast<int>(arguments.size()), arguments.data(), model, no_callback, data);
        read(model, limits, report);
    }

    /// A report without a point has no point to drop.
    [[nodiscard]] detail::PointVerdict verdict_on(MilpReport& report) const {
        if (report.point.empty()) return detail::PointVerdict::kept;
        const auto rows = static_cast<std::size_t>(lp_.getNumRows());
        std::vector<double> activity(rows);
        lp_.getMatrixByRow()->times(report.point.data(), activity.data());
        return detail::drop_invented_point({activity, {lp_.getRowLower(), rows}, {lp_.getRowUpper(), rows}},
                                           watch_.interrupted, report);
    }

    static std::string fixed(double value) {
        std::array<char, 400> text{};
        const auto end =
            std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed);
        return {text.data(), end.ptr};
    }

    void read(const CbcModel& model, const MilpLimits& limits, MilpReport& report) const {
        report.nodes = model.getNodeCount();
        const bool has_point = model.bestSolution() != nullptr;
        if (has_point) report.point.assign(model.bestSolution(), model.bestSolution() + lp_.getNumCols());
        if (watch_.interrupted) {
            report.status = has_point ? SolveStatus::feasible : SolveStatus::stopped;
            report.stopped_by = StopReason::time;
        } else if (model.isProvenOptimal() && has_point) {
            report.status = SolveStatus::optimal;
            report.bound = model.getObjValue() - limits.absolute_gap;
        } else if (model.isProvenInfeasible()) {
            report.status = SolveStatus::infeasible;
        } else {
            report.message = "CBC stopped without a result, status " + std::to_string(model.status()) + "/" +
                             std::to_string(model.secondaryStatus());
            report.point.clear();
        }
    }

    detail::DeadlineWatch watch_;
    OsiClpSolverInterface lp_;
};

}  // namespace

/// CBC's full default machinery (CbcMain1: preprocessing, cuts, heuristics, strong branching), faster than
/// `cbc` on the paper formulation. The feasibility pump is off: it aborts on some programs. Each solve is in
/// a copy of the process (detail::in_own_process), one at a time; the time limit includes waiting for another
/// solve. The clock is checked in every relaxation and at every node, but not within preprocessing and cut
/// generation: one of these steps may overrun the limit.
constexpr MilpBackend kCbcMain = milp_backend<CbcMainSession>(
    {.name = "cbc-main",
     .description = "CBC with its defaults: cuts, heuristics, preprocessing, strong branching; one at a time",
     .traits = SolverTrait::suits_paper | SolverTrait::refuses_huge_costs,
     .library = "CBC " CBC_VERSION ", Clp " CLP_VERSION});

}  // namespace conelane
