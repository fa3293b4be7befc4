#pragma once

#include "conelane/formulation.hpp"
#include "conelane/lane_graph.hpp"
#include "conelane/rld_parameters.hpp"
#include "model/binary_program.hpp"

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

using Rational = boost::multiprecision::cpp_rational;

/// A program at one point in rational arithmetic. Every coefficient, bound and coordinate is a double, hence
/// a rational number. Only the differences below are rounded, once each, when they are stored.
struct ExactProgramReport {
    Rational objective;
    double objective_rounding =
        0.0;                    ///< rounding of the objective's sum in double, in the order of the columns
    double row_rounding = 0.0;  ///< largest rounding of a row's sum in double
    double violation = 0.0;     ///< largest violation of a row or of a column's bounds; 0: feasible
    std::string violated;       ///< the name of that row or column
    std::size_t rows = 0;
    std::size_t terms = 0;  ///< number of terms that are not 0
};

/// Precondition: a finite coordinate for each column.
[[nodiscard]] ExactProgramReport recompute_exactly(const BinaryProgram& program,
                                                   std::span<const double> point);

/// The point of a lane graph, by the meaning of the columns' names (formulation.md): a_i_j, f_i_j_k, g_i, u_i
/// and e_i_j. `near` tells for each cone whether it is near (11). Throws std::invalid_argument if the program
/// has a column of another family, or no column for an edge of the graph.
[[nodiscard]] std::vector<double> point_of(const BinaryProgram& program, const LaneGraph& graph,
                                           const std::vector<bool>& near);

/// The program of that formulation for the scene, at the lane graph. Rows that are added on demand count if
/// the lane graph violates them. Nothing if the program is too large. Precondition: each edge of the graph
/// joins two different cones of the scene, and none occurs twice.
[[nodiscard]] std::optional<ExactProgramReport> recompute_exactly(const Scene& scene,
                                                                  const RldParameters& parameters,
                                                                  Formulation formulation,
                                                                  const LaneGraph& graph);

/// |exact - stated|, rounded once.
[[nodiscard]] double exact_difference(const Rational& exact, double stated);

}  // namespace conelane
