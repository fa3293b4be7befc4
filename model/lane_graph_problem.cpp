#include "model/lane_graph_problem.hpp"

#include "model/geometry.hpp"
#include "model/shape_costs.hpp"

#include <algorithm>
#include <cmath>

namespace conelane {
namespace {

double fourth_power(double value) {
    const double square = value * value;
    return square * square;
}

/// A value that ties with its limit counts as within it.
bool within(double value, double limit) {
    return value <= limit + kTieTolerance;
}

/// Blue cones bound the lane on its left, yellow ones on its right; orange ones stand on both sides.
double color_cost_of(const Scene& scene, std::size_t i, std::size_t j, bool along_heading) {
    const auto either_is = [&](ConeColor color) {
        return scene.cones[i].color == color || scene.cones[j].color == color;
    };
    const bool blue = either_is(ConeColor::blue);
    const bool yellow = either_is(ConeColor::yellow);
    double cost = blue && yellow ? 1.0 : 0.0;
    if (along_heading) {
        const Point& from = scene.cones[i].position;
        const Point v = scene.cones[j].position - from;
        const double ahead = v.dot(scene.pose.heading());
        const double midpoint_left = scene.pose.left_m(from + 0.5 * v);
        // In a bend the outer boundary crosses the car's axis, and the inner one turns its line on the car.
        const double car_left = std::copysign(1.0, ahead) * cross(v, scene.pose.position - from);
        const bool left_of_car = std::min(midpoint_left, -car_left) > kTieTolerance;
        const bool right_of_car = std::max(midpoint_left, -car_left) < -kTieTolerance;
        if (std::abs(ahead) > kTieTolerance && ((blue && right_of_car) || (yellow && left_of_car)))
            cost += 1.0;
    }
    return cost;
}

ProblemEdge make_problem_edge(const Scene& scene, const Point& heading, const RldParameters& p, std::size_t i,
                              std::size_t j, double length) {
    const Point& from = scene.cones[i].position;
    const Point& to = scene.cones[j].position;
    const Point v = to - from;
    const double across = std::abs(cross(v, heading));
    const Point midpoint = 0.5 * (from + to);
    const double car_distance = std::max((midpoint - scene.pose.position).norm(), kShortestCarDistance_m);
    const double spacing_cost = fourth_power((length - p.d_e) / p.d_t);  // (18)
    const double heading_cost = fourth_power(across / car_distance);     // (25)
    const double acute_angle = std::atan2(across, std::abs(v.dot(heading)));
    const double edge_distance = foot_point(scene.pose.position, {from, to}).distance_m;
    const bool along_heading = within(edge_distance, p.d_h) && within(acute_angle, p.theta_heading);
    const double color_cost = color_cost_of(scene, i, j, along_heading);
    const double benefit =
        p.use_confidence ? p.w_b * scene.cones[i].confidence * scene.cones[j].confidence : p.w_b;
    return {i,
            j,
            spacing_cost,
            heading_cost,
            color_cost,
            0.0,
            p.w_s * spacing_cost + p.w_p * heading_cost + p.w_color * color_cost - benefit,
            along_heading,
            !within(spacing_cost, p.s_crit) || length == 0.0};
}

/// (6)-(8): pairs of edges without a common cone that come closer than d_min, not between their ends; with
/// forbid_crossing those that cross too.
void find_conflicts(const Scene& scene, LaneGraphProblem& problem) {
    struct Disc {
        Point middle;
        double radius;
    };
    std::vector<Disc> discs;
    std::vector<Segment> segments;
    discs.reserve(problem.edges.size());
    segments.reserve(problem.edges.size());
    for (const ProblemEdge& edge : problem.edges) {
        segments.push_back({scene.cones[edge.i].position, scene.cones[edge.j].position});
        const Segment& segment = segments.back();
        discs.push_back({0.5 * (segment.from + segment.to), 0.5 * (segment.to - segment.from).norm()});
    }
    const double d_min = problem.parameters.d_min;
    for (std::size_t e = 0; e < problem.edges.size(); ++e) {
        const ProblemEdge& a = problem.edges[e];
        for (std::size_t other = e + 1; other < problem.edges.size(); ++other) {
            const ProblemEdge& b = problem.edges[other];
            const double reach = discs[e].radius + discs[other].radius + d_min;
            if ((discs[e].middle - discs[other].middle).squaredNorm() > reach * reach) continue;
            if (a.i == b.i || a.i == b.j || a.j == b.i || a.j == b.j) continue;
            const SegmentDistance gap = segment_distance(segments[e], segments[other]);
            const bool crossing =
                problem.parameters.forbid_crossing && segments_cross(segments[e], segments[other]);
            if (crossing || (gap.distance_m < d_min - kTieTolerance && !gap.between_ends)) {
                problem.conflicts.emplace_back(e, other);
            }
        }
    }
}

/// Precondition: all edges are listed.
void add_shape_costs(const Scene& scene, LaneGraphProblem& problem) {
    const RldParameters& p = problem.parameters;
    if (p.w_v > 0.0) {
        const std::vector<double> facing = facing_costs(scene, problem.edges, p);
        for (std::size_t e = 0; e < facing.size(); ++e) problem.edges[e].facing_cost = facing[e];
    }
    problem.near_end_fit.assign(problem.cone_count, 0.0);
    if (p.w_n > 0.0) {
        for (std::size_t i = 0; i < problem.cone_count; ++i) {
            if (problem.near[i]) problem.near_end_fit[i] = near_end_fit(scene, scene.cones[i].position, p);
        }
    }
    for (ProblemEdge& edge : problem.edges) {
        edge.cost +=
            p.w_v * edge.facing_cost - p.w_n * (problem.near_end_fit[edge.i] + problem.near_end_fit[edge.j]);
    }
}

/// Precondition: edges and the fit of near ends are known.
void find_turns(const Scene& scene, LaneGraphProblem& problem) {
    const RldParameters& p = problem.parameters;
    const auto other_end = [&](std::size_t edge, std::size_t cone) {
        const ProblemEdge& e = problem.edges[edge];
        return e.i == cone ? e.j : e.i;
    };
    for (std::size_t middle = 0; middle < problem.cone_count; ++middle) {
        const std::vector<std::size_t>& incident = problem.incident[middle];
        const Point& at = scene.cones[middle].position;
        const double end_cost = 2.0 * p.w_n * problem.near_end_fit[middle];
        for (std::size_t first = 0; first < incident.size(); ++first) {
            for (std::size_t second = first + 1; second < incident.size(); ++second) {
                // Ascending edges at a cone have ascending other ends.
                const Point& before = scene.cones[other_end(incident[first], middle)].position;
                const Point& after = scene.cones[other_end(incident[second], middle)].position;
                const double angle = interior_angle(before, at, after);
                const double angle_cost = fourth_power((angle - p.theta_e) / p.theta_t);  // (20)
                const double uneven =
                    p.w_u > 0.0 ? unevenness((before - at).norm(), (after - at).norm(), p) : 0.0;
                problem.turns.push_back({incident[first], incident[second], middle, angle_cost, uneven,
                                         p.w_t * angle_cost + p.w_u * uneven + end_cost,
                                         !within(angle_cost, p.t_crit)});
            }
        }
    }
}

/// By problem edge. Precondition: the graph's edges are ascending.
std::vector<bool> chosen_edges(const LaneGraphProblem& problem, const LaneGraph& graph) {
    std::vector<bool> chosen(problem.edges.size(), false);
    for (std::size_t e = 0; e < problem.edges.size(); ++e) {
        chosen[e] = std::ranges::binary_search(graph.edges, Edge{problem.edges[e].i, problem.edges[e].j});
    }
    return chosen;
}

}  // namespace

LaneGraphProblem make_problem(const Scene& scene, const RldParameters& parameters, EdgeExtent extent) {
    validate(scene);
    validate(parameters);
    LaneGraphProblem problem;
    const std::size_t n = scene.cones.size();
    problem.cone_count = n;
    problem.parameters = parameters;
    const Point heading = scene.pose.heading();

    problem.near.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
        problem.near[i] = within((scene.cones[i].position - scene.pose.position).norm(), parameters.d_near);
    }
    problem.incident.resize(n);
    if (extent == EdgeExtent::all_pairs) problem.distance_m.assign(n, std::vector<double>(n, 0.0));
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = i + 1; j < n; ++j) {
            const double distance = (scene.cones[j].position - scene.cones[i].position).norm();
            if (!problem.near[i] && !problem.near[j] && !within(distance, parameters.d_max)) {
                problem.far_apart.emplace_back(i, j);
            }
            if (extent == EdgeExtent::all_pairs) {
                problem.distance_m[i][j] = problem.distance_m[j][i] = distance;
            } else if (!within(fourth_power((distance - parameters.d_e) / parameters.d_t),
                               parameters.s_crit) ||
                       distance == 0.0) {
                continue;
            }
            problem.incident[i].push_back(problem.edges.size());
            problem.incident[j].push_back(problem.edges.size());
            problem.edges.push_back(make_problem_edge(scene, heading, parameters, i, j, distance));
        }
    }
    add_shape_costs(scene, problem);
    find_turns(scene, problem);
    find_conflicts(scene, problem);
    return problem;
}

