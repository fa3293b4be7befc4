#include "solvers/path_pair/primal/incumbent_window.hpp"

#include <numeric>

namespace conelane::path_pair {

void IncumbentWindow::assign(std::span<const char> usable) {
    usable_.assign(usable.begin(), usable.end());
    next_start_.assign(to_index(graph_.cone_count()) + 2, 0);
    for (const int arc : whole_.arc) {
        if (usable_[to_index(arc)] != 0) ++next_start_[to_index(graph_.tail(arc)) + 2];
    }
    std::partial_sum(next_start_.begin(), next_start_.end(), next_start_.begin());
    next_.resize(to_index(next_start_.back()));
    for (const int arc : whole_.arc) {
        if (usable_[to_index(arc)] != 0)
            next_[to_index(next_start_[to_index(graph_.tail(arc)) + 1]++)] = graph_.head(arc);
    }
}

void IncumbentWindow::restart(std::size_t max_arcs) {
    max_arcs_ = max_arcs;
    settled_.assign(to_index(graph_.cone_count()), 0);
}

int IncumbentWindow::next_centre(const std::array<std::vector<int>, 2>& legs) const {
    const std::size_t longest = std::max(legs[0].size(), legs[1].size());
    for (std::size_t back = 1; back <= longest; ++back) {
        for (const std::vector<int>& leg : legs) {
            if (back > leg.size()) continue;
            const int cone = graph_.head(leg[leg.size() - back]);
            if (settled_[to_index(cone)] == 0) return cone;
        }
    }
    return -1;
}

/// Collects the cones around the centre, until there are enough arcs among them.
void IncumbentWindow::spread(int centre) {
    place_.assign(to_index(graph_.cone_count()), Place::outside);
    place_[to_index(centre)] = Place::reached;
    cones_.assign(1, centre);
    std::size_t arcs = 0;
    std::size_t done = 0;
    for (; done < cones_.size() && arcs < max_arcs_; ++done) {
        const int cone = cones_[done];
        place_[to_index(cone)] = Place::inside;
        for (int k = next_start_[to_index(cone)]; k < next_start_[to_index(cone) + 1]; ++k) {
            const int other = next_[to_index(k)];
            if (place_[to_index(other)] == Place::inside) arcs += 2;  // and the way back, mostly
            if (place_[to_index(other)] != Place::outside) continue;
            place_[to_index(other)] = Place::reached;
            cones_.push_back(other);
        }
    }
    holds_all_ = done == cones_.size();
    cones_.resize(done);
}

bool IncumbentWindow::next(const std::array<std::vector<int>, 2>& legs, std::vector<int>& arcs) {
    const int centre = next_centre(legs);
    if (centre < 0) return false;
    spread(centre);
    of_legs_.assign(to_index(graph_.arc_count()), 0);
    blocked_.assign((to_index(graph_.edge_count()) + 63) / 64, 0);
    fixed_cones_.clear();
    system_.kind_count = 2;
    system_.ends_are_partners = true;
    for (std::size_t k = 0; k < 2; ++k) fix_outside(legs[k], system_.kinds[k]);
    for (const int cone : fixed_cones_) place_[to_index(cone)] = Place::outside;
    arcs.clear();
    for (int a = 0; a < whole_.size(); ++a) {
        const int arc = whole_.arc[to_index(a)];
        const std::size_t edge = to_index(arc / 2);
        const bool open =
            usable_[to_index(arc)] != 0 && is_inside(arc) && (blocked_[edge / 64] >> (edge % 64) & 1) == 0;
        if (open || of_legs_[to_index(arc)] != 0) arcs.push_back(a);
    }
    return true;
}

/// Arcs of the leg that are not in the window stay, and exclude others there: those that are incompatible
/// with them, and those at a cone between two of them, or at a start or an end.
void IncumbentWindow::fix_outside(std::span<const int> leg, LegSystem::Kind& kind) {
    kind = whole_system_.kinds[0];
    const auto fix_end = [&](std::vector<char>& ends, int cone) {
        std::ranges::fill(ends, char{0});
        ends[to_index(cone)] = 1;
        fixed_cones_.push_back(cone);
    };
    if (!is_inside(leg.front())) fix_end(kind.start, graph_.tail(leg.front()));
    if (!is_inside(leg.back())) fix_end(kind.end, graph_.head(leg.back()));
    for (std::size_t i = 0; i < leg.size(); ++i) {
        of_legs_[to_index(leg[i])] = 1;
        if (is_inside(leg[i])) continue;
        const std::span<const std::uint64_t> row = graph_.incompatible_row(leg[i] / 2);
        for (std::size_t w = 0; w < blocked_.size(); ++w) blocked_[w] |= row[w];
        if (i + 1 < leg.size() && !is_inside(leg[i + 1])) fixed_cones_.push_back(graph_.head(leg[i]));
    }
}

void IncumbentWindow::report(bool improved) {
    const std::size_t near =
        improved || holds_all_ ? cones_.size() : std::max<std::size_t>(1, cones_.size() / 2);
    for (std::size_t k = 0; k < near; ++k) settled_[to_index(cones_[k])] = improved ? 0 : 1;
}

}  // namespace conelane::path_pair
