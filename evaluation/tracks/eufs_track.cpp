#include "evaluation/files/input_error.hpp"
#include "evaluation/tracks/shortest_tour.hpp"
#include "evaluation/tracks/track_checks.hpp"
#include "evaluation/tracks/track_readers.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>

#include <boost/geometry.hpp>
#include <boost/geometry/geometries/point_xy.hpp>
#include <boost/geometry/geometries/polygon.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace conelane {
namespace {

/// The content of an EUFS file, still unordered.
struct EufsCones {
    std::vector<Cone> cones;
    std::vector<std::size_t> blue;
    std::vector<std::size_t> yellow;
    std::vector<std::size_t> orange;  ///< small and big ones
    std::optional<Pose> car_start;
    std::size_t car_start_line = 0;
    std::map<std::string, std::size_t> other_tags;  ///< number of cones whose tag belongs to no boundary
};

std::string_view trimmed(std::string_view text) {
    constexpr std::string_view kBlank = " \t\r";
    const std::size_t first = text.find_first_not_of(kBlank);
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

std::vector<std::string_view> fields_of(std::string_view line) {
    std::vector<std::string_view> fields;
    while (true) {
        const std::size_t comma = line.find(',');
        fields.push_back(trimmed(line.substr(0, comma)));
        if (comma == std::string_view::npos) return fields;
        line.remove_prefix(comma + 1);
    }
}

/// The columns that are read, found by the header line.
class EufsColumns {
  public:
    EufsColumns(std::filesystem::path file, std::size_t line, std::string_view header)
        : file_(std::move(file)) {
        const std::vector<std::string_view> names = fields_of(header);
        const auto column = [&](std::string_view name) {
            const auto found = std::ranges::find(names, name);
            if (found == names.end()) throw InputError(file_, line, std::string(name), "column missing");
            return static_cast<std::size_t>(found - names.begin());
        };
        tag_ = column("tag");
        x_ = column("x");
        y_ = column("y");
        direction_ = column("direction");
    }

    void read_row(std::size_t line, std::string_view row, EufsCones& result) const {
        const std::vector<std::string_view> fields = fields_of(row);
        const std::string_view tag = field(fields, tag_, line, "tag");
        const Point position{number(fields, x_, line, "x"), number(fields, y_, line, "y")};
        if (tag == "car_start") {
            if (result.car_start) throw InputError(file_, line, "car_start", "is there twice");
            result.car_start = Pose{position, number(fields, direction_, line, "direction")};
            result.car_start_line = line;
            return;
        }
        Cone cone;
        cone.id = static_cast<ConeId>(result.cones.size());
        cone.position = position;
        if (tag == "blue") {
            cone.color = ConeColor::blue;
            result.blue.push_back(result.cones.size());
        } else if (tag == "yellow") {
            cone.color = ConeColor::yellow;
            result.yellow.push_back(result.cones.size());
        } else if (tag == "orange" || tag == "big_orange") {
            cone.color = ConeColor::orange;
            result.orange.push_back(result.cones.size());
        } else if (tag != "unknown") {
            ++result.other_tags[std::string(tag)];
        }
        result.cones.push_back(cone);
    }

  private:
    [[nodiscard]] std::string_view field(const std::vector<std::string_view>& fields, std::size_t column,
                                         std::size_t line, const char* key) const {
        if (column >= fields.size() || fields[column].empty()) throw InputError(file_, line, key, "missing");
        return fields[column];
    }

    [[nodiscard]] double number(const std::vector<std::string_view>& fields, std::size_t column,
                                std::size_t line, const char* key) const {
        const std::string_view text = field(fields, column, line, key);
        double value = 0.0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
        if (error != std::errc{} || end != text.data() + text.size()) {
            throw InputError(file_, line, key, fmt::format("'{}' is not a number", text));
        }
        if (const std::string fault = coordinate_fault(value); !fault.empty()) {
            throw InputError(file_, line, key, fault);
        }
        return value;
    }

    std::filesystem::path file_;
    std::size_t tag_ = 0;
    std::size_t x_ = 0;
    std::size_t y_ = 0;
    std::size_t direction_ = 0;
};

EufsCones read_eufs_cones(const std::filesystem::path& file) {
    EufsCones result;
    std::optional<EufsColumns> columns;
    std::istringstream content(file_content(file));
    std::string row;
    for (std::size_t line = 1; std::getline(content, row); ++line) {
        if (trimmed(row).empty()) continue;
        if (columns) {
            columns->read_row(line, row, result);
        } else {
            columns.emplace(file, line, row);
        }
    }
    if (!columns) throw InputError(file, 0, "tag", "column missing");
    return result;
}

using Boundary = std::vector<std::size_t>;  ///< indices into the cones

std::vector<Point> positions(const std::vector<Cone>& cones, const Boundary& boundary) {
    std::vector<Point> result;
    for (const std::size_t index : boundary) result.push_back(cones[index].position);
    return result;
}

Boundary in_order(const std::vector<Cone>& cones, const Boundary& boundary, bool closed) {
    const std::vector<Point> points = positions(cones, boundary);
    Boundary ordered;
    for (const std::size_t position : closed ? shortest_tour(points) : shortest_path(points)) {
        ordered.push_back(boundary[position]);
    }
    return ordered;
}

/// Whether cones can be the boundary of a closed course. Compared with their shortest path, their shortest
/// tour must have no unusually long edge, except a straight one across a gate without cones of a color.
bool may_close(const std::vector<Cone>& cones, const Boundary& boundary) {
    constexpr double kOutstanding = 1.5;
    constexpr double kMinCosine = 0.5;  // of the turns at both ends of a gate
    if (boundary.size() < 3) return false;
    const std::vector<Point> path = positions(cones, in_order(cones, boundary, false));
    const std::vector<Point> tour = positions(cones, in_order(cones, boundary, true));
    double max_length_m = 0.0;
    for (std::size_t i = 0; i + 1 < path.size(); ++i) {
        max_length_m = std::max(max_length_m, (path[i + 1] - path[i]).norm());
    }
    if (polyline_length_m(tour, true) - polyline_length_m(path, false) <= kOutstanding * max_length_m)
        return true;
    const Point gap = (path.front() - path.back()).normalized();
    const Point out = (path.back() - path[path.size() - 2]).normalized();
    const Point in = (path[1] - path[0]).normalized();
    return gap.dot(out) >= kMinCosine && gap.dot(in) >= kMinCosine;
}

using BoostPoint = boost::geometry::model::d2::point_xy<double>;
using Ring = boost::geometry::model::ring<BoostPoint, /*ClockWise=*/false, /*Closed=*/false>;

Ring ring(const std::vector<Point>& vertices) {
    Ring result;
    for (const Point& vertex : vertices) result.emplace_back(vertex.x(), vertex.y());
    return result;
}

bool encloses(const Ring& outer, const Ring& inner) {
    Ring counter_clockwise = outer;
    boost::geometry::correct(counter_clockwise);
    return std::ranges::all_of(
        inner, [&](const BoostPoint& vertex) { return boost::geometry::within(vertex, counter_clockwise); });
}

/// The place of a closed boundary's cone nearest ahead of a car.
void start_nearest_ahead(Boundary& boundary, const std::vector<Cone>& cones, const Pose& car) {
    const auto distance_m = [&](std::size_t index) {
        const Point& position = cones[index].position;
        return car.ahead_m(position) < 0.0 ? std::numeric_limits<double>::infinity()
                                           : (position - car.position).norm();
    };
    std::rotate(boundary.begin(), std::ranges::min_element(boundary, {}, distance_m), boundary.end());
}

/// Starts a closed course at its first pair: the first left cone of the file and the right one nearest to it.
void start_at_first_pair(Track& track) {
    std::rotate(track.left.begin(), std::ranges::min_element(track.left), track.left.end());
    const Point first = track.cones[track.left.front()].position;
    const auto nearest = std::ranges::min_element(
        track.right, {}, [&](std::size_t index) { return (track.cones[index].position - first).norm(); });
    std::rotate(track.right.begin(), nearest, track.right.end());
}

/// Reverses the boundary of an open course if most of the other boundary's cones are on its wrong side:
/// `side` is +1 if they belong to its left, -1 to its right.
void direct_open_boundary(Boundary& boundary, const Boundary& other, const std::vector<Cone>& cones,
                          double side) {
    const std::vector<Point> line = positions(cones, boundary);
    std::ptrdiff_t votes = 0;
    for (const Point& position : positions(cones, other)) {
        const PolylineFoot foot = foot_on_polyline(position, line);
        const std::size_t from = std::min(foot.segment, line.size() - 2);
        votes += side * cross(line[from + 1] - line[from], position - line[from]) > 0.0 ? 1 : -1;
    }
    if (votes < 0) std::ranges::reverse(boundary);
}

/// Removes orange cones from an ordered boundary that are beside it and not in its line: a gate may be wider
/// than the lane.
void drop_beside(Boundary& boundary, const std::vector<Cone>& cones, bool closed) {
    constexpr double kSideBySide_m = 1.5;
    constexpr double kDetour_m = 0.4;
    const Boundary all = boundary;
    const std::size_t n = all.size();
    const auto beside = [&](std::size_t i) {
        if (cones[all[i]].color != ConeColor::orange || (!closed && (i == 0 || i + 1 == n))) return false;
        const Point& before = cones[all[(i + n - 1) % n]].position;
        const Point& after = cones[all[(i + 1) % n]].position;
        const Point& here = cones[all[i]].position;
        const double to_before_m = (here - before).norm();
        const double to_after_m = (after - here).norm();
        return std::min(to_before_m, to_after_m) < kSideBySide_m &&
               to_before_m + to_after_m - (after - before).norm() > kDetour_m;
    };
    boundary.clear();
    for (std::size_t i = 0; i < n; ++i) {
        if (!beside(i)) boundary.push_back(all[i]);
    }
}

/// Orders the boundaries of a track; orange cones join the one that they are nearer to if they stand in its
/// line.
void order_boundaries(Track& track, const Boundary& orange) {
    const auto order = [&] {
        track.left = in_order(track.cones, track.left, track.closed);
        track.right = in_order(track.cones, track.right, track.closed);
    };
    order();
    if (orange.empty()) return;
    const std::vector<Point> left = positions(track.cones, track.left);
    const std::vector<Point> right = positions(track.cones, track.right);
    for (const std::size_t index : orange) {
        const Point& position = track.cones[index].position;
        const bool nearer_left = foot_on_polyline(position, left, track.closed).distance_m <=
                                 foot_on_polyline(position, right, track.closed).distance_m;
        (nearer_left ? track.left : track.right).push_back(index);
    }
    order();
    drop_beside(track.left, track.cones, track.closed);
    drop_beside(track.right, track.cones, track.closed);
}

/// Gives the ordered boundaries of a closed course their direction, which follows from the colors: with the
/// inner boundary on the left, it is driven counter-clockwise.
void direct_closed_boundaries(Track& track, const std::filesystem::path& file) {
    const Ring left_ring = ring(positions(track.cones, track.left));
    const Ring right_ring = ring(positions(track.cones, track.right));
    const bool counter_clockwise = encloses(right_ring, left_ring);
    if (!counter_clockwise && !encloses(left_ring, right_ring)) {
        throw InputError(file, 0, "tag", "the blue and the yellow cones do not bound a closed course");
    }
    if ((boost::geometry::area(left_ring) > 0.0) != counter_clockwise) std::ranges::reverse(track.left);
    if ((boost::geometry::area(right_ring) > 0.0) != counter_clockwise) std::ranges::reverse(track.right);
}

void require_direction_of_car(const Track& track, const EufsCones& content,
                              const std::filesystem::path& file) {
    const std::vector<Point> left = positions(track.cones, track.left);
    const PolylineFoot foot = foot_on_polyline(content.car_start->position, left, track.closed);
    const std::size_t from = track.closed ? foot.segment : std::min(foot.segment, left.size() - 2);
    const Point along = left[(from + 1) % left.size()] - left[from];
    if (along.dot(content.car_start->heading()) > 0.0) return;
    throw InputError(file, content.car_start_line, "direction",
                     "the car does not drive with the blue cones on its left");
}

std::string warning_of(const std::map<std::string, std::size_t>& other_tags) {
    std::size_t cones = 0;
    std::vector<std::string> tags;
    for (const auto& [tag, count] : other_tags) {
        cones += count;
        tags.push_back(tag);
    }
    return fmt::format("{} cones belong to no boundary by their tag: {}", cones, fmt::join(tags, ", "));
}

}  // namespace

Track read_eufs_track(const std::filesystem::path& file) {
    EufsCones content = read_eufs_cones(file);
    Track track;
    track.name = "eufs_" + file.stem().string();
    track.cones = content.cones;
    track.left = content.blue;
    track.right = content.yellow;
    track.closed = false;
    require_enough_cones(track, file);
    track.closed = may_close(track.cones, track.left) || may_close(track.cones, track.right);
    require_enough_cones(track, file);

    order_boundaries(track, content.orange);
    if (track.closed) {
        direct_closed_boundaries(track, file);
    } else {
        direct_open_boundary(track.left, track.right, track.cones, -1.0);
        direct_open_boundary(track.right, track.left, track.cones, 1.0);
    }
    if (content.car_start) require_direction_of_car(track, content, file);
    if (track.closed && content.car_start) {
        start_nearest_ahead(track.left, track.cones, *content.car_start);
        start_nearest_ahead(track.right, track.cones, *content.car_start);
    } else if (track.closed) {
        start_at_first_pair(track);
    }
    track = without_doubled_cones(std::move(track));
    require_enough_cones(track, file);
    if (!content.other_tags.empty()) track.warnings.push_back(warning_of(content.other_tags));
    return track;
}

}  // namespace conelane
