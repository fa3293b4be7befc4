#include "detectors/detail/lane_rungs.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace conelane {
namespace {

constexpr double kSample_m = 0.5;          ///< between matched places of a boundary, at most
constexpr double kSamplesAtMost = 2000.0;  ///< of a boundary; a longer one is sampled more coarsely
constexpr double kRungSpacing_m = 0.25;    ///< at most
constexpr double kShortestMidline_m = 0.5;
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

/// Drops places at the end of either boundary that are farther than `widest_m` from the other boundary. One
/// place is left at least.
void even_ends(Places& a_places, const LaneBoundary& a, Places& b_places, const LaneBoundary& b,
               double widest_m) {
    const auto drop_far = [widest_m](Places& places, const LaneBoundary& other) {
        const double reach_m = other.length_m() + 1.0;
        while (places.size() > 1 && other.distance_m(places.back().point, 0.0, reach_m) > widest_m) {
            places.pop_back();
        }
    };
    drop_far(a_places, b);
    drop_far(b_places, a);
}

/// Turns a closed boundary so that it begins and ends at its place `first`.
void begin_at(Places& places, std::size_t first, double length_m) {
    places.pop_back();  // the first place again
    for (std::size_t i = 0; i < first; ++i) places[i].arc_m += length_m;
    std::rotate(places.begin(), places.begin() + static_cast<std::ptrdiff_t>(first), places.end());
    places.push_back({places.front().point, places.front().arc_m + length_m});
}

/// Lets both boundaries of a closed lane begin where it is narrowest: at the closest places that lie on their
/// sides and run the same way, hence face each other across this lane rather than across a neighbouring one.
/// Where there are none, at the closest places.
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

std::vector<Rung> matched(const Places& left, const Places& right) {
    const std::size_t columns = right.size();
    std::vector<Step> steps(left.size() * columns, Step::both);
    std::vector<double> row(columns);
    std::vector<double> row_before(columns);
    for (std::size_t i = 0; i < left.size(); ++i) {
        std::swap(row, row_before);
        for (std::size_t j = 0; j < columns; ++j) {
            const double cost = (left[i].point - right[j].point).squaredNorm();
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
    std::vector<Rung> rungs;
    std::size_t i = left.size() - 1;
    std::size_t j = columns - 1;
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

/// The same rungs at equal distances along the line of their middles. A step is along one segment of either
/// boundary, so what lies between two rungs is on the boundaries too.
RungLadder evenly_spaced(const std::vector<Rung>& rungs, bool closed) {
    std::vector<double> arc_m{0.0};
    for (std::size_t i = 1; i < rungs.size(); ++i) {
        arc_m.push_back(arc_m.back() + (rungs[i].middle() - rungs[i - 1].middle()).norm());
    }
    const double length_m = arc_m.back();
    if (!(length_m >= kShortestMidline_m)) return {};
    const auto gaps =
        2 * std::max<std::size_t>(2, static_cast<std::size_t>(std::ceil(length_m / (2.0 * kRungSpacing_m))));
    RungLadder ladder;
    ladder.spacing_m = length_m / static_cast<double>(gaps);
    std::size_t i = 1;
    for (std::size_t k = 0; k < gaps + (closed ? 0 : 1); ++k) {
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
    return ladder;
}

}  // namespace

RungLadder lane_rungs(const LaneBoundary& left, const LaneBoundary& right, double widest_m) {
    Places left_places = sampled(left);
    Places right_places = sampled(right);
    if (left.closed()) {
        begin_at_narrowest(left_places, left.length_m(), right_places, right.length_m());
    } else {
        even_ends(left_places, left, right_places, right, widest_m);
        std::ranges::reverse(left_places);
        std::ranges::reverse(right_places);
        even_ends(left_places, left, right_places, right, widest_m);
        std::ranges::reverse(left_places);
        std::ranges::reverse(right_places);
    }
    return evenly_spaced(matched(left_places, right_places), left.closed());
}

}  // namespace conelane
