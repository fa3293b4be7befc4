#include "model/strip_problem.hpp"

#include "conelane/invalid_input.hpp"
#include "model/deadline.hpp"
#include "model/geometry.hpp"
#include "model/strip_features.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace conelane {
namespace {

constexpr std::size_t kMaxRungs = 200'000;
constexpr std::size_t kMaxTriangles = 2'000'000;

class Builder {
  public:
    Builder(const Scene& scene, StripProblem& problem, const Deadline& deadline)
        : scene_(scene),
          problem_(problem),
          deadline_(deadline),
          costs_(problem.parameters.costs.get()),
          features_(scene, problem.graph, problem.reach_m = longest_m()) {}

    /// Why it stopped.
    std::optional<StopReason> build() {
        number_places();
        add_rungs();
        if (problem_.rungs.size() > kMaxRungs) return StopReason::memory;
        add_triangles();
        if (problem_.triangles.size() > kMaxTriangles) return StopReason::memory;
        if (!stopped_) add_turns();
        if (!stopped_) add_ends();
        return stopped_ ? std::optional(StopReason::time) : std::nullopt;
    }

  private:
    [[nodiscard]] double longest_m() const {
        double squared = square(problem_.parameters.w_max_m);
        for (const ProblemEdge& edge : problem_.graph.edges)
            squared = std::max(squared,
                               (scene_.cones[edge.j].position - scene_.cones[edge.i].position).squaredNorm());
        return std::sqrt(squared);
    }
    static double square(double value) { return value * value; }

    template <typename Features>
    [[nodiscard]] double learned(StripPart part, const Features& features) const {
        return costs_->of(part)(features);
    }
    /// Checked before a step of about a microsecond.
    bool stop() {
        constexpr int kStepsPerClock = 64;
        if (!stopped_ && ++steps_ % kStepsPerClock == 0) stopped_ = deadline_.passed();
        return stopped_;
    }

    void number_places() {
        const LaneGraphProblem& graph = problem_.graph;
        place_.resize(graph.edges.size());
        for (std::size_t cone = 0; cone < graph.cone_count; ++cone) {
            const auto& incident = graph.incident[cone];
            problem_.places_of.push_back(places_);
            problem_.turns_of.push_back(turns_);
            places_ += incident.size();
            turns_ += incident.size() * incident.size();
            for (std::size_t place = 0; place < incident.size(); ++place)
                place_[incident[place]][graph.edges[incident[place]].i == cone ? 0 : 1] =
                    static_cast<std::uint16_t>(place);
        }
    }
    [[nodiscard]] std::uint16_t place(std::size_t edge, std::size_t cone) const {
        return place_[edge][problem_.graph.edges[edge].j == cone ? 1 : 0];
    }

    void add_rungs() {
        const StripParameters& p = problem_.parameters;
        const std::size_t n = problem_.graph.cone_count;
        const Point heading = scene_.pose.heading();
        rung_.assign(n * n, -1);
        across_.resize(n);
        for (std::size_t l = 0; l < n && !stop(); ++l) {
            for (std::size_t r = 0; r < n; ++r) {
                const double squared = (features_.at(l) - features_.at(r)).squaredNorm();
                if (l == r || squared > square(p.w_max_m + kTieTolerance) ||
                    squared < square(std::max(0.0, p.w_min_m - kTieTolerance)))
                    continue;
                const bool may_start = problem_.graph.near[l] && problem_.graph.near[r] &&
                                       cross(heading, features_.at(l) - features_.at(r)) > 0.0;
                rung_[l * n + r] = static_cast<std::int32_t>(problem_.rungs.size());
                across_[l].push_back(r);
                problem_.rungs.push_back({.left = l,
                                          .right = r,
                                          .may_start = may_start,
                                          .may_end = is_far(l) && is_far(r),
                                          .start_cost = may_start && costs_ != nullptr
                                                            ? learned(StripPart::start, features_.start(l, r))
                                                            : 0.0});
            }
        }
    }
    [[nodiscard]] bool is_far(std::size_t cone) const {
        const double end_m = problem_.parameters.d_end_m;
        return end_m == 0.0 || features_.at(cone).norm() > end_m + kTieTolerance;
    }
    [[nodiscard]] std::int32_t rung(std::size_t left, std::size_t right) const {
        return rung_[left * problem_.graph.cone_count + right];
    }

