#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>

namespace conelane::path_pair {

/// The deadline as the parts of the search see it: they count their work, and the clock is looked at once in
/// a while. Once it has struck it stays so, and what a part was working on is of no use.
class SearchClock {
  public:
    /// Never strikes.
    SearchClock() = default;
    explicit SearchClock(std::function<bool()> stopped) : stopped_(std::move(stopped)) {}

    /// Counts `work` steps of about a nanosecond.
    bool out_of_time(std::size_t work) {
        constexpr std::size_t kWorkPerClock = 50'000;
        work_ += work;
        total_work_ += static_cast<std::int64_t>(work);
        if (work_ < kWorkPerClock) return struck_;
        return out_of_time();
    }
    /// Looks at the clock now.
    bool out_of_time() {
        work_ = 0;
        struck_ = struck_ || (stopped_ && stopped_());
        return struck_;
    }
    [[nodiscard]] bool struck() const { return struck_; }
    /// All that was counted, on any machine the same.
    [[nodiscard]] std::int64_t total_work() const { return total_work_; }

  private:
    std::function<bool()> stopped_;
    std::size_t work_ = 0;
    std::int64_t total_work_ = 0;
    bool struck_ = false;
};

}  // namespace conelane::path_pair
