#pragma once

#include "solvers/path_pair/search_clock.hpp"

namespace conelane::tests {

/// A clock of path-pair's search that counts the checks of its deadline, and whose time ends at one of them.
class FakeSearchClock : public path_pair::SearchClock {
  public:
    /// Counted from 1; 0: never.
    explicit FakeSearchClock(int strikes_at = 0) : strikes_at_(strikes_at) {}

    [[nodiscard]] int looks() const { return looks_; }
    /// The time ends at the next check.
    void strike() { strikes_at_ = looks_ + 1; }
    /// The same clock for another search.
    void restart(int strikes_at) {
        SearchClock::restart(Deadline());
        strikes_at_ = strikes_at;
        looks_ = 0;
    }

  private:
    [[nodiscard]] bool has_passed() override { return ++looks_ == strikes_at_; }

    int strikes_at_;
    int looks_ = 0;
};

}  // namespace conelane::tests
