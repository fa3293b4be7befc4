#include "solvers/path_pair/frontier/partner_bounds.hpp"

#include "solvers/path_pair/graph/block_rows.hpp"

namespace conelane::path_pair {
namespace {

// As in is_cheaper.
constexpr double kSmallestGain = 1e-12;
constexpr double kRounding = 1e-14;
constexpr double kNoWay = 1e100;  ///< Unlike infinity, its differences are numbers.

}  // namespace

bool PartnerBounds::find(const PairRelaxation& relaxation, const ResidualGraph& residual, double limit,
                         SearchClock& clock) {
    find_ends(relaxation, residual, limit);
    return find_walks(relaxation, residual, clock) && find_partners(relaxation, residual, clock);
}

void PartnerBounds::find_ends(const PairRelaxation& relaxation, const ResidualGraph& residual, double limit) {
    ends_.clear();
    end_at_.assign(relaxation.rest(0).size(), -1);
    end_of_arc_.assign(residual.arc.size(), -1);
    for (int a = 0; a < residual.size(); ++a) {
        const std::size_t cone = to_index(residual.head[to_index(a)]);
        if (!relaxation.may_end(residual, 0, a) ||
            !(relaxation.best(0)[cone] + relaxation.rest(0)[cone] < limit))
            continue;
        if (end_at_[cone] < 0) {
            end_at_[cone] = static_cast<int>(ends_.size());
            ends_.push_back(static_cast<int>(cone));
        }
        end_of_arc_[to_index(a)] = end_at_[cone];
    }
}

/// Sweeps against the order of the arcs, until nothing changes.
bool PartnerBounds::find_walks(const PairRelaxation& relaxation, const ResidualGraph& residual,
                               SearchClock& clock) {
    const std::size_t ends = ends_.size();
    if (!path_pair::fill(to_end_, residual.arc.size() * ends, kNoWay, clock)) return false;
    changed_.assign(residual.arc.size(), 0);
    for (int a = 0; a < residual.size(); ++a) {
        const int end = end_of_arc_[to_index(a)];
        if (end >= 0) to_end_[to_index(a) * ends + to_index(end)] = 0.0;
    }
    bool again = true;
    for (int sweep = 1; again; ++sweep) {
        again = false;
        for (int a = residual.size(); a-- > 0;) {
            // Where no leg comes, cycles may gain.
            if (relaxation.forward(0)[to_index(a)] == kUnreachable) continue;
            double* const here = to_end_.data() + to_index(a) * ends;
            for (int p = residual.out_start[to_index(a)]; p < residual.out_start[to_index(a) + 1]; ++p) {
                const int next = residual.out_arc[to_index(p)];
                if (changed_[to_index(next)] < sweep - 1) continue;
                if (clock.out_of_time(ends)) return false;
                const double step = residual.out_cost[to_index(p)] + relaxation.reduced()[to_index(next)];
                const double* const there = to_ends(next);
                double gain = 0.0;
                for (std::size_t e = 0; e < ends; ++e) {
                    const double label = step + there[e];
                    gain = std::max(gain, here[e] - label - kRounding * std::abs(label));
                    here[e] = std::min(here[e], label);
                }
                if (!(gain > kSmallestGain)) continue;
                changed_[to_index(a)] = sweep;
                again = true;
            }
        }
    }
    return true;
}

bool PartnerBounds::find_partners(const PairRelaxation& relaxation, const ResidualGraph& residual,
                                  SearchClock& clock) {
    const std::size_t ends = ends_.size();
    if (!path_pair::fill(to_partner_, residual.arc.size() * ends, kNoWay, clock)) return false;
    for (std::size_t e = 0; e < ends; ++e) {
        for (std::size_t k = 0; k < ends; ++k) {
            if (!relaxation.ends_fit(ends_[e], ends_[k])) continue;
            if (clock.out_of_time(residual.arc.size())) return false;
            for (std::size_t at = 0; at < to_end_.size(); at += ends)
                to_partner_[at + e] = std::min(to_partner_[at + e], to_end_[at + k]);
        }
    }
    return true;
}

double PartnerBounds::onward(int arc, int other_arc) const {
    const double* const one = to_ends(arc);
    const double* const other = to_partners(other_arc);
    double least = kUnreachable;
    for (std::size_t e = 0; e < ends_.size(); ++e) least = std::min(least, one[e] + other[e]);
    return least;
}

double PartnerBounds::onward_to_partner(int arc, int ended_arc) const {
    const int end = end_of_arc_[to_index(ended_arc)];
    return end < 0 ? kUnreachable : to_partners(arc)[to_index(end)];
}

}  // namespace conelane::path_pair
