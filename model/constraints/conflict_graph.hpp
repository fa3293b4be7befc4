#pragma once

#include "conelane/lane_graph_problem.hpp"

namespace conelane::constraints {

/// A graph with edges as vertices. Two are joined if no lane graph holds both. Adjacency: rows of bits.
class ConflictGraph {
  public:
    explicit ConflictGraph(std::size_t edges) : words_((edges + 63) / 64), bits_(edges * words_, 0) {}

    /// Width conflicts (6)-(8) and forbidden turns (28).
    explicit ConflictGraph(const LaneGraphProblem& problem) : ConflictGraph(problem.edges.size()) {
        for (const auto& [first, second] : problem.conflicts) join(first, second);
        for (const ProblemTurn& turn : problem.turns) {
            if (turn.high_cost) join(turn.edge_i, turn.edge_k);
        }
    }

    void join(std::size_t a, std::size_t b) {
        row(a)[b / 64] |= bit(b);
        row(b)[a / 64] |= bit(a);
    }
    void part(std::size_t a, std::size_t b) { row(a)[b / 64] &= ~bit(b); }
    [[nodiscard]] bool joined(std::size_t a, std::size_t b) const { return (row(a)[b / 64] & bit(b)) != 0; }
    [[nodiscard]] std::size_t words() const { return words_; }
    [[nodiscard]] std::uint64_t* row(std::size_t edge) { return bits_.data() + edge * words_; }
    [[nodiscard]] const std::uint64_t* row(std::size_t edge) const { return bits_.data() + edge * words_; }

  private:
    static std::uint64_t bit(std::size_t edge) { return std::uint64_t{1} << (edge % 64); }

    std::size_t words_;
    std::vector<std::uint64_t> bits_;
};

}  // namespace conelane::constraints
