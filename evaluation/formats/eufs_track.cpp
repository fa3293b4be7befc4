#include "evaluation/formats/cone_table.hpp"
#include "evaluation/formats/track_spec.hpp"
#include "evaluation/input_error.hpp"
#include "evaluation/world/shortest_tour.hpp"

#include <iterator>
#include <limits>
#include <utility>

#include <boost/geometry.hpp>
#include <boost/geometry/geometries/point_xy.hpp>
#include <boost/geometry/geometries/polygon.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace conelane {
namespace {

/// A cone that cannot belong to the boundary of its color.
struct MisplacedCone {
    std::size_t cone = 0;
    std::string reason;
    bool is_same = false;  ///< as another cone, at its place
};

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

/// Of some cones, those more than 15 m from the largest group: where two of them are nearer, they are of one
/// group.
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

/// The cones of the second row if a boundary, still unordered, was written twice: nearly half of its cones
/// stand within 0.5 m of an earlier one.
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

/// The cone of an ordered boundary that fits it least: it stands in the line of the other boundary, or
/// outside the lane.
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

void require_direction_of_car(const Track& track, const ConeTable& content,
                              const std::filesystem::path& file) {
    const std::vector<Point> left = positions(track.cones, track.left);
    const PolylineFoot foot = foot_on_polyline(content.car_start->position, left, track.closed);
    const std::size_t from = track.closed ? foot.segment : std::min(foot.segment, left.size() - 2);
    const Point along = left[(from + 1) % left.size()] - left[from];
    if (along.dot(content.car_start->heading()) > 0.0) return;
    throw InputError(file, content.car_start_line, "direction",
                     "the car does not drive with the blue cones on its left");
}

/// The boundaries of a table, in order and without cones that cannot belong to them.
class EufsBoundaries {
  public:
    EufsBoundaries(const ConeTable& content, const std::filesystem::path& file)
        : content_(content), file_(file) {
        for (std::size_t index = 0; index < content.cones.size(); ++index) {
            if (content.cones[index].color != ConeColor::unknown) kept_.push_back(index);
        }
    }

    /// Sets the boundaries of a track that has the cones.
    void put_into(Track& track) {
        leave_out(far_cones(track.cones, kept_));
        for (const ConeColor color : {ConeColor::blue, ConeColor::yellow}) {
            leave_out(second_row(track.cones, of(color, kept_)));
        }
        require_enough_cones(with(kept_, track, false), file_);
        Remaining best = without_misplaced(track, true);
        if (!best.is_closed || !best.left_out.empty()) {
            // In a ring the ends of an open course seem misplaced, and its misplaced cones may not.
            Remaining open = without_misplaced(track, false);
            const bool fewer = open.left_out.size() < best.left_out.size();
            if (!open.is_closed && (!best.is_closed || fewer)) best = std::move(open);
        }
        kept_ = std::move(best.kept);
        left_out_.insert(left_out_.end(), best.left_out.begin(), best.left_out.end());
        with(kept_, track, best.is_closed);
        require_enough_cones(track, file_);
        order_boundaries(track, of(ConeColor::orange, kept_));
        if (!left_out_.empty()) track.warnings.push_back(warning());
    }

    /// Cones at the place of another one of their boundary.
    [[nodiscard]] Boundary repeated() const {
        Boundary result;
        for (const MisplacedCone& cone : left_out_) {
            if (cone.is_same) result.push_back(cone.cone);
        }
        return result;
    }

  private:
    struct Remaining {
        Boundary kept;
        std::vector<MisplacedCone> left_out{};
        bool is_closed = false;  ///< as it seems without those
    };

    [[nodiscard]] Remaining without_misplaced(Track track, bool closed) const {
        Remaining result{kept_};
        const std::size_t fewest = kept_.size() - kept_.size() / 10;  // with fewer, the colors mean nothing
        while (result.kept.size() > fewest) {
            with(result.kept, track, closed);
            if (std::min(track.left.size(), track.right.size()) < 3) break;
            order_boundaries(track, of(ConeColor::orange, result.kept));
            const auto misplaced = most_misplaced_cone(track);
            if (!misplaced) break;
            std::erase(result.kept, misplaced->cone);
            result.left_out.push_back(*misplaced);
        }
        result.is_closed = may_close(track.cones, of(ConeColor::blue, result.kept)) ||
                           may_close(track.cones, of(ConeColor::yellow, result.kept));
        return result;
    }

    /// The track with boundaries, unordered and without orange cones.
    const Track& with(const Boundary& kept, Track& track, bool closed) const {
        track.left = of(ConeColor::blue, kept);
        track.right = of(ConeColor::yellow, kept);
        track.closed = closed;
        return track;
    }

    [[nodiscard]] Boundary of(ConeColor color, const Boundary& kept) const {
        Boundary result;
        std::ranges::copy_if(kept, std::back_inserter(result),
                             [&](std::size_t index) { return content_.cones[index].color == color; });
        return result;
    }

    void leave_out(const std::vector<MisplacedCone>& misplaced) {
        for (const MisplacedCone& cone : misplaced) {
            std::erase(kept_, cone.cone);
            left_out_.push_back(cone);
        }
    }

    [[nodiscard]] std::string warning() const {
        constexpr std::size_t kNamed = 5;
        std::vector<std::string> names;
        for (const MisplacedCone& misplaced :
             std::span(left_out_).first(std::min(left_out_.size(), kNamed))) {
            const Cone& cone = content_.cones[misplaced.cone];
            names.push_back(fmt::format("the {} cone of line {} at ({:.2f}, {:.2f}) {}",
                                        to_string(cone.color), content_.lines[misplaced.cone],
                                        cone.position.x(), cone.position.y(), misplaced.reason));
        }
        if (left_out_.size() > kNamed) names.push_back(fmt::format("{} more", left_out_.size() - kNamed));
        return fmt::format("left out of the boundaries: {}", fmt::join(names, ", "));
    }

    const ConeTable& content_;
    const std::filesystem::path& file_;
    Boundary kept_;  ///< cones of boundaries, in the order of the file
    std::vector<MisplacedCone> left_out_;
};

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
    const ConeTable content = read_cone_table(file);
    Track track;
    track.name = "eufs_" + file.stem().string();
    if (!content.guess.empty()) track.warnings.push_back(content.guess);
    track.cones = content.cones;
    EufsBoundaries boundaries(content, file);
    boundaries.put_into(track);
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
    track = without_doubled_cones(std::move(track), boundaries.repeated());
    require_enough_cones(track, file);
    if (!content.other_tags.empty()) track.warnings.push_back(warning_of(content.other_tags));
    return track;
}

constexpr TrackFormat kEufsTracks{.word = "eufs",
                                  .what = "FILE",
                                  .reads = "CSV of EUFS, FSDS and others: tag,x,y of a cone a line",
                                  .ending = ".csv",
                                  .read = read_eufs_track};

}  // namespace conelane
