#include "graph_search/front/front_map.hpp"

#include <tuple>

namespace conelane {
namespace {

/// A cone farther than this from a way does not count as beside it.
constexpr double kBeside_m = 2.0;
constexpr double kBlocking_m = 0.2;
constexpr double kMiddleFrom = 0.15;
constexpr double kMiddleTo = 0.85;
/// Shares of a way between which a cone counts as beside it: cones at the ends are left out.
constexpr double kBesideFrom = 0.1;
constexpr double kBesideTo = 0.9;
/// The value of `continuation` if no segment continues the way.
constexpr float kNoContinuation = 2.0F;

}  // namespace

double front_angle(double cross, double dot) {
    const double x = std::abs(dot);
    const double y = std::abs(cross);
    if (x + y == 0.0) return 0.0;
    const double ratio = std::min(x, y) / std::max(x, y);
    const double s = ratio * ratio;
    // Minimax polynomial of the arc tangent on [0, 1].
    double angle =
        ratio * (0.99997726 +
                 s * (-0.33262347 + s * (0.19354346 + s * (-0.11643287 + s * (0.05265332 - s * 0.0117212)))));
    if (y > x) angle = std::numbers::pi / 2.0 - angle;
    if (dot < 0.0) angle = std::numbers::pi - angle;
    return cross < 0.0 ? -angle : angle;
}

void FrontMap::build(const Scene& scene, SearchBudget& budget) {
    const Point heading = scene.pose.heading();
    const std::size_t count = scene.cones.size();
    found_.clear();
    positions_.resize(count);
    order_.resize(count);
    const auto in_car_frame = [&](std::size_t i) {
        const Point from_car = scene.cones[i].position - scene.pose.position;
        return Point(heading.dot(from_car), cross(heading, from_car));
    };
    for (std::size_t i = 0; i < count; ++i) {
        order_[i] = static_cast<std::uint32_t>(i);
        positions_[i] = in_car_frame(i);
    }
    std::ranges::sort(order_, [&](std::uint32_t a, std::uint32_t b) {
        return std::tuple(positions_[a].x(), positions_[a].y(), scene.cones[a].id) <
               std::tuple(positions_[b].x(), positions_[b].y(), scene.cones[b].id);
    });
    for (std::size_t i = 0; i < count; ++i) positions_[i] = in_car_frame(order_[i]);
    find_view_radius(budget);
    take_colors(scene, budget);
    take_spread(scene);
    places_.assign(count, {0, kNotAsked});
    used_ = 0;
    left_out_edges_ = false;
}

void FrontMap::take_colors(const Scene& scene, SearchBudget& budget) {
    has_colors_ = std::ranges::any_of(scene.cones, [](const Cone& cone) {
        return cone.color_probabilities ? cone.color_probabilities->unknown < 1.0
                                        : cone.color != ConeColor::unknown;
    });
    color_share_ = 0.0F;
    color_consistency_ = 0.0F;
    if (!has_colors_) return;
    colors_.resize(positions_.size());
    for (Vertex cone = 0; cone < positions_.size(); ++cone) {
        const ColorProbabilities p = scene.cones[order_[cone]].probabilities();
        colors_[cone] = {{static_cast<float>(p.blue), static_cast<float>(p.yellow)},
                         static_cast<float>(p.orange + p.big_orange)};
        color_share_ += colors_[cone].of_side[kLeft] + colors_[cone].of_side[kRight];
    }
    color_share_ /= static_cast<float>(positions_.size());
    float sum = 0.0F;
    float pairs = 0.0F;
    for (Vertex cone = 0; cone < positions_.size(); ++cone) {
        const float own = colors_[cone].speaks_for(kLeft);
        if (own == 0.0F) continue;
        const Vertex other = nearest_colored(cone, budget);
        if (budget.stopped_by) return;
        if (other == kNoCone) continue;
        sum += own * colors_[other].speaks_for(kLeft);
        pairs += 1.0F;
    }
    if (pairs > 0.0F) color_consistency_ = sum / pairs;
}

void FrontMap::take_spread(const Scene& scene) {
    has_spread_ = std::ranges::any_of(scene.cones, [](const Cone& cone) {
        return cone.position_covariance.value_or(PositionCovariance{}) != PositionCovariance{};
    });
    if (!has_spread_) return;
    const Point ahead = scene.pose.heading();
    const Point left(-ahead.y(), ahead.x());
    spread_.resize(positions_.size());
    for (Vertex cone = 0; cone < positions_.size(); ++cone) {
        const PositionCovariance given =
            scene.cones[order_[cone]].position_covariance.value_or(PositionCovariance{});
        const double xy_m2 = ahead.x() * left.x() * given.xx_m2 +
                             (ahead.x() * left.y() + ahead.y() * left.x()) * given.xy_m2 +
                             ahead.y() * left.y() * given.yy_m2;
        spread_[cone] = {given.along_m2(ahead), xy_m2, given.along_m2(left)};
    }
}

double FrontMap::spread_between_m(Vertex a, Vertex b) const {
    if (!has_spread_) return 0.0;
    const Point apart = positions_[b] - positions_[a];
    const double distance_m = apart.norm();
    if (distance_m == 0.0) return 0.0;
    const Point direction = apart / distance_m;
    return std::sqrt(variance_m2(a, direction) + variance_m2(b, direction));
}

/// The nearest other cone that has a color; of equally near ones the first.
Vertex FrontMap::nearest_colored(Vertex cone, SearchBudget& budget) const {
    const Point& at = positions_[cone];
    double nearest_m2 = kShortSegment_m * kShortSegment_m;
    Vertex nearest = kNoCone;
    const auto goes_on_past = [&](Vertex other) {
        const double ahead_m = positions_[other].x() - at.x();
        if (ahead_m * ahead_m >= nearest_m2 || budget.spend(1)) return false;
        const double off_m2 = (positions_[other] - at).squaredNorm();
        if (off_m2 < nearest_m2 && colors_[other].speaks_for(kLeft) != 0.0F) {
            nearest_m2 = off_m2;
            nearest = other;
        }
        return true;
    };
    for (Vertex other = cone; other > 0 && goes_on_past(other - 1);) --other;
    for (Vertex other = cone + 1; other < positions_.size() && goes_on_past(other);) ++other;
    return nearest;
}

void FrontMap::find_view_radius(SearchBudget& budget) {
    view_radius_m_ = 0.0;
    double farthest_m = 0.0;
    for (Vertex cone = 0; cone < positions_.size(); ++cone) {
        const double distance_m = positions_[cone].norm();
        farthest_m = std::max(farthest_m, distance_m);
        if (distance_m > view_radius_m_ && !is_alone(cone, budget)) view_radius_m_ = distance_m;
        if (budget.stopped_by) return;
    }
    if (view_radius_m_ == 0.0) view_radius_m_ = farthest_m;
}

bool FrontMap::is_alone(Vertex cone, SearchBudget& budget) const {
    const Point& at = positions_[cone];
    const auto [first, last] = ahead_between(at.x() - kMaxSegment_m, at.x() + kMaxSegment_m);
    for (Vertex other = first; other < last && !budget.spend(1); ++other) {
        if (other != cone && (positions_[other] - at).squaredNorm() <= kMaxSegment_m * kMaxSegment_m)
            return false;
    }
    return true;
}

std::pair<Vertex, Vertex> FrontMap::ahead_between(double low_m, double high_m) const {
    const auto x = [](const Point& point) { return point.x(); };
    const auto first = std::ranges::lower_bound(positions_, low_m, {}, x);
    const auto last = std::ranges::upper_bound(positions_, high_m, {}, x);
    return {static_cast<Vertex>(first - positions_.begin()), static_cast<Vertex>(last - positions_.begin())};
}

void FrontMap::find_edges(Vertex from) {
    const Point& at = positions_[from];
    const auto find = [&](double beyond_m, double up_to_m) {
        const auto [first, last] = ahead_between(at.x() - up_to_m, at.x() + up_to_m);
        for (Vertex to = first; to < last; ++to) {
            const Point way = positions_[to] - at;
            const double squared_m2 = way.squaredNorm();
            if (squared_m2 <= beyond_m * beyond_m || squared_m2 > up_to_m * up_to_m) continue;
            const double length_m = std::sqrt(squared_m2);
            found_.push_back(
                {.to = to, .length_m = static_cast<float>(length_m), .direction = way / length_m});
        }
    };
    found_.clear();
    // Shorter ways have no direction, or a float length of 0: the two cones are at the same place.
    constexpr double kOnePlace_m = 1e-9;
    find(kOnePlace_m, kMaxSegment_m);
    std::size_t most = kMaxEdges;
    if (found_.size() < kFewEdges) {
        most = kFewEdges;
        find(kMaxSegment_m, kMaxLengthAmongFew_m);
    } else if (found_.size() > kMaxEdges) {
        left_out_edges_ = true;
    }
    const auto shorter = [](const FrontEdge& a, const FrontEdge& b) {
        return std::tie(a.length_m, a.to) < std::tie(b.length_m, b.to);
    };
    if (found_.size() > most) {
        const auto end = found_.begin() + static_cast<std::ptrdiff_t>(most);
        std::nth_element(found_.begin(), end, found_.end(), shorter);
        found_.erase(end, found_.end());
    }
    std::sort(found_.begin(), found_.end(), shorter);
    // A list of ways must not cross the end of a block.
    if (used_ % kEdgesPerBlock + found_.size() > kEdgesPerBlock)
        used_ += kEdgesPerBlock - used_ % kEdgesPerBlock;
    while (used_ + found_.size() > blocks_.size() * kEdgesPerBlock) {
        // The order matters: if the memory for a block is missing, the larger vector does no harm later.
        neighbourhoods_.resize((blocks_.size() + 1) * kEdgesPerBlock);
        blocks_.emplace_back(kEdgesPerBlock);
    }
    const auto is_short = [](const FrontEdge& edge) {
        return edge.length_m <= static_cast<float>(kShortSegment_m);
    };
    const auto near = static_cast<double>(std::ranges::count_if(found_, is_short));
    places_[from] = {used_, static_cast<std::uint32_t>(found_.size()),
                     static_cast<float>(std::log1p(near) - 1.5)};
    for (FrontEdge& edge : found_) {
        edge.log_length = static_cast<float>(std::log(static_cast<double>(edge.length_m)));
        edge.bearing_rad = static_cast<float>(front_angle(edge.direction.y(), edge.direction.x()));
        neighbourhoods_[used_].known = false;
        *edge_at(used_++) = edge;
    }
}

const EdgeNeighbourhood& FrontMap::neighbourhood(Vertex from, std::size_t edge) {
    const std::size_t place = places_[from].first + edge;
    if (!neighbourhoods_[place].known) {
        EdgeNeighbourhood found = find_neighbourhood(from, edge);
        found.known = true;
        neighbourhoods_[place] = found;  // computing the continuation may have reallocated the vector
    }
    return neighbourhoods_[place];
}

EdgeNeighbourhood FrontMap::find_neighbourhood(Vertex from, std::size_t edge) {
    EdgeNeighbourhood found;
    const std::span<const FrontEdge> near = edges(from);
    const FrontEdge& way = near[edge];
    const double length_m = way.length_m;
    for (const FrontEdge& other : near) {
        if (other.length_m > length_m + kBeside_m) break;
        if (other.to == way.to) continue;
        const double along_m = other.length_m * way.direction.dot(other.direction);
        const double left_m = other.length_m * cross(way.direction, other.direction);
        if (along_m * (along_m - length_m) + left_m * left_m < 0.0) found.within_disc += 1.0F;
        const double share = along_m / length_m;
        const double off_m = std::abs(left_m);
        if (off_m <= kBlocking_m && share >= kMiddleFrom && share <= kMiddleTo) found.blocked = true;
        if (off_m >= kBeside_m || share < kBesideFrom || share > kBesideTo) continue;
        const auto nearness = static_cast<float>(1.0 - off_m / kBeside_m);
        float& nearest = found.nearest_beside[left_m > 0.0 ? kLeft : kRight];
        nearest = std::max(nearest, nearness);
        found.beside += nearness;
        if (!has_colors_) continue;
        for (const Side side : {kLeft, kRight}) {
            const float of_color = nearness * colors_[other.to].of_side[side];
            found.nearest_of_color[side] = std::max(found.nearest_of_color[side], of_color);
        }
    }
    found.continuation = kNoContinuation;
    for (const FrontEdge& next : edges(way.to)) {
        if (next.to == from) continue;
        if (next.length_m < kBeside_m)
            found.crowding = std::max(found.crowding, static_cast<float>(1.0 - next.length_m / kBeside_m));
        if (next.length_m > kShortSegment_m + 1.0) break;
        const double bend_rad = std::abs(
            wrapped_angle(static_cast<double>(next.bearing_rad) - static_cast<double>(way.bearing_rad)));
        const auto badness = static_cast<float>(bend_rad + std::abs(next.log_length - way.log_length));
        found.continuation = std::min(found.continuation, badness);
    }
    return found;
}

std::size_t FrontMap::memory_bytes() const {
    return blocks_.size() * kEdgesPerBlock * (sizeof(FrontEdge) + sizeof(EdgeNeighbourhood));
}

}  // namespace conelane
