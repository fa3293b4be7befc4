#include "solvers/path_pair/primal/pair_completion.hpp"

namespace conelane::path_pair {
namespace {

constexpr int kSecondRounds = 4;  ///< of the multipliers' ascent, before the second leg is searched
constexpr int kGivenLegs = 3;     ///< one after the other

}  // namespace

void PairCompletion::complete(const ResidualGraph& residual, int kind, std::span<const int> walk,
                              std::int64_t budget) {
    if (walk.empty()) return;
    if (is_leg(residual, walk)) {
        leg_.assign(walk.begin(), walk.end());
    } else {
        find_first_leg(residual, kind, budget);
        if (leg_.empty()) return;
    }
    for (int given = 0; given < kGivenLegs; ++given) {
        if (clock_.out_of_time()) return;
        find_second_leg(residual, kind, budget);
        if (best_second_.empty()) return;
        leg_ = best_second_;
        kind = relaxation_.other(kind);
    }
}

bool PairCompletion::is_leg(const ResidualGraph& residual, std::span<const int> walk) {
    visited_.assign(to_index(graph_.cone_count()), 0);
    visited_[to_index(residual.tail[to_index(walk.front())])] = 1;
    for (std::size_t k = 0; k < walk.size(); ++k) {
        char& visited = visited_[to_index(residual.head[to_index(walk[k])])];
        if (visited != 0) return false;
        visited = 1;
        for (std::size_t l = 0; l + 1 < k; ++l) {
            if (graph_.incompatible(residual.edge(walk[k]), residual.edge(walk[l]))) return false;
        }
    }
    return true;
}

void PairCompletion::find_first_leg(const ResidualGraph& residual, int kind, std::int64_t budget) {
    const PairRelaxation& r = relaxation_;
    leg_.clear();
    const LegSearch::Query query{.graph = graph_,
                                 .residual = residual,
                                 .reduced = r.reduced(),
                                 .start = r.start(kind),
                                 .end = r.end(kind),
                                 .backward = r.backward(kind)};
    const double cutoff = incumbent_.limit() + r.offset();
    search_.run(query, cutoff, budget, [&](std::span<const int> leg, double cost) {
        leg_.assign(leg.begin(), leg.end());
        return cost;
    });
}

void PairCompletion::find_second_leg(const ResidualGraph& residual, int kind, std::int64_t budget) {
    best_second_.clear();
    to_arcs(residual, leg_, first_arcs_);
    const double first_cost = incumbent_.leg_cost(first_arcs_);
    const auto limit = [&] { return incumbent_.limit() - first_cost; };
    const auto offer = [&](std::span<const int> leg) {
        to_arcs(residual, leg, second_arcs_);
        if (incumbent_.offer(first_arcs_, second_arcs_)) best_second_.assign(leg.begin(), leg.end());
    };
    second_.assign(relaxation_, residual, relaxation_.other(kind), leg_);
    for (int round = 1;; ++round) {
        if (!second_.evaluate(budget)) return;
        if (second_.value() >= limit()) return;
        offer(second_.walk());
        if (second_.value() >= limit()) return;
        if (round == kSecondRounds || !second_.step(limit())) break;
    }
    if (!second_.evaluate_backward()) return;
    const double offset = second_.offset();
    search_.run(second_.query(), limit() + offset, budget, [&](std::span<const int> leg, double) {
        offer(leg);
        return limit() + offset;
    });
}

void PairCompletion::to_arcs(const ResidualGraph& residual, std::span<const int> leg,
                             std::vector<int>& arcs) {
    arcs.clear();
    for (const int a : leg) arcs.push_back(residual.arc[to_index(a)]);
}

}  // namespace conelane::path_pair