    void add_triangles() {
        for (std::size_t e = 0; e < problem_.graph.edges.size() && !stop(); ++e) {
            const ProblemEdge& edge = problem_.graph.edges[e];
            if (edge.high_cost) continue;
            const double edge_cost =
                costs_ != nullptr ? learned(StripPart::edge, features_.edge(edge.i, edge.j)) : edge.cost;
            for (const std::size_t across : across_[edge.i]) {
                const double side = cross(features_.at(edge.j) - features_.at(edge.i),
                                          features_.at(across) - features_.at(edge.i));
                if (rung(edge.j, across) < 0 || side == 0.0) continue;
                const double inside = costs_ != nullptr ? features_.inside_of(across, edge.i, edge.j) : 0.0;
                // With `across` to the right of the edge i, j, a left boundary goes from i to j, and a right
                // one from j to i.
                add_triangle(e, edge.i, edge.j, across, side < 0.0, inside, edge_cost);
                add_triangle(e, edge.j, edge.i, across, side > 0.0, inside, edge_cost);
            }
        }
        sort_triangles();
    }
    void add_triangle(std::size_t edge, std::size_t from, std::size_t to, std::size_t across, bool is_left,
                      double inside, double edge_cost) {
        const auto number = [&](std::size_t cone) {
            return static_cast<std::uint32_t>(is_left ? rung(cone, across) : rung(across, cone));
        };
        const double cost = costs_ != nullptr
                                ? learned(StripPart::triangle, features_.triangle(from, to, across, inside))
                                : 0.0;
        problem_.triangles.push_back({.from = number(from),
                                      .to = number(to),
                                      .edge = static_cast<std::uint32_t>(edge),
                                      .out = place(edge, from),
                                      .in = place(edge, to),
                                      .is_left = is_left,
                                      .cost = edge_cost + cost});
    }
    void sort_triangles() {
        std::vector<std::uint32_t>& first = problem_.triangles_of;
        first.assign(problem_.rungs.size() + 1, 0);
        for (const StripTriangle& triangle : problem_.triangles) ++first[triangle.from + 1];
        for (std::size_t k = 1; k < first.size(); ++k) first[k] += first[k - 1];
        std::vector<StripTriangle> sorted(problem_.triangles.size());
        std::vector<std::uint32_t> next = first;
        for (const StripTriangle& triangle : problem_.triangles) sorted[next[triangle.from]++] = triangle;
        problem_.triangles = std::move(sorted);
    }

    void add_turns() {
        problem_.turn_costs.assign(turns_, StripProblem::kForbidden);
        for (const ProblemTurn& turn : problem_.graph.turns) {
            if (turn.high_cost) continue;
            if (stop()) return;
            const std::size_t i = problem_.other(turn.edge_i, turn.middle);
            const std::size_t k = problem_.other(turn.edge_k, turn.middle);
            double* const costs = problem_.turn_costs.data() + problem_.turns_of[turn.middle];
            const std::size_t a = place(turn.edge_i, turn.middle);
            const std::size_t b = place(turn.edge_k, turn.middle);
            const std::size_t degree = problem_.degree(turn.middle);
            costs[a * degree + b] = costs[b * degree + a] = turn.cost;
            if (costs_ == nullptr) continue;
            // The lane is to the right of the left boundary.
            const bool bends_right = cross(features_.at(turn.middle) - features_.at(i),
                                           features_.at(k) - features_.at(turn.middle)) < 0.0;
            const auto inner = features_.turn(i, turn.middle, k, true);
            auto outer = inner;
            outer[kStripInnerFeature] = 0.0;
            costs[a * degree + b] = learned(StripPart::turn, bends_right ? inner : outer);
            costs[b * degree + a] = learned(StripPart::turn, bends_right ? outer : inner);
        }
    }

