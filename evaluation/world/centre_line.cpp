#include "evaluation/world/centre_line.hpp"

#include "conelane/invalid_input.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>

namespace conelane {
namespace {

constexpr double kBoundarySample_m = 0.4;
constexpr double kCentreSample_m = 0.2;
constexpr double kSmoothing_m = 3.0;
constexpr double kHeadingBaseline_m = 1.0;  ///< the heading is the direction over this length

using Polyline = std::vector<Point>;

/// Vertices at equal arc lengths, at most `at_most_m` apart. On a closed polyline they end just before the
/// first vertex, on an open one at the last vertex. Precondition: the length is positive.
Polyline resampled(const Polyline& vertices, bool closed, double at_most_m) {
    const double length_m = polyline_length_m(vertices, closed);
    const auto gaps = static_cast<std::size_t>(std::max(1.0, std::ceil(length_m / at_most_m)));
    Polyline result;
    std::size_t segment = 0;
    double segment_start_m = 0.0;
    const auto segment_end = [&] { return vertices[(segment + 1) % vertices.size()]; };
    const std::size_t last_segment = vertices.size() - (closed ? 1 : 2);
    for (std::size_t i = 0; i < gaps; ++i) {
        const double s_m = length_m * static_cast<double>(i) / static_cast<double>(gaps);
        double segment_m = (segment_end() - vertices[segment]).norm();
        while (segment < last_segment && segment_start_m + segment_m <= s_m) {
            segment_start_m += segment_m;
            ++segment;
            segment_m = (segment_end() - vertices[segment]).norm();
        }
        const double share = segment_m > 0.0 ? std::min(1.0, (s_m - segment_start_m) / segment_m) : 0.0;
        result.push_back(vertices[segment] + share * (segment_end() - vertices[segment]));
    }
    if (!closed) result.push_back(vertices.back());
    return result;
}

Polyline dense_boundary(const Polyline& vertices, bool closed, const std::string& key) {
    if (vertices.size() < (closed ? 3U : 2U)) throw InvalidInput(key, "has too few cones");
    const double length_m = polyline_length_m(vertices, closed);
    if (!(length_m > 0.0)) throw InvalidInput(key, "has no length");
    if (!(length_m <= kMaxBoundary_m)) throw InvalidInput(key, "is longer than any track");
    return resampled(vertices, closed, kBoundarySample_m);
}

Point direction_at(const Polyline& closed_boundary, std::size_t i) {
    const std::size_t n = closed_boundary.size();
    return (closed_boundary[(i + 1) % n] - closed_boundary[(i + n - 1) % n]).normalized();
}

/// The narrowest place of a closed lane: the closest places of both boundaries that are on their sides and
/// run the same way, so they face each other across this lane and not across a neighbouring one. If there are
/// none, the closest places.
FacingPlaces narrowest_place(const Polyline& left, const Polyline& right) {
    std::optional<FacingPlaces> facing;
    FacingPlaces closest{0, 0};
    double facing_m2 = std::numeric_limits<double>::infinity();
    double closest_m2 = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < left.size(); ++i) {
        const Point left_direction = direction_at(left, i);
        for (std::size_t j = 0; j < right.size(); ++j) {
            const Point across = right[j] - left[i];
            const double distance_m2 = across.squaredNorm();
            if (distance_m2 < closest_m2) {
                closest_m2 = distance_m2;
                closest = {i, j};
            }
            if (distance_m2 >= facing_m2) continue;
            const Point right_direction = direction_at(right, j);
            if (left_direction.dot(right_direction) > 0.5 && cross(left_direction, across) < 0.0) {
                facing_m2 = distance_m2;
                facing = {i, j};
            }
        }
    }
    return facing.value_or(closest);
}

void rotate_to(Polyline& closed, std::size_t first) {
    std::rotate(closed.begin(), closed.begin() + static_cast<std::ptrdiff_t>(first), closed.end());
}

/// Midpoints of a closed lane, from where its first left vertex is matched.
Polyline closed_midpoints(Polyline left, Polyline right) {
    const FacingPlaces start = narrowest_place(left, right);
    const std::size_t first_left = (left.size() - start.left) % left.size();
    rotate_to(left, start.left);
    rotate_to(right, start.right);
    left.push_back(left.front());
    right.push_back(right.front());
    const std::vector<FacingPlaces> matching = match_boundaries(left, right);
    Polyline midpoints;
    std::optional<std::size_t> first;
    for (std::size_t k = 0; k + 1 < matching.size(); ++k) {  // the last pair repeats the first one
        if (!first && matching[k].left == first_left) first = k;
        midpoints.push_back((left[matching[k].left] + right[matching[k].right]) / 2.0);
    }
    rotate_to(midpoints, first.value_or(0));
    return midpoints;
}

/// Cuts off the part of either boundary before the place where the other one begins. That place is searched
/// in the first half.
void even_starts(Polyline& left, Polyline& right) {
    const auto nearest = [](const Polyline& boundary, const Point& query) {
        const auto half = static_cast<std::ptrdiff_t>((boundary.size() + 1) / 2);
        return std::ranges::min_element(boundary.begin(), boundary.begin() + half, {},
                                        [&](const Point& place) { return (place - query).squaredNorm(); });
    };
    const auto facing_left_start = nearest(right, left.front());
    const auto facing_right_start = nearest(left, right.front());
    if ((*facing_left_start - left.front()).squaredNorm() <=
        (*facing_right_start - right.front()).squaredNorm()) {
        right.erase(right.begin(), facing_left_start);
    } else {
        left.erase(left.begin(), facing_right_start);
    }
}

Polyline open_midpoints(Polyline left, Polyline right) {
    even_starts(left, right);
    std::ranges::reverse(left);
    std::ranges::reverse(right);
    even_starts(left, right);
    std::ranges::reverse(left);
    std::ranges::reverse(right);
    Polyline midpoints;
    for (const FacingPlaces& pair : match_boundaries(left, right)) {
        midpoints.push_back((left[pair.left] + right[pair.right]) / 2.0);
    }
    return midpoints;
}

/// Mean over `reach` vertices to either side; the window is smaller near the ends of an open line.
Polyline smoothed(const Polyline& line, bool closed, std::size_t reach) {
    const std::size_t n = line.size();
    Polyline result;
    for (std::size_t i = 0; i < n; ++i) {
        const std::size_t r = closed ? std::min(reach, (n - 1) / 2) : std::min({reach, i, n - 1 - i});
        Point sum = line[i];
        for (std::size_t k = 1; k <= r; ++k) sum += line[(i + k) % n] + line[(i + n - k) % n];
        result.push_back(sum / static_cast<double>(2 * r + 1));
    }
    return result;
}

/// A polyline measured along its length.
class MeasuredLine {
  public:
    MeasuredLine(Polyline vertices, bool closed) : vertices_(std::move(vertices)), closed_(closed) {
        const std::vector<Point>& v = vertices_;
        for (std::size_t i = 0; i + 1 < v.size(); ++i) {
            lengths_m_.push_back(lengths_m_.back() + (v[i + 1] - v[i]).norm());
        }
        if (closed) lengths_m_.push_back(lengths_m_.back() + (v.front() - v.back()).norm());
    }

