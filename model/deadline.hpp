#pragma once

#include <chrono>
#include <limits>

namespace conelane {

/// Wall clock since construction [ms].
class Stopwatch {
  public:
    [[nodiscard]] double elapsed_ms() const {
        return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count();
    }

  private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// A limit of wall clock, counted from construction.
class Deadline {
  public:
    explicit Deadline(double limit_ms = std::numeric_limits<double>::infinity()) : limit_ms_(limit_ms) {}

    [[nodiscard]] double remaining_ms() const { return limit_ms_ - watch_.elapsed_ms(); }
    [[nodiscard]] bool passed() const { return remaining_ms() <= 0.0; }

  private:
    Stopwatch watch_;
    double limit_ms_;
};

}  // namespace conelane
