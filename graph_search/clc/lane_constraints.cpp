#include "graph_search/clc/lane_constraints.hpp"

#include "graph_search/shared/simd_batch.hpp"
#include "model/geometry.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace conelane {
namespace {

/// Segments of a boundary that are tested together.
constexpr std::size_t kChunk = 8;
static_assert(kChunk <= BoundaryArrays::kSpare);

/// Whether two segments are apart in x or in y. Of segments whose ends are on different sides of each other,
/// the others nearly always meet; the exact predicate decides.
bool are_apart(const Segment& line, const Segment& segment) {
    const auto apart = [](double a, double b, double c, double d) {
        return std::max(a, b) < std::min(c, d) || std::max(c, d) < std::min(a, b);
    };
    return apart(line.from.x(), line.to.x(), segment.from.x(), segment.to.x()) ||
           apart(line.from.y(), line.to.y(), segment.from.y(), segment.to.y());
}

bool segment_meets(const Segment& line, const Segment& segment) {
    return !are_apart(line, segment) && segments_intersect(line, segment);
}

/// The first of `count` segments of a boundary, from `first` on, that `line` may meet, rounded down to a
/// multiple of a chunk from `first`; `count` if there is none. The ends of each are tested against the line
/// through the other without a branch, so that the loop vectorises.
CONELANE_SIMD std::size_t first_suspicious_chunk(const BoundaryArrays& boundary, std::size_t first,
                                                 std::size_t count, const Segment& line) {
    const double* const x = boundary.x.data();
    const double* const y = boundary.y.data();
    const double* const all_dx = boundary.dx.data();
    const double* const all_dy = boundary.dy.data();
    const double line_from_x = line.from.x();
    const double line_from_y = line.from.y();
    const double line_to_x = line.to.x();
    const double line_to_y = line.to.y();
    const double line_dx = line_to_x - line_from_x;
    const double line_dy = line_to_y - line_from_y;
    for (; first < count; first += kChunk) {
        std::int64_t suspicious = 0;
        for (std::size_t i = first; i < first + kChunk; ++i) {
            const double from_x = x[i] - line_from_x;
            const double from_y = y[i] - line_from_y;
            const double dx = all_dx[i];
            const double dy = all_dy[i];
            const double begin_side = line_dx * from_y - line_dy * from_x;
            const double end_side = line_dx * (y[i + 1] - line_from_y) - line_dy * (x[i + 1] - line_from_x);
            const double line_begin_side = dy * from_x - dx * from_y;
            const double line_end_side = dx * (line_to_y - y[i]) - dy * (line_to_x - x[i]);
            suspicious |= static_cast<std::int64_t>(i < count) &
                          static_cast<std::int64_t>(begin_side * end_side <= 0.0) &
                          static_cast<std::int64_t>(line_begin_side * line_end_side <= 0.0);
        }
        if (suspicious != 0) break;
    }
    return first;
}

/// Whether `line` meets one of the first `count` segments of a boundary.
bool meets(const BoundaryArrays& boundary, std::size_t count, const Segment& line) {
    for (std::size_t first = 0; first < count; first += kChunk) {
        first = first_suspicious_chunk(boundary, first, count, line);
        for (std::size_t i = first; i < std::min(first + kChunk, count); ++i) {
            if (segment_meets(line, boundary.segment(i))) return true;
        }
    }
    return false;
}

Segment ring_segment(std::span<const Point> ring, std::size_t i) {
    return {ring[i], ring[(i + 1) % ring.size()]};
}

bool ends_near(std::span<const Point> ring, double d_max_m) {
    const double gap_m = (ring.back() - ring.front()).norm();
    return gap_m > 0.0 && gap_m <= d_max_m;
}

bool turns_allowed(std::span<const Point> ring, double phi_max_rad) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const Segment in = ring_segment(ring, i);
        const Segment out = ring_segment(ring, (i + 1) % ring.size());
        if (std::abs(turning_angle(in.to - in.from, out.to - out.from)) >= phi_max_rad) return false;
    }
    return true;
}

bool is_simple(std::span<const Point> ring) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
        for (std::size_t j = i + 2; j < ring.size(); ++j) {
            if (i == 0 && j == ring.size() - 1) continue;
            if (segments_intersect(ring_segment(ring, i), ring_segment(ring, j))) return false;
        }
    }
    return true;
}

