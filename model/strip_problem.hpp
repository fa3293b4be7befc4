#pragma once

#include "conelane/lane_graph_problem.hpp"
#include "model/strip_costs.hpp"

#include <limits>

namespace conelane {

/// A lane as a strip of triangles between its two boundaries (formulation.md, "The strip").
struct StripParameters {
    /// Limits of edges and turns, (27), (28) and gaps; which cones are near; without `costs` also the costs
    /// of edges and turns. Its limits of whole lanes, (6)-(9) and (17), do not count.
    RldParameters gates = {};
    double w_min_m = 2.0;  ///< least length of a rung [m]; at least 0
    double w_max_m = 6.5;  ///< largest length of a rung [m]; above w_min_m, at most 100
    /// A rung longer than this joins a cone with one of its `nearest_of_rung` nearest [m].
    double w_usual_m = 6.5;
    double nearest_of_rung = 0.0;  ///< for one end, fewer cones than this are nearer than the other; 0: off
    double d_end_m = 0.0;          ///< a lane ends at cones farther from the car than this [m]; 0: at any
    std::shared_ptr<const StripCosts> costs = {};  ///< replace those of the gates
};
/// Throws InvalidInput naming the first parameter that is out of its range.
void validate(const StripParameters& parameters);
/// For a car on the road: wide limits, which nearly all true lanes keep, and the hand-set costs.
[[nodiscard]] StripParameters driving_strip_parameters();
/// The strip program that has the edges, turns, near and far cones and costs of an RLD problem.
[[nodiscard]] StripParameters strip_parameters_of(const RldParameters& parameters);

/// Cones across the lane from each other. A strip goes from rung to rung.
struct StripRung {
    std::size_t left;
    std::size_t right;
    bool may_start;  ///< both cones are near the car, the left one to the left of the right one
    bool may_end;
    double start_cost;  ///< of s; 0 if it may not start

    [[nodiscard]] std::size_t of(bool is_left) const { return is_left ? left : right; }
};

/// One boundary goes on by an edge, the other one stays: from rung to rung. The triangle is wound so that the
/// other boundary lies on the lane's side of the edge.
struct StripTriangle {
    std::uint32_t from;  ///< rung
    std::uint32_t to;    ///< rung
    std::uint32_t edge;  ///< of the graph
    std::uint16_t out;   ///< place of the edge among those at the cone that it leaves
    std::uint16_t in;    ///< place of the edge among those at the cone that it reaches
    bool is_left;        ///< the left boundary goes on
    double cost;         ///< of y, with the cost of the edge
};

/// The numbers of one scene.
struct StripProblem {
    /// What an edge may not do in any strip.
    static constexpr double kForbidden = std::numeric_limits<double>::infinity();

    StripParameters parameters;
    LaneGraphProblem graph;  ///< without turns, conflicts and costs if the parameters have `costs`
    double reach_m = 0.0;    ///< no triangle has a longer side
    std::vector<StripRung> rungs;
    std::vector<StripTriangle> triangles;     ///< in the order of the rungs that they leave
    std::vector<std::uint32_t> triangles_of;  ///< by rung its first triangle, and the number of all
    /// Cost of f_L by cone, place of the edge that arrives and place of the edge that leaves; a turn of the
    /// right boundary costs the same as that of the left one with both places swapped.
    std::vector<double> turn_costs;
    std::vector<std::size_t> turns_of;   ///< by cone, its first turn cost
    std::vector<double> end_costs;       ///< cost of e by cone and place of the edge that arrives
    std::vector<std::size_t> places_of;  ///< by cone, its first end cost

    [[nodiscard]] std::size_t degree(std::size_t cone) const { return graph.incident[cone].size(); }
    [[nodiscard]] double turn_cost(std::size_t cone, bool is_left, std::size_t in, std::size_t out) const {
        const auto [row, column] = is_left ? std::pair(in, out) : std::pair(out, in);
        return turn_costs[turns_of[cone] + row * degree(cone) + column];
    }
    /// The same, and 0 if the boundary has no edge yet.
    [[nodiscard]] double step_cost(std::size_t cone, bool is_left, std::size_t in, std::size_t out) const {
        return in == degree(cone) ? 0.0 : turn_cost(cone, is_left, in, out);
    }
    [[nodiscard]] double end_cost(std::size_t cone, std::size_t in) const {
        return end_costs[places_of[cone] + in];
    }
    /// The other cone of an edge.
    [[nodiscard]] std::size_t other(std::size_t edge, std::size_t cone) const {
        return graph.edges[edge].i == cone ? graph.edges[edge].j : graph.edges[edge].i;
    }
    [[nodiscard]] std::span<const StripTriangle> leaving(std::size_t rung) const {
        return std::span(triangles).subspan(triangles_of[rung], triangles_of[rung + 1] - triangles_of[rung]);
    }
    /// The cone that a triangle enters.
    [[nodiscard]] std::size_t entered(const StripTriangle& triangle) const {
        return rungs[triangle.to].of(triangle.is_left);
    }
};

/// Throws InvalidInput if the scene or the parameters are invalid.
[[nodiscard]] StripProblem make_strip_problem(const Scene& scene, const StripParameters& parameters);

struct LimitedStripProblem {
    std::optional<StripProblem> problem;
    std::optional<StopReason> stopped_by;  ///< without a problem
};
/// The same, or why its construction stopped.
[[nodiscard]] LimitedStripProblem make_strip_problem(const Scene& scene, const StripParameters& parameters,
                                                     const Deadline& deadline);

/// Both boundaries as cone indices from the start on.
struct StripLane {
    std::vector<std::size_t> left;
    std::vector<std::size_t> right;

    bool operator==(const StripLane&) const = default;
};
/// The cheapest strip between two boundaries, as its triangles in order and the whole cost of the lane.
/// Nothing if no strip joins them.
struct StripOfLane {
    std::vector<std::size_t> triangles;
    double cost = 0.0;
};
[[nodiscard]] std::optional<StripOfLane> cheapest_strip(const StripProblem& problem, const StripLane& lane);

[[nodiscard]] LaneGraph lane_graph_of(const StripLane& lane);

}  // namespace conelane
