#include "experiments/studies/beams.hpp"

#include <array>
#include <limits>

#include <boost/dynamic_bitset.hpp>

namespace conelane::experiments {
namespace {

class LaneGraphBeam {
  public:
    LaneGraphBeam(const LaneGraphProblem& problem, std::size_t width) : problem_(problem), width_(width) {
        const std::size_t arcs = 2 * problem.edges.size();
        successions_.resize(arcs);
        excluded_.assign(problem.edges.size(), boost::dynamic_bitset<>(problem.edges.size()));
        for (const ProblemTurn& turn : problem.turns) add(turn);
        for (const auto& [first, second] : problem.conflicts) exclude(first, second);
        far_apart_.assign(problem.cone_count, boost::dynamic_bitset<>(problem.cone_count));
        for (const auto& [i, j] : problem.far_apart) {
            far_apart_[i].set(j);
            far_apart_[j].set(i);
        }
    }

    std::optional<LaneGraph> run() {
        std::vector<State> states = starts();
        while (!states.empty()) states = grown(states);
        return best_;
    }

  private:
    struct Succession {
        std::size_t arc;
        double cost;  ///< of the turn
    };
    /// A partial lane with one more edge than its parent, not yet made.
    struct Move {
        double cost;              ///< of the partial lane, see State
        std::size_t parent;       ///< among the states
        std::size_t arc;          ///< the new one
        std::size_t path = 0;     ///< that it belongs to
        bool ends_other = false;  ///< the other path has ended
    };
    struct Start {
        double cost;
        std::size_t first;  ///< arcs
        std::size_t second;
    };
    struct State {
        double cost = 0.0;                       ///< of edges and turns; open ends have none
        std::array<std::size_t, 2> tip{};        ///< the last arc of each path
        std::array<std::size_t, 2> edges{1, 1};  ///< of each path, their number
        std::array<bool, 2> ended{};
        boost::dynamic_bitset<> cones;
        boost::dynamic_bitset<> blocked;  ///< edges
        std::vector<std::size_t> chosen;  ///< edges
    };

    // An arc is an edge with a direction: 2 e from its cone of lower index, 2 e + 1 back.
    [[nodiscard]] const ProblemEdge& edge(std::size_t arc) const { return problem_.edges[arc / 2]; }
    [[nodiscard]] std::size_t tail(std::size_t arc) const { return arc % 2 == 0 ? edge(arc).i : edge(arc).j; }
    [[nodiscard]] std::size_t head(std::size_t arc) const { return arc % 2 == 0 ? edge(arc).j : edge(arc).i; }

    void exclude(std::size_t e, std::size_t f) {
        excluded_[e].set(f);
        excluded_[f].set(e);
    }

    void add(const ProblemTurn& turn) {
        const ProblemEdge& first = problem_.edges[turn.edge_i];
        const ProblemEdge& second = problem_.edges[turn.edge_k];
        if (turn.high_cost || first.high_cost || second.high_cost) return exclude(turn.edge_i, turn.edge_k);
        const auto into = [&](std::size_t e) { return 2 * e + (problem_.edges[e].j == turn.middle ? 0 : 1); };
        successions_[into(turn.edge_i)].push_back({into(turn.edge_k) ^ 1U, turn.cost});
        successions_[into(turn.edge_k)].push_back({into(turn.edge_i) ^ 1U, turn.cost});
    }

    /// What a path costs that ends there. It is part of the cost of each edge at the cone, and is taken back
    /// by each turn there.
    [[nodiscard]] double end_cost(std::size_t cone) const {
        return problem_.learned_end_cost[cone] -
               problem_.parameters.near_end_weight * problem_.near_end_fit[cone];
    }
    /// Without that of its head, where the path is open.
    [[nodiscard]] double open_cost(std::size_t arc) const { return edge(arc).cost - end_cost(head(arc)); }

    /// The `width` cheapest, the cheapest first.
    template <typename Item>
    void keep_cheapest(std::vector<Item>& items) const {
        // Stable: of equally cheap ones those that were met first.
        std::ranges::stable_sort(items, {}, &Item::cost);
        if (items.size() > width_) items.resize(width_);
    }