    void add_ends() {
        problem_.end_costs.assign(places_, 0.0);
        if (costs_ == nullptr) return;
        for (std::size_t cone = 0; cone < problem_.graph.cone_count && !stop(); ++cone) {
            for (std::size_t place = 0; place < problem_.degree(cone); ++place)
                problem_.end_costs[problem_.places_of[cone] + place] =
                    learned(StripPart::end,
                            features_.end(problem_.other(problem_.graph.incident[cone][place], cone), cone));
        }
    }

    const Scene& scene_;
    StripProblem& problem_;
    const Deadline& deadline_;
    const StripCosts* costs_;
    StripFeatures features_;
    std::vector<std::array<std::uint16_t, 2>> place_;  ///< by edge, at its first and at its second cone
    std::vector<std::int32_t> rung_;                   ///< by left and right cone; -1: none
    std::vector<std::vector<std::size_t>> across_;     ///< by cone those with which it has a rung
    std::size_t places_ = 0;
    std::size_t turns_ = 0;
    int steps_ = 0;
    bool stopped_ = false;
};

}  // namespace

void validate(const StripParameters& p) {
    validate(p.gates);
    const auto require = [](bool is_valid, const char* key, const char* what) {
        if (!is_valid) throw InvalidInput(key, what);
    };
    require(p.w_min_m >= 0.0 && p.w_min_m < 100.0, "w_min_m", "must be at least 0 and below 100");
    require(p.w_max_m > p.w_min_m && p.w_max_m <= 100.0, "w_max_m", "must be above w_min_m, at most 100");
    require(p.d_end_m >= 0.0 && p.d_end_m <= 1000.0, "d_end_m", "must be between 0 and 1000");
    if (p.costs) validate(*p.costs);
}

StripParameters driving_strip_parameters() {
    StripParameters p;
    p.gates.d_e = 2.8;
    p.gates.d_t = 1.7;
    p.gates.s_crit = 7.0;
    p.gates.theta_t = 0.9;
    p.gates.t_crit = 12.0;
    p.gates.d_min = 0.0;
    p.gates.d_near = 9.0;
    p.gates.d_side = 4.5;
    p.gates.d_gap = 11.0;
    p.gates.theta_gap = 1.3;
    p.gates.d_clear = 0.3;
    p.gates.nearest_of_edge = 8.0;
    p.gates.nearest_of_gap = 16.0;
    p.w_max_m = 8.5;
    p.costs = std::make_shared<const StripCosts>(hand_set_strip_costs());
    return p;
}

StripParameters strip_parameters_of(const RldParameters& parameters) {
    StripParameters p{.gates = parameters, .w_min_m = 0.0, .w_max_m = parameters.d_max};
    p.d_end_m = parameters.d_near;
    return p;
}

LimitedStripProblem make_strip_problem(const Scene& scene, const StripParameters& parameters,
                                       const Deadline& deadline) {
    validate(parameters);
    RldParameters gates = parameters.gates;
    gates.d_min = 0.0;  // (6)-(8) are no rows of this program
    gates.forbid_crossing = false;
    LimitedProblem graph = make_problem(scene, gates, EdgeExtent::candidates, deadline);
    if (!graph.problem) return {std::nullopt, graph.stopped_by};
    StripProblem problem;
    problem.parameters = parameters;
    problem.graph = *std::move(graph.problem);
    if (const auto stopped_by = Builder(scene, problem, deadline).build()) return {std::nullopt, stopped_by};
    return {std::move(problem), std::nullopt};
}

StripProblem make_strip_problem(const Scene& scene, const StripParameters& parameters) {
    LimitedStripProblem made = make_strip_problem(scene, parameters, Deadline());
    if (!made.problem) throw InvalidInput("scene", "has too many cones for a strip program");
    return *std::move(made.problem);
}

