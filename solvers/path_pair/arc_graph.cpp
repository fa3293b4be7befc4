#include "solvers/path_pair/arc_graph.hpp"

#include <algorithm>

namespace conelane::path_pair {

bool ArcGraph::build(const LaneGraphProblem& problem, SearchClock& clock) {
    cone_count_ = static_cast<int>(problem.cone_count);
    add_edges(problem);
    if (clock.out_of_time()) return false;
    incompatible_.reset(edge_count(), edge_count());
    for (const auto& [first, second] : problem.conflicts) exclude(first, second);
    if (clock.out_of_time()) return false;
    add_successions(problem);
    if (clock.out_of_time()) return false;
    return add_partners(problem, clock);
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

/// Problem edges that no lane graph holds both of.
void ArcGraph::exclude(std::size_t first, std::size_t second) {
    const int a = edge_of_problem_[first];
    const int b = edge_of_problem_[second];
    if (a < 0 || b < 0) return;
    incompatible_.set(a, b);
    incompatible_.set(b, a);
}

void ArcGraph::add_successions(const LaneGraphProblem& problem) {
    // Through the middle cone of a turn: arc_k leaves it, the reverse of arc_i arrives, and the other way
    // round.
    const auto for_each_succession = [&](auto&& visit) {
        for (const ProblemTurn& turn : problem.turns) {
            const int edge_i = edge_of_problem_[turn.edge_i];
            const int edge_k = edge_of_problem_[turn.edge_k];
            if (turn.high_cost || edge_i < 0 || edge_k < 0) continue;
            const auto middle = static_cast<int>(turn.middle);
            const int from_i = tail(2 * edge_i) == middle ? 2 * edge_i : 2 * edge_i + 1;
            const int from_k = tail(2 * edge_k) == middle ? 2 * edge_k : 2 * edge_k + 1;
            visit(from_i ^ 1, from_k, turn.cost);
            visit(from_k ^ 1, from_i, turn.cost);
        }
    };
    start_.assign(static_cast<std::size_t>(arc_count()) + 1, 0);
    for_each_succession([&](int arc, int, double) { ++start_[static_cast<std::size_t>(arc) + 1]; });
    for (std::size_t a = 1; a < start_.size(); ++a) start_[a] += start_[a - 1];
    successions_.resize(start_.back());
    fill_.assign(start_.begin(), start_.end() - 1);
    for_each_succession([&](int arc, int next, double cost) {
        successions_[fill_[static_cast<std::size_t>(arc)]++] = {next, cost};
    });
    for (const ProblemTurn& turn : problem.turns) {
        if (turn.high_cost) exclude(turn.edge_i, turn.edge_k);
    }
}

bool ArcGraph::add_partners(const LaneGraphProblem& problem, SearchClock& clock) {
    near_.assign(problem.cone_count, 0);
    apart_.reset(cone_count_, cone_count_);
    for (int cone = 0; cone < cone_count_; ++cone) {
        near_[static_cast<std::size_t>(cone)] = problem.near[static_cast<std::size_t>(cone)] ? 1 : 0;
        apart_.set(cone, cone);
    }
    for (const auto& [i, j] : problem.far_apart) {
        apart_.set(static_cast<int>(i), static_cast<int>(j));
        apart_.set(static_cast<int>(j), static_cast<int>(i));
    }
    partner_start_.assign(1, 0);
    partners_.clear();
    for (int cone = 0; cone < cone_count_; ++cone) {
        if (clock.out_of_time(2 * problem.cone_count)) return false;
        for (int other = 0; other < cone_count_; ++other) {
            if (!near(cone) && !near(other) && !apart_.test(cone, other)) partners_.push_back(other);
        }
        partner_start_.push_back(partners_.size());
    }
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

double ArcGraph::share_bound() const {
    std::vector<double> share(static_cast<std::size_t>(cone_count_), 0.0);
    for (int arc = 0; arc < arc_count(); ++arc) {
        double& end = share[static_cast<std::size_t>(head(arc))];
        const double half = 0.5 * cost(arc / 2);
        end = std::min(end, half);
        for (const Succession& next : successions(arc)) {
            end = std::min(end, half + next.cost + 0.5 * cost(next.arc / 2));
        }
    }
    double sum = 0.0;
    for (const double value : share) sum += value;
    return sum;
}

}  // namespace conelane::path_pair
