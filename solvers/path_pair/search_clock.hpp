#pragma once

#include "model/deadline.hpp"

#include <cstddef>
#include <cstdint>

namespace conelane::path_pair {

/// The deadline of a search, shared by all its parts. They count their work in steps of about a nanosecond;
/// the deadline is checked after every 50 000 steps. Expiry is sticky, and results of the interrupted part
/// are then invalid.
class SearchClock {
  public:
    /// Without a deadline and a limit of total_work it never expires.
    explicit SearchClock(const Deadline& deadline = Deadline(),
                         std::int64_t max_work = std::numeric_limits<std::int64_t>::max())
        : deadline_(deadline), max_work_(max_work) {}
    virtual ~SearchClock() = default;
    SearchClock(const SearchClock&) = delete;
    SearchClock& operator=(const SearchClock&) = delete;

    /// The same clock for another search, with nothing counted.
    void restart(const Deadline& deadline, std::int64_t max_work = std::numeric_limits<std::int64_t>::max()) {
        deadline_ = deadline;
        max_work_ = max_work;
        work_ = 0;
        total_work_ = 0;
        expired_ = false;
    }

    /// Counts `work` steps, also in the total.
    bool out_of_time(std::size_t work) {
        total_work_ += static_cast<std::int64_t>(work);
        return tick(work);
    }
    /// Counts `work` steps towards the next check of the deadline, but not in the total.
    bool tick(std::size_t work) {
        constexpr std::size_t kWorkPerCheck = 50'000;
        work_ += work;
        return work_ < kWorkPerCheck ? expired_ : out_of_time();
    }
    /// Checks the deadline now.
    bool out_of_time() {
        work_ = 0;
        expired_ = expired_ || total_work_ >= max_work_ || has_passed();
        return expired_;
    }
    [[nodiscard]] bool expired() const { return expired_; }
    /// The counted steps: the same on every machine.
    [[nodiscard]] std::int64_t total_work() const { return total_work_; }

  private:
    /// Tests may make it expire at any time.
    [[nodiscard]] virtual bool has_passed() { return deadline_.passed(); }

    Deadline deadline_;
    std::int64_t max_work_;
    std::size_t work_ = 0;
    std::int64_t total_work_ = 0;
    bool expired_ = false;
};

}  // namespace conelane::path_pair
