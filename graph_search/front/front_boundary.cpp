#include "graph_search/front/front_boundary.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <tuple>

namespace conelane {
namespace {

/// A segment of at least this length counts in full.
constexpr double kFullSegment_m = 2.0;
// Each of these costs as much as a whole segment earns.
constexpr double kTurnScale_rad = 1.2;
constexpr double kTurnChangeScale_rad = 0.9;
constexpr double kLogRatioScale = 0.8;
constexpr double kStartAhead_m = 6.0;
constexpr double kOffUsual_m = 2.0;
/// Largest curvature with which a chain is continued back to the car: its first cones tell little of corners.
constexpr double kSharpestBack_1pm = 0.1;

double squared(double value) {
    return value * value;
}

}  // namespace

std::optional<Side> BoundarySearch::find(FrontMap& map, SearchBudget& budget, std::vector<Vertex>& cones) {
    cones.clear();
    chains_.clear();
    start(map);
    std::size_t best = kNone;
    std::size_t first = 0;
    while (first < chains_.size()) {
        const std::size_t last = chains_.size();
        next_.clear();
        for (std::size_t number = first; number < last; ++number) {
            const Chain& chain = chains_[number];
            if (is_boundary(chain) && (best == kNone || chain.score > chains_[best].score)) {
                best = number;
            }
            if (chain.count < rules_.max_cones) extend(map, number);
            if (budget.read_clock()) return std::nullopt;
        }
        keep_best(last);
        first = last;
    }
    if (best == kNone) return std::nullopt;
    for (std::size_t number = best; number != kNone; number = chains_[number].parent)
        cones.push_back(chains_[number].last);
    std::ranges::reverse(cones);
    return chains_[best].side;
}

bool BoundarySearch::is_boundary(const Chain& chain) const {
    return chain.count >= rules_.fewest_cones && chain.score >= rules_.least_score &&
           chain.score >= rules_.least_mean_score * static_cast<double>(chain.count - 1);
}

void BoundarySearch::start(const FrontMap& map) {
    const auto [first, last] = map.ahead_between(-rules_.start_behind_m, rules_.start_ahead_m);
    next_.clear();
    for (Vertex cone = first; cone < last; ++cone) {
        const Point& at = map.position(cone);
        if (std::abs(at.y()) > rules_.start_aside_m) continue;
        const double score = -squared(std::max(0.0, at.x()) / kStartAhead_m);
        next_.push_back({.last = cone, .parent = kNone, .count = 1, .score = score, .direction = {1.0, 0.0}});
    }
    keep_best(0);
}

void BoundarySearch::extend(FrontMap& map, std::size_t number) {
    const Chain chain = chains_[number];
    const std::span<const FrontEdge> edges = map.edges(chain.last);
    for (std::size_t i = 0; i < edges.size(); ++i) {
        const FrontEdge& edge = edges[i];
        const double length_m = edge.length_m;
        if (length_m < rules_.shortest_segment_m) continue;
        const double turn_rad =
            front_angle(cross(chain.direction, edge.direction), chain.direction.dot(edge.direction));
        const double turn_size_rad = std::abs(turn_rad);
        if (length_m > kShortSegment_m) {
            if (chain.count < rules_.fewest_cones || length_m > kMaxSegment_m) break;
            if (turn_size_rad > rules_.largest_bridging_turn_rad || map.neighbourhood(chain.last, i).blocked)
                continue;
        }
        Chain longer{.last = edge.to,
                     .parent = number,
                     .count = chain.count + 1,
                     .score = chain.score + std::min(1.0, length_m / kFullSegment_m),
                     .direction = edge.direction,
                     .segment_m = length_m,
                     .side = chain.side};
        if (chain.count == 1) {
            if (turn_size_rad > rules_.largest_first_turn_rad) continue;
        } else {
            const double ratio = std::max(length_m / chain.segment_m, chain.segment_m / length_m);
            const double change_rad = chain.count > 2 ? std::abs(turn_rad - chain.turn_rad) : 0.0;
            if (turn_size_rad > rules_.largest_turn_rad || change_rad > rules_.largest_turn_change_rad)
                continue;
            // A segment that bridges a gap may have any length.
            if (length_m <= kShortSegment_m) {
                if (ratio > rules_.largest_length_ratio && chain.segment_m <= kShortSegment_m) continue;
                longer.score -=
                    squared(std::log(std::min(ratio, rules_.largest_length_ratio)) / kLogRatioScale);
            }
            longer.score -= squared(turn_rad / kTurnScale_rad) + squared(change_rad / kTurnChangeScale_rad);
            longer.turn_rad = turn_rad;
        }
        if (chain.count == 2) {
            const Point& first = map.position(chains_[chain.parent].last);
            const double left_m = car_to_left_m(first, chain, turn_rad, length_m);
            const double off_m = std::abs(left_m);
            if (!(off_m >= rules_.nearest_m && off_m <= rules_.farthest_m)) continue;
            longer.side = left_m > 0.0 ? kRight : kLeft;
            longer.score -= squared((off_m - rules_.usual_distance_m) / kOffUsual_m);
        }
        const Segment added{map.position(chain.last), map.position(edge.to)};
        if (!meets(map, number, added, edge.to)) next_.push_back(longer);
    }
}

double BoundarySearch::car_to_left_m(const Point& first, const Chain& chain, double turn_rad,
                                     double segment_m) {
    // The tangent at the first cone is turned back from the first segment, by its share of the turn.
    const double bend_1pm =
        std::clamp(2.0 * turn_rad / (chain.segment_m + segment_m), -kSharpestBack_1pm, kSharpestBack_1pm);
    const double back_rad = 0.5 * bend_1pm * chain.segment_m;
    const Point& d = chain.direction;
    const Point tangent(std::cos(back_rad) * d.x() + std::sin(back_rad) * d.y(),
                        std::cos(back_rad) * d.y() - std::sin(back_rad) * d.x());
    const Point car = -first;
    const double left_m = cross(tangent, car);
    // Distance from the circle of that bend; from the tangent if the bend is 0.
    const double square = 1.0 - 2.0 * bend_1pm * left_m + bend_1pm * bend_1pm * car.squaredNorm();
    return (2.0 * left_m - bend_1pm * car.squaredNorm()) / (1.0 + std::sqrt(std::max(0.0, square)));
}

bool BoundarySearch::meets(const FrontMap& map, std::size_t number, const Segment& added, Vertex to) const {
    const Vertex last = chains_[number].last;
    for (; number != kNone; number = chains_[number].parent) {
        const Chain& chain = chains_[number];
        if (chain.last == to) return true;
        if (chain.parent == kNone || chain.last == last) continue;
        const Segment segment{map.position(chains_[chain.parent].last), map.position(chain.last)};
        if (segments_intersect(added, segment)) return true;
    }
    return false;
}

void BoundarySearch::keep_best(std::size_t first) {
    std::ranges::sort(next_, {},
                      [](const Chain& chain) { return std::tuple(-chain.score, chain.parent, chain.last); });
    for (const Chain& chain : next_) {
        if (chains_.size() - first == rules_.beam_width) break;
        // The rest of a chain depends on its last three cones: of chains that share them, the best stays.
        const auto cone_before = [&](std::size_t number) {
            return number == kNone ? kNoCone : chains_[number].last;
        };
        const auto same_end = [&](std::size_t kept) {
            const Chain& other = chains_[kept];
            if (other.last != chain.last || cone_before(other.parent) != cone_before(chain.parent))
                return false;
            if (chain.parent == kNone) return true;
            return cone_before(chains_[other.parent].parent) == cone_before(chains_[chain.parent].parent);
        };
        bool is_new = true;
        for (std::size_t kept = first; kept < chains_.size() && is_new; ++kept) is_new = !same_end(kept);
        if (is_new) chains_.push_back(chain);
    }
}

}  // namespace conelane
