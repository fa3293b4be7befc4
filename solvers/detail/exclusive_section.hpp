#pragma once

#include "model/deadline.hpp"

#include <algorithm>
#include <mutex>

namespace conelane::detail {

/// Locks the mutex, waiting until the deadline at most. Does not own the lock if the deadline has passed.
[[nodiscard]] inline std::unique_lock<std::timed_mutex> lock_until(std::timed_mutex& mutex,
                                                                   const Deadline& deadline) {
    constexpr double kMaxWait_ms = 1e9;  // larger values overflow a clock's integers
    std::unique_lock lock(mutex, std::defer_lock);
    while (!lock.owns_lock() && !deadline.passed()) {
        const double wait_ms = std::min(deadline.remaining_ms(), kMaxWait_ms);
        (void)lock.try_lock_for(std::chrono::duration<double, std::milli>(wait_ms));
    }
    return lock;
}

}  // namespace conelane::detail
