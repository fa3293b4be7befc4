#pragma once

#include "model/deadline.hpp"

#include <coin/CbcEventHandler.hpp>

namespace conelane::detail {

/// CBC overruns its own limit; this stops it at the next node. The deadline must outlive it.
class CbcDeadline : public CbcEventHandler {
  public:
    explicit CbcDeadline(const Deadline* deadline) : deadline_(deadline) {}
    CbcAction event(CbcEvent) override { return deadline_->passed() ? stop : noAction; }
    CbcEventHandler* clone() const override { return new CbcDeadline(*this); }

  private:
    const Deadline* deadline_;
};

}  // namespace conelane::detail
