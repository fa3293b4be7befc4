#pragma once

#include "model/deadline.hpp"

#include <algorithm>

#include <coin/CbcEventHandler.hpp>
#include <coin/CbcModel.hpp>
#include <coin/ClpEventHandler.hpp>

namespace conelane::detail {

/// The only clock of a COIN solve. COIN's own limits are not used: if one of them interrupts a relaxation,
/// CBC treats the relaxation as infeasible and the search as complete. This watch records every interruption,
/// so a search without one is known to be a proof.
struct DeadlineWatch {
    Deadline deadline;
    bool interrupted = false;  ///< a part of the solve was interrupted
    /// CBC's lower bound before any relaxation was interrupted.
    double bound = -std::numeric_limits<double>::infinity();

    /// Whether to stop now, which is recorded.
    bool must_stop() {
        interrupted = interrupted || deadline.passed();
        return interrupted;
    }
};

/// Stops Clp at the next iteration. The watch must outlive it and its clones.
class ClpDeadline : public ClpEventHandler {
  public:
    explicit ClpDeadline(DeadlineWatch* watch) : watch_(watch) {}
    int event(Event which) override {
        const bool may_stop = which == endOfIteration || which == endOfFactorization;
        return may_stop && watch_->must_stop() ? 1 : -1;
    }
    ClpEventHandler* clone() const override { return new ClpDeadline(*this); }

  private:
    DeadlineWatch* watch_;
};

/// Stops CBC at the next node. The watch must outlive it and its clones.
class CbcDeadline : public CbcEventHandler {
  public:
    explicit CbcDeadline(DeadlineWatch* watch) : watch_(watch) {}
    CbcAction event(CbcEvent which) override {
        if (which == node && !watch_->interrupted && model_ != nullptr) {
            watch_->bound = std::max(watch_->bound, model_->getBestPossibleObjValue());
        }
        return watch_->must_stop() ? stop : noAction;
    }
    CbcEventHandler* clone() const override { return new CbcDeadline(*this); }

  private:
    DeadlineWatch* watch_;
};

}  // namespace conelane::detail
