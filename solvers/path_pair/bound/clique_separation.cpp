#include "solvers/path_pair/bound/clique_separation.hpp"

#include <algorithm>
#include <bit>

namespace conelane::path_pair {
namespace {

constexpr double kMinUse = 0.02;
constexpr double kMinViolation = 0.05;

}  // namespace

int CliqueSeparation::separate(const ArcGraph& graph, std::span<const double> edge_use,
                               std::span<const char> edge_alive, int most, CliquePool& pool,
                               SearchClock& clock) {
    used_.clear();
    for (int e = 0; e < graph.edge_count(); ++e) {
        if (edge_use[static_cast<std::size_t>(e)] > kMinUse) used_.push_back(e);
    }
    std::ranges::sort(used_, [&](int a, int b) {
        const double use_a = edge_use[static_cast<std::size_t>(a)];
        const double use_b = edge_use[static_cast<std::size_t>(b)];
        return use_a != use_b ? use_a > use_b : a < b;
    });
    covered_.assign(used_.size(), 0);
    int added = 0;
    for (std::size_t seed = 0; seed < used_.size() && added < most; ++seed) {
        if (covered_[seed] != 0) continue;
        if (clock.out_of_time(used_.size() + 20 * graph.incompatible_row(used_[seed]).size())) break;
        clique_.assign(1, used_[seed]);
        double sum = edge_use[static_cast<std::size_t>(used_[seed])];
        const std::span<const std::uint64_t> row = graph.incompatible_row(used_[seed]);
        common_.assign(row.begin(), row.end());
        const auto in_common = [&](int e) {
            return (common_[static_cast<std::size_t>(e) / 64] >> (static_cast<unsigned>(e) % 64) & 1) != 0;
        };
        const auto join = [&](int e) {
            clique_.push_back(e);
            const std::span<const std::uint64_t> other = graph.incompatible_row(e);
            for (std::size_t w = 0; w < common_.size(); ++w) common_[w] &= other[w];
        };
        for (const int e : used_) {
            if (!in_common(e)) continue;
            sum += edge_use[static_cast<std::size_t>(e)];
            join(e);
        }
        if (sum <= 1.0 + kMinViolation) continue;
        for (std::size_t other = seed; other < used_.size(); ++other) {
            if (std::ranges::find(clique_, used_[other]) != clique_.end()) covered_[other] = 1;
        }
        for (std::size_t w = 0; w < common_.size(); ++w) {
            for (std::uint64_t bits = common_[w]; bits != 0; bits &= bits - 1) {
                const auto e = static_cast<int>(w * 64) + std::countr_zero(bits);
                if (edge_alive[static_cast<std::size_t>(e)] != 0 && in_common(e)) join(e);
            }
        }
        std::ranges::sort(clique_);
        if (pool.add(clique_)) ++added;
    }
    return added;
}

}  // namespace conelane::path_pair
