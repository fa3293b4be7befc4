#include "solvers/path_pair/prices.hpp"

#include <algorithm>
#include <numeric>

namespace conelane::path_pair {

void CliquePool::clear() {
    start_.assign(1, 0);
    edges_.clear();
}

bool CliquePool::add(std::span<const int> clique) {
    for (int q = 0; q < size(); ++q) {
        if (std::ranges::equal(edges(q), clique)) return false;
    }
    edges_.insert(edges_.end(), clique.begin(), clique.end());
    start_.push_back(edges_.size());
    return true;
}

double Prices::offset() const {
    return std::accumulate(cone.begin(), cone.end(), 0.0) +
           std::accumulate(clique.begin(), clique.end(), 0.0) - 2.0 * heading;
}

void reduce(const ArcGraph& graph, const CliquePool& cliques, const Prices& prices,
            const ResidualGraph& residual, std::vector<double>& edge_price, std::vector<double>& reduced) {
    edge_price.assign(static_cast<std::size_t>(graph.edge_count()), 0.0);
    for (int q = 0; q < cliques.size(); ++q) {
        const double price = prices.clique[static_cast<std::size_t>(q)];
        if (price == 0.0) continue;
        for (const int edge : cliques.edges(q)) edge_price[static_cast<std::size_t>(edge)] += price;
    }
    reduced.resize(residual.arc.size());
    for (std::size_t a = 0; a < reduced.size(); ++a) {
        const int edge = residual.arc[a] / 2;
        reduced[a] = graph.cost(edge) + edge_price[static_cast<std::size_t>(edge)] -
                     (graph.along_heading(edge) ? prices.heading : 0.0) +
                     prices.cone[static_cast<std::size_t>(residual.head[a])];
    }
}

void Ascent::restart(const Prices& prices) {
    direction_.assign(prices.cone.size() + prices.clique.size() + 1, 0.0);
}

void Ascent::step(Prices& prices, const Usage& usage, std::span<const int> required, double gap,
                  double scale) {
    const std::size_t cones = prices.cone.size();
    const std::size_t cliques = prices.clique.size();
    direction_.resize(cones + cliques + 1, 0.0);
    // Order: heading, cones, cliques, so that new cliques come last.
    violation_.resize(direction_.size());
    // A price at its limit 0 that the violation would push below does not take part.
    const auto violation = [](double value, double price, bool free) {
        return value < 0.0 && price <= 0.0 && !free ? 0.0 : value;
    };
    violation_[0] = violation(2.0 - usage.along_heading, prices.heading, false);
    for (std::size_t v = 0; v < cones; ++v) {
        violation_[1 + v] = violation(usage.cone[v] - 1.0, prices.cone[v], required[v] > 0);
    }
    for (std::size_t q = 0; q < cliques; ++q) {
        violation_[1 + cones + q] = violation(usage.clique[q] - 1.0, prices.clique[q], false);
    }
    double along = 0.0;
    double before = 0.0;
    for (std::size_t k = 0; k < direction_.size(); ++k) {
        along += violation_[k] * direction_[k];
        before += direction_[k] * direction_[k];
    }
    const double theta = along < 0.0 && before > 0.0 ? -1.5 * along / before : 0.0;
    double squared = 0.0;
    for (std::size_t k = 0; k < direction_.size(); ++k) {
        direction_[k] = violation_[k] + theta * direction_[k];
        squared += direction_[k] * direction_[k];
    }
    if (squared == 0.0) return;
    const double length = scale * gap / squared;
    prices.heading = std::max(0.0, prices.heading + length * direction_[0]);
    for (std::size_t v = 0; v < cones; ++v) {
        const double price = prices.cone[v] + length * direction_[1 + v];
        prices.cone[v] = required[v] > 0 ? price : std::max(0.0, price);
    }
    for (std::size_t q = 0; q < cliques; ++q) {
        prices.clique[q] = std::max(0.0, prices.clique[q] + length * direction_[1 + cones + q]);
    }
}

}  // namespace conelane::path_pair
