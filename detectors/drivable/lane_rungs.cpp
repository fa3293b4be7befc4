#include "detectors/drivable/lane_rungs.hpp"

#include <cstdint>
#include <utility>

namespace conelane {
namespace {

constexpr double kOnePlace_m = 1e-6;       ///< vertices closer than this are at one place
constexpr double kParallelSine = 1e-12;    ///< a ray parallel to a segment does not meet it
constexpr double kSegmentEndShare = 1e-9;  ///< share of a segment's length by which its ends are extended

// The inferred boundary.
constexpr double kStep_m = 0.5;
constexpr double kMaxSteps = 2000.0;       ///< of a boundary; a longer one is sampled more coarsely
constexpr double kDirectionReach_m = 2.5;  ///< to either side; also along an extended lane
/// A point opposite to the known boundary must be at least this share of the width from that boundary.
constexpr double kNearestShare = 0.85;

/// A point of a polyline at an arc length. At both ends, the polyline continues straight.
Point point_at(const LaneBoundary& boundary, double arc_m) {
    std::size_t i = 0;
    while (i + 1 < boundary.segments() && boundary.segment_end_m(i) < arc_m) ++i;
    const Segment segment = boundary.segment(i);
    const double start_m = boundary.segment_start_m(i);
    const double share = (arc_m - start_m) / (boundary.segment_end_m(i) - start_m);
    return segment.from + share * (segment.to - segment.from);
}

constexpr double kSample_m = 0.5;          ///< largest distance between matched places of a boundary
constexpr double kSamplesAtMost = 2000.0;  ///< of a boundary; a longer one is sampled more coarsely
constexpr double kRungSpacing_m = 0.25;    ///< largest spacing
constexpr double kMinMidline_m = 0.5;
constexpr double kWholeMean = 1.01;  ///< means up to this factor above the least mean count as equal
constexpr double kMinAdvance = 0.2;  ///< least advance of an extension, as a share of the boundary's
constexpr double kNever = std::numeric_limits<double>::infinity();

struct Place {
    Point point;
    double arc_m;
};
using Places = std::vector<Place>;

/// Places along a boundary, its vertices among them. A closed one ends where it began.
Places sampled(const LaneBoundary& boundary) {
    const double at_most_m = std::max(kSample_m, boundary.length_m() / kSamplesAtMost);
    Places places{{boundary.vertices().front(), 0.0}};
    for (std::size_t i = 0; i < boundary.segments(); ++i) {
        const Segment segment = boundary.segment(i);
        const double start_m = boundary.segment_start_m(i);
        const double length_m = boundary.segment_end_m(i) - start_m;
        const double parts = std::max(1.0, std::ceil(length_m / at_most_m));
        for (double k = 1.0; k <= parts; ++k) {
            const double share = k / parts;
            places.push_back(
                {segment.from + share * (segment.to - segment.from), start_m + share * length_m});
        }
    }
    return places;
}

/// Turns a closed boundary so that it begins and ends at its place `first`.
void begin_at(Places& places, std::size_t first, double length_m) {
    places.pop_back();  // the repeated first place
    for (std::size_t i = 0; i < first; ++i) places[i].arc_m += length_m;
    std::rotate(places.begin(), places.begin() + static_cast<std::ptrdiff_t>(first), places.end());
    places.push_back({places.front().point, places.front().arc_m + length_m});
}

/// Makes both boundaries of a closed lane begin where it is narrowest: at the closest places that are on
/// their sides and run the same way, so they face each other across this lane and not across a neighbouring
/// one. If there are none, at the closest places.
void begin_at_narrowest(Places& left, double left_length_m, Places& right, double right_length_m) {
    const auto directions = [](const Places& places) {
        std::vector<Point> result;
        for (std::size_t i = 0; i + 1 < places.size(); ++i) {
            result.push_back((places[i + 1].point - places[i].point).normalized());
        }
        return result;
    };
    const std::vector<Point> left_directions = directions(left);
    const std::vector<Point> right_directions = directions(right);
    struct Best {
        double distance_m2 = kNever;
        std::size_t left = 0;
        std::size_t right = 0;
    };
    Best facing;
    Best closest;
    for (std::size_t i = 0; i < left_directions.size(); ++i) {
        for (std::size_t j = 0; j < right_directions.size(); ++j) {
            const Point across = right[j].point - left[i].point;
            const double distance_m2 = across.squaredNorm();
            if (distance_m2 < closest.distance_m2) closest = {distance_m2, i, j};
            if (distance_m2 < facing.distance_m2 && left_directions[i].dot(right_directions[j]) > 0.5 &&
                cross(left_directions[i], across) < 0.0) {
                facing = {distance_m2, i, j};
            }
        }
    }
    const Best& best = facing.distance_m2 < kNever ? facing : closest;
    begin_at(left, best.left, left_length_m);
    begin_at(right, best.right, right_length_m);
}

enum class Step : std::uint8_t { both, left, right };

/// The matching from the first places to the last places of both sides. With `open_end`: to the last place of
/// one side and the place of the other that minimises the mean of the squared lengths.
std::vector<Rung> matched(std::span<const Place> left, std::span<const Place> right, bool open_end,
                          const TimeCheck& check_time) {
    const std::size_t columns = right.size();
    std::vector<Step> steps(left.size() * columns, Step::both);
    std::vector<double> row(columns);
    std::vector<double> row_before(columns);
    std::size_t i_end = left.size() - 1;
    std::size_t j_end = columns - 1;
    double min_mean = kNever;
    for (std::size_t i = 0; i < left.size(); ++i) {
        check_time();
        std::swap(row, row_before);
        for (std::size_t j = 0; j < columns; ++j) {
            const double cost = (left[i].point - right[j].point).squaredNorm();
            if (i == 0 && j == 0) {
                row[j] = cost;
            } else {
                const double both = i > 0 && j > 0 ? row_before[j - 1] + 2.0 * cost : kNever;
                const double on_left = i > 0 ? row_before[j] + cost : kNever;
                const double on_right = j > 0 ? row[j - 1] + cost : kNever;
                row[j] = std::min({both, on_left, on_right});
                steps[i * columns + j] =
                    row[j] == both ? Step::both : (row[j] == on_left ? Step::left : Step::right);
            }
            if (!open_end || (i + 1 < left.size() && j + 1 < columns)) continue;
            const double mean = row[j] / static_cast<double>(i + j + 1);
            if (mean > min_mean) continue;  // of equal means the last one: a longer lane
            min_mean = mean;
            i_end = i;
            j_end = j;
        }
    }
    const double whole_mean = row.back() / static_cast<double>(left.size() + columns - 1);
    if (open_end && whole_mean <= kWholeMean * min_mean) {  // both end side by side
        i_end = left.size() - 1;
        j_end = columns - 1;
    }
    std::vector<Rung> rungs;
    std::size_t i = i_end;
    std::size_t j = j_end;
    const auto add = [&] { rungs.push_back({left[i].point, right[j].point, left[i].arc_m, right[j].arc_m}); };
    add();
    while (i > 0 || j > 0) {
        const Step step = steps[i * columns + j];
        if (step != Step::right) --i;
        if (step != Step::left) --j;
        add();
    }
    std::ranges::reverse(rungs);
    return rungs;
}

double length_m(const Rung& rung) {
    return (rung.left - rung.right).norm();
}

/// Drops the last rungs while they share their place on one side and grow longer.
void drop_fan(std::vector<Rung>& rungs) {
    const double left_m = rungs.back().left_m;
    const double right_m = rungs.back().right_m;
    while (rungs.size() > 1) {
        const Rung& last = rungs.back();
        const Rung& before = rungs[rungs.size() - 2];
        const bool from_left = last.left_m == left_m && before.left_m == left_m;
        const bool from_right = last.right_m == right_m && before.right_m == right_m;
        if (!(from_left || from_right) || length_m(last) < length_m(before)) return;
        rungs.pop_back();
    }
}

/// For a boundary that ends at the end of the matching: from there, the lane keeps its width along the other
/// boundary, whose places are `along`, in the direction of the matching. `left_normal` is 1 if the ended side
/// is to the left of that direction, else -1. Returns the places that continue the ended side, each with the
/// place beside it: from the first one after `from` on.
struct KeptWidth {
    std::vector<Point> ended;
    std::vector<Place> beside;
};
KeptWidth keep_width(const Point& end, std::span<const Place> along, std::size_t from, double left_normal,
                     double widest_m) {
    std::size_t last = from;
    while (last + 1 < along.size() && (along[last + 1].point - end).norm() <= widest_m) ++last;
    const double width_m = (along[from].point - end).norm();
    const auto side_of_line = [&](const Point& point) { return cross(along[last].point - end, point - end); };
    const double inside = side_of_line(along[from].point);
    KeptWidth kept;
    Point last_middle = 0.5 * (along[from].point + end);
    std::size_t behind = from;
    std::size_t ahead = from;
    for (std::size_t k = from + 1; k <= last; ++k) {
        // The direction over several metres, because that of a single segment changes abruptly at each cone.
        const auto apart_m = [&](std::size_t i) { return std::abs(along[i].arc_m - along[k].arc_m); };
        while (apart_m(behind) > kDirectionReach_m) ++behind;
        while (behind > 0 && apart_m(behind - 1) <= kDirectionReach_m) --behind;
        while (ahead + 1 < along.size() && apart_m(ahead + 1) <= kDirectionReach_m) ++ahead;
        const Point direction = (along[ahead].point - along[behind].point).normalized();
        const Point across = left_normal * Point(-direction.y(), direction.x());
        const Point opposite = along[k].point + width_m * across;
        const Point middle = 0.5 * (opposite + along[k].point);
        if (side_of_line(middle) * inside < 0.0) break;
        // On the outer side of a sharp corner, points that run backwards are not part of the lane.
        const double travelled_m = (along[k].point - along[k - 1].point).norm();
        if ((middle - last_middle).dot(direction) < kMinAdvance * travelled_m) break;
        last_middle = middle;
        kept.ended.push_back(opposite);
        kept.beside.push_back(along[k]);
    }
    return kept;
}

/// The same rungs at equal distances along the line of their middles. Each step is along one segment of a
/// boundary, so points between two rungs are on the boundaries too.
void space_evenly(RungLadder& ladder) {
    const std::vector<Rung> rungs = std::move(ladder.rungs);
    ladder.rungs.clear();
    std::vector<double> arc_m{0.0};
    for (std::size_t i = 1; i < rungs.size(); ++i) {
        arc_m.push_back(arc_m.back() + (rungs[i].middle() - rungs[i - 1].middle()).norm());
    }
    const double total_m = arc_m.back();
    if (!(total_m >= kMinMidline_m)) return;
    const auto gaps =
        2 * std::max<std::size_t>(2, static_cast<std::size_t>(std::ceil(total_m / (2.0 * kRungSpacing_m))));
    ladder.spacing_m = total_m / static_cast<double>(gaps);
    std::size_t i = 1;
    for (std::size_t k = 0; k < gaps + (ladder.left.closed() ? 0 : 1); ++k) {
        const double wanted_m = static_cast<double>(k) * ladder.spacing_m;
        while (i + 1 < rungs.size() && arc_m[i] < wanted_m) ++i;
        const double gap_m = arc_m[i] - arc_m[i - 1];
        const double share = gap_m > 0.0 ? std::clamp((wanted_m - arc_m[i - 1]) / gap_m, 0.0, 1.0) : 0.0;
        const Rung& a = rungs[i - 1];
        const Rung& b = rungs[i];
        ladder.rungs.push_back({a.left + share * (b.left - a.left), a.right + share * (b.right - a.right),
                                std::lerp(a.left_m, b.left_m, share),
                                std::lerp(a.right_m, b.right_m, share)});
    }
}

/// Rungs and places behind the end of the matching, where one boundary has ended. `left_side` is 1 if the
/// left boundary is to the left of the matching's direction, else -1.
struct Extension {
    std::vector<Rung> rungs;
    std::vector<Point> left;   ///< continuation of the left boundary
    std::vector<Point> right;  ///< continuation of the right boundary
};
Extension extension(const Places& left, const Places& right, const Rung& last, double left_side,
                    double widest_m) {
    const auto index_of = [](const Places& places, double arc_m) {
        return static_cast<std::size_t>(std::ranges::find(places, arc_m, &Place::arc_m) - places.begin());
    };
    const std::size_t i = index_of(left, last.left_m);
    const std::size_t j = index_of(right, last.right_m);
    const bool left_ends = i + 1 == left.size();
    if (!left_ends && j + 1 != right.size()) return {};
    const Point& end = left_ends ? last.left : last.right;
    KeptWidth kept = left_ends ? keep_width(end, right, j, left_side, widest_m)
                               : keep_width(end, left, i, -left_side, widest_m);
    double arc_m = left_ends ? last.left_m : last.right_m;
    Extension result;
    for (std::size_t k = 0; k < kept.ended.size(); ++k) {
        const Point& ended = kept.ended[k];
        const Place& beside = kept.beside[k];
        arc_m += left_side * (ended - (k > 0 ? kept.ended[k - 1] : end)).norm();
        result.rungs.push_back(left_ends ? Rung{ended, beside.point, arc_m, beside.arc_m}
                                         : Rung{beside.point, ended, beside.arc_m, arc_m});
    }
    (left_ends ? result.left : result.right) = std::move(kept.ended);
    return result;
}

/// A boundary, continued by the places `before` its first vertex, nearest first, and `after` its last one.
LaneBoundary extended(const LaneBoundary& boundary, const std::vector<Point>& before,
                      const std::vector<Point>& after) {
    if (before.empty() && after.empty()) return boundary;
    std::vector<Point> vertices(before.rbegin(), before.rend());
    vertices.insert(vertices.end(), boundary.vertices().begin(), boundary.vertices().end());
    vertices.insert(vertices.end(), after.begin(), after.end());
    return {vertices, false};
}

RungLadder open_ladder(const LaneBoundary& left, const LaneBoundary& right, double widest_m,
                       const TimeCheck& check_time) {
    Places left_places = sampled(left);
    Places right_places = sampled(right);
    // The first matching finds the end; the second one runs from there to the beginning.
    std::vector<Rung> rungs = matched(left_places, right_places, true, check_time);
    drop_fan(rungs);
    const auto up_to = [](const Places& places, double arc_m) {
        return Places(places.begin(), std::ranges::find(places, arc_m, &Place::arc_m) + 1);
    };
    Places left_part = up_to(left_places, rungs.back().left_m);
    Places right_part = up_to(right_places, rungs.back().right_m);
    std::ranges::reverse(left_part);
    std::ranges::reverse(right_part);
    rungs = matched(left_part, right_part, true, check_time);
    drop_fan(rungs);
    std::ranges::reverse(left_places);  // so that the beginning is an end
    std::ranges::reverse(right_places);
    std::ranges::reverse(rungs);
    const Extension before = extension(left_places, right_places, rungs.front(), -1.0, widest_m);
    std::ranges::reverse(left_places);
    std::ranges::reverse(right_places);
    const Extension after = extension(left_places, right_places, rungs.back(), 1.0, widest_m);
    rungs.insert(rungs.begin(), before.rungs.rbegin(), before.rungs.rend());
    rungs.insert(rungs.end(), after.rungs.begin(), after.rungs.end());

    RungLadder ladder{
        extended(left, before.left, after.left), extended(right, before.right, after.right), {}};
    const double left_shift_m = before.left.empty() ? 0.0 : -before.rungs.back().left_m;
    const double right_shift_m = before.right.empty() ? 0.0 : -before.rungs.back().right_m;
    for (Rung& rung : rungs) {
        rung.left_m += left_shift_m;
        rung.right_m += right_shift_m;
    }
    ladder.rungs = std::move(rungs);
    return ladder;
}

RungLadder closed_ladder(const LaneBoundary& left, const LaneBoundary& right, const TimeCheck& check_time) {
    Places left_places = sampled(left);
    Places right_places = sampled(right);
    begin_at_narrowest(left_places, left.length_m(), right_places, right.length_m());
    return {left, right, matched(left_places, right_places, false, check_time)};
}

}  // namespace

LaneBoundary::LaneBoundary(const std::vector<Point>& vertices, bool closed) : closed_(closed) {
    for (const Point& vertex : vertices) {
        if (vertices_.empty() || (vertex - vertices_.back()).norm() > kOnePlace_m)
            vertices_.push_back(vertex);
    }
    while (closed && vertices_.size() > 1 && (vertices_.back() - vertices_.front()).norm() <= kOnePlace_m) {
        vertices_.pop_back();
    }
    if (vertices_.size() < 2) closed_ = false;
    arc_m_.push_back(0.0);
    const std::size_t count = vertices_.size() - (closed_ ? 0 : 1);
    for (std::size_t i = 0; i < count; ++i) {
        const Segment s = segment(i);
        arc_m_.push_back(arc_m_.back() + (s.to - s.from).norm());
    }
}

template <typename Visit>
void LaneBoundary::for_segments_near(double place_m, double reach_m, const Visit& visit) const {
    const std::size_t count = segments();
    if (count == 0) return;
    if (closed_ && 2.0 * reach_m >= length_m()) {
        for (std::size_t i = 0; i < count; ++i) visit(i);
        return;
    }
    double from_m = place_m - reach_m;
    if (closed_) from_m -= length_m() * std::floor(from_m / length_m());
    const double to_m = from_m + 2.0 * reach_m;
    const auto after = std::upper_bound(arc_m_.begin() + 1, arc_m_.end() - 1, from_m);
    auto i = static_cast<std::size_t>(after - arc_m_.begin()) - 1;
    double turn_m = 0.0;
    while (arc_m_[i] + turn_m <= to_m) {
        visit(i);
        if (++i < count) continue;
        if (!closed_) return;
        i = 0;
        turn_m += length_m();
    }
}

double LaneBoundary::distance_m(const Point& query, double place_m, double reach_m) const {
    if (segments() == 0) return (query - vertices_.front()).norm();
    double min_m2 = std::numeric_limits<double>::infinity();
    for_segments_near(place_m, reach_m, [&](std::size_t i) {
        const Segment s = segment(i);
        const Point along = s.to - s.from;
        const Point to_query = query - s.from;
        const double share = std::clamp(to_query.dot(along) / along.squaredNorm(), 0.0, 1.0);
        min_m2 = std::min(min_m2, (to_query - share * along).squaredNorm());
    });
    return std::sqrt(min_m2);
}

std::optional<double> LaneBoundary::ray_hit_m(const Point& from, const Point& unit_direction, double place_m,
                                              double reach_m) const {
    std::optional<double> nearest_m;
    for_segments_near(place_m, reach_m, [&](std::size_t i) {
        const Segment s = segment(i);
        const Point along = s.to - s.from;
        const double sine = cross(unit_direction, along);
        if (std::abs(sine) <= kParallelSine * along.norm()) return;
        const Point to_segment = s.from - from;
        const double share = cross(to_segment, unit_direction) / sine;
        const double hit_m = cross(to_segment, along) / sine;
        if (share < -kSegmentEndShare || share > 1.0 + kSegmentEndShare || hit_m < 0.0) return;
        if (!nearest_m || hit_m < *nearest_m) nearest_m = hit_m;
    });
    return nearest_m;
}

std::vector<Point> inferred_boundary(const LaneBoundary& known, bool known_is_left, double width_m) {
    std::vector<Point> across;
    if (known.segments() == 0) return across;
    const double length_m = known.length_m();
    const double steps = std::clamp(std::ceil(length_m / kStep_m), 1.0, kMaxSteps);
    const double side = known_is_left ? -1.0 : 1.0;
    for (double k = 0.0; k <= steps; ++k) {
        const double arc_m = length_m * k / steps;
        const Point from = point_at(known, arc_m);
        const Point direction =
            point_at(known, arc_m + kDirectionReach_m) - point_at(known, arc_m - kDirectionReach_m);
        const double norm_m = direction.norm();
        if (!(norm_m > 0.0)) continue;
        const Point point = from + side * width_m / norm_m * Point(-direction.y(), direction.x());
        if (known.distance_m(point, arc_m, length_m) < kNearestShare * width_m) continue;
        if (!across.empty() && (point - across.back()).dot(direction) <= 0.0) continue;
        across.push_back(point);
    }
    return across;
}

RungLadder lane_rungs(const LaneBoundary& left, const LaneBoundary& right, double widest_m,
                      const TimeCheck& check_time) {
    RungLadder ladder = left.closed() ? closed_ladder(left, right, check_time)
                                      : open_ladder(left, right, widest_m, check_time);
    space_evenly(ladder);
    return ladder;
}

}  // namespace conelane
