#pragma once

#include "model/strip_problem.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace conelane {

/// The last edges of both boundaries: a rung, and by which place among the edges of each cone it was reached;
/// the degree of the cone where the boundary has no edge yet.
struct StripState {
    std::uint32_t rung = 0;
    std::uint16_t left_in = 0;
    std::uint16_t right_in = 0;
};

struct StripStep {
    StripState to;
    std::size_t cone;  ///< that it enters
    bool is_left;
    double cost;  ///< of the triangle, its edge and the turn
};

/// The states of a strip problem that can be reached from a start, turns apart.
class StripStates {
  public:
    /// False if there are too many.
    [[nodiscard]] bool build(const StripProblem& problem);

    [[nodiscard]] std::size_t size() const { return size_; }
    [[nodiscard]] bool has(std::uint32_t rung) const { return base_[rung] >= 0; }
    /// Rungs, those of most steps from a start first: mostly after those that they lead to.
    [[nodiscard]] const std::vector<std::uint32_t>& order() const { return order_; }
    /// The first state of a rung; its states are rows by left_in and columns by right_in.
    [[nodiscard]] std::size_t base(std::uint32_t rung) const { return static_cast<std::size_t>(base_[rung]); }
    [[nodiscard]] std::size_t rows(std::uint32_t rung) const {
        return problem_->degree(problem_->rungs[rung].left) + 1;
    }
    [[nodiscard]] std::size_t columns(std::uint32_t rung) const {
        return problem_->degree(problem_->rungs[rung].right) + 1;
    }
    [[nodiscard]] std::size_t index(const StripState& state) const {
        return base(state.rung) + state.left_in * columns(state.rung) + state.right_in;
    }
    /// Of a lane that begins with the rung.
    [[nodiscard]] StripState first(std::uint32_t rung) const {
        return {rung, static_cast<std::uint16_t>(rows(rung) - 1),
                static_cast<std::uint16_t>(columns(rung) - 1)};
    }
    /// Of both ends; forbidden unless both boundaries have an edge and the rung may end.
    [[nodiscard]] double end_cost(const StripState& state) const {
        const StripRung& rung = problem_->rungs[state.rung];
        if (!rung.may_end || state.left_in + 1U == rows(state.rung) ||
            state.right_in + 1U == columns(state.rung))
            return StripProblem::kForbidden;
        return problem_->end_cost(rung.left, state.left_in) + problem_->end_cost(rung.right, state.right_in);
    }

    template <typename Use>
    void for_each_step(const StripState& state, const Use& use) const {
        const StripRung& from = problem_->rungs[state.rung];
        for (const StripTriangle& triangle : problem_->leaving(state.rung)) {
            const std::size_t cone = triangle.is_left ? from.left : from.right;
            const std::size_t in = triangle.is_left ? state.left_in : state.right_in;
            const double turn = in == problem_->degree(cone)
                                    ? 0.0
                                    : problem_->turn_cost(cone, triangle.is_left, in, triangle.out);
            if (!(turn < StripProblem::kForbidden)) continue;
            const StripRung& to = problem_->rungs[triangle.to];
            use(StripStep{triangle.is_left ? StripState{triangle.to, triangle.in, state.right_in}
                                           : StripState{triangle.to, state.left_in, triangle.in},
                          triangle.is_left ? to.left : to.right, triangle.is_left, triangle.cost + turn});
        }
    }

  private:
    const StripProblem* problem_ = nullptr;
    std::vector<std::int64_t> base_;  ///< by rung; -1: not reached
    std::vector<std::uint32_t> order_;
    std::size_t size_ = 0;
};

}  // namespace conelane