bool rings_meet(std::span<const Point> a, std::span<const Point> b) {
    for (std::size_t i = 0; i < a.size(); ++i) {
        for (std::size_t j = 0; j < b.size(); ++j) {
            if (segments_intersect(ring_segment(a, i), ring_segment(b, j))) return true;
        }
    }
    return false;
}

/// Only for a point that is on no segment of the ring.
bool encloses(std::span<const Point> ring, const Point& point) {
    double winding_rad = 0.0;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const Segment segment = ring_segment(ring, i);
        winding_rad += turning_angle(segment.from - point, segment.to - point);
    }
    return std::abs(winding_rad) > std::numbers::pi;
}

}  // namespace

void LaneConstraints::reset(const Point& left, const Point& right, const LaneBounds& bounds,
                            WidthBacktracking rule) {
    bounds_ = bounds;
    rule_ = rule;
    width_.reset(left, right, bounds.w_max_m);
    State start;
    start.hopeless = width_.state().narrowest_squared <= bounds.w_min_m * bounds.w_min_m;
    start.needs.fill(width_.state().too_wide[kLeft] > 0);
    start.feasible = !start.hopeless && !start.needs[kLeft];
    states_.assign(1, start);
}

void LaneConstraints::push(Side side, const Point& point, bool turn_allowed) {
    State next;
    next.hopeless = states_.back().hopeless || !turn_allowed || new_segment_meets(side, point);
    if (next.hopeless) {
        width_.push_unmeasured(side, point);
    } else {
        width_.push(side, point);
        const OnlineLaneWidth::State& width = width_.state();
        next.hopeless = width.narrowest_squared <= bounds_.w_min_m * bounds_.w_min_m ||
                        (rule_ == WidthBacktracking::left_behind && width.too_wide_behind);
        if (!next.hopeless) {
            // A vertex that is too far from the other boundary needs an extension of that boundary.
            next.needs = {width.too_wide[kRight] > 0, width.too_wide[kLeft] > 0};
            next.end_line_meets = end_line_meets();
            next.feasible = !next.needs[kLeft] && !next.needs[kRight] && !next.end_line_meets;
        }
    }
    states_.push_back(next);
}

void LaneConstraints::pop(Side side) {
    width_.pop(side);
    states_.pop_back();
}

bool LaneConstraints::new_segment_meets(Side side, const Point& point) const {
    const BoundaryArrays& own = width_.boundary(side);
    const BoundaryArrays& other = width_.boundary(opposite(side));
    const Segment segment{own.vertex(own.size - 1), point};
    if (meets(other, other.size - 1, segment)) return true;
    // The first segment of a side is adjacent to the line between the first points.
    if (own.size == 1) return false;
    return meets(own, own.size - 2, segment) || segment_meets(segment, {own.vertex(0), other.vertex(0)});
}

bool LaneConstraints::end_line_meets() const {
    const BoundaryArrays& left = width_.boundary(kLeft);
    const BoundaryArrays& right = width_.boundary(kRight);
    const Segment end_line{left.vertex(left.size - 1), right.vertex(right.size - 1)};
    if (left.size > 2 && meets(left, left.size - 2, end_line)) return true;
    if (right.size > 2 && meets(right, right.size - 2, end_line)) return true;
    return left.size > 1 && right.size > 1 && segment_meets(end_line, {left.vertex(0), right.vertex(0)});
}

bool can_be_closed(std::span<const Point> left, std::span<const Point> right, double d_max_m,
                   const LaneBounds& bounds) {
    if (left.size() < 3 || right.size() < 3) return false;
    if (!ends_near(left, d_max_m) || !ends_near(right, d_max_m)) return false;
    for (const std::span<const Point> ring : {left, right}) {
        if (!turns_allowed(ring, bounds.phi_max_rad) || !is_simple(ring)) return false;
    }
    if (rings_meet(left, right)) return false;
    if (!encloses(left, right.front()) && !encloses(right, left.front())) return false;
    const LaneWidths widths = lane_widths(left, right, true);
    const auto allowed = [&](double width_m) { return bounds.w_min_m < width_m && width_m < bounds.w_max_m; };
    return std::ranges::all_of(widths.of_vertex_m[kLeft], allowed) &&
           std::ranges::all_of(widths.of_vertex_m[kRight], allowed) &&
           std::ranges::all_of(widths.of_segment_m[kLeft], allowed) &&
           std::ranges::all_of(widths.of_segment_m[kRight], allowed);
}

}  // namespace conelane
