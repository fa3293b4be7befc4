#pragma once

#include "conelane/lane_graph.hpp"
#include "conelane/rld_parameters.hpp"
#include "conelane/scene.hpp"

#include <cstddef>
#include <optional>
#include <vector>

#include <boost/dynamic_bitset.hpp>
#include <boost/multiprecision/cpp_int.hpp>

namespace conelane {

/// A multiple of 2^-60; throws std::overflow_error and std::range_error instead of wrapping around.
using Exact = boost::multiprecision::checked_int128_t;
inline constexpr int kExactFractionBits = 60;

/// The number, rounded down. Precondition: finite.
[[nodiscard]] Exact exact_below(double value);

/// A scene as rational numbers: the edges and turns that a lane graph may have, and lower bounds of their
/// costs. An arc is an edge with a direction: 2 e from its cone of lower index to the other one, and 2 e + 1
/// back.
struct ExactScene {
    struct Succession {
        std::size_t arc;  ///< the next one
        Exact cost;       ///< of the turn
    };

    std::vector<Edge> edges;  ///< edges that break no final constraint by themselves
    std::vector<Exact> edge_cost;
    std::vector<bool> along_heading;  ///< (9)
    std::vector<boost::dynamic_bitset<>>
        excluded;  ///< by edge: edges that no lane graph has together with it
    std::vector<std::vector<Succession>> successions;  ///< by arc
    std::vector<Exact> end_cost;                       ///< by cone: the cost if a path ends there
    std::vector<bool> near;
    std::vector<std::vector<bool>> partners;  ///< by pair of far cones: within d_max of each other (17)

    [[nodiscard]] std::size_t tail(std::size_t arc) const {
        return arc % 2 == 0 ? edges[arc / 2].i : edges[arc / 2].j;
    }
    [[nodiscard]] std::size_t head(std::size_t arc) const {
        return arc % 2 == 0 ? edges[arc / 2].j : edges[arc / 2].i;
    }
    /// A lower bound of the cost of an edge that may be part of a lane graph.
    [[nodiscard]] std::optional<std::size_t> find(const Edge& edge) const;
    /// An upper bound of the cost of any lane graph.
    [[nodiscard]] Exact cost_limit() const;
};

[[nodiscard]] ExactScene make_exact_scene(const Scene& scene, const RldParameters& parameters);

}  // namespace conelane
