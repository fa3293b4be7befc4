#pragma once

#include "solvers/path_pair/bound/multipliers.hpp"
#include "solvers/path_pair/graph/residual_graph.hpp"

#include <cstddef>
#include <vector>

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
};

}  // namespace conelane::path_pair
