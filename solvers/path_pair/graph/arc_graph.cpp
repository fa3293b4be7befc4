#include "solvers/path_pair/graph/arc_graph.hpp"

#include <bit>

namespace conelane::path_pair {

namespace {

/// Calls `visit(k)` for k below `count`; false if the time ends before. `work`: steps of one visit.
template <typename Visit>
bool for_each(std::size_t count, std::size_t work, SearchClock& clock, const Visit& visit) {
    constexpr std::size_t kBlock = 512;
    for (std::size_t k = 0; k < count; ++k) {
        if (k % kBlock == 0 && clock.out_of_time(work * std::min(kBlock, count - k))) return false;
        visit(k);
    }
    return true;
}

}  // namespace

bool ArcGraph::build(const LaneGraphProblem& problem, SearchClock& clock) {
    cone_count_ = static_cast<int>(problem.cone_count);
    add_edges(problem);
    const auto stop = [&](std::size_t words) { return clock.out_of_time(2 * words); };
    if (clock.out_of_time(20 * problem.edges.size()) ||
        !incompatible_.reset(edge_count(), edge_count(), stop)) {
        return false;
    }
    return for_each(
               problem.conflicts.size(), 10, clock,
               [&](std::size_t k) { exclude(problem.conflicts[k].first, problem.conflicts[k].second); }) &&
           add_successions(problem, clock) && find_share_bound(clock) && add_partners(problem, clock);
}

void ArcGraph::add_edges(const LaneGraphProblem& problem) {
    cone_.clear();
    cost_.clear();
    along_heading_.clear();
    problem_edge_.clear();
    edge_of_problem_.assign(problem.edges.size(), -1);
    for (std::size_t e = 0; e < problem.edges.size(); ++e) {
        const ProblemEdge& edge = problem.edges[e];
        if (edge.high_cost) continue;
        edge_of_problem_[e] = edge_count();
        cone_.push_back(static_cast<int>(edge.i));
        cone_.push_back(static_cast<int>(edge.j));
        cost_.push_back(edge.cost);
        along_heading_.push_back(edge.along_heading ? 1 : 0);
        problem_edge_.push_back(e);
    }
}

/// Marks two problem edges that no lane graph holds together.
void ArcGraph::exclude(std::size_t first, std::size_t second) {
    const int a = edge_of_problem_[first];
    const int b = edge_of_problem_[second];
    if (a < 0 || b < 0) return;
    incompatible_.set(a, b);
    incompatible_.set(b, a);
}

bool ArcGraph::add_successions(const LaneGraphProblem& problem, SearchClock& clock) {
    const auto leaving = [&](int edge, std::size_t cone) {
        return 2 * edge + (tail(2 * edge) == static_cast<int>(cone) ? 0 : 1);
    };
    start_.assign(to_index(arc_count()) + 1, 0);
    turns_.clear();
    turns_.reserve(problem.turns.size());
    const auto add_turn = [&](std::size_t k) {
        const ProblemTurn& turn = problem.turns[k];
        if (turn.high_cost) {
            exclude(turn.edge_i, turn.edge_k);
            return;
        }
        const int edge_i = edge_of_problem_[turn.edge_i];
        const int edge_k = edge_of_problem_[turn.edge_k];
        if (edge_i < 0 || edge_k < 0) return;
        turns_.push_back({leaving(edge_i, turn.middle), leaving(edge_k, turn.middle), turn.cost});
        ++start_[to_index(turns_.back().arc_i ^ 1) + 1];
        ++start_[to_index(turns_.back().arc_k ^ 1) + 1];
    };
    if (!for_each(problem.turns.size(), 20, clock, add_turn)) return false;
    for (std::size_t a = 1; a < start_.size(); ++a) start_[a] += start_[a - 1];
    successions_.clear();
    successions_.reserve(start_.back());
    constexpr std::size_t kBlock = 4096;
    while (successions_.size() < start_.back()) {
        const std::size_t before = successions_.size();
        successions_.resize(std::min(start_.back(), before + kBlock));
        if (clock.out_of_time(2 * (successions_.size() - before))) return false;
    }
    fill_.assign(start_.begin(), start_.end() - 1);
    // The reverse of an arc that leaves the middle cone arrives there, and the other arc leaves it.
    return for_each(turns_.size(), 20, clock, [&](std::size_t k) {
        const Turn& turn = turns_[k];
        successions_[fill_[to_index(turn.arc_i ^ 1)]++] = {turn.arc_k, turn.cost};
        successions_[fill_[to_index(turn.arc_k ^ 1)]++] = {turn.arc_i, turn.cost};
    });
}

bool ArcGraph::add_partners(const LaneGraphProblem& problem, SearchClock& clock) {
    near_.assign(problem.cone_count, 0);
    far_.reset(1, cone_count_);
    apart_.reset(cone_count_, cone_count_);
    for (int cone = 0; cone < cone_count_; ++cone) {
        const bool is_near = problem.near[to_index(cone)];
        near_[to_index(cone)] = is_near ? 1 : 0;
        if (!is_near) far_.set(0, cone);
        apart_.set(cone, cone);
    }
    for (const auto& [i, j] : problem.far_apart) {
        apart_.set(static_cast<int>(i), static_cast<int>(j));
        apart_.set(static_cast<int>(j), static_cast<int>(i));
    }
    partner_start_.assign(1, 0);
    partners_.clear();
    const std::span<const std::uint64_t> far = far_.row(0);
    for (int cone = 0; cone < cone_count_; ++cone) {
        if (clock.out_of_time(2 * problem.cone_count)) return false;
        const std::span<const std::uint64_t> apart = apart_.row(cone);
        for (std::size_t w = 0; w < far.size() && !near(cone); ++w) {
            for (std::uint64_t bits = far[w] & ~apart[w]; bits != 0; bits &= bits - 1) {
                partners_.push_back(static_cast<int>(w * 64) + std::countr_zero(bits));
            }
        }
        partner_start_.push_back(partners_.size());
    }
    return true;
}

bool ArcGraph::find_share_bound(SearchClock& clock) {
    share_.assign(to_index(cone_count_), 0.0);
    for (int arc = 0; arc < arc_count(); ++arc) {
        double& share = share_[to_index(head(arc))];
        share = std::min(share, 0.5 * cost(arc / 2));
    }
    const auto lower = [&](std::size_t k) {
        const Turn& turn = turns_[k];
        double& share = share_[to_index(tail(turn.arc_i))];
        const double half_i = 0.5 * cost(turn.arc_i / 2);
        const double half_k = 0.5 * cost(turn.arc_k / 2);
        share = std::min(share, half_i + turn.cost + half_k);
    };
    if (!for_each(turns_.size(), 10, clock, lower)) return false;
    share_bound_ = 0.0;
    for (const double share : share_) share_bound_ += share;
    return true;
}

int ArcGraph::arc(int from, int to) const {
    int a = 0;
    while (tail(a) != from || head(a) != to) ++a;
    return a;
}

double ArcGraph::turn_cost(int arc, int next) const {
    const std::span<const Succession> all = successions(arc);
    return std::ranges::find(all, next, &Succession::arc)->cost;
}

}  // namespace conelane::path_pair
