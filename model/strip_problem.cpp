#include "model/strip_problem.hpp"

#include "conelane/invalid_input.hpp"
#include "model/deadline.hpp"
#include "model/geometry.hpp"
#include "model/strip_features.hpp"
#include "model/valid_scene_problem.hpp"

namespace conelane {
namespace {

constexpr std::size_t kMaxRungs = 200'000;
constexpr std::size_t kMaxTriangles = 2'000'000;

double square(double value) {
    return value * value;
}

class Builder {
  public:
    Builder(const Scene& scene, StripProblem& problem, const Deadline& deadline)
        : scene_(scene),
          problem_(problem),
          deadline_(deadline),
          costs_(problem.parameters.costs.get()),
          features_(scene, problem.graph, problem.reach_m = longest_m(),
                    [&deadline] { return deadline.passed(); }) {}

    /// Why it stopped.
    std::optional<StopReason> build() {
        if (deadline_.passed()) return StopReason::time;
        number_places();
        find_turns();
        add_rungs();
        if (problem_.rungs.size() > kMaxRungs) return StopReason::memory;
        add_triangles();
        if (problem_.triangles.size() > kMaxTriangles) return StopReason::memory;
        problem_.end_costs.assign(places_, 0.0);
        if (costs_ != nullptr) price();
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

    /// Of (29) with their costs; of learned costs which are allowed.
    void find_turns() {
        problem_.turn_costs.reserve(turns_);
        for (std::size_t cone = 0; cone < problem_.graph.cone_count; ++cone) {
            if (stop()) return;
            const std::size_t degree = problem_.degree(cone);
            problem_.turn_costs.resize(problem_.turn_costs.size() + degree * degree,
                                       StripProblem::kForbidden);
        }
        const auto allow = [&](std::size_t cone, std::size_t a, std::size_t b, double cost) {
            double* const costs = problem_.turn_costs.data() + problem_.turns_of[cone];
            costs[a * problem_.degree(cone) + b] = costs[b * problem_.degree(cone) + a] = cost;
        };
        for (const ProblemTurn& turn : problem_.graph.turns) {
            if (!turn.high_cost)
                allow(turn.middle, place(turn.edge_i, turn.middle), place(turn.edge_k, turn.middle),
                      turn.cost);
        }
        std::vector<Point> rays;
        for (std::size_t cone = 0; costs_ != nullptr && cone < problem_.graph.cone_count; ++cone) {
            const auto& incident = problem_.graph.incident[cone];
            rays.clear();
            for (const std::size_t edge : incident)
                rays.push_back((features_.at(problem_.other(edge, cone)) - features_.at(cone)).normalized());
            for (std::size_t b = 1; b < incident.size(); ++b) {
                for (std::size_t a = 0; a < b && !stop(); ++a) {
                    const bool over_gap =
                        problem_.graph.edges[incident[a]].gap || problem_.graph.edges[incident[b]].gap;
                    if (is_turn(rays[a], rays[b], over_gap)) allow(cone, a, b, 0.0);
                }
            }
        }
    }
    /// (28), and theta_gap over a gap. The cosine decides unless it is near a limit.
    [[nodiscard]] bool is_turn(const Point& a, const Point& b, bool over_gap) const {
        const RldParameters& p = problem_.parameters.gates;
        constexpr double kPi = std::numbers::pi;
        const double off = p.theta_t * std::sqrt(std::sqrt(p.t_crit));
        if (p.theta_e + off > kPi && std::abs(a.dot(b) - limits_[over_gap ? 1 : 0]) > 1e-6)
            return a.dot(b) < limits_[over_gap ? 1 : 0];
        const double angle = interior_angle(a, {}, b);
        return square(square((angle - p.theta_e) / p.theta_t)) <= p.t_crit + kTieTolerance &&
               (!over_gap || kPi - angle <= p.theta_gap + kTieTolerance);
    }
    /// Cosines of the sharpest turns, also over a gap; 2 if any is allowed.
    [[nodiscard]] std::array<double, 2> turn_limits() const {
        const RldParameters& p = problem_.parameters.gates;
        const auto cosine = [](double angle) { return angle > 0.0 ? std::cos(angle) : 2.0; };
        const double least = p.theta_e - p.theta_t * std::sqrt(std::sqrt(p.t_crit));
        return {cosine(least), cosine(std::max(least, std::numbers::pi - p.theta_gap))};
    }

    void add_rungs() {
        const StripParameters& p = problem_.parameters;
        const std::size_t n = problem_.graph.cone_count;
        const Point heading = scene_.pose.heading();
        const double longest = square(p.w_max_m + kTieTolerance);
        const double shortest = square(std::max(0.0, p.w_min_m - kTieTolerance));
        const std::vector<double> reach_m =
            reach_of_nearest(scene_, p.nearest_of_rung, p.w_max_m, [this] { return stop(); });
        const auto is_usual = [&](double squared, std::size_t l, std::size_t r) {
            const double most_m = std::max({p.w_usual_m, reach_m[l], reach_m[r]}) + kTieTolerance;
            return squared <= square(most_m);
        };
        rung_.assign(n * n, -1);
        across_.resize(n);
        for (std::size_t l = 0; l < n; ++l) {
            for (std::size_t r = 0; r < n; ++r) {
                if (stop()) return;
                const Point way = features_.at(l) - features_.at(r);
                const double squared = way.squaredNorm();
                if (squared > longest || squared < shortest || l == r || !is_usual(squared, l, r)) continue;
                rung_[l * n + r] = static_cast<std::int32_t>(problem_.rungs.size());
                across_[l].push_back(r);
                const bool may_start =
                    problem_.graph.near[l] && problem_.graph.near[r] && cross(heading, way) > 0.0;
                problem_.rungs.push_back({l, r, may_start, is_far(l) && is_far(r), 0.0});
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
        std::size_t most = 0;
        for (const ProblemEdge& edge : problem_.graph.edges) most += 2 * across_[edge.i].size();
        problem_.triangles.reserve(std::min(most, kMaxTriangles));
        for (std::size_t e = 0; e < problem_.graph.edges.size(); ++e) {
            const ProblemEdge& edge = problem_.graph.edges[e];
            if (edge.high_cost) continue;
            const Point way = features_.at(edge.j) - features_.at(edge.i);
            for (const std::size_t across : across_[edge.i]) {
                if (stop()) return;
                if (rung(edge.j, across) < 0) continue;
                const double side = cross(way, features_.at(across) - features_.at(edge.i));
                if (side == 0.0) continue;
                // Learned costs take the cones inside from here.
                const double cost =
                    costs_ != nullptr ? features_.inside_of(across, edge.i, edge.j) : edge.cost;
                // With `across` to the right of the edge i, j, a left boundary goes from i to j, and a right
                // one from j to i.
                add_triangle(e, edge.i, edge.j, across, side < 0.0, cost);
                add_triangle(e, edge.j, edge.i, across, side > 0.0, cost);
            }
        }
        index_triangles();
    }
    void add_triangle(std::size_t edge, std::size_t from, std::size_t to, std::size_t across, bool is_left,
                      double cost) {
        const auto number = [&](std::size_t cone) {
            return static_cast<std::uint32_t>(is_left ? rung(cone, across) : rung(across, cone));
        };
        problem_.triangles.push_back({.from = number(from),
                                      .to = number(to),
                                      .edge = static_cast<std::uint32_t>(edge),
                                      .out = place(edge, from),
                                      .in = place(edge, to),
                                      .is_left = is_left,
                                      .cost = cost});
    }
    /// Sorts them by the rungs that they leave.
    void index_triangles() {
        std::vector<std::uint32_t>& first = problem_.triangles_of;
        first.assign(problem_.rungs.size() + 1, 0);
        for (const StripTriangle& triangle : problem_.triangles) {
            if (stop()) return;
            ++first[triangle.from + 1];
        }
        for (std::size_t k = 1; k < first.size(); ++k) first[k] += first[k - 1];
        std::vector<StripTriangle> sorted;
        sorted.reserve(problem_.triangles.size());
        for (std::size_t k = 0; k < problem_.triangles.size() && !stop(); ++k) sorted.emplace_back();
        std::vector<std::uint32_t> next = first;
        for (const StripTriangle& triangle : problem_.triangles) {
            if (stop()) return;
            sorted[next[triangle.from]++] = triangle;
        }
        problem_.triangles = std::move(sorted);
    }

    void price() {
        for (StripRung& rung : problem_.rungs) {
            if (stop()) return;
            if (rung.may_start)
                rung.start_cost = learned(StripPart::start, features_.start(rung.left, rung.right));
        }
        std::vector<double> of_edge;
        for (const ProblemEdge& edge : problem_.graph.edges) {
            if (stop()) return;
            of_edge.push_back(learned(StripPart::edge, features_.edge(edge.i, edge.j)));
        }
        for (StripTriangle& t : problem_.triangles) {
            if (stop()) return;
            const std::size_t from = problem_.rungs[t.from].of(t.is_left);
            const std::size_t across = problem_.rungs[t.from].of(!t.is_left);
            t.cost = of_edge[t.edge] + learned(StripPart::triangle,
                                               features_.triangle(from, problem_.entered(t), across, t.cost));
        }
        for (std::size_t cone = 0; cone < problem_.graph.cone_count; ++cone) {
            const auto& incident = problem_.graph.incident[cone];
            for (std::size_t a = 0; a < incident.size(); ++a) {
                const std::size_t from = problem_.other(incident[a], cone);
                problem_.end_costs[problem_.places_of[cone] + a] =
                    learned(StripPart::end, features_.end(from, cone));
                for (std::size_t b = 0; b < a && !stop(); ++b) price_turn(cone, a, b);
            }
        }
    }
    /// Of both boundaries.
    void price_turn(std::size_t cone, std::size_t a, std::size_t b) {
        const std::size_t degree = problem_.degree(cone);
        double* const costs = problem_.turn_costs.data() + problem_.turns_of[cone];
        double& there = costs[a * degree + b];
        double& back = costs[b * degree + a];
        if (!(there < StripProblem::kForbidden)) return;
        const std::size_t i = problem_.other(problem_.graph.incident[cone][a], cone);
        const std::size_t k = problem_.other(problem_.graph.incident[cone][b], cone);
        // The lane is to the right of the left boundary.
        const bool bends_right =
            cross(features_.at(cone) - features_.at(i), features_.at(k) - features_.at(cone)) < 0.0;
        auto features = features_.turn(i, cone, k, true);
        (bends_right ? there : back) = learned(StripPart::turn, features);
        features[kStripInnerFeature] = 0.0;
        (bends_right ? back : there) = learned(StripPart::turn, features);
    }

    const Scene& scene_;
    StripProblem& problem_;
    const Deadline& deadline_;
    const StripCosts* costs_;
    StripFeatures features_;
    std::array<double, 2> limits_ = turn_limits();
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
    require(p.w_usual_m >= 0.0 && p.w_usual_m <= 100.0, "w_usual_m", "must be between 0 and 100");
    require(p.nearest_of_rung >= 0.0 && p.nearest_of_rung <= 1e6, "nearest_of_rung",
            "must be between 0 and 1e6");
    require(p.d_end_m >= 0.0 && p.d_end_m <= 1000.0, "d_end_m", "must be between 0 and 1000");
    if (p.costs) validate(*p.costs);
}

StripParameters driving_strip_parameters() {
    StripParameters p;
    p.gates.d_e = 2.8;
    p.gates.d_t = 1.7;
    p.gates.s_crit = 250.0;
    p.gates.theta_t = 0.9;
    p.gates.t_crit = 12.0;
    p.gates.d_min = 0.0;
    p.gates.d_near = 11.0;
    p.gates.d_side = 6.0;
    p.gates.d_gap = 15.0;
    p.gates.theta_gap = 1.3;
    p.gates.d_clear = 0.3;
    p.gates.nearest_of_edge = 12.0;
    p.gates.nearest_of_gap = 16.0;
    p.w_max_m = 12.0;
    p.w_usual_m = 8.5;
    p.nearest_of_rung = 8.0;
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
    validate(scene);
    LimitedProblem graph = parameters.costs
                               ? make_edges_of_valid_scene(scene, gates, deadline)
                               : make_problem_of_valid_scene(scene, gates, EdgeExtent::candidates, deadline);
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
std::optional<double> cost_of_boundary(const StripProblem& problem, const std::vector<std::size_t>& side,
                                       bool is_left) {
    double cost = 0.0;
    std::size_t in = problem.degree(side.front());
    for (std::size_t k = 0; k + 1 < side.size(); ++k) {
        const auto place = [&](std::size_t cone, std::size_t other) {
            const auto& incident = problem.graph.incident[cone];
            const auto edge =
                std::ranges::find(incident, other, [&](std::size_t e) { return problem.other(e, cone); });
            return static_cast<std::size_t>(edge - incident.begin());
        };
        const std::size_t out = place(side[k], side[k + 1]);
        if (out == problem.degree(side[k])) return std::nullopt;
        cost += problem.step_cost(side[k], is_left, in, out);
        in = place(side[k + 1], side[k]);
    }
    return cost + problem.end_cost(side.back(), in);
}

}  // namespace

std::optional<StripOfLane> cheapest_strip(const StripProblem& problem, const StripLane& lane) {
    const auto& [left, right] = lane;
    if (left.size() < 2 || right.size() < 2) return std::nullopt;
    const std::optional<double> of_left = cost_of_boundary(problem, left, true);
    const std::optional<double> of_right = cost_of_boundary(problem, right, false);
    const auto rung = std::ranges::find_if(problem.rungs, [&](const StripRung& r) {
        return r.may_start && r.left == left.front() && r.right == right.front();
    });
    if (!of_left || !of_right || rung == problem.rungs.end()) return std::nullopt;
    struct Reached {
        double cost = StripProblem::kForbidden;
        std::size_t rung = 0;
        std::size_t by = 0;  ///< triangle
    };
    const std::size_t columns = right.size();
    std::vector<Reached> reached(left.size() * columns);  // left advances along rows, right along columns
    reached[0] = {rung->start_cost, static_cast<std::size_t>(rung - problem.rungs.begin()), 0};
    for (std::size_t k = 0; k < reached.size(); ++k) {
        if (!(reached[k].cost < StripProblem::kForbidden)) continue;
        for (const StripTriangle& triangle : problem.leaving(reached[k].rung)) {
            const StripRung& to = problem.rungs[triangle.to];
            const std::size_t i = k / columns + (triangle.is_left ? 1 : 0);
            const std::size_t j = k % columns + (triangle.is_left ? 0 : 1);
            if (i >= left.size() || j >= columns || to.left != left[i] || to.right != right[j]) continue;
            Reached& next = reached[i * columns + j];
            if (const double cost = reached[k].cost + triangle.cost; cost < next.cost)
                next = {cost, triangle.to, static_cast<std::size_t>(&triangle - problem.triangles.data())};
        }
    }
    StripOfLane strip{{}, reached.back().cost + *of_left + *of_right};
    if (!(strip.cost < StripProblem::kForbidden) || !problem.rungs[reached.back().rung].may_end)
        return std::nullopt;
    for (std::size_t k = reached.size() - 1; k > 0;) {
        strip.triangles.push_back(reached[k].by);
        k -= problem.triangles[reached[k].by].is_left ? columns : 1;
    }
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
