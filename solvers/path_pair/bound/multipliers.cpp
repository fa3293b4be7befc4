#include "solvers/path_pair/bound/multipliers.hpp"

#include <bit>
#include <numeric>

namespace conelane::path_pair {
namespace {

constexpr double kMinUse = 0.02;
constexpr double kMinViolation = 0.05;

}  // namespace

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

int CliqueSeparation::separate(const ArcGraph& graph, std::span<const double> edge_use,
                               std::span<const char> edge_alive, int most, CliquePool& pool,
                               SearchClock& clock) {
    used_.clear();
    for (int e = 0; e < graph.edge_count(); ++e) {
        if (edge_use[to_index(e)] > kMinUse) used_.push_back(e);
    }
    std::ranges::sort(used_, [&](int a, int b) {
        const double use_a = edge_use[to_index(a)];
        const double use_b = edge_use[to_index(b)];
        return use_a != use_b ? use_a > use_b : a < b;
    });
    covered_.assign(used_.size(), 0);
    int added = 0;
    for (std::size_t seed = 0; seed < used_.size() && added < most; ++seed) {
        if (covered_[seed] != 0) continue;
        if (clock.out_of_time(used_.size() + 20 * graph.incompatible_row(used_[seed]).size())) break;
        clique_.assign(1, used_[seed]);
        double sum = edge_use[to_index(used_[seed])];
        const std::span<const std::uint64_t> row = graph.incompatible_row(used_[seed]);
        common_.assign(row.begin(), row.end());
        const auto in_common = [&](int e) {
            return (common_[to_index(e) / 64] >> (static_cast<unsigned>(e) % 64) & 1) != 0;
        };
        const auto join = [&](int e) {
            clique_.push_back(e);
            const std::span<const std::uint64_t> other = graph.incompatible_row(e);
            for (std::size_t w = 0; w < common_.size(); ++w) common_[w] &= other[w];
        };
        for (const int e : used_) {
            if (!in_common(e)) continue;
            sum += edge_use[to_index(e)];
            join(e);
        }
        if (sum <= 1.0 + kMinViolation) continue;
        for (std::size_t other = seed; other < used_.size(); ++other) {
            if (std::ranges::find(clique_, used_[other]) != clique_.end()) covered_[other] = 1;
        }
        for (std::size_t w = 0; w < common_.size(); ++w) {
            for (std::uint64_t bits = common_[w]; bits != 0; bits &= bits - 1) {
                const auto e = static_cast<int>(w * 64) + std::countr_zero(bits);
                if (edge_alive[to_index(e)] != 0 && in_common(e)) join(e);
            }
        }
        std::ranges::sort(clique_);
        if (pool.add(clique_)) ++added;
    }
    return added;
}

double Multipliers::offset() const {
    return std::accumulate(cone.begin(), cone.end(), 0.0) +
           std::accumulate(clique.begin(), clique.end(), 0.0) - 2.0 * heading;
}

void reduce(const ArcGraph& graph, const CliquePool& cliques, const Multipliers& multipliers,
            const ResidualGraph& residual, std::vector<double>& edge_multiplier,
            std::vector<double>& reduced) {
    edge_multiplier.assign(to_index(graph.edge_count()), 0.0);
    for (int q = 0; q < cliques.size(); ++q) {
        const double multiplier = multipliers.clique[to_index(q)];
        if (multiplier == 0.0) continue;
        for (const int edge : cliques.edges(q)) edge_multiplier[to_index(edge)] += multiplier;
    }
    reduced.resize(residual.arc.size());
    for (std::size_t a = 0; a < reduced.size(); ++a) {
        const int edge = residual.arc[a] / 2;
        reduced[a] = graph.cost(edge) + edge_multiplier[to_index(edge)] -
                     (graph.along_heading(edge) ? multipliers.heading : 0.0) +
                     multipliers.cone[to_index(residual.head[a])];
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
