#include "solvers/path_pair/bound/multipliers.hpp"

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

double Multipliers::offset() const {
    return std::accumulate(cone.begin(), cone.end(), 0.0) +
           std::accumulate(clique.begin(), clique.end(), 0.0) - 2.0 * heading;
}

void reduce(const ArcGraph& graph, const CliquePool& cliques, const Multipliers& multipliers,
            const ResidualGraph& residual, std::vector<double>& edge_multiplier,
            std::vector<double>& reduced) {
    edge_multiplier.assign(static_cast<std::size_t>(graph.edge_count()), 0.0);
    for (int q = 0; q < cliques.size(); ++q) {
        const double multiplier = multipliers.clique[static_cast<std::size_t>(q)];
        if (multiplier == 0.0) continue;
        for (const int edge : cliques.edges(q)) edge_multiplier[static_cast<std::size_t>(edge)] += multiplier;
    }
    reduced.resize(residual.arc.size());
    for (std::size_t a = 0; a < reduced.size(); ++a) {
        const int edge = residual.arc[a] / 2;
        reduced[a] = graph.cost(edge) + edge_multiplier[static_cast<std::size_t>(edge)] -
                     (graph.along_heading(edge) ? multipliers.heading : 0.0) +
                     multipliers.cone[static_cast<std::size_t>(residual.head[a])];
    }
}

void Ascent::restart(const Multipliers& multipliers) {
    direction_.assign(multipliers.cone.size() + multipliers.clique.size() + 1, 0.0);
}

bool Ascent::step(Multipliers& multipliers, const Usage& usage, std::span<const int> required, double gap,
                  double scale) {
    const std::size_t cones = multipliers.cone.size();
    const std::size_t cliques = multipliers.clique.size();
    direction_.resize(cones + cliques + 1, 0.0);
    // The order is heading, cones, cliques, so that new cliques come last.
    violation_.resize(direction_.size());
    // A multiplier that is 0 and must not fall takes no part where the violation would lower it.
    const auto violation = [](double value, double multiplier, bool free) {
        return value < 0.0 && multiplier <= 0.0 && !free ? 0.0 : value;
    };
    violation_[0] = violation(2.0 - usage.along_heading, multipliers.heading, false);
    for (std::size_t v = 0; v < cones; ++v) {
        violation_[1 + v] = violation(usage.cone[v] - 1.0, multipliers.cone[v], required[v] > 0);
    }
    for (std::size_t q = 0; q < cliques; ++q) {
        violation_[1 + cones + q] = violation(usage.clique[q] - 1.0, multipliers.clique[q], false);
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
    if (squared == 0.0) return false;
    const double length = scale * gap / squared;
    multipliers.heading = std::max(0.0, multipliers.heading + length * direction_[0]);
    for (std::size_t v = 0; v < cones; ++v) {
        const double multiplier = multipliers.cone[v] + length * direction_[1 + v];
        multipliers.cone[v] = required[v] > 0 ? multiplier : std::max(0.0, multiplier);
    }
    for (std::size_t q = 0; q < cliques; ++q) {
        multipliers.clique[q] = std::max(0.0, multipliers.clique[q] + length * direction_[1 + cones + q]);
    }
    return true;
}

}  // namespace conelane::path_pair
