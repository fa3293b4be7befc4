#pragma once

#include "model/deadline.hpp"

namespace conelane {

/// Thrown where the time for a drivable lane is over.
struct OutOfTime {};

/// Ends what is at work by OutOfTime once the deadline has passed; without one it does nothing.
class TimeCheck {
  public:
    TimeCheck() = default;
    explicit TimeCheck(const Deadline& deadline) : deadline_(&deadline) {}

    void operator()() const {
        if (kEnds && deadline_ != nullptr && deadline_->passed()) throw OutOfTime{};
    }

  private:
#ifdef __wasi__  // there are no exceptions: what is at work, some milliseconds at most, ends by itself
    static constexpr bool kEnds = false;
#else
    static constexpr bool kEnds = true;
#endif
    const Deadline* deadline_ = nullptr;
};

}  // namespace conelane
