#include "solvers/path_pair/frontier/dominated_edges.hpp"

namespace conelane::path_pair {

bool intersect_with_union(std::uint64_t* target, const std::uint64_t* given, const std::uint64_t* own,
                          std::size_t words) {
    std::uint64_t change = 0;
    for (std::size_t w = 0; w < words; ++w) {
        const std::uint64_t set = given[w] | own[w];
        change |= target[w] & ~set;
        target[w] &= set;
    }
    return change != 0;
}

void DominatedEdges::find(const ResidualGraph& residual, const PairRelaxation& relaxation,
                          const EdgeSets& edges, bool propagate, SearchClock& clock) {
    edges_ = &edges;
    const std::size_t words = edges.words();
    const auto work = [&](int a) {
        return static_cast<std::size_t>(residual.out_start[to_index(a) + 1] -
                                        residual.out_start[to_index(a)]) *
               (2 + words);
    };
    for (int kind = 0; kind < relaxation.system().kind_count; ++kind) {
        std::vector<std::uint64_t>& before = before_[to_index(kind)];
        std::vector<std::uint64_t>& after = after_[to_index(kind)];
        before.clear();
        after.clear();
        before.reserve(residual.arc.size() * words);
        after.reserve(residual.arc.size() * words);
        for (int a = 0; a < residual.size(); ++a) {
            if (clock.tick(2 * words)) return;
            before.resize((to_index(a) + 1) * words, ~std::uint64_t{0});
            after.resize((to_index(a) + 1) * words, propagate ? ~std::uint64_t{0} : 0);
            if (!propagate || relaxation.start(kind)[to_index(a)] < kUnreachable) {
                std::copy_n(edges.lost_after(a), words, before.data() + to_index(a) * words);
            }
            if (relaxation.may_end(residual, kind, a)) {
                std::fill_n(after.data() + to_index(a) * words, words, std::uint64_t{0});
            }
        }
        if (!propagate) continue;
        // An edge taken out of a set lets more arcs follow, so both passes go on until nothing changes.
        for (bool again = true; again;) {
            again = false;
            for (int a = 0; a < residual.size(); ++a) {
                if (clock.out_of_time(work(a))) return;
                for (int p = residual.out_start[to_index(a)]; p < residual.out_start[to_index(a) + 1]; ++p) {
                    const int b = residual.out_arc[to_index(p)];
                    if (EdgeSets::contains(row(before_, kind, a), edges.number(b))) continue;
                    const bool changed =
                        intersect_with_union(before.data() + to_index(b) * words,
                                             before.data() + to_index(a) * words, edges.lost_after(b), words);
                    again |= changed && b < a;
                }
            }
        }
        for (bool again = true; again;) {
            again = false;
            for (int a = residual.size(); a-- > 0;) {
                if (clock.out_of_time(work(a))) return;
                for (int p = residual.out_start[to_index(a)]; p < residual.out_start[to_index(a) + 1]; ++p) {
                    const int b = residual.out_arc[to_index(p)];
                    if (!may_follow(kind, a, b)) continue;
                    again |=
                        intersect_with_union(after.data() + to_index(a) * words,
                                             after.data() + to_index(b) * words, edges.lost_before(b), words);
                }
            }
        }
    }
}

}  // namespace conelane::path_pair