    [[nodiscard]] double length_m() const { return lengths_m_.back(); }

    /// The point at an arc length, which wraps on a closed line and is clamped on an open one.
    [[nodiscard]] Point at(double arc_length_m) const {
        if (closed_) {
            arc_length_m -= length_m() * std::floor(arc_length_m / length_m());
        } else {
            arc_length_m = std::clamp(arc_length_m, 0.0, length_m());
        }
        const auto end = std::upper_bound(lengths_m_.begin() + 1, lengths_m_.end() - 1, arc_length_m);
        const auto i = static_cast<std::size_t>(end - lengths_m_.begin()) - 1;
        const double segment_m = lengths_m_[i + 1] - lengths_m_[i];
        const double share = segment_m > 0.0 ? (arc_length_m - lengths_m_[i]) / segment_m : 0.0;
        return vertices_[i] + share * (vertices_[(i + 1) % vertices_.size()] - vertices_[i]);
    }

  private:
    Polyline vertices_;
    bool closed_;
    std::vector<double> lengths_m_{0.0};  ///< arc length at each vertex, and at the end of a closed line
};

double rounded(double value, double digits) {
    return std::round(value * digits) / digits + 0.0;  // + 0.0: no negative zero
}

enum class Step : std::uint8_t { both, left, right };

}  // namespace

