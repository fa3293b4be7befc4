#include "graph_search/front/front_state.hpp"

#include <algorithm>
#include <tuple>

namespace conelane {
namespace {

/// Width of a usual lane; it counts as one measured width.
constexpr float kDefaultWidth_m = 3.6F;

/// Whether the other boundary's last cones leave room for a segment.
bool leaves_room(const FrontMap& map, const FrontEnd& other, Vertex from, Vertex to,
                 const FrontRules& rules) {
    const Segment segment{map.position(from), map.position(to)};
    const double narrowest_m = narrowest_between_m(map, to, other.cones[0], rules);
    const auto near = [&](const Segment& facing) { return come_within(segment, facing, narrowest_m); };
    const Point& last = map.position(other.cones[0]);
    if (other.count < 2) return !near({last, last});
    const Point& before = map.position(other.cones[1]);
    if (near({last, before})) return false;
    return other.count < 3 || !near({before, map.position(other.cones[2])});
}

/// Whether a side that continues alone stays near the end of the side that has stopped.
bool stays_near(const FrontMap& map, const FrontEnd& other, const Point& cone, const FrontRules& rules) {
    if (!other.stopped) return true;
    double distance_m = (cone - map.position(other.cones[0])).norm();
    for (std::size_t i = 1; i < std::min<std::size_t>(other.count, other.cones.size()); ++i) {
        const Segment segment{map.position(other.cones[i]), map.position(other.cones[i - 1])};
        distance_m = std::min(distance_m, foot_point(cone, segment).distance_m);
    }
    return distance_m <= rules.widest_alone_m;
}

}  // namespace

float FrontState::mean_width_m() const {
    return (kDefaultWidth_m + width_sum_m) / static_cast<float>(1 + widths);
}

float FrontState::color_agreement() const {
    return color_sum / static_cast<float>(1 + ends[kLeft].count + ends[kRight].count);
}

bool FrontState::same_front(const FrontState& other) const {
    return std::ranges::equal(ends, other.ends, [](const FrontEnd& a, const FrontEnd& b) {
        return a.cones == b.cones && a.stopped == b.stopped;
    });
}

FrontState start_state(const FrontMap& map, Vertex left, Vertex right) {
    FrontState state;
    const std::array<Vertex, 2> cones{left, right};
    for (const Side side : {kLeft, kRight}) {
        state.ends[side].cones[0] = cones[side];
        state.ends[side].count = 1;
        // The place of the first cone counts as progress: otherwise lanes that begin later seem behind.
        state.ends[side].length_m = std::max(0.0, map.position(cones[side]).x());
        if (map.has_colors()) state.color_sum += map.color(cones[side]).speaks_for(side);
    }
    return state;
}

Side moving_side(const FrontMap& map, const FrontState& state) {
    const auto& [left, right] = state.ends;
    if (left.stopped) return kRight;
    if (right.stopped) return kLeft;
    const Point along = left.direction + right.direction;
    const Point lead = map.position(left.cones[0]) - map.position(right.cones[0]);
    return lead.dot(along) <= 0.0 ? kLeft : kRight;
}

FrontState moved(FrontMap& map, const FrontState& state, Side side, const FrontMove& move) {
    FrontState next = state;
    FrontEnd& end = next.ends[side];
    if (move.stops()) {
        end.stopped = true;
        return next;
    }
    const FrontEdge& edge = map.edges(end.cones[0])[move.edge];
    if (end.count > 1) {
        end.turn_rad = static_cast<float>(
            wrapped_angle(static_cast<double>(edge.bearing_rad) - static_cast<double>(end.bearing_rad)));
    }
    end.cones = {move.to, end.cones[0], end.cones[1]};
    end.direction = edge.direction;
    end.bearing_rad = edge.bearing_rad;
    end.segment_m = edge.length_m;
    end.log_segment = edge.log_length;
    end.length_m += static_cast<double>(edge.length_m);
    ++end.count;
    next.width_sum_m +=
        static_cast<float>(facing_distance_m(map, state.ends[opposite(side)], map.position(move.to)));
    ++next.widths;
    if (map.has_colors()) next.color_sum += map.color(move.to).speaks_for(side);
    return next;
}

double narrowest_between_m(const FrontMap& map, Vertex added, Vertex facing, const FrontRules& rules) {
    constexpr double kLeast_m = 0.5;
    if (!map.has_spread()) return rules.narrowest_m;
    return std::max(kLeast_m,
                    rules.narrowest_m - rules.narrowest_spreads * map.spread_between_m(added, facing));
}

void FrontMoves::list(FrontMap& map, const FrontState& state, Side side, const FrontRules& rules) {
    const FrontEnd& own = state.ends[side];
    const FrontEnd& other = state.ends[opposite(side)];
    const Vertex from = own.cones[0];
    extensions.clear();
    long_segments_.clear();
    left_out = false;
    stops = own.count > 1;
    // The cosine is compared, so that no angle is computed.
    const double least =
        own.count > 1 ? turn_.of(rules.largest_turn_rad) : first_turn_.of(rules.largest_first_turn_rad);
    const double least_long = long_turn_.of(rules.largest_long_turn_rad);
    const std::span<const FrontEdge> edges = map.edges(from);
    const auto is_allowed = [&](const FrontEdge& edge) {
        if (edge.to == other.cones[0] || edge.to == other.cones[1] || edge.to == own.cones[1]) return false;
        if (own.length_m + static_cast<double>(edge.length_m) > rules.longest_boundary_m) return false;
        return leaves_room(map, other, from, edge.to, rules) &&
               stays_near(map, other, map.position(edge.to), rules);
    };
    // By how much the cosine may be off: all limits are about a right angle.
    const auto slack = [&](const FrontEdge& edge) {
        if (!map.has_spread()) return 0.0;
        const Point across(-edge.direction.y(), edge.direction.x());
        const double variance_m2 = map.variance_m2(from, across) + map.variance_m2(edge.to, across);
        return rules.turn_spreads * std::sqrt(3.0 * variance_m2) /
               std::max(static_cast<double>(edge.length_m), 1.0);
    };
    for (std::size_t i = 0; i < edges.size(); ++i) {
        const FrontEdge& edge = edges[i];
        const double straightness = own.direction.dot(edge.direction) + slack(edge);
        if (edge.length_m <= static_cast<float>(kShortSegment_m)) {
            if (straightness < least || !is_allowed(edge)) continue;
            if (extensions.size() == rules.short_segments) {
                left_out = true;
                continue;
            }
            extensions.push_back({edge.to, i});
        } else if (straightness >= least_long) {
            long_segments_.push_back(
                {std::abs(cross(own.direction, edge.direction)) * static_cast<double>(edge.length_m), i});
        }
    }
    std::ranges::sort(long_segments_, [](const LongSegment& a, const LongSegment& b) {
        return std::tie(a.off_m, a.edge) < std::tie(b.off_m, b.edge);
    });
    std::size_t added = 0;
    for (const LongSegment& candidate : long_segments_) {
        if (added == rules.long_segments) break;
        const FrontEdge& edge = edges[candidate.edge];
        if (!is_allowed(edge) || map.neighbourhood(from, candidate.edge).blocked) continue;
        extensions.push_back({edge.to, candidate.edge});
        ++added;
    }
}

void FrontStarts::list(const FrontMap& map, const FrontRules& rules) {
    left_out = false;
    const auto [first, last] = map.ahead_between(-rules.start_behind_m, rules.start_ahead_m);
    for (const Side side : {kLeft, kRight}) {
        std::vector<Vertex>& found = cones[side];
        found.clear();
        for (Vertex cone = first; cone < last; ++cone) {
            const double outward_m = side == kLeft ? map.position(cone).y() : -map.position(cone).y();
            if (outward_m >= -rules.start_across_m && outward_m <= rules.start_aside_m) found.push_back(cone);
        }
        if (found.size() <= rules.start_cones) continue;
        left_out = true;
        std::ranges::sort(found, [&](Vertex a, Vertex b) {
            return std::tuple(map.position(a).squaredNorm(), a) <
                   std::tuple(map.position(b).squaredNorm(), b);
        });
        found.resize(rules.start_cones);
    }
    pairs.clear();
    for (std::size_t left = 0; left < cones[kLeft].size(); ++left) {
        const Point& l = map.position(cones[kLeft][left]);
        for (std::size_t right = 0; right < cones[kRight].size(); ++right) {
            const Point& r = map.position(cones[kRight][right]);
            const double width_m = (l - r).norm();
            const double narrowest_m =
                narrowest_between_m(map, cones[kLeft][left], cones[kRight][right], rules);
            if (width_m < narrowest_m || width_m > rules.widest_start_m) continue;
            if (l.y() <= r.y()) continue;  // the sides would be swapped
            pairs.push_back({left, right});
        }
    }
}

}  // namespace conelane
