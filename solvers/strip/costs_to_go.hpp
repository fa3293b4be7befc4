#pragma once

#include "model/deadline.hpp"
#include "model/strip_problem.hpp"

namespace conelane {

/// Makes `size` numbers of the same value; false if the deadline passed.
template <typename Number>
[[nodiscard]] bool fill(std::vector<Number>& numbers, std::size_t size, Number value,
                        const Deadline& deadline) {
    constexpr std::size_t kBlock = 1 << 15;
    numbers.clear();
    numbers.reserve(size);
    while (numbers.size() < size && !deadline.passed())
        numbers.insert(numbers.end(), std::min(kBlock, size - numbers.size()), value);
    return numbers.size() == size;
}

/// A rung, and the last edges of both boundaries as positions among those that they may have there.
struct StripState {
    std::uint32_t rung = 0;
    std::uint16_t left = 0;
    std::uint16_t right = 0;
};

struct StripStep {
    StripState to;
    std::uint32_t triangle;
    double cost;  ///< of the triangle, its edge and the turn
};

/// The states of a strip problem, and the least cost from each to an end, where a strip may use a cone again.
/// Each use of a cone costs its multiplier too, so that their sum less bounds the strips that use no cone
/// twice. A loop of negative cost raises the multipliers of its cones until it costs something.
class CostsToGo {
  public:
    /// Why it stopped: time, memory, or iterations if loops of negative cost do not end. The problem must
    /// outlive it.
    [[nodiscard]] std::optional<StopReason> compute(const StripProblem& problem, const Deadline& deadline);

    [[nodiscard]] std::size_t size() const { return size_; }
    [[nodiscard]] std::size_t index(const StripState& state) const {
        const Block& block = blocks_[state.rung];
        return block.first + std::size_t{state.left} * block.columns + state.right;
    }
    /// Of a lane that begins with the rung, which may start.
    [[nodiscard]] StripState first(std::uint32_t rung) const {
        const Block& block = blocks_[rung];
        return {rung, static_cast<std::uint16_t>(block.rows - 1),
                static_cast<std::uint16_t>(block.columns - 1)};
    }
    /// Of both ends; forbidden unless both boundaries have an edge and the rung may end.
    [[nodiscard]] double end_cost(const StripState& state) const {
        return problem_->rungs[state.rung].may_end ? end_costs_[begin(state.rung, true) + state.left] +
                                                         end_costs_[begin(state.rung, false) + state.right]
                                                   : StripProblem::kForbidden;
    }
    [[nodiscard]] double of(const StripState& state) const { return costs_[index(state)]; }
    [[nodiscard]] const std::vector<double>& multipliers() const { return multipliers_; }
    [[nodiscard]] double sum() const { return sum_; }

    template <typename Use>
    void for_each_step(const StripState& state, const Use& use) const {
        for (std::uint32_t k = problem_->triangles_of[state.rung]; k < problem_->triangles_of[state.rung + 1];
             ++k) {
            const StripTriangle& t = problem_->triangles[k];
            if (!moves_[k].is_possible) continue;
            const double turn = turns_[moves_[k].turns + (t.is_left ? state.left : state.right)];
            const std::uint16_t other = others_[moves_[k].others + (t.is_left ? state.right : state.left)];
            if (turn < StripProblem::kForbidden)
                use(StripStep{
                    t.is_left ? StripState{t.to, moves_[k].in, other} : StripState{t.to, other, moves_[k].in},
                    k, t.cost + turn});
        }
    }

  private:
    using Edges = std::uint64_t;  ///< last edges of a boundary, a bit each; all from the 64th on share one
    /// The states of a rung: rows by the left boundary's last edge, columns by the right one's.
    struct Block {
        std::size_t first;
        std::uint32_t rows;
        std::uint32_t columns;
    };
    /// What a triangle does to a state.
    struct Move {
        bool is_possible = false;
        std::uint16_t in = 0;      ///< position of its own boundary at the rung that it reaches
        std::uint32_t turns = 0;   ///< in `turns_`, by position of its own boundary: the cost of the turn
        std::uint32_t others = 0;  ///< in `others_`, by position of the other boundary: that at the new rung
    };
    [[nodiscard]] std::size_t begin(std::size_t rung, bool is_left) const {
        return ins_of_[2 * rung + (is_left ? 0 : 1)];
    }
    [[nodiscard]] std::span<const std::uint16_t> ins(std::size_t rung, bool is_left) const {
        return std::span(ins_).subspan(begin(rung, is_left),
                                       begin(rung + (is_left ? 0 : 1), !is_left) - begin(rung, is_left));
    }
    [[nodiscard]] bool reach(const Deadline& deadline);
    void list_turns();
    [[nodiscard]] bool can_turn(const StripTriangle& triangle) const;
    [[nodiscard]] bool list_states(const Deadline& deadline);
    [[nodiscard]] bool list_moves(const Deadline& deadline);
    void add_move(const StripTriangle& triangle);
    [[nodiscard]] bool sort_rungs(const Deadline& deadline);
    [[nodiscard]] bool is_stale(std::uint32_t rung) const;
    [[nodiscard]] bool relax(std::uint32_t rung);
    void relax(const StripTriangle& triangle, const Move& move);
    [[nodiscard]] bool raise_loops(const Deadline& deadline);
    [[nodiscard]] bool raise_loop_from(StripState state, const Deadline& deadline);
    [[nodiscard]] std::optional<StripStep> cheapest(const StripState& state) const;
    [[nodiscard]] std::size_t entered(const StripStep& step) const {
        return problem_->entered(problem_->triangles[step.triangle]);
    }

    const StripProblem* problem_ = nullptr;
    std::vector<Edges> can_precede_;             ///< by cone and place: from which edges one may turn into it
    std::vector<std::array<Edges, 2>> reached_;  ///< by rung, left first
    std::vector<std::uint32_t> waiting_;
    std::vector<char> is_waiting_;
    /// The last edges that a boundary may have at a rung, as places among the edges of its cone, ascending;
    /// the degree of the cone is no edge yet. Each boundary is followed without the other one's turns.
    std::vector<std::uint16_t> ins_;
    std::vector<double> end_costs_;    ///< by position in `ins_`
    std::vector<std::size_t> ins_of_;  ///< by rung and side, left first
    std::vector<Block> blocks_;        ///< by rung
    std::vector<Move> moves_;          ///< by triangle
    std::vector<double> turns_;
    std::vector<std::uint16_t> others_;
    std::vector<std::uint32_t> order_;  ///< rungs that a start reaches, mostly after those that they lead to
    std::vector<std::pair<std::uint32_t, std::uint32_t>> stack_;
    std::size_t size_ = 0;
    std::vector<double> costs_;  ///< by state
    std::vector<double> multipliers_;
    double sum_ = 0.0;
    std::uint32_t clock_ = 0;
    std::vector<std::uint32_t> relaxed_at_;  ///< by rung
    std::vector<std::uint32_t> changed_at_;
    std::vector<double> row_;       ///< the new costs of a rung
    std::vector<double> gathered_;  ///< costs after a triangle, by position of the other boundary
};

}  // namespace conelane