    [[nodiscard]] std::vector<State> starts() const {
        std::vector<std::size_t> first;
        for (std::size_t a = 0; a < successions_.size(); ++a) {
            if (!edge(a).high_cost && problem_.near[tail(a)]) first.push_back(a);
        }
        std::vector<Start> pairs;
        for (std::size_t k = 0; k < first.size(); ++k) {
            for (std::size_t l = k + 1; l < first.size(); ++l) {
                const std::size_t a = first[k];
                const std::size_t b = first[l];
                if (tail(a) == tail(b) || tail(a) == head(b) || head(a) == tail(b) || head(a) == head(b))
                    continue;
                if (excluded_[a / 2][b / 2]) continue;
                pairs.push_back({open_cost(a) + open_cost(b), a, b});
            }
        }
        keep_cheapest(pairs);
        std::vector<State> states;
        for (const Start& pair : pairs) {
            State& state = states.emplace_back();
            state.cost = pair.cost;
            state.tip = {pair.first, pair.second};
            state.cones.resize(problem_.cone_count);
            state.blocked.resize(problem_.edges.size());
            for (const std::size_t arc : state.tip) {
                state.cones.set(tail(arc));
                take(state, arc);
            }
        }
        return states;
    }

    void take(State& state, std::size_t arc) const {
        state.cones.set(head(arc));
        state.blocked |= excluded_[arc / 2];
        state.chosen.push_back(arc / 2);
    }

    std::vector<State> grown(const std::vector<State>& states) {
        std::vector<Move> moves;
        for (std::size_t s = 0; s < states.size(); ++s) {
            const State& state = states[s];
            complete(state);
            const std::size_t shorter = state.edges[0] <= state.edges[1] ? 0 : 1;
            if (!state.ended[shorter]) add_moves(state, s, shorter, state.ended[1 - shorter], moves);
            if (state.ended[1 - shorter]) continue;
            if (state.ended[shorter] || !problem_.near[head(state.tip[shorter])])
                add_moves(state, s, 1 - shorter, true, moves);
        }
        keep_cheapest(moves);
        std::vector<State> result;
        for (const Move& move : moves) {
            State& state = result.emplace_back(states[move.parent]);
            state.cost = move.cost;
            state.tip[move.path] = move.arc;
            ++state.edges[move.path];
            state.ended[1 - move.path] = move.ends_other;
            take(state, move.arc);
        }
        return result;
    }

    void add_moves(const State& state, std::size_t parent, std::size_t path, bool ends_other,
                   std::vector<Move>& moves) const {
        const std::size_t tip = state.tip[path];
        double cost = state.cost + end_cost(head(tip));
        // An end that this move decides.
        if (ends_other && !state.ended[1 - path]) cost += end_cost(head(state.tip[1 - path]));
        for (const auto& [arc, turn] : successions_[tip]) {
            if (state.cones[head(arc)] || state.blocked[arc / 2]) continue;
            moves.push_back({cost + turn + open_cost(arc), parent, arc, path, ends_other});
        }
    }

    void complete(const State& state) {
        const std::array<std::size_t, 2> ends{head(state.tip[0]), head(state.tip[1])};
        if (problem_.near[ends[0]] || problem_.near[ends[1]] || far_apart_[ends[0]][ends[1]]) return;
        double cost = state.cost;
        for (const std::size_t path : {0, 1}) {
            if (!state.ended[path]) cost += end_cost(ends[path]);
        }
        if (cost >= least_) return;
        LaneGraph graph;
        for (const std::size_t e : state.chosen)
            graph.edges.push_back({problem_.edges[e].i, problem_.edges[e].j});
        std::ranges::sort(graph.edges);
        if (!is_feasible(problem_, graph)) return;  // too few edges along the heading
        least_ = cost;
        best_ = std::move(graph);
    }

