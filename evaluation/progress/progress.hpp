#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <mutex>
#include <string>

namespace conelane {

/// A bar on stderr with rate and remaining time, redrawn a few times a second; silent if stderr is not a
/// terminal.
class Progress {
  public:
    Progress(std::string what, std::size_t total);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// Counts a step. May be called from any thread.
    void advance();

  private:
    using Clock = std::chrono::steady_clock;
    void draw(std::size_t done, Clock::time_point now);

    std::string what_;
    std::size_t total_;
    bool shown_;
    Clock::time_point start_;
    std::atomic<std::size_t> done_{0};
    std::mutex drawing_;
    Clock::time_point next_draw_;
};

}  // namespace conelane
