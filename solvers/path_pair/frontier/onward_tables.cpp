#include "solvers/path_pair/frontier/onward_tables.hpp"

#include <bit>

namespace conelane::path_pair {
namespace {

constexpr std::size_t kBlock = 16;
constexpr std::size_t kBytesPerStep = 4;       ///< of the clock
constexpr std::size_t kBytesAtOnce = 200'000;  ///< that a table grows by
constexpr double kMinQuantum = 1e-9;
constexpr double kRounding = 0.01;  ///< of a quantum: more than sums of costs are off by

/// mine = min(mine, max(theirs + more, excluded)). Tells whether any fell.
bool lower(Quanta* mine, const Quanta* theirs, const Quanta* excluded, Quanta more, std::size_t count) {
    Quanta change = 0;
    for (std::size_t k = 0; k < count; ++k) {
        const auto sum = static_cast<Quanta>(theirs[k] + more);
        const Quanta least = std::min(mine[k], std::max(sum, excluded[k]));
        change |= static_cast<Quanta>(mine[k] ^ least);
        mine[k] = least;
    }
    return change != 0;
}

}  // namespace

bool OnwardTables::out_of_time(std::size_t bytes) {
    return clock_.tick(bytes / kBytesPerStep);
}

/// `count` times kTooMany; false, and fewer, if the time has ended.
bool OnwardTables::fill(std::vector<Quanta>& table, std::size_t count) {
    table.clear();
    table.reserve(count);
    while (table.size() < count) {
        const std::size_t more = std::min(count - table.size(), kBytesAtOnce);
        if (out_of_time(more)) return false;
        table.resize(table.size() + more, kTooMany);
    }
    return true;
}

Quanta OnwardTables::to_quanta(double cost) const {
    const double count = cost / quantum_;
    return count < kTooMany ? static_cast<Quanta>(std::max(0.0, count)) : kTooMany;
}

Quanta OnwardTables::more(int frontier, const FrontierGraph::Step& step) const {
    return to_quanta(frontiers_.cost(step) + frontiers_.onward(step.to) - frontiers_.onward(frontier));
}

int OnwardTables::quanta_below(double slack) const {
    return static_cast<int>(std::clamp<double>(slack / quantum_ + kRounding, 0.0, kTooMany - 1));
}

std::size_t OnwardTables::row_bytes(const ResidualGraph& residual) {
    return 2 * residual.arc.size() + 64 + kBlock;
}

void OnwardTables::find(double limit, bool with_detours) {
    double bound = kUnreachable;
    for (const int f : frontiers_.starts())
        bound = std::min(bound, frontiers_.start_cost(f) + frontiers_.onward(f));
    quantum_ = std::max((limit - bound) / (kTooMany - 1), kMinQuantum);
    edge_count_ = edges_.words() * 64;
    find_regrets();
    have_detours_ = with_detours && !clock_.expired();
    if (!have_detours_) return;
    number_arcs();
    find_excluded();
    find_detours();
}

template <typename LowerEnd, typename LowerBy>
void OnwardTables::sweep_back(std::vector<Quanta>& table, std::size_t count, const LowerEnd& lower_end,
                              const LowerBy& lower_by) {
    if (!fill(table, to_index(frontiers_.size()) * count)) return;
    nothing_.assign(count, 0);
    changed_.assign(to_index(frontiers_.size()), 0);
    bool again = true;
    for (int sweep = 1; again; ++sweep) {
        again = false;
        for (int f = frontiers_.size(); f-- > 0;) {
            Quanta* const mine = table.data() + to_index(f) * count;
            bool change = sweep == 1 && lower_end(f, mine);
            for (const FrontierGraph::Step& step : frontiers_.steps(f)) {
                if (sweep > 1 && changed_[to_index(step.to)] < sweep - 1) continue;
                const Quanta delta = more(f, step);
                if (delta == kTooMany) continue;
                if (out_of_time(count)) return;
                change |= lower_by(step, delta, mine);
            }
            if (!change) continue;
            changed_[to_index(f)] = sweep;
            again = true;
        }
    }
}

void OnwardTables::find_regrets() {
    const std::size_t count = edge_count_;
    sweep_back(
        regret_, count, [](int, Quanta*) { return false; },
        [&](const FrontierGraph::Step& step, Quanta delta, Quanta* mine) {
            bool change =
                lower(mine, regret_.data() + to_index(step.to) * count, nothing_.data(), delta, count);
            if (step.arc < 0) return change;
            Quanta& own = mine[edges_.number(step.arc)];
            change |= delta < own;
            own = std::min(own, delta);
            return change;
        });
}

/// Columns only for the arcs that frontiers have: a small part of the graph's arcs.
void OnwardTables::number_arcs() {
    constexpr std::size_t kNone = ~std::size_t{0};
    column_.assign(frontiers_.residual().arc.size(), kNone);
    arcs_.clear();
    const auto add = [&](int arc) {
        if (column_[to_index(arc)] != kNone) return;
        column_[to_index(arc)] = arcs_.size();
        arcs_.push_back(arc);
    };
    for (int f = 0; f < frontiers_.size(); ++f) {
        add(frontiers_.frontier(f).moving);
        add(frontiers_.frontier(f).waiting);
    }
    arc_count_ = (arcs_.size() + kBlock) / kBlock * kBlock;
    for (std::size_t& column : column_) column = std::min(column, arcs_.size());
}

void OnwardTables::find_excluded() {
    columns_of_edge_.assign(edge_count_, {-1, -1});
    for (std::size_t column = 0; column < arcs_.size(); ++column) {
        std::array<int, 2>& columns = columns_of_edge_[edges_.number(arcs_[column])];
        columns[columns[0] < 0 ? 0 : 1] = static_cast<int>(column);
    }
    excluded_.assign(arcs_.size() * arc_count_, 0);
    for (std::size_t column = 0; column < arcs_.size(); ++column) {
        const std::uint64_t* const lost = edges_.lost_after(arcs_[column]);
        for (std::size_t w = 0; w < edges_.words(); ++w) {
            for (std::uint64_t bits = lost[w]; bits != 0; bits &= bits - 1) {
                for (const int row : columns_of_edge_[w * 64 + to_index(std::countr_zero(bits))]) {
                    if (row >= 0) excluded_[to_index(row) * arc_count_ + column] = kTooMany;
                }
            }
        }
    }
}

void OnwardTables::find_detours() {
    const std::size_t count = arc_count_;
    const auto end_here = [&](int f, Quanta* mine) {
        return frontiers_.is_last(f) &&
               lower(mine, nothing_.data(), nothing_.data(), to_quanta(-frontiers_.onward(f)), count);
    };
    sweep_back(detour_, count, end_here, [&](const FrontierGraph::Step& step, Quanta delta, Quanta* mine) {
        const Quanta* const excluded =
            step.arc < 0 ? nothing_.data() : excluded_.data() + column_[to_index(step.arc)] * count;
        return lower(mine, detour_.data() + to_index(step.to) * count, excluded, delta, count);
    });
}

}  // namespace conelane::path_pair
