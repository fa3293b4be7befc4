#include "graph_search/clc/lane_width.hpp"

#include "graph_search/shared/simd_batch.hpp"

namespace conelane {
namespace {

std::vector<Segment> segments_of(std::span<const Point> vertices, bool closed) {
    std::vector<Segment> segments;
    for (std::size_t i = 1; i < vertices.size(); ++i) segments.push_back({vertices[i - 1], vertices[i]});
    if (closed && vertices.size() > 1) segments.push_back({vertices.back(), vertices.front()});
    return segments;
}

/// From this parameter on, a foot point counts as the end of its segment: rounding may place it just below 1.
constexpr double kEndOfSegment = 1.0 - 1e-9;

struct SquaredDistance {
    double value;
    double foot;  ///< parameter on the segment, in [0, 1]
};

/// Of a point at offset (px, py) from the segment's begin. Plain arithmetic, so that loops vectorise.
SquaredDistance to_segment(double px, double py, double dx, double dy, double inverse_squared_length) {
    const double foot = std::min(1.0, std::max(0.0, (px * dx + py * dy) * inverse_squared_length));
    const double ex = px - foot * dx;
    const double ey = py - foot * dy;
    return {ex * ex + ey * ey, foot};
}

static_assert(kDoublesPerBatch <= BoundaryArrays::kSpare);

constexpr std::size_t whole_fours(std::size_t count) {
    return (count + kDoublesPerBatch - 1) / kDoublesPerBatch * kDoublesPerBatch;
}

/// For the first `count`; values behind them, up to a multiple of four, are overwritten.
inline double smallest(double* values, std::size_t count) {
    constexpr double kNone = std::numeric_limits<double>::infinity();
    const std::size_t end = whole_fours(count);
    for (std::size_t i = count; i < end; ++i) values[i] = kNone;
    Doubles lanes{kNone, kNone, kNone, kNone};
    for (std::size_t i = 0; i < end; i += kDoublesPerBatch) {
        const Doubles next = *reinterpret_cast<const UnalignedDoubles*>(values + i);
        lanes = next < lanes ? next : lanes;
    }
    return std::min(std::min(lanes[0], lanes[1]), std::min(lanes[2], lanes[3]));
}

/// What a push measures: the facing vertices against the new segment, and the facing segments against the new
/// vertex.
struct Measured {
    double* to_segment;  ///< squared, one for each facing vertex
    double* foot;        ///< parameter on the segment at which it is attained, in [0, 1]
    double* to_vertex;   ///< squared, one for each facing segment
    double nearest_to_segment;
    double nearest_to_vertex;
};

/// `i`: the new segment of `own`. If there is only one facing vertex, no facing segment is measured against
/// the new vertex.
CONELANE_SIMD void measure(const BoundaryArrays& own, std::size_t i, const BoundaryArrays& facing,
                           Measured& measured) {
    const std::size_t n = facing.size;
    const auto at = [](const std::vector<double>& values, std::size_t k) -> const UnalignedDoubles& {
        return *reinterpret_cast<const UnalignedDoubles*>(values.data() + k);
    };
    const double from_x = own.x[i];
    const double from_y = own.y[i];
    const double to_x = own.x[i + 1];
    const double to_y = own.y[i + 1];
    const double dx = own.dx[i];
    const double dy = own.dy[i];
    const double inverse = own.inverse_squared_length[i];
    // As in to_segment, up to a multiple of four: entries behind the last one are spare.
    for (std::size_t k = 0; k < whole_fours(n); k += kDoublesPerBatch) {
        const Doubles px = at(facing.x, k) - from_x;
        const Doubles py = at(facing.y, k) - from_y;
        Doubles foot = (px * dx + py * dy) * inverse;
        foot = foot > 0.0 ? foot : Doubles{};
        foot = foot < 1.0 ? foot : Doubles{} + 1.0;
        const Doubles ex = px - foot * dx;
        const Doubles ey = py - foot * dy;
        *reinterpret_cast<UnalignedDoubles*>(measured.to_segment + k) = ex * ex + ey * ey;
        *reinterpret_cast<UnalignedDoubles*>(measured.foot + k) = foot;
    }
    for (std::size_t k = 0; k < whole_fours(n - 1); k += kDoublesPerBatch) {
        const Doubles px = to_x - at(facing.x, k);
        const Doubles py = to_y - at(facing.y, k);
        const Doubles facing_dx = at(facing.dx, k);
        const Doubles facing_dy = at(facing.dy, k);
        Doubles foot = (px * facing_dx + py * facing_dy) * at(facing.inverse_squared_length, k);
        foot = foot > 0.0 ? foot : Doubles{};
        foot = foot < 1.0 ? foot : Doubles{} + 1.0;
        const Doubles ex = px - foot * facing_dx;
        const Doubles ey = py - foot * facing_dy;
        *reinterpret_cast<UnalignedDoubles*>(measured.to_vertex + k) = ex * ex + ey * ey;
    }
    measured.nearest_to_segment = smallest(measured.to_segment, n);
    measured.nearest_to_vertex = smallest(measured.to_vertex, n - 1);
}

/// Widths of one side's queries for one length of the other boundary.
struct Row {
    double* vertex_squared;
    double* segment_squared;
    std::int64_t* at_end;
};

/// How many vertices of the new row are w_max or more from the other boundary, and how many of these are
/// nearest to a point before its end.
struct TooWide {
    std::int64_t all = 0;
    std::int64_t not_at_end = 0;
};

/// Writes the row of `n` queries: the minimum of the old row and the new distances.
CONELANE_SIMD TooWide lower(const Row& before, const Measured& measured, std::size_t n, double squared_w_max,
                            const Row& after) {
    const double* const __restrict old_vertex = before.vertex_squared;
    const double* const __restrict old_segment = before.segment_squared;
    const double* const __restrict to_segment_squared = measured.to_segment;
    const double* const __restrict to_vertex_squared = measured.to_vertex;
    const double* const __restrict foot = measured.foot;
    double* const __restrict vertex = after.vertex_squared;
    double* const __restrict segment = after.segment_squared;
    std::int64_t* const __restrict at_end = after.at_end;
    TooWide too_wide;
    for (std::size_t i = 0; i < n; ++i) {
        const std::int64_t nearer = to_segment_squared[i] < old_vertex[i] ? 1 : 0;
        const double now = to_segment_squared[i] < old_vertex[i] ? to_segment_squared[i] : old_vertex[i];
        const std::int64_t ends = nearer & (foot[i] >= kEndOfSegment ? 1 : 0);
        const std::int64_t wide = now >= squared_w_max ? 1 : 0;
        vertex[i] = now;
        at_end[i] = ends;
        too_wide.all += wide;
        too_wide.not_at_end += wide & (1 - ends);
    }
    segment[0] = 0.0;
    for (std::size_t i = 1; i < n; ++i) {
        const double new_m2 = to_segment_squared[i - 1] < to_segment_squared[i] ? to_segment_squared[i - 1]
                                                                                : to_segment_squared[i];
        const double old_m2 =
            old_segment[i] < to_vertex_squared[i - 1] ? old_segment[i] : to_vertex_squared[i - 1];
        segment[i] = new_m2 < old_m2 ? new_m2 : old_m2;
    }
    return too_wide;
}

struct WidthSums {
    double widths = 0.0;
    double squares = 0.0;
};

CONELANE_SIMD void add_widths(const double* squared, std::size_t count, WidthSums& sums) {
    Doubles widths{};
    Doubles squares{};
    std::size_t i = 0;
    for (; i + kDoublesPerBatch <= count; i += kDoublesPerBatch) {
        const Doubles squared_m2 = *reinterpret_cast<const UnalignedDoubles*>(squared + i);
        squares += squared_m2;
        for (std::size_t lane = 0; lane < kDoublesPerBatch; ++lane)
            widths[lane] += std::sqrt(squared_m2[lane]);
    }
    for (; i < count; ++i) {
        sums.widths += std::sqrt(squared[i]);
        sums.squares += squared[i];
    }
    for (std::size_t lane = 0; lane < kDoublesPerBatch; ++lane) {
        sums.widths += widths[lane];
        sums.squares += squares[lane];
    }
}

template <typename T>
void grow(std::vector<T>& values, std::size_t size) {
    if (values.size() < size) values.resize(2 * size);
}

}  // namespace

LaneWidths lane_widths(std::span<const Point> left, std::span<const Point> right, bool closed) {
    const std::array<std::span<const Point>, 2> vertices{left, right};
    const std::array<std::vector<Segment>, 2> segments{segments_of(left, closed), segments_of(right, closed)};
    LaneWidths widths;
    for (const Side side : {kLeft, kRight}) {
        const Side other = opposite(side);
        for (const Point& vertex : vertices[side]) {
            widths.of_vertex_m[side].push_back(foot_on_polyline(vertex, vertices[other], closed).distance_m);
        }
        for (const Segment& segment : segments[side]) {
            double width = foot_point(vertices[other].front(), segment).distance_m;
            for (const Segment& target : segments[other]) {
                width = std::min(width, segment_distance(segment, target).distance_m);
            }
            widths.of_segment_m[side].push_back(width);
        }
    }
    return widths;
}

void BoundaryArrays::push(const Point& point) {
    grow(x, size + 1 + kSpare);
    grow(y, size + 1 + kSpare);
    x[size] = point.x();
    y[size] = point.y();
    if (size > 0) {
        grow(dx, size + kSpare);
        grow(dy, size + kSpare);
        grow(inverse_squared_length, size + kSpare);
        const Point direction = point - vertex(size - 1);
        dx[size - 1] = direction.x();
        dy[size - 1] = direction.y();
        inverse_squared_length[size - 1] = 1.0 / direction.squaredNorm();
    }
    ++size;
}

void OnlineLaneWidth::Rows::make_room(std::size_t size) {
    grow(vertex_squared, size);
    grow(segment_squared, size);
    grow(at_end, size);
}

void OnlineLaneWidth::reset(const Point& left, const Point& right, double w_max_m) {
    squared_w_max_ = w_max_m * w_max_m;
    const double squared_distance = (right - left).squaredNorm();
    for (const Side side : {kLeft, kRight}) {
        boundaries_[side].size = 0;
        boundaries_[side].push(side == kLeft ? left : right);
        rows_[side].begins.assign(1, 0);
        rows_[side].make_room(1);
        rows_[side].vertex_squared[0] = squared_distance;
        rows_[side].segment_squared[0] = 0.0;
        rows_[side].at_end[0] = 1;
    }
    const std::uint32_t too_wide = squared_distance >= squared_w_max_ ? 1 : 0;
    states_.assign(1, State{squared_distance, {too_wide, too_wide}, false});
}

void OnlineLaneWidth::push(Side side, const Point& point) {
    const Side other = opposite(side);
    BoundaryArrays& own = boundaries_[side];
    const BoundaryArrays& facing = boundaries_[other];
    Rows& own_rows = rows_[side];
    Rows& facing_rows = rows_[other];
    const std::size_t m = own.size;
    const std::size_t n = facing.size;
    own.push(point);
    State next = states_.back();

    grow(to_new_segment_, whole_fours(n));
    grow(foot_, whole_fours(n));
    grow(to_new_vertex_, whole_fours(n));
    Measured measured{to_new_segment_.data(), foot_.data(), to_new_vertex_.data(), 0.0, 0.0};
    measure(own, m - 1, facing, measured);
    bool vertex_at_end = true;
    if (n == 1) {
        measured.nearest_to_vertex = (facing.vertex(0) - point).squaredNorm();
    } else {
        const std::size_t last = n - 2;
        const SquaredDistance to_last =
            to_segment(point.x() - facing.x[last], point.y() - facing.y[last], facing.dx[last],
                       facing.dy[last], facing.inverse_squared_length[last]);
        vertex_at_end = to_last.foot >= kEndOfSegment && to_last.value <= measured.nearest_to_vertex;
    }

    // A new row for the queries of the facing boundary: the minimum of the old row and the new distances.
    const std::size_t old_row = facing_rows.begins.back();
    const std::size_t new_row = old_row + n;
    facing_rows.make_room(new_row + n);
    facing_rows.begins.push_back(new_row);
    const auto row = [&](std::size_t begin) {
        return Row{facing_rows.vertex_squared.data() + begin, facing_rows.segment_squared.data() + begin,
                   facing_rows.at_end.data() + begin};
    };
    const TooWide too_wide = lower(row(old_row), measured, n, squared_w_max_, row(new_row));
    next.too_wide[other] = static_cast<std::uint32_t>(too_wide.all);
    const std::size_t last_facing = new_row + n - 1;
    const bool last_counts =
        facing_rows.vertex_squared[last_facing] >= squared_w_max_ && facing_rows.at_end[last_facing] == 0;
    if (too_wide.not_at_end > (last_counts ? 1 : 0)) next.too_wide_behind = true;

    // The queries that the new vertex adds to its own boundary.
    const std::size_t own_row = own_rows.begins.back();
    own_rows.make_room(own_row + m + 1);
    const std::size_t former_last = own_row + m - 1;
    own_rows.vertex_squared[own_row + m] = measured.nearest_to_vertex;
    own_rows.segment_squared[own_row + m] = std::min(
        {measured.nearest_to_segment, measured.nearest_to_vertex, own_rows.vertex_squared[former_last]});
    own_rows.at_end[own_row + m] = vertex_at_end ? 1 : 0;
    if (measured.nearest_to_vertex >= squared_w_max_) ++next.too_wide[side];
    if (own_rows.vertex_squared[former_last] >= squared_w_max_ && own_rows.at_end[former_last] == 0) {
        next.too_wide_behind = true;
    }

    next.narrowest_squared =
        std::min({next.narrowest_squared, measured.nearest_to_segment, measured.nearest_to_vertex});
    states_.push_back(next);
}

void OnlineLaneWidth::push_unmeasured(Side side, const Point& point) {
    const Side other = opposite(side);
    const std::size_t n = boundaries_[other].size;
    boundaries_[side].push(point);
    const std::size_t new_row = rows_[other].begins.back() + n;
    rows_[other].make_room(new_row + n);
    rows_[other].begins.push_back(new_row);
    rows_[side].make_room(rows_[side].begins.back() + boundaries_[side].size);
    states_.emplace_back(states_.back());
}

void OnlineLaneWidth::pop(Side side) {
    boundaries_[side].pop();
    rows_[opposite(side)].begins.pop_back();
    states_.pop_back();
}

double OnlineLaneWidth::variance() const {
    WidthSums sums;
    double count = 0.0;
    for (const Side side : {kLeft, kRight}) {
        const Rows& rows = rows_[side];
        const std::size_t size = boundaries_[side].size;
        add_widths(rows.vertex_squared.data() + rows.begins.back(), size, sums);
        // The first entry of the segments is not used.
        add_widths(rows.segment_squared.data() + rows.begins.back() + 1, size - 1, sums);
        count += static_cast<double>(2 * size - 1);
    }
    const double mean = sums.widths / count;
    return std::max(0.0, sums.squares / count - mean * mean);
}

}  // namespace conelane
