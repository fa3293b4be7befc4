#include "graph_search/lane_width.hpp"

#include <algorithm>
#include <cmath>

namespace conelane {
namespace {

std::vector<Segment> segments_of(std::span<const Point> vertices, bool closed) {
    std::vector<Segment> segments;
    for (std::size_t i = 1; i < vertices.size(); ++i) segments.push_back({vertices[i - 1], vertices[i]});
    if (closed && vertices.size() > 1) segments.push_back({vertices.back(), vertices.front()});
    return segments;
}

/// From here on a foot point counts as the end of its segment: a foot exactly there may be rounded below.
constexpr double kEndOfSegment = 1.0 - 1e-9;

struct SquaredDistance {
    double value;
    double foot;  ///< parameter on the segment, in [0, 1]
};

/// From a point at offset (px, py) of the segment's begin. As plain arithmetic, so that loops vectorise.
SquaredDistance to_segment(double px, double py, double dx, double dy, double inverse_squared_length) {
    const double foot = std::min(1.0, std::max(0.0, (px * dx + py * dy) * inverse_squared_length));
    const double ex = px - foot * dx;
    const double ey = py - foot * dy;
    return {ex * ex + ey * ey, foot};
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
    grow(x, size + 1);
    grow(y, size + 1);
    x[size] = point.x();
    y[size] = point.y();
    if (size > 0) {
        grow(dx, size);
        grow(dy, size);
        grow(inverse_squared_length, size);
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

    grow(to_new_segment_, n);
    grow(foot_, n);
    grow(to_new_vertex_, n);
    double* const to_segment_squared = to_new_segment_.data();
    double* const foot = foot_.data();
    double* const to_vertex_squared = to_new_vertex_.data();
    const double* const x = facing.x.data();
    const double* const y = facing.y.data();

    const double from_x = own.x[m - 1];
    const double from_y = own.y[m - 1];
    const double dx = own.dx[m - 1];
    const double dy = own.dy[m - 1];
    const double inverse = own.inverse_squared_length[m - 1];
    double nearest_to_segment = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < n; ++i) {
        const SquaredDistance distance = to_segment(x[i] - from_x, y[i] - from_y, dx, dy, inverse);
        to_segment_squared[i] = distance.value;
        foot[i] = distance.foot;
        nearest_to_segment = std::min(nearest_to_segment, distance.value);
    }
    double nearest_to_vertex = std::numeric_limits<double>::infinity();
    bool vertex_at_end = true;
    if (n == 1) {
        nearest_to_vertex = (facing.vertex(0) - point).squaredNorm();
    } else {
        double last_foot = 0.0;
        for (std::size_t i = 0; i + 1 < n; ++i) {
            const SquaredDistance distance = to_segment(point.x() - x[i], point.y() - y[i], facing.dx[i],
                                                        facing.dy[i], facing.inverse_squared_length[i]);
            to_vertex_squared[i] = distance.value;
            last_foot = distance.foot;
            nearest_to_vertex = std::min(nearest_to_vertex, distance.value);
        }
        vertex_at_end = last_foot >= kEndOfSegment && to_vertex_squared[n - 2] <= nearest_to_vertex;
    }

    // A new row for the queries of the facing boundary: the old one, lowered by what is new.
    const std::size_t old_row = facing_rows.begins.back();
    const std::size_t new_row = old_row + n;
    facing_rows.make_room(new_row + n);
    facing_rows.begins.push_back(new_row);
    std::uint32_t too_wide = 0;
    for (std::size_t i = 0; i < n; ++i) {
        const double before = facing_rows.vertex_squared[old_row + i];
        const bool nearer = to_segment_squared[i] < before;
        const double now = nearer ? to_segment_squared[i] : before;
        const bool at_end = nearer && foot[i] >= kEndOfSegment;
        facing_rows.vertex_squared[new_row + i] = now;
        facing_rows.at_end[new_row + i] = at_end ? 1 : 0;
        if (now >= squared_w_max_) {
            ++too_wide;
            if (!at_end && i + 1 < n) next.too_wide_behind = true;
        }
    }
    facing_rows.segment_squared[new_row] = 0.0;
    for (std::size_t i = 1; i < n; ++i) {
        facing_rows.segment_squared[new_row + i] =
            std::min({facing_rows.segment_squared[old_row + i], to_segment_squared[i - 1],
                      to_segment_squared[i], to_vertex_squared[i - 1]});
    }
    next.too_wide[other] = too_wide;

    // The queries that the new vertex adds to its own boundary.
    const std::size_t own_row = own_rows.begins.back();
    own_rows.make_room(own_row + m + 1);
    const std::size_t former_last = own_row + m - 1;
    own_rows.vertex_squared[own_row + m] = nearest_to_vertex;
    own_rows.segment_squared[own_row + m] =
        std::min({nearest_to_segment, nearest_to_vertex, own_rows.vertex_squared[former_last]});
    own_rows.at_end[own_row + m] = vertex_at_end ? 1 : 0;
    if (nearest_to_vertex >= squared_w_max_) ++next.too_wide[side];
    if (own_rows.vertex_squared[former_last] >= squared_w_max_ && own_rows.at_end[former_last] == 0) {
        next.too_wide_behind = true;
    }

    next.narrowest_squared = std::min({next.narrowest_squared, nearest_to_segment, nearest_to_vertex});
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

double OnlineLaneWidth::vertex_width_m(Side side, std::size_t vertex) const {
    return std::sqrt(rows_[side].vertex_squared[rows_[side].begins.back() + vertex]);
}

double OnlineLaneWidth::segment_width_m(Side side, std::size_t segment) const {
    return std::sqrt(rows_[side].segment_squared[rows_[side].begins.back() + segment + 1]);
}

double OnlineLaneWidth::variance() const {
    double sum = 0.0;
    double sum_of_squares = 0.0;
    double count = 0.0;
    for (const Side side : {kLeft, kRight}) {
        const Rows& rows = rows_[side];
        const double* const vertex_squared = rows.vertex_squared.data() + rows.begins.back();
        const double* const segment_squared = rows.segment_squared.data() + rows.begins.back();
        const std::size_t size = boundaries_[side].size;
        // The first entry of the segments stands for none and is 0.
        for (std::size_t i = 0; i < size; ++i) {
            sum += std::sqrt(vertex_squared[i]) + std::sqrt(segment_squared[i]);
            sum_of_squares += vertex_squared[i] + segment_squared[i];
        }
        count += static_cast<double>(2 * size - 1);
    }
    const double mean = sum / count;
    return std::max(0.0, sum_of_squares / count - mean * mean);
}

}  // namespace conelane