double objective(const LaneGraphProblem& problem, const LaneGraph& graph) {
    const std::vector<bool> chosen = chosen_edges(problem, graph);
    double sum = 0.0;
    for (std::size_t e = 0; e < problem.edges.size(); ++e) {
        if (chosen[e]) sum += problem.edges[e].cost;
    }
    for (const ProblemTurn& turn : problem.turns) {
        if (chosen[turn.edge_i] && chosen[turn.edge_k]) sum += turn.cost;
    }
    return sum;
}

bool is_feasible(const LaneGraphProblem& problem, const LaneGraph& graph) {
    const std::vector<bool> chosen = chosen_edges(problem, graph);
    std::size_t allowed = 0;
    std::size_t along_heading = 0;
    for (std::size_t e = 0; e < problem.edges.size(); ++e) {
        if (!chosen[e]) continue;
        if (!problem.edges[e].high_cost) ++allowed;
        if (problem.edges[e].along_heading) ++along_heading;
    }
    if (allowed != graph.edges.size() || along_heading < 2) return false;
    const auto both_chosen = [&](std::size_t a, std::size_t b) { return chosen[a] && chosen[b]; };
    for (const auto& [first, second] : problem.conflicts) {
        if (both_chosen(first, second)) return false;
    }
    for (const ProblemTurn& turn : problem.turns) {
        if (turn.high_cost && both_chosen(turn.edge_i, turn.edge_k)) return false;
    }
    const auto boundaries = paths(graph, problem.cone_count);
    if (!boundaries || boundaries->size() != 2) return false;
    std::vector<std::size_t> far_ends;
    for (const std::vector<std::size_t>& path : *boundaries) {
        if (problem.parameters.pairing == Pairing::near_far &&
            problem.near[path.front()] == problem.near[path.back()]) {
            return false;
        }
        for (const std::size_t end : {path.front(), path.back()}) {
            if (!problem.near[end]) far_ends.push_back(end);
        }
    }
    std::ranges::sort(far_ends);
    return far_ends.size() == 2 &&
           std::ranges::find(problem.far_apart, std::pair(far_ends[0], far_ends[1])) ==
               problem.far_apart.end();
}

}  // namespace conelane
