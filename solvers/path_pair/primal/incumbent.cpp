#include "solvers/path_pair/primal/incumbent.hpp"

namespace conelane::path_pair {

void Incumbent::reset(double cutoff, double tolerance) {
    cutoff_ = cutoff;
    tolerance_ = tolerance;
    found_ = false;
    edges_.clear();
}

double Incumbent::leg_cost(std::span<const int> leg) const {
    double sum = 0.0;
    for (std::size_t k = 0; k < leg.size(); ++k) {
        sum += graph_->cost(leg[k] / 2);
        if (k > 0) sum += graph_->turn_cost(leg[k - 1], leg[k]);
    }
    return sum;
}

bool Incumbent::goes_far() const {
    return found_ && std::ranges::all_of(legs_, [&](const std::vector<int>& leg) {
               return graph_->near(graph_->tail(leg.front())) && !graph_->near(graph_->head(leg.back()));
           });
}

/// Two ends are near and two are far, these are not too far apart (17), and no leg runs from far to near.
bool Incumbent::has_ends_of_a_lane(std::span<const int> first, std::span<const int> second) const {
    std::array<int, 4> far_ends{};
    std::size_t far_count = 0;
    for (const std::span<const int> leg : {first, second}) {
        const int start = graph_->tail(leg.front());
        const int end = graph_->head(leg.back());
        if (!graph_->near(start) && graph_->near(end)) return false;
        for (const int cone : {start, end}) {
            if (!graph_->near(cone)) far_ends[far_count++] = cone;
        }
    }
    return far_count == 2 && graph_->are_partners(far_ends[0], far_ends[1]);
}

bool Incumbent::offer(std::span<const int> first, std::span<const int> second) {
    if (first.empty() || second.empty()) return false;
    const double cost = leg_cost(first) + leg_cost(second);
    if (!(cost < cutoff_)) return false;
    if (!has_ends_of_a_lane(first, second)) return false;
    visited_.assign(to_index(graph_->cone_count()), 0);
    candidate_.clear();
    int along_heading = 0;
    for (const std::span<const int> leg : {first, second}) {
        char& start = visited_[to_index(graph_->tail(leg.front()))];
        if (start != 0) return false;
        start = 1;
        for (const int arc : leg) {
            char& visited = visited_[to_index(graph_->head(arc))];
            if (visited != 0) return false;
            visited = 1;
            candidate_.push_back(arc / 2);
            along_heading += graph_->along_heading(arc / 2) ? 1 : 0;
        }
    }
    if (along_heading < 2) return false;
    for (std::size_t k = 0; k < candidate_.size(); ++k) {
        for (std::size_t l = 0; l < k; ++l) {
            if (graph_->incompatible(candidate_[k], candidate_[l])) return false;
        }
    }
    cutoff_ = cost;
    found_ = true;
    edges_ = candidate_;
    legs_[0].assign(first.begin(), first.end());
    legs_[1].assign(second.begin(), second.end());
    return true;
}

}  // namespace conelane::path_pair
