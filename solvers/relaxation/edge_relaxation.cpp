#include "solvers/relaxation/edge_relaxation.hpp"

#include <algorithm>
#include <limits>

namespace conelane {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

EdgeRelaxation::EdgeRelaxation(const LaneGraphProblem& problem)
    : cone_count_(problem.cone_count), problem_edges_(problem.edges.size()) {
    std::vector<int> variable_of(problem.edges.size(), -1);
    for (std::size_t e = 0; e < problem.edges.size(); ++e) {
        const ProblemEdge& edge = problem.edges[e];
        if (edge.high_cost) continue;
        variable_of[e] = static_cast<int>(edges_.size());
        edges_.push_back(e);
        ends_.emplace_back(static_cast<int>(edge.i), static_cast<int>(edge.j));
        costs_.push_back(edge.cost);
    }
    add_path_rows(problem);
    const auto exclude = [&](std::size_t first, std::size_t second) {
        rows_.push_back({{{variable_of[first], 1.0}, {variable_of[second], 1.0}}, -kInfinity, 1.0});
    };
    for (const auto& [first, second] : problem.conflicts) {  // (6)-(8)
        if (variable_of[first] >= 0 && variable_of[second] >= 0) exclude(first, second);
    }
    for (const ProblemTurn& turn : problem.turns) {
        const int first = variable_of[turn.edge_i];
        const int second = variable_of[turn.edge_k];
        if (first < 0 || second < 0) continue;
        if (turn.high_cost) {
            exclude(turn.edge_i, turn.edge_k);  // (28)
        } else {
            products_.push_back({std::min(first, second), std::max(first, second), turn.cost});
        }
    }
}

void EdgeRelaxation::add_path_rows(const LaneGraphProblem& problem) {
    const auto g = [&](std::size_t cone) { return static_cast<int>(edges_.size() + cone); };
    std::vector<std::vector<std::pair<int, double>>> degree(cone_count_);  // A_i
    for (std::size_t a = 0; a < ends_.size(); ++a) {
        for (const int end : {ends_[a].first, ends_[a].second}) {
            degree[static_cast<std::size_t>(end)].emplace_back(static_cast<int>(a), 1.0);
        }
    }
    // Sum of factor * (A_i - 2 g_i) over some cones.
    const auto sum_of_ends = [&](const std::vector<std::size_t>& cones, double factor) {
        std::vector<double> sum(variables(), 0.0);
        for (const std::size_t cone : cones) {
            for (const auto& [variable, one] : degree[cone]) {
                sum[static_cast<std::size_t>(variable)] += factor * one;
            }
            sum[static_cast<std::size_t>(g(cone))] -= 2.0 * factor;
        }
        std::vector<std::pair<int, double>> terms;
        for (std::size_t v = 0; v < sum.size(); ++v) {
            if (sum[v] != 0.0) terms.emplace_back(static_cast<int>(v), sum[v]);
        }
        return terms;
    };
    std::vector<std::size_t> all;
    std::vector<std::size_t> near;
    for (std::size_t cone = 0; cone < cone_count_; ++cone) {
        all.push_back(cone);
        if (problem.near[cone]) near.push_back(cone);
        rows_.push_back({sum_of_ends({cone}, 1.0), -kInfinity, 0.0});  // (2)
        std::vector<std::pair<int, double>> chosen = degree[cone];     // (1)
        chosen.emplace_back(g(cone), -1.0);
        rows_.push_back({std::move(chosen), 0.0, kInfinity});
    }
    rows_.push_back({sum_of_ends(all, 1.0), -4.0, -4.0});    // (3)
    rows_.push_back({sum_of_ends(near, -1.0), 2.0, 2.0});    // (11)
    for (const auto& [first, second] : problem.far_apart) {  // (12)-(17)
        rows_.push_back({sum_of_ends({first, second}, -1.0), -kInfinity, 1.0});
    }
    Row heading{{}, 2.0, kInfinity};  // (9)
    for (std::size_t a = 0; a < edges_.size(); ++a) {
        if (problem.edges[edges_[a]].along_heading) heading.terms.emplace_back(static_cast<int>(a), 1.0);
    }
    rows_.push_back(std::move(heading));
}

double EdgeRelaxation::objective(std::span<const double> x) const {
    double sum = 0.0;
    for (std::size_t a = 0; a < costs_.size(); ++a) sum += costs_[a] * x[a];
    for (const Product& product : products_) {
        sum += product.factor * x[static_cast<std::size_t>(product.first)] *
               x[static_cast<std::size_t>(product.second)];
    }
    return sum;
}

void EdgeRelaxation::gradient(std::span<const double> x, std::span<double> result) const {
    std::ranges::fill(result, 0.0);
    std::ranges::copy(costs_, result.begin());
    for (const Product& product : products_) {
        const auto first = static_cast<std::size_t>(product.first);
        const auto second = static_cast<std::size_t>(product.second);
        result[first] += product.factor * x[second];
        result[second] += product.factor * x[first];
    }
}

std::vector<double> EdgeRelaxation::point(std::span<const double> edge_values) const {
    std::vector<double> x(variables(), 0.0);
    for (std::size_t a = 0; a < edges_.size(); ++a) {
        x[a] = edge_values[edges_[a]];
        for (const int end : {ends_[a].first, ends_[a].second}) {
            x[edges_.size() + static_cast<std::size_t>(end)] += 0.5 * x[a];
        }
    }
    for (double& value : x) value = std::clamp(value, 0.0, 1.0);
    return x;
}

std::vector<double> EdgeRelaxation::edge_values(std::span<const double> x) const {
    std::vector<double> values(problem_edges_, 0.0);
    for (std::size_t a = 0; a < edges_.size(); ++a) values[edges_[a]] = x[a];
    return values;
}

}  // namespace conelane
