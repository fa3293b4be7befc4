#include "conelane/lane_graph_problem.hpp"

#include "model/deadline.hpp"
#include "model/learned_features.hpp"
#include "model/near_edges.hpp"
#include "model/shape_costs.hpp"
#include "model/valid_scene_problem.hpp"

#include <iterator>

namespace conelane {
namespace {

/// In double, a shorter edge may lose its squares, and so its direction [m].
constexpr double kMinEdge_m = 1e-100;

/// More than the rounding error of a distance [m].
constexpr double kMargin_m = 1e-3;

/// Largest number of entries that are reserved before they are counted. A vector that grows copies all its
/// entries, which takes milliseconds without a check of the clock. Reserved memory that is not written to
/// costs nothing.
constexpr std::size_t kReservedEntries = std::size_t{1} << 20U;

/// The limits that may end the construction of a problem early.
class Limits {
  public:
    Limits() = default;
    explicit Limits(const Deadline& deadline) : deadline_(&deadline) {}

    /// Call it before a step with this amount of work, in operations of a few nanoseconds.
    bool stop(const LaneGraphProblem& problem, std::size_t work) {
        if (deadline_ == nullptr || stopped_by_) return stopped_by_.has_value();
        work_ += work;
        if (work_ < kWorkPerClock) return false;
        work_ = 0;
        if (is_too_large(problem)) {
            stopped_by_ = StopReason::memory;
        } else if (deadline_->passed()) {
            stopped_by_ = StopReason::time;
        }
        return stopped_by_.has_value();
    }
    /// The same, but the limits are checked at once.
    bool stop(const LaneGraphProblem& problem) { return stop(problem, kWorkPerClock); }

    /// Whether all pairs of so many cones are more edges than a problem may have.
    bool stop_for_table(std::size_t cones) {
        if (deadline_ != nullptr && cones > 1 && cones * (cones - 1) / 2 > kMaxProblemEdges)
            stopped_by_ = StopReason::memory;
        return stopped_by_.has_value();
    }

    [[nodiscard]] std::optional<StopReason> stopped_by() const { return stopped_by_; }

  private:
    static constexpr std::size_t kWorkPerClock = 20'000;

