#pragma once

#include "model/deadline.hpp"

namespace conelane {

/// Thrown when the time for a drivable lane has ended.
struct OutOfTime {};

/// Throws OutOfTime once the deadline has passed; does nothing without a deadline.
class TimeCheck {
  public:
    TimeCheck() = default;
    explicit TimeCheck(const Deadline& deadline) : deadline_(&deadline) {}

    void operator()() const {
        if (kEnds && deadline_ != nullptr && deadline_->passed()) throw OutOfTime{};
    }

  private:
#ifdef __wasi__  // exceptions are off here: the computation, some milliseconds at most, runs to its end
    static constexpr bool kEnds = false;
#else
    static constexpr bool kEnds = true;
#endif
    const Deadline* deadline_ = nullptr;
};

}  // namespace conelane
