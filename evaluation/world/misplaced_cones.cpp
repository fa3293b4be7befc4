#include "evaluation/world/misplaced_cones.hpp"

#include "evaluation/world/track_checks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace conelane {
namespace {

constexpr double kGroup_m = 15.0;  ///< a gate without cones of a color is up to 12 m long

double median(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::ranges::nth_element(values, middle);
    return *middle;
}

/// A boundary without one of its cones; an open one goes on straight at its ends.
std::vector<Point> line_without(std::vector<Point> line, std::size_t place, bool closed) {
    constexpr double kBeyondEnd_m = 10.0;
    if (place < line.size()) line.erase(line.begin() + static_cast<std::ptrdiff_t>(place));
    if (closed || line.size() < 2) return line;
    const Point before = line[0] + kBeyondEnd_m * (line[0] - line[1]).normalized();
    const std::size_t last = line.size() - 1;
    line.push_back(line[last] + kBeyondEnd_m * (line[last] - line[last - 1]).normalized());
    line.insert(line.begin(), before);
    return line;
}

double distance_m(const Point& position, const std::vector<Point>& line, bool closed) {
    return foot_on_polyline(position, line, closed).distance_m;
}

}  // namespace

std::vector<MisplacedCone> far_cones(const std::vector<Cone>& cones, std::span<const std::size_t> some) {
    std::vector<std::size_t> rest(some.begin(), some.end());
    std::vector<std::vector<std::size_t>> groups;
    while (!rest.empty()) {
        std::vector<std::size_t> group{rest.back()};
        rest.pop_back();
        for (std::size_t next = 0; next < group.size(); ++next) {
            const Point position = cones[group[next]].position;
            const auto near = std::ranges::partition(rest, [&](std::size_t other) {
                return (cones[other].position - position).norm() > kGroup_m;
            });
            group.insert(group.end(), near.begin(), near.end());
            rest.erase(near.begin(), near.end());
        }
        groups.push_back(std::move(group));
    }
    const auto largest = std::ranges::max_element(groups, {}, &std::vector<std::size_t>::size);
    std::vector<MisplacedCone> far;
    for (auto group = groups.begin(); group != groups.end(); ++group) {
        if (group == largest) continue;
        for (const std::size_t cone : *group) far.push_back({cone, "is far from all others"});
    }
    return far;
}

std::vector<MisplacedCone> second_row(const std::vector<Cone>& cones, std::span<const std::size_t> boundary) {
    constexpr double kRowsApart_m = 0.5;  // the boundaries of two legs may be 1 m apart
    constexpr double kMinShare = 0.4;     // of cones that repeat earlier ones: half, less what is far apart
    std::vector<MisplacedCone> second;
    std::vector<std::size_t> first;
    for (const std::size_t cone : boundary) {
        double nearest_m = std::numeric_limits<double>::infinity();
        for (const std::size_t other : first) {
            nearest_m = std::min(nearest_m, (cones[other].position - cones[cone].position).norm());
        }
        if (nearest_m > kRowsApart_m) {
            first.push_back(cone);
        } else {
            second.push_back({cone, "repeats another cone", nearest_m <= kDoubledTrackCone_m});
        }
    }
    if (static_cast<double>(second.size()) < kMinShare * static_cast<double>(boundary.size())) return {};
    return second;
}

std::optional<MisplacedCone> most_misplaced_cone(const Track& track) {
    constexpr double kMaxWidths = 3.0;  // distance of a boundary from the other one, in widths of the lane
    constexpr double kMinWidths = 0.6;  // from its own line, of a cone in the line of the other one
    constexpr double kMaxShare = 0.4;   // of that distance, to the line of the other one
    const TrackBoundaries both = boundaries(track);
    struct Place {
        std::size_t cone;
        double own_m;    ///< to the line of its boundary without it
        double other_m;  ///< to the other boundary
    };
    std::vector<Place> places;
    std::vector<double> widths_m;
    const auto add = [&](const std::vector<std::size_t>& cones, const std::vector<Point>& line,
                         const std::vector<Point>& other) {
        const std::vector<Point> facing = line_without(other, other.size(), track.closed);
        for (std::size_t i = 0; i < cones.size(); ++i) {
            places.push_back({cones[i],
                              distance_m(line[i], line_without(line, i, track.closed), track.closed),
                              distance_m(line[i], facing, track.closed)});
            widths_m.push_back(places.back().other_m);
        }
    };
    add(track.left, both.left, both.right);
    add(track.right, both.right, both.left);
    const double width_m = median(widths_m);
    std::optional<MisplacedCone> most;
    double most_m = 0.0;
    for (const Place& place : places) {
        const ConeColor color = track.cones[place.cone].color;
        const bool outside = place.other_m > kMaxWidths * width_m && place.own_m > width_m;
        const bool in_other = color != ConeColor::orange && place.own_m > kMinWidths * width_m &&
                              place.other_m < kMaxShare * place.own_m;
        const double gain_m = std::abs(place.own_m - place.other_m);
        if ((!outside && !in_other) || gain_m <= most_m) continue;
        most_m = gain_m;
        most = {place.cone, outside ? "is outside the lane" : "stands in the other boundary"};
    }
    return most;
}

}  // namespace conelane
