#pragma once

#include "solvers/path_pair/bound/multipliers.hpp"

namespace conelane::path_pair {

/// The result of a node.
enum class Verdict {
    closed,  ///< no pair in it costs less than the cutoff
    open,    ///< there may be a cheaper pair
    stopped  ///< by the clock
};

struct Branching {
    enum class On { nothing, end, edge } on;
    int what;    ///< the cone or the edge
    double use;  ///< by the relaxation, averaged
};

struct Decision {
    Branching branching;
    bool in;
};

/// A part of the pairs of legs: those that use arcs and turns of its graph and keep its decisions.
struct Node {
    ResidualGraph graph;
    Multipliers multipliers;  ///< those of the best bound
    std::vector<Decision> decisions;
    double bound = -kUnreachable;
    int max_steps = 0;       ///< of its ascent
    std::size_t number = 0;  ///< nodes that were made before it

    /// No bound, and all multipliers 0.
    void restart(const ArcGraph& arc_graph, int cliques) {
        multipliers.cone.assign(to_index(arc_graph.cone_count()), 0.0);
        multipliers.clique.assign(to_index(cliques), 0.0);
        multipliers.heading = 0.0;
        bound = -kUnreachable;
    }
};

/// The open nodes. Nodes that are given back are reused with their memory.
class NodeQueue {
  public:
    /// With `max_open` open nodes or more the search goes depth-first, which bounds the memory.
    explicit NodeQueue(std::size_t max_open) : max_open_(max_open) {}

    void clear();
    [[nodiscard]] bool empty() const { return open_.empty(); }
    /// A reused node with its old content, or a new one. It does not move until it is taken.
    Node& add();
    /// Removes and returns the next node: one of the lowest bound, of these the last that was added.
    /// Precondition: not empty.
    [[nodiscard]] std::unique_ptr<Node> take_next();
    void give_back(std::unique_ptr<Node> node) { spare_.push_back(std::move(node)); }
    /// kUnreachable without a node.
    [[nodiscard]] double min_bound() const;

  private:
    std::size_t max_open_;
    std::vector<std::unique_ptr<Node>> open_;
    std::vector<std::unique_ptr<Node>> spare_;
    std::size_t made_ = 0;
};

}  // namespace conelane::path_pair
