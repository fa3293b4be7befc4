#pragma once

#include "solvers/path_pair/bound/pair_relaxation.hpp"
#include "solvers/path_pair/graph/edge_sets.hpp"

namespace conelane::path_pair {

/// The dominated edges of every arc (bound fixing): those that every way up to the arc has lost, and those
/// that every way on from it excludes. A pair with a leg through the arc cannot use them. With the sets of
/// EdgeSets,
///     before(b) = lost_after(b)  united with the intersection of before(a) over all a that b may follow,
///     after(a)  = the intersection, over all b that may follow a, of lost_before(b) united with after(b),
/// where b may follow a unless before(a) has b or after(b) has a. A leg that may start with b, or end with a,
/// adds the empty set to the intersection. Both are the largest sets that fulfil this.
class DominatedEdges {
  public:
    /// With `propagate` false, only the arc itself counts: before is lost_after, after is empty. If the
    /// time ends within the call, the sets are incomplete and must not be used.
    void find(const ResidualGraph& residual, const PairRelaxation& relaxation, const EdgeSets& edges,
              bool propagate, SearchClock& clock);

    /// Whether b may follow a on a leg of the kind. Precondition: b is a successor of a.
    [[nodiscard]] bool may_follow(int kind, int a, int b) const {
        return !EdgeSets::contains(row(before_, kind, a), edges_->number(b)) &&
               !EdgeSets::contains(row(after_, kind, b), edges_->number(a));
    }
    /// Whether a leg of `kind` through a and a leg of `other_kind` through b may be a pair. `b_ended`: the
    /// other leg ends with b.
    [[nodiscard]] bool may_pair(int kind, int a, int other_kind, int b, bool b_ended) const {
        const std::size_t edge_a = edges_->number(a);
        const std::size_t edge_b = edges_->number(b);
        return !EdgeSets::contains(row(before_, kind, a), edge_b) &&
               !EdgeSets::contains(row(after_, kind, a), edge_b) &&
               !EdgeSets::contains(row(before_, other_kind, b), edge_a) &&
               (b_ended || !EdgeSets::contains(row(after_, other_kind, b), edge_a));
    }

  private:
    using Sets = std::array<std::vector<std::uint64_t>, 2>;  ///< by kind, a row for each arc
    [[nodiscard]] const std::uint64_t* row(const Sets& sets, int kind, int arc) const {
        return sets[to_index(kind)].data() + to_index(arc) * edges_->words();
    }

    const EdgeSets* edges_ = nullptr;
    Sets before_;
    Sets after_;
};

/// Intersects target with the union of given and own. True if that changes target.
bool intersect_with_union(std::uint64_t* target, const std::uint64_t* given, const std::uint64_t* own,
                          std::size_t words);

}  // namespace conelane::path_pair
