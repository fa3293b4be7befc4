#pragma once

#include "model/deadline.hpp"

#include <chrono>
#include <cmath>
#include <mutex>

namespace conelane::detail {

/// Waits until no other solve of the process holds the mutex, until the deadline at most. Owns no lock where
/// that has passed.
[[nodiscard]] inline std::unique_lock<std::timed_mutex> take_turn(std::timed_mutex& mutex,
                                                                  const Deadline& deadline) {
    const double remaining_ms = deadline.remaining_ms();
    if (!std::isfinite(remaining_ms)) return std::unique_lock(mutex);
    return {mutex, std::chrono::duration<double, std::milli>(remaining_ms)};
}

}  // namespace conelane::detail
