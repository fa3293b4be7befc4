#include "solvers/strip/strip_states.hpp"

#include <algorithm>

namespace conelane {
namespace {

/// 8 bytes each, and an entry of the search.
constexpr std::size_t kMaxStates = 8'000'000;

}  // namespace

bool StripStates::build(const StripProblem& problem) {
    problem_ = &problem;
    base_.assign(problem.rungs.size(), -1);
    order_.clear();
    size_ = 0;
    const auto reach = [&](std::uint32_t rung) {
        if (base_[rung] >= 0) return;
        base_[rung] = 0;
        order_.push_back(rung);
    };
    for (std::uint32_t rung = 0; rung < problem.rungs.size(); ++rung) {
        if (problem.rungs[rung].may_start) reach(rung);
    }
    for (std::size_t k = 0; k < order_.size(); ++k) {
        for (const StripTriangle& triangle : problem.leaving(order_[k])) reach(triangle.to);
    }
    std::ranges::reverse(order_);
    for (const std::uint32_t rung : order_) {
        base_[rung] = static_cast<std::int64_t>(size_);
        size_ += rows(rung) * columns(rung);
    }
    return size_ <= kMaxStates;
}

}  // namespace conelane