    const LaneGraphProblem& problem_;
    std::size_t width_;
    std::vector<std::vector<Succession>> successions_;  ///< by arc
    std::vector<boost::dynamic_bitset<>> excluded_;     ///< by edge
    std::vector<boost::dynamic_bitset<>> far_apart_;    ///< by cone
    double least_ = std::numeric_limits<double>::infinity();
    std::optional<LaneGraph> best_;
};

class StripBeam {
  public:
    StripBeam(const StripProblem& problem, std::size_t width) : problem_(problem), width_(width) {}

    std::optional<StripLane> run() {
        std::vector<State> states = starts();
        while (!states.empty()) states = grown(states);
        return best_;
    }

  private:
    struct State {
        double cost = 0.0;  ///< without the ends
        std::size_t rung = 0;
        std::array<std::size_t, 2> in{};  ///< left first: places of the last edges; the degree is none
        boost::dynamic_bitset<> cones;
        StripLane lane;

        [[nodiscard]] bool has_same_future(const State& other) const {
            return rung == other.rung && in == other.in && cones == other.cones;
        }
    };
    struct Move {
        double cost;
        std::size_t parent;
        const StripTriangle* triangle;
    };

    [[nodiscard]] std::vector<State> starts() const {
        std::vector<State> states;
        for (std::size_t r = 0; r < problem_.rungs.size(); ++r) {
            const StripRung& rung = problem_.rungs[r];
            if (!rung.may_start) continue;
            State& state = states.emplace_back();
            state = {rung.start_cost,
                     r,
                     {problem_.degree(rung.left), problem_.degree(rung.right)},
                     boost::dynamic_bitset<>(problem_.graph.cone_count),
                     {{rung.left}, {rung.right}}};
            state.cones.set(rung.left);
            state.cones.set(rung.right);
        }
        std::ranges::stable_sort(states, {}, &State::cost);
        if (states.size() > width_) states.resize(width_);
        return states;
    }

    std::vector<State> grown(const std::vector<State>& states) {
        std::vector<Move> moves;
        for (std::size_t s = 0; s < states.size(); ++s) {
            const State& state = states[s];
            complete(state);
            for (const StripTriangle& triangle : problem_.leaving(state.rung)) {
                if (state.cones[problem_.entered(triangle)]) continue;
                const double turn =
                    problem_.step_cost(problem_.rungs[state.rung].of(triangle.is_left), triangle.is_left,
                                       state.in[triangle.is_left ? 0 : 1], triangle.out);
                if (turn < StripProblem::kForbidden)
                    moves.push_back({state.cost + triangle.cost + turn, s, &triangle});
            }
        }
        std::ranges::stable_sort(moves, {}, &Move::cost);
        std::vector<State> result;
        for (const Move& move : moves) {
            if (result.size() == width_) break;
            State state = after(states[move.parent], move);
            if (std::ranges::none_of(result, [&](const State& met) { return met.has_same_future(state); }))
                result.push_back(std::move(state));
        }
        return result;
    }

    [[nodiscard]] State after(State state, const Move& move) const {
        const StripTriangle& triangle = *move.triangle;
        const std::size_t cone = problem_.entered(triangle);
        state.cost = move.cost;
        state.rung = triangle.to;
        state.in[triangle.is_left ? 0 : 1] = triangle.in;
        state.cones.set(cone);
        (triangle.is_left ? state.lane.left : state.lane.right).push_back(cone);
        return state;
    }

    void complete(const State& state) {
        if (!problem_.rungs[state.rung].may_end || state.lane.left.size() < 2 || state.lane.right.size() < 2)
            return;
        const double cost = state.cost + problem_.end_cost(state.lane.left.back(), state.in[0]) +
                            problem_.end_cost(state.lane.right.back(), state.in[1]);
        if (cost >= least_) return;
        least_ = cost;
        best_ = state.lane;
    }

    const StripProblem& problem_;
    std::size_t width_;
    double least_ = std::numeric_limits<double>::infinity();
    std::optional<StripLane> best_;
};

}  // namespace

std::optional<LaneGraph> beam_lane_graph(const LaneGraphProblem& problem, std::size_t width) {
    return LaneGraphBeam(problem, width).run();
}

std::optional<StripLane> beam_strip(const StripProblem& problem, std::size_t width) {
    return StripBeam(problem, width).run();
}

}  // namespace conelane::experiments