    const Deadline* deadline_ = nullptr;
    std::size_t work_ = 0;
    std::optional<StopReason> stopped_by_;
};

double fourth_power(double value) {
    const double square = value * value;
    return square * square;
}

/// A value that ties with its limit counts as within it.
bool within(double value, double limit) {
    return value <= limit + kTieTolerance;
}

/// Blue cones bound the lane on its left, yellow ones on its right; orange ones stand on both sides. The
/// colors of the two cones are independent.
double color_cost_of(const Scene& scene, std::size_t i, std::size_t j, bool along_heading) {
    const ColorProbabilities a = scene.cones[i].probabilities();
    const ColorProbabilities b = scene.cones[j].probabilities();
    const double blue = a.blue + b.blue - a.blue * b.blue;  // probability that one is blue
    const double yellow = a.yellow + b.yellow - a.yellow * b.yellow;
    double cost = a.blue * b.yellow + a.yellow * b.blue;
    if (along_heading && (blue > 0.0 || yellow > 0.0)) {
        const Point& from = scene.cones[i].position;
        const Point v = scene.cones[j].position - from;
        const double ahead = v.dot(scene.pose.heading());
        const double midpoint_left = scene.pose.left_m(from + 0.5 * v);
        // Two tests of the side: in a bend, each of them alone is wrong for one of the two boundaries.
        const double car_left = std::copysign(1.0, ahead) * cross(v, scene.pose.position - from);
        const bool left_of_car = std::min(midpoint_left, -car_left) > kTieTolerance;
        const bool right_of_car = std::max(midpoint_left, -car_left) < -kTieTolerance;
        if (std::abs(ahead) > kTieTolerance) cost += right_of_car ? blue : left_of_car ? yellow : 0.0;
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
    const double midpoint_distance = (midpoint - scene.pose.position).norm();
    const double car_distance = std::max(midpoint_distance, kMinCarDistance_m);
    const double spacing_cost = fourth_power((length - p.d_e) / p.d_t);  // (18)
    const double heading_cost = fourth_power(across / car_distance);     // (25)
    const auto acute_angle = [&] { return std::atan2(across, std::abs(v.dot(heading))); };
    // No point of the edge is nearer to the car than this: midpoint distance minus half the length.
    const bool is_away = midpoint_distance - 0.5 * length > p.d_h + kMargin_m;
    const bool along_heading = !is_away &&
                               within(foot_point(scene.pose.position, {from, to}).distance_m, p.d_h) &&
                               within(acute_angle(), p.theta_heading);
    const double color_cost = color_cost_of(scene, i, j, along_heading);
    const double benefit =
        p.use_confidence ? p.w_b * scene.cones[i].confidence * scene.cones[j].confidence : p.w_b;
    return {.i = i,
            .j = j,
            .spacing_cost = spacing_cost,
            .heading_cost = heading_cost,
            .color_cost = color_cost,
            .facing_cost = 0.0,
            .cost = p.w_s * spacing_cost + p.w_p * heading_cost + p.w_color * color_cost - benefit,
            .along_heading = along_heading,
            .high_cost = !within(spacing_cost, p.s_crit) || length < kMinEdge_m};
}

double longest_edge_m(const RldParameters& p) {
    return p.d_e + p.d_t * std::sqrt(std::sqrt(p.s_crit + kTieTolerance));
}

/// Excludes the edges that k_edge excludes. Precondition: all edges within s_crit are listed, and no gaps.
void keep_nearest(const Scene& scene, EdgeExtent extent, LaneGraphProblem& problem, Limits& limits) {
    const RldParameters& p = problem.parameters;
    if (!(p.nearest_of_edge > 0.0) || limits.stop(problem, problem.cone_count * problem.cone_count)) return;
    const std::vector<double> reach_m = reach_of_nearest(scene, p.nearest_of_edge, longest_edge_m(p));
    const auto is_excluded = [&](const ProblemEdge& edge) {
        const double length_m = (scene.cones[edge.j].position - scene.cones[edge.i].position).norm();
        return !within(length_m, reach_m[edge.i]) && !within(length_m, reach_m[edge.j]);
    };
    if (extent == EdgeExtent::candidates) {
        std::erase_if(problem.edges, is_excluded);
        return;
    }
    for (ProblemEdge& edge : problem.edges) edge.high_cost = edge.high_cost || is_excluded(edge);
}

/// Whether three cones bend by at most theta_gap at the middle one.
bool is_straight(const Scene& scene, std::size_t before, std::size_t middle, std::size_t after,
                 const RldParameters& p) {
    const double angle = interior_angle(scene.cones[before].position, scene.cones[middle].position,
                                        scene.cones[after].position);
    return within(std::numbers::pi - angle, p.theta_gap);
}

/// Whether no other cone stands on an edge: nearer to its line than d_clear, and farther from both ends,
/// along the line, than that.
bool is_clear(const Scene& scene, std::size_t i, std::size_t j, std::span<const std::size_t> near_i,
              const RldParameters& p) {
    const Point& from = scene.cones[i].position;
    const Point v = scene.cones[j].position - from;
    const double length = v.norm();
    return std::ranges::none_of(near_i, [&](std::size_t cone) {
        const Point way = scene.cones[cone].position - from;
        const double along = way.dot(v) / length;
        return std::abs(cross(v, way)) / length < p.d_clear - kTieTolerance &&
               std::min(along, length - along) > p.d_clear + kTieTolerance;
    });
}

/// Edges over gaps: longer than s_crit allows, at most d_gap, among the k_gap nearest, no cone stands on
/// them, and at one end or both an edge within s_crit continues nearly straight. Precondition: all edges
/// within s_crit are listed, and no gaps.
std::vector<ProblemEdge> find_gaps(const Scene& scene, const Point& heading, const LaneGraphProblem& problem,
                                   Limits& limits) {
    const RldParameters& p = problem.parameters;
    const std::size_t n = problem.cone_count;
    std::vector<ProblemEdge> gaps;
    if (p.d_gap <= p.d_e || limits.stop(problem, n * n)) return gaps;
    const std::vector<double> reach_m = reach_of_nearest(scene, p.nearest_of_gap, p.d_gap);
    std::vector<std::vector<std::size_t>> next(n);
    for (const ProblemEdge& edge : problem.edges) {
        if (edge.high_cost) continue;
        next[edge.i].push_back(edge.j);
        next[edge.j].push_back(edge.i);
    }
    const auto goes_on = [&](std::size_t from, std::size_t to) {
        return std::ranges::any_of(next[to],
                                   [&](std::size_t on) { return is_straight(scene, from, to, on, p); });
    };
    std::vector<std::size_t> near_i;  // what stands on an edge is nearer than its other end
    for (std::size_t i = 0; i < n; ++i) {
        if (limits.stop(problem, 10 * n)) return gaps;
        near_i.clear();
        for (std::size_t cone = 0; p.d_clear > 0.0 && cone < n; ++cone) {
            const double distance = (scene.cones[cone].position - scene.cones[i].position).norm();
            if (distance > 0.0 && within(distance, p.d_gap)) near_i.push_back(cone);
        }
        for (std::size_t j = i + 1; j < n; ++j) {
            const double distance = (scene.cones[j].position - scene.cones[i].position).norm();
            if (!within(distance, p.d_gap) || distance <= p.d_e ||
                within(fourth_power((distance - p.d_e) / p.d_t), p.s_crit) ||
                (!within(distance, reach_m[i]) && !within(distance, reach_m[j])))
                continue;
            if (limits.stop(problem, near_i.size())) return gaps;
            if (!is_clear(scene, i, j, near_i, p) || (!goes_on(i, j) && !goes_on(j, i))) continue;
            ProblemEdge edge = make_problem_edge(scene, heading, p, i, j, distance);
            edge.high_cost = false;
            edge.gap = true;
            gaps.push_back(edge);
        }
    }
    return gaps;
}

void add_gaps(std::span<const ProblemEdge> gaps, EdgeExtent extent, LaneGraphProblem& problem) {
    const auto cones = [](const ProblemEdge& edge) { return std::pair(edge.i, edge.j); };
    if (extent == EdgeExtent::all_pairs) {  // every pair is listed
        for (const ProblemEdge& gap : gaps)
            *std::ranges::lower_bound(problem.edges, cones(gap), {}, cones) = gap;
        return;
    }
    std::vector<ProblemEdge> all;
    all.reserve(problem.edges.size() + gaps.size());
    std::ranges::merge(problem.edges, gaps, std::back_inserter(all), {}, cones, cones);
    problem.edges = std::move(all);
}

/// (6)-(8): pairs of edges without a common cone that come closer than d_min, but not between two ends. With
/// forbid_crossing also pairs that cross.
void find_conflicts(const Scene& scene, LaneGraphProblem& problem, Limits& limits) {
    const std::vector<ProblemEdge>& edges = problem.edges;
    const double too_close_m = problem.parameters.d_min - kTieTolerance;
    if (too_close_m <= 0.0 && !problem.parameters.forbid_crossing) return;
    std::vector<MeasuredSegment> segments;
    segments.reserve(edges.size());
    for (const ProblemEdge& edge : edges) {
        segments.emplace_back(scene.cones[edge.i].position, scene.cones[edge.j].position);
    }
    NearEdges near_edges(scene, edges, too_close_m);
    problem.conflicts.reserve(std::min(edges.size() * edges.size() / 8, kReservedEntries));
    for (std::size_t e = 0; e < edges.size(); ++e) {
        if (limits.stop(problem, edges.size() - e)) return;
        const MeasuredSegment& a = segments[e];
        const std::size_t conflicts_before = problem.conflicts.size();
        for (const std::size_t other : near_edges.after(e)) {
            const MeasuredSegment& b = segments[other];
            const bool crossing =
                problem.parameters.forbid_crossing && segments_cross({a.from, a.to}, {b.from, b.to});
            if (crossing || come_closer(a, b, too_close_m)) problem.conflicts.emplace_back(e, other);
        }
        if (limits.stop(problem, 10 * (problem.conflicts.size() - conflicts_before))) return;
    }
}

/// Precondition: all edges are listed.
void add_shape_costs(const Scene& scene, LaneGraphProblem& problem, Limits& limits) {
    const RldParameters& p = problem.parameters;
    if (p.facing_weight > 0.0 || p.learned_costs) {
        const auto stop = [&](std::size_t pairs) { return limits.stop(problem, 4 * pairs); };
        const std::vector<double> facing = facing_costs(scene, problem.edges, problem.facers, p, stop);
        if (limits.stopped_by()) return;
        for (std::size_t e = 0; e < facing.size(); ++e) problem.edges[e].facing_cost = facing[e];
    }
    problem.near_end_fit.assign(problem.cone_count, 0.0);
    if (p.near_end_weight > 0.0) {
        for (std::size_t i = 0; i < problem.cone_count; ++i) {
            if (problem.near[i]) problem.near_end_fit[i] = near_end_fit(scene, scene.cones[i].position, p);
        }
    }
    for (ProblemEdge& edge : problem.edges) {
        edge.cost += p.facing_weight * edge.facing_cost -
                     p.near_end_weight * (problem.near_end_fit[edge.i] + problem.near_end_fit[edge.j]);
    }
}

/// Adds the learned costs of edges and ends. Precondition: all edges are listed, with their shape costs.
void add_learned_costs(const LearnedFeatures& features, LaneGraphProblem& problem, Limits& limits) {
    const LearnedCosts& costs = *problem.parameters.learned_costs;
    for (std::size_t i = 0; i < problem.cone_count; ++i) {
        const double cost = problem.near[i] ? costs.of(LearnedPart::near_end)(features.near_end(i))
                                            : costs.of(LearnedPart::far_end)(features.far_end(i));
        problem.learned_end_cost[i] = std::min(0.0, cost);
    }
    for (std::size_t e = 0; e < problem.edges.size(); ++e) {
        if (limits.stop(problem, 100 + 2 * problem.cone_count)) return;
        ProblemEdge& edge = problem.edges[e];
        if (!edge.high_cost) edge.learned_cost = costs.of(LearnedPart::edge)(features.edge(e));
        edge.cost += edge.learned_cost + problem.learned_end_cost[edge.i] + problem.learned_end_cost[edge.j];
    }
}

/// Precondition: the costs of edges and ends are known. `features`: null without learned costs.
void find_turns(const Scene& scene, const LearnedFeatures* features, LaneGraphProblem& problem,
                Limits& limits) {
    const RldParameters& p = problem.parameters;
    const auto other_end = [&](std::size_t edge, std::size_t cone) {
        const ProblemEdge& e = problem.edges[edge];
        return e.i == cone ? e.j : e.i;
    };
    std::size_t turns = 0;
    for (const std::vector<std::size_t>& incident : problem.incident)
        turns += incident.empty() ? 0 : incident.size() * (incident.size() - 1) / 2;
    problem.turns.reserve(std::min(turns, kMaxProblemEntries));
    for (std::size_t middle = 0; middle < problem.cone_count; ++middle) {
        const std::vector<std::size_t>& incident = problem.incident[middle];
        const Point& at = scene.cones[middle].position;
        const double end_cost =
            2.0 * p.near_end_weight * problem.near_end_fit[middle] - 2.0 * problem.learned_end_cost[middle];
        for (std::size_t first = 0; first < incident.size(); ++first) {
            const std::size_t work = features != nullptr ? 200 : 20;
            if (limits.stop(problem, work * (incident.size() - first))) return;
            for (std::size_t second = first + 1; second < incident.size(); ++second) {
                // Edges at a cone are sorted, so their other ends are sorted too.
                const Point& before = scene.cones[other_end(incident[first], middle)].position;
                const Point& after = scene.cones[other_end(incident[second], middle)].position;
                const double angle = interior_angle(before, at, after);
                const double angle_cost = fourth_power((angle - p.theta_e) / p.theta_t);  // (20)
                const double uneven = p.unevenness_weight > 0.0
                                          ? unevenness((before - at).norm(), (after - at).norm(), p)
                                          : 0.0;
                const ProblemEdge& e = problem.edges[incident[first]];
                const ProblemEdge& f = problem.edges[incident[second]];
                const bool too_sharp = !within(angle_cost, p.t_crit) ||
                                       ((e.gap || f.gap) && !within(std::numbers::pi - angle, p.theta_gap));
                double learned = 0.0;
                if (features != nullptr && !too_sharp && !e.high_cost && !f.high_cost) {
                    learned = std::max(0.0, p.learned_costs->of(LearnedPart::turn)(features->turn(
                                                incident[first], incident[second], middle, angle_cost)));
                }
                problem.turns.push_back(
                    {.edge_i = incident[first],
                     .edge_k = incident[second],
                     .middle = middle,
                     .angle_cost = angle_cost,
                     .unevenness = uneven,
                     .cost = p.w_t * angle_cost + p.unevenness_weight * uneven + end_cost + learned,
                     .high_cost = too_sharp,
                     .learned_cost = learned});
            }
        }
    }
}

/// Result by problem edge. Precondition: the edges of the graph are in ascending order, like the problem's.
std::vector<char> chosen_edges(const LaneGraphProblem& problem, const LaneGraph& graph) {
    std::vector<char> chosen(problem.edges.size(), 0);
    auto next = graph.edges.begin();
    for (std::size_t e = 0; e < problem.edges.size(); ++e) {
        const Edge edge{problem.edges[e].i, problem.edges[e].j};
        while (next != graph.edges.end() && *next < edge) ++next;
        if (next != graph.edges.end() && *next == edge) chosen[e] = 1;
    }
    return chosen;
}

void find_edges(const Scene& scene, EdgeExtent extent, LaneGraphProblem& problem, Limits& limits) {
    const RldParameters& parameters = problem.parameters;
    const std::size_t n = problem.cone_count;
    const Point heading = scene.pose.heading();
    if (extent == EdgeExtent::all_pairs) problem.distance_m.assign(n, std::vector<double>(n, 0.0));
    problem.edges.reserve(std::min(4 * n, kReservedEntries));
    problem.far_apart.reserve(std::min(n * n / 2, kReservedEntries));
    // Longer pairs are too long for (27) and (17). Most pairs are longer.
    const double longest = kMargin_m + std::max(parameters.d_max, longest_edge_m(parameters));
    for (std::size_t i = 0; i < n; ++i) {
        if (limits.stop(problem, 2 * (n - i))) return;
        const bool is_far = !problem.near[i];
        const std::size_t edges_before = problem.edges.size();
        for (std::size_t j = i + 1; j < n; ++j) {
            const double squared_distance = (scene.cones[j].position - scene.cones[i].position).squaredNorm();
            const bool both_are_far = is_far && !problem.near[j];
            if (squared_distance > longest * longest && extent == EdgeExtent::candidates) {
                if (both_are_far) problem.far_apart.emplace_back(i, j);
                continue;
            }
            const double distance = std::sqrt(squared_distance);
            if (both_are_far && !within(distance, parameters.d_max)) problem.far_apart.emplace_back(i, j);
            if (extent == EdgeExtent::all_pairs) {
                problem.distance_m[i][j] = problem.distance_m[j][i] = distance;
            } else if (!within(fourth_power((distance - parameters.d_e) / parameters.d_t),
                               parameters.s_crit) ||
                       distance < kMinEdge_m) {
                continue;
            }
            problem.edges.push_back(make_problem_edge(scene, heading, parameters, i, j, distance));
        }
        if (limits.stop(problem, 50 * (problem.edges.size() - edges_before))) return;
    }
}

/// Precondition: all edges are listed.
void find_incident(LaneGraphProblem& problem) {
    std::vector<std::size_t> count(problem.cone_count, 0);
    for (const ProblemEdge& edge : problem.edges) {
        ++count[edge.i];
        ++count[edge.j];
    }
    problem.incident.resize(problem.cone_count);
    for (std::size_t i = 0; i < problem.cone_count; ++i) problem.incident[i].reserve(count[i]);
    for (std::size_t e = 0; e < problem.edges.size(); ++e) {
        problem.incident[problem.edges[e].i].push_back(e);
        problem.incident[problem.edges[e].j].push_back(e);
    }
}

/// Farther than this from the origin, a sum of coordinates loses the difference between two cones; a
/// difference of coordinates does not. Nearer, this error of a problem's numbers is below 1e-9 [m].
constexpr double kFarFromOrigin_m = 1e5;

bool is_far_from_origin(const Scene& scene) {
    return scene.pose.position.cwiseAbs().maxCoeff() > kFarFromOrigin_m;
}

/// The same scene with the car at the origin. Throws InvalidInput if a difference of two finite coordinates
/// is not finite.
Scene seen_from_car(const Scene& scene) {
    Scene seen = scene;
    for (Cone& cone : seen.cones) cone.position -= scene.pose.position;
    seen.pose.position = {0.0, 0.0};
    validate(seen);
    return seen;
}

LaneGraphProblem problem_of_valid(const Scene& scene, const RldParameters& parameters, EdgeExtent extent,
                                  Limits& limits, bool edges_alone) {
    if (is_far_from_origin(scene))
        return problem_of_valid(seen_from_car(scene), parameters, extent, limits, edges_alone);
    LaneGraphProblem problem;
    const std::size_t n = scene.cones.size();
    // The table of distances is allocated in one step, so its size is checked first.
    if (limits.stop(problem) || (extent == EdgeExtent::all_pairs && limits.stop_for_table(n))) return problem;
    problem.cone_count = n;
    problem.parameters = parameters;
    problem.near.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
        const Point& cone = scene.cones[i].position;
        const double aside_m = std::abs(scene.pose.left_m(cone));
        problem.near[i] = within((cone - scene.pose.position).norm(), parameters.d_near) &&
                          (parameters.d_side == 0.0 || within(aside_m, parameters.d_side));
    }
    find_edges(scene, extent, problem, limits);
    const std::vector<ProblemEdge> gaps = find_gaps(scene, scene.pose.heading(), problem, limits);
    if (limits.stop(problem)) return problem;
    if (parameters.facing_weight > 0.0 || parameters.learned_costs) {
        for (const ProblemEdge& edge : problem.edges) {
            if (!edge.high_cost) problem.facers.push_back({edge.i, edge.j});
        }
    }
    keep_nearest(scene, extent, problem, limits);
    add_gaps(gaps, extent, problem);
    if (limits.stop(problem)) return problem;
    find_incident(problem);
    if (edges_alone) return problem;
    add_shape_costs(scene, problem, limits);
    problem.learned_end_cost.assign(n, 0.0);
    std::optional<LearnedFeatures> features;
    if (parameters.learned_costs && !limits.stop(problem)) {
        features.emplace(scene, problem, [&](std::size_t work) { return limits.stop(problem, work); });
        if (!limits.stop(problem)) add_learned_costs(*features, problem, limits);
    }
    if (!limits.stop(problem)) find_turns(scene, features ? &*features : nullptr, problem, limits);
    if (!limits.stop(problem)) find_conflicts(scene, problem, limits);
    limits.stop(problem);
    return problem;
}

LimitedProblem limited_problem(const Scene& scene, const RldParameters& parameters, EdgeExtent extent,
                               const Deadline& deadline, bool edges_alone) {
    validate(parameters);
    Limits limits(deadline);
    LaneGraphProblem problem = problem_of_valid(scene, parameters, extent, limits, edges_alone);
    if (limits.stopped_by()) return {std::nullopt, limits.stopped_by()};
    return {std::move(problem), std::nullopt};
}

}  // namespace

std::vector<double> reach_of_nearest(const Scene& scene, double k, double max_m,
                                     const std::function<bool()>& stop) {
    const std::size_t n = scene.cones.size();
    std::vector<double> reach_m(n, std::numeric_limits<double>::infinity());
    if (!(k > 0.0)) return reach_m;
    const auto rank = static_cast<std::size_t>(std::ceil(k));
    const double longest_m = max_m + kMargin_m;
    std::vector<double> distance_m;
    for (std::size_t i = 0; i < n && !(stop && stop()); ++i) {
        distance_m.clear();
        for (std::size_t j = 0; j < n; ++j) {
            const double squared = (scene.cones[j].position - scene.cones[i].position).squaredNorm();
            if (j != i && squared <= longest_m * longest_m) distance_m.push_back(std::sqrt(squared));
        }
        if (distance_m.size() < rank) continue;
        const auto nth = distance_m.begin() + static_cast<std::ptrdiff_t>(rank - 1);
        std::ranges::nth_element(distance_m, nth);
        reach_m[i] = *nth;
    }
    return reach_m;
}

LaneGraphProblem make_problem(const Scene& scene, const RldParameters& parameters, EdgeExtent extent) {
    validate(scene);
    validate(parameters);
    Limits none;
    return problem_of_valid(scene, parameters, extent, none, false);
}

LimitedProblem make_problem(const Scene& scene, const RldParameters& parameters, EdgeExtent extent,
                            const Deadline& deadline) {
    validate(scene);
    return make_problem_of_valid_scene(scene, parameters, extent, deadline);
}

LimitedProblem make_problem_of_valid_scene(const Scene& scene, const RldParameters& parameters,
                                           EdgeExtent extent, const Deadline& deadline) {
    return limited_problem(scene, parameters, extent, deadline, false);
}

LimitedProblem make_edges_of_valid_scene(const Scene& scene, const RldParameters& parameters,
                                         const Deadline& deadline) {
    return limited_problem(scene, parameters, EdgeExtent::candidates, deadline, true);
}

bool is_too_large(const LaneGraphProblem& problem) {
    return problem.edges.size() > kMaxProblemEdges ||
           problem.turns.size() + problem.conflicts.size() + problem.far_apart.size() > kMaxProblemEntries;
}

double objective(const LaneGraphProblem& problem, const LaneGraph& graph) {
    const std::vector<char> chosen = chosen_edges(problem, graph);
    double sum = 0.0;
    for (std::size_t e = 0; e < problem.edges.size(); ++e) {
        if (chosen[e] != 0) sum += problem.edges[e].cost;
    }
    for (const ProblemTurn& turn : problem.turns) {
        if (chosen[turn.edge_i] != 0 && chosen[turn.edge_k] != 0) sum += turn.cost;
    }
    return sum;
}

bool is_feasible(const LaneGraphProblem& problem, const LaneGraph& graph) {
    const std::vector<char> chosen = chosen_edges(problem, graph);
    std::size_t allowed = 0;
    std::size_t along_heading = 0;
    for (std::size_t e = 0; e < problem.edges.size(); ++e) {
        if (chosen[e] == 0) continue;
        if (!problem.edges[e].high_cost) ++allowed;
        if (problem.edges[e].along_heading) ++along_heading;
    }
    if (allowed != graph.edges.size() || along_heading < 2) return false;
    const auto both_chosen = [&](std::size_t a, std::size_t b) { return chosen[a] != 0 && chosen[b] != 0; };
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