std::vector<Pose> centre_line_poses(const TrackBoundaries& boundaries, double every_m) {
    if (!(every_m >= kMinEvery_m) || !std::isfinite(every_m)) {
        throw InvalidInput("every_m", "is not a length of at least 0.01 m");
    }
    const bool closed = boundaries.closed;
    Polyline left = dense_boundary(boundaries.left, closed, "left");
    Polyline right = dense_boundary(boundaries.right, closed, "right");
    const Polyline midpoints = closed ? closed_midpoints(std::move(left), std::move(right))
                                      : open_midpoints(std::move(left), std::move(right));
    if (!(polyline_length_m(midpoints, closed) > 0.0)) {
        throw InvalidInput("left", "has no lane between it and the right boundary");
    }
    constexpr auto kReach = static_cast<std::size_t>(kSmoothing_m / kCentreSample_m / 2.0);
    const MeasuredLine line(smoothed(resampled(midpoints, closed, kCentreSample_m), closed, kReach), closed);

    std::vector<Pose> poses;
    for (std::size_t i = 0;; ++i) {
        const double s_m = static_cast<double>(i) * every_m;
        if (closed ? s_m >= line.length_m() : s_m > line.length_m()) break;
        const Point position = line.at(s_m);
        const Point along = line.at(s_m + kHeadingBaseline_m / 2.0) - line.at(s_m - kHeadingBaseline_m / 2.0);
        poses.push_back({{rounded(position.x(), 1e6), rounded(position.y(), 1e6)},
                         rounded(std::atan2(along.y(), along.x()), 1e9)});
    }
    return poses;
}

std::vector<FacingPlaces> match_boundaries(std::span<const Point> left, std::span<const Point> right) {
    const std::size_t columns = right.size();
    std::vector<Step> steps(left.size() * columns, Step::both);
    std::vector<double> row(columns);
    std::vector<double> row_before(columns);
    constexpr double kNever = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < left.size(); ++i) {
        std::swap(row, row_before);
        for (std::size_t j = 0; j < columns; ++j) {
            const double cost = (left[i] - right[j]).squaredNorm();
            if (i == 0 && j == 0) {
                row[j] = cost;
                continue;
            }
            const double both = i > 0 && j > 0 ? row_before[j - 1] + 2.0 * cost : kNever;
            const double on_left = i > 0 ? row_before[j] + cost : kNever;
            const double on_right = j > 0 ? row[j - 1] + cost : kNever;
            row[j] = std::min({both, on_left, on_right});
            steps[i * columns + j] =
                row[j] == both ? Step::both : (row[j] == on_left ? Step::left : Step::right);
        }
    }

    std::vector<FacingPlaces> matching;
    std::size_t i = left.size() - 1;
    std::size_t j = columns - 1;
    matching.push_back({i, j});
    while (i > 0 || j > 0) {
        const Step step = steps[i * columns + j];
        if (step != Step::right) --i;
        if (step != Step::left) --j;
        matching.push_back({i, j});
    }
    std::ranges::reverse(matching);
    return matching;
}

}  // namespace conelane