namespace {

/// What is the same for each strip between the boundaries: turns and ends. Nothing if an edge is not allowed.
std::optional<double> cost_of_boundaries(const StripProblem& problem, const StripLane& lane) {
    double cost = 0.0;
    for (const auto* side : {&lane.left, &lane.right}) {
        const auto place = [&](std::size_t cone, std::size_t other) {
            const auto& incident = problem.graph.incident[cone];
            const auto edge = std::ranges::find_if(
                incident, [&](std::size_t e) { return problem.other(e, cone) == other; });
            return static_cast<std::size_t>(edge - incident.begin());
        };
        for (std::size_t k = 1; k < side->size(); ++k) {
            const std::size_t cone = (*side)[k];
            const std::size_t in = place(cone, (*side)[k - 1]);
            if (in == problem.degree(cone)) return std::nullopt;
            if (k + 1 == side->size()) {
                cost += problem.end_cost(cone, in);
                continue;
            }
            const std::size_t out = place(cone, (*side)[k + 1]);
            if (out == problem.degree(cone)) return std::nullopt;
            cost += problem.turn_cost(cone, side == &lane.left, in, out);
        }
    }
    return cost;
}

}  // namespace

std::optional<StripOfLane> cheapest_strip(const StripProblem& problem, const StripLane& lane) {
    const auto& [left, right] = lane;
    if (left.size() < 2 || right.size() < 2) return std::nullopt;
    const std::optional<double> fixed = cost_of_boundaries(problem, lane);
    if (!fixed) return std::nullopt;
    struct Reached {
        double cost = StripProblem::kForbidden;
        std::size_t by = 0;  ///< triangle
        bool is_left = false;
    };
    const std::size_t columns = right.size();
    std::vector<Reached> reached(left.size() * columns);  // left advances along rows, right along columns
    const auto rung = std::ranges::find_if(problem.rungs, [&](const StripRung& r) {
        return r.may_start && r.left == left.front() && r.right == right.front();
    });
    if (rung == problem.rungs.end()) return std::nullopt;
    reached[0].cost = rung->start_cost;
    std::vector<std::size_t> rung_at(reached.size(), 0);
    rung_at[0] = static_cast<std::size_t>(rung - problem.rungs.begin());
    for (std::size_t k = 0; k < reached.size(); ++k) {
        if (!(reached[k].cost < StripProblem::kForbidden)) continue;
        for (const StripTriangle& triangle : problem.leaving(rung_at[k])) {
            const StripRung& to = problem.rungs[triangle.to];
            const std::size_t i = k / columns + (triangle.is_left ? 1 : 0);
            const std::size_t j = k % columns + (triangle.is_left ? 0 : 1);
            if (i >= left.size() || j >= columns || to.left != left[i] || to.right != right[j]) continue;
            Reached& next = reached[i * columns + j];
            if (const double cost = reached[k].cost + triangle.cost; cost < next.cost) {
                const auto number = static_cast<std::size_t>(&triangle - problem.triangles.data());
                next = {cost, number, triangle.is_left};
                rung_at[i * columns + j] = triangle.to;
            }
        }
    }
    const double cost = reached.back().cost + *fixed;
    if (!(cost < StripProblem::kForbidden) || !problem.rungs[rung_at.back()].may_end) return std::nullopt;
    StripOfLane strip{{}, cost};
    for (std::size_t k = reached.size() - 1; k > 0; k -= reached[k].is_left ? columns : 1)
        strip.triangles.push_back(reached[k].by);
    std::ranges::reverse(strip.triangles);
    return strip;
}

LaneGraph lane_graph_of(const StripLane& lane) {
    LaneGraph graph;
    for (const auto* side : {&lane.left, &lane.right}) {
        for (std::size_t k = 1; k < side->size(); ++k)
            graph.edges.push_back(make_edge((*side)[k - 1], (*side)[k]));
    }
    std::ranges::sort(graph.edges);
    return graph;
}

}  // namespace conelane
