#include "experiments/files/input_error.hpp"
#include "experiments/tracks/shortest_tour.hpp"
#include "experiments/tracks/track_checks.hpp"
#include "experiments/tracks/track_readers.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <sstream>
#include <string_view>
#include <utility>

#include <boost/geometry.hpp>
#include <boost/geometry/geometries/point_xy.hpp>
#include <boost/geometry/geometries/polygon.hpp>
#include <fmt/core.h>

namespace conelane::experiments {
namespace {

/// What an EUFS file says, before any order.
struct EufsCones {
    std::vector<Cone> cones;
    std::vector<std::size_t> blue;
    std::vector<std::size_t> yellow;
    std::vector<std::size_t> orange;  ///< small and big ones
    Pose car_start;
    std::size_t car_start_line = 0;
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
            if (result.car_start_line > 0) throw InputError(file_, line, "car_start", "is there twice");
            result.car_start = {position, number(fields, direction_, line, "direction")};
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
            throw InputError(file_, line, "tag", fmt::format("'{}' is no known tag", tag));
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
    if (result.car_start_line == 0) throw InputError(file, 0, "car_start", "missing");
    return result;
}

using Boundary = std::vector<std::size_t>;  ///< indices into the cones

std::vector<Point> positions(const std::vector<Cone>& cones, const Boundary& boundary) {
    std::vector<Point> result;
    for (const std::size_t index : boundary) result.push_back(cones[index].position);
    return result;
}

Boundary in_tour_order(const std::vector<Cone>& cones, const Boundary& boundary) {
    Boundary ordered;
    for (const std::size_t position : shortest_tour(positions(cones, boundary))) {
        ordered.push_back(boundary[position]);
    }
    return ordered;
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

void start_nearest_ahead(Boundary& boundary, const std::vector<Cone>& cones, const Pose& car) {
    const auto distance_m = [&](std::size_t index) {
        const Point& position = cones[index].position;
        return car.ahead_m(position) < 0.0 ? std::numeric_limits<double>::infinity()
                                           : (position - car.position).norm();
    };
    std::rotate(boundary.begin(), std::ranges::min_element(boundary, {}, distance_m), boundary.end());
}

}  // namespace

Track read_eufs_track(const std::filesystem::path& file) {
    EufsCones content = read_eufs_cones(file);
    Track track;
    track.name = "eufs_" + file.stem().string();
    track.closed = true;
    track.left = content.blue;
    track.right = content.yellow;
    require_enough_cones({track.name, content.cones, track.left, track.right, true}, file);

    const auto order = [&] {
        track.left = in_tour_order(content.cones, track.left);
        track.right = in_tour_order(content.cones, track.right);
    };
    order();
    if (!content.orange.empty()) {
        const std::vector<Point> left = positions(content.cones, track.left);
        const std::vector<Point> right = positions(content.cones, track.right);
        for (const std::size_t index : content.orange) {
            const Point& position = content.cones[index].position;
            const bool nearer_left = foot_on_polyline(position, left, true).distance_m <=
                                     foot_on_polyline(position, right, true).distance_m;
            (nearer_left ? track.left : track.right).push_back(index);
        }
        order();
    }

    // The colours fix the direction: who has the inner boundary on the left drives counter-clockwise.
    const Ring left_ring = ring(positions(content.cones, track.left));
    const Ring right_ring = ring(positions(content.cones, track.right));
    const bool counter_clockwise = encloses(right_ring, left_ring);
    if (!counter_clockwise && !encloses(left_ring, right_ring)) {
        throw InputError(file, 0, "tag", "the blue and the yellow cones do not bound a closed course");
    }
    if ((boost::geometry::area(left_ring) > 0.0) != counter_clockwise) std::ranges::reverse(track.left);
    if ((boost::geometry::area(right_ring) > 0.0) != counter_clockwise) std::ranges::reverse(track.right);

    const std::vector<Point> left = positions(content.cones, track.left);
    const PolylineFoot foot = foot_on_polyline(content.car_start.position, left, true);
    const Point along = left[(foot.segment + 1) % left.size()] - left[foot.segment];
    if (along.dot(content.car_start.heading()) <= 0.0) {
        throw InputError(file, content.car_start_line, "direction",
                         "the car does not drive with the blue cones on its left");
    }
    start_nearest_ahead(track.left, content.cones, content.car_start);
    start_nearest_ahead(track.right, content.cones, content.car_start);
    track.cones = std::move(content.cones);
    track = without_doubled_cones(std::move(track));
    require_enough_cones(track, file);
    return track;
}

}  // namespace conelane::experiments
