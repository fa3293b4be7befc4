#include "solvers/path_pair/bound/leg_bounds.hpp"

#include <bit>

namespace conelane::path_pair {
namespace {

// Finer than is_cheaper, so that no cycle that this leaves gains in the sums that use it: they would go on
// for ever. Here, a cycle that gains is found, even by rounding alone.
constexpr double kForwardGain = 1e-14;
// A cycle is raised this far above 0, or above this share of its terms, so that rounding does not make its
// cost negative again.
constexpr double kAboveZero = 1e-7;
constexpr double kShareAboveZero = 1e-12;
constexpr std::size_t kArcsPerClock = 512;
constexpr std::size_t kWorkPerArc = 50;

}  // namespace

bool LegBounds::forward(const ResidualGraph& graph, std::span<const double> reduced,
                        std::span<const double> start, std::vector<double>& label, std::vector<int>& before,
                        std::vector<int>& cycles) {
    const std::size_t size = graph.arc.size();
    begin_forward(graph, reduced, start, label, before);
    open_.assign((size + 63) / 64, 0);
    for (std::size_t a = 0; a < size; ++a) {
        if (label[a] < kUnreachable) open_[a / 64] |= std::uint64_t{1} << (a % 64);
    }
    std::size_t until_check = size + 64;
    std::size_t until_clock = kArcsPerClock;
    for (bool again = true; again;) {
        again = false;
        for (std::size_t word = 0; word < open_.size(); ++word) {
            while (open_[word] != 0) {
                const std::size_t a = word * 64 + to_index(std::countr_zero(open_[word]));
                open_[word] &= open_[word] - 1;
                if (--until_check == 0) {
                    if (find_cycles(before, cycles)) return false;
                    until_check = size / 2 + 1;
                }
                if (--until_clock == 0) {
                    if (clock_.out_of_time(kArcsPerClock * kWorkPerArc)) return true;
                    until_clock = kArcsPerClock;
                }
                const double value = label[a];
                for (int position = graph.out_start[a]; position < graph.out_start[a + 1]; ++position) {
                    const auto p = to_index(position);
                    const auto b = to_index(graph.out_arc[p]);
                    const double candidate = value + graph.out_cost[p] + reduced[b];
                    if (candidate < label[b] - kForwardGain) {
                        label[b] = candidate;
                        before[b] = static_cast<int>(a);
                        open_[b / 64] |= std::uint64_t{1} << (b % 64);
                        again |= b / 64 < word;
                    }
                }
            }
        }
    }
    return true;
}

/// The labels of the walks that `before` describes. A walk ends where the graph no longer has its arcs.
void LegBounds::begin_forward(const ResidualGraph& graph, std::span<const double> reduced,
                              std::span<const double> start, std::vector<double>& label,
                              std::vector<int>& before) {
    const std::size_t size = graph.arc.size();
    label.resize(size);
    if (before.size() != size) {
        before.assign(size, -1);
        for (std::size_t a = 0; a < size; ++a) label[a] = start[a] + reduced[a];
        return;
    }
    enum : int { unknown, on_the_way, known };
    color_.assign(size, unknown);
    for (std::size_t last = 0; last < size; ++last) {
        walk_.clear();
        for (auto a = static_cast<int>(last); a >= 0 && color_[to_index(a)] == unknown;
             a = before[to_index(a)]) {
            color_[to_index(a)] = on_the_way;
            walk_.push_back(a);
        }
        for (; !walk_.empty(); walk_.pop_back()) {
            const auto b = to_index(walk_.back());
            color_[b] = known;
            label[b] = start[b] + reduced[b];
            const int a = std::exchange(before[b], -1);
            if (a < 0 || color_[to_index(a)] != known) continue;  // cuts a cycle open
            const auto* const first = graph.in_arc.data() + graph.in_start[b];
            const auto* const end = graph.in_arc.data() + graph.in_start[b + 1];
            const auto* const found = std::find(first, end, a);
            if (found == end) continue;
            const double turn = graph.in_cost[static_cast<std::size_t>(found - graph.in_arc.data())];
            const double on = label[to_index(a)] + turn + reduced[b];
            if (!(on < label[b])) continue;
            label[b] = on;
            before[b] = a;
        }
    }
}

void LegBounds::backward(const ResidualGraph& graph, std::span<const double> reduced,
                         std::span<const double> end, std::span<const char> usable,
                         std::vector<double>& label) {
    const std::size_t size = graph.arc.size();
    label.resize(size);
    open_.assign((size + 63) / 64, 0);
    for (std::size_t a = 0; a < size; ++a) {
        label[a] = usable[a] != 0 ? end[a] : kUnreachable;
        if (label[a] < kUnreachable) open_[a / 64] |= std::uint64_t{1} << (a % 64);
    }
    std::size_t until_clock = kArcsPerClock;
    for (bool again = true; again;) {
        again = false;
        for (std::size_t word = open_.size(); word-- > 0;) {
            while (open_[word] != 0) {
                const std::size_t bit = 63 - to_index(std::countl_zero(open_[word]));
                const std::size_t b = word * 64 + bit;
                open_[word] &= ~(std::uint64_t{1} << bit);
                if (--until_clock == 0) {
                    if (clock_.out_of_time(kArcsPerClock * kWorkPerArc)) return;
                    until_clock = kArcsPerClock;
                }
                const double value = label[b] + reduced[b];
                for (int position = graph.in_start[b]; position < graph.in_start[b + 1]; ++position) {
                    const auto p = to_index(position);
                    const auto a = to_index(graph.in_arc[p]);
                    const double candidate = value + graph.in_cost[p];
                    if (is_cheaper(candidate, label[a]) && usable[a] != 0) {
                        label[a] = candidate;
                        open_[a / 64] |= std::uint64_t{1} << (a % 64);
                        again |= a / 64 > word;
                    }
                }
            }
        }
    }
}

bool LegBounds::find_cycles(std::span<const int> before, std::vector<int>& cycles) {
    cycles.clear();
    color_.assign(before.size(), -1);
    for (std::size_t first = 0; first < before.size(); ++first) {
        auto a = static_cast<int>(first);
        while (a >= 0 && color_[to_index(a)] < 0) {
            color_[to_index(a)] = static_cast<int>(first);
            a = before[to_index(a)];
        }
        if (a < 0 || color_[to_index(a)] != static_cast<int>(first)) continue;
        const auto begin = static_cast<std::ptrdiff_t>(cycles.size());
        int member = a;
        do {
            cycles.push_back(member);
            member = before[to_index(member)];
        } while (member != a);
        std::reverse(cycles.begin() + begin, cycles.end());
        cycles.push_back(-1);
    }
    return !cycles.empty();
}

void raise_cycles(const ResidualGraph& graph, std::span<const int> cycles, std::span<const double> reduced,
                  std::vector<double>& cone_multiplier) {
    const auto head = [&](int arc) { return graph.head[to_index(arc)]; };
    for (std::size_t begin = 0; begin < cycles.size();) {
        const auto past = static_cast<std::size_t>(
            std::find(cycles.begin() + static_cast<std::ptrdiff_t>(begin), cycles.end(), -1) -
            cycles.begin());
        const std::span<const int> before = cycles.first(begin);
        const std::span<const int> cycle = cycles.subspan(begin, past - begin);
        begin = past + 1;
        const bool shares_cone = std::ranges::any_of(cycle, [&](int arc) {
            return std::ranges::any_of(before,
                                       [&](int other) { return other >= 0 && head(other) == head(arc); });
        });
        if (shares_cone) continue;
        double cost = 0.0;
        double terms = 0.0;  // sum of their amounts
        for (std::size_t k = 0; k < cycle.size(); ++k) {
            const auto a = to_index(cycle[k]);
            const int next = cycle[(k + 1) % cycle.size()];
            const auto* const first = graph.out_arc.data() + graph.out_start[a];
            const auto* const last = graph.out_arc.data() + graph.out_start[a + 1];
            const double turn =
                graph.out_cost[static_cast<std::size_t>(std::find(first, last, next) - graph.out_arc.data())];
            cost += reduced[a] + turn;
            terms += std::abs(reduced[a]) + turn + std::abs(cone_multiplier[to_index(head(cycle[k]))]);
        }
        const double above = std::max(kAboveZero, kShareAboveZero * terms);
        const double raise = std::max(above - cost, above) / static_cast<double>(cycle.size());
        for (const int arc : cycle) cone_multiplier[to_index(head(arc))] += raise;
    }
}

}  // namespace conelane::path_pair
