#include "evaluation/world/generated_tracks.hpp"

#include "conelane/invalid_input.hpp"
#include "evaluation/seeded_random.hpp"
#include "evaluation/world/track_layouts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <string_view>

#include <boost/random/uniform_real_distribution.hpp>
#include <fmt/format.h>

namespace conelane {
namespace {

constexpr double kSpacingJitter = 0.11;    ///< of a cone along its boundary, as a share of the spacing
constexpr double kBendNotice_m = 2.5;      ///< cones stand denser from this far before a bend
constexpr double kSample_m = 0.1;          ///< along the centre line
constexpr double kStrayOutside_m = 1.4;    ///< at least, from the mean boundary: outside the widest lane
constexpr double kStrayFarthest_m = 10.0;  ///< from the centre line at most
constexpr double kStrayClearance_m = 1.0;  ///< from every other cone at least

/// Random numbers of one track. They depend on its name and its seed, so that tracks of one seed differ from
/// each other.
class Draw {
  public:
    Draw(const std::string& name, std::uint64_t seed) : generator_(generator_of(name, seed)) {}
    double uniform(double low, double high) {
        return boost::random::uniform_real_distribution<double>(low, high)(generator_);
    }

  private:
    boost::random::mt19937_64 generator_;
};

/// Half the lane width along a path: two sinusoids around the mean, with whole numbers of periods.
class HalfWidth {
  public:
    HalfWidth(double path_length_m, const TrackStyle& style, Draw& draw)
        : swells_{{{style.slow_swell_m, std::floor(draw.uniform(2.0, 4.0)), draw.uniform(0.0, 1.0)},
                   {style.quick_swell_m, std::floor(draw.uniform(5.0, 9.0)), draw.uniform(0.0, 1.0)}}},
          mean_width_m_(style.mean_width_m),
          path_length_m_(path_length_m) {}

    [[nodiscard]] double at(double arc_length_m) const {
        double width_m = mean_width_m_;
        for (const Swell& swell : swells_) {
            const double periods = swell.periods * arc_length_m / path_length_m_ + swell.phase;
            width_m += swell.amplitude_m * std::sin(2.0 * std::numbers::pi * periods);
        }
        return width_m / 2.0;
    }

  private:
    struct Swell {
        double amplitude_m;
        double periods;
        double phase;
    };
    std::array<Swell, 2> swells_;
    double mean_width_m_;
    double path_length_m_;
};

/// The point `left_m` to the left of a path.
Point beside(const RoundedPath& path, double arc_length_m, double left_m) {
    const RoundedPath::Place place = path.at(arc_length_m);
    return place.position + left_m * Point(-place.direction.y(), place.direction.x());
}

/// Expected spacing of the cones at places every kSample_m along a path.
std::vector<double> expected_spacings_m(const RoundedPath& path, const TrackStyle& style, std::size_t samples,
                                        double sample_m) {
    const auto reach = static_cast<int>(std::ceil(kBendNotice_m / sample_m));
    std::vector<double> result;
    for (std::size_t i = 0; i < samples; ++i) {
        double sharpest_1_m = 0.0;
        for (int step = -reach; step <= reach; ++step) {
            const double s_m = (static_cast<double>(i) + step) * sample_m;
            sharpest_1_m = std::max(sharpest_1_m, std::abs(path.at(s_m).curvature_1_m));
        }
        result.push_back(style.widest_spacing_m / (1.0 + style.spacing_per_curvature_m * sharpest_1_m));
    }
    return result;
}

/// Arc lengths along the path of the cones of the boundary `side` (+1 left, -1 right), ascending. The
/// boundary is measured in expected spacings, so that cones at whole numbers of them stand densest in bends
/// and a closed boundary closes without a short or a long gap.
std::vector<double> cone_places_m(const RoundedPath& path, const TrackStyle& style,
                                  const HalfWidth& half_width, double side, Draw& draw) {
    const auto samples = static_cast<std::size_t>(std::ceil(path.length_m() / kSample_m));
    const double sample_m = path.length_m() / static_cast<double>(samples);
    const std::vector<double> spacings_m = expected_spacings_m(path, style, samples, sample_m);
    std::vector<double> measure{0.0};
    Point before = beside(path, 0.0, side * half_width.at(0.0));
    for (std::size_t i = 0; i < samples; ++i) {
        const double s_m = static_cast<double>(i + 1) * sample_m;
        const Point after = beside(path, s_m, side * half_width.at(s_m));
        measure.push_back(measure.back() + (after - before).norm() / spacings_m[i]);
        before = after;
    }

    const double gaps = std::ceil(measure.back());
    const double stretch = measure.back() / gaps;
    const double offset = path.closed() ? draw.uniform(0.2, 0.8) : 0.0;
    const auto cones = static_cast<std::size_t>(gaps) + (path.closed() ? 0 : 1);
    std::vector<double> places_m;
    for (std::size_t cone = 0; cone < cones; ++cone) {
        const double jitter = draw.uniform(-kSpacingJitter, kSpacingJitter);
        const double target =
            std::clamp((static_cast<double>(cone) + offset + jitter) * stretch, 0.0, measure.back());
        const auto above = std::upper_bound(measure.begin() + 1, measure.end() - 1, target);
        const double share = (target - *(above - 1)) / (*above - *(above - 1));
        places_m.push_back((static_cast<double>(above - measure.begin() - 1) + share) * sample_m);
    }
    return places_m;
}

/// Multiples of 0.1 mm, so that differences between mathematical libraries do not show.
Point rounded(const Point& point) {
    const auto round = [](double value_m) { return std::round(value_m * 1e4) / 1e4; };
    return {round(point.x()), round(point.y())};
}

void append_cone(Track& track, const Point& position, ConeColor color) {
    track.cones.push_back({static_cast<ConeId>(track.cones.size()), rounded(position), color, 1.0});
}

/// A gate: a gap of the boundaries around a place, with a pair of orange cones on each side.
struct Gate {
    double place_m;     ///< along the path
    double half_gap_m;  ///< to the next cone of the boundary
    double half_pair_m;
};

/// Gates at the straightest places: the path is divided into as many parts, with one gate in each.
std::vector<Gate> draw_gates(const RoundedPath& path, std::size_t count, Draw& draw) {
    constexpr double kReach_m = 10.0;
    constexpr double kStep_m = 1.0;
    std::vector<Gate> gates;
    const double part_m = path.length_m() / static_cast<double>(count);
    for (std::size_t part = 0; part < count; ++part) {
        const double start_m = static_cast<double>(part) * part_m;
        double straightest_1_m = 1e9;
        double place_m = start_m + part_m / 2.0;
        for (double s_m = start_m + kReach_m; s_m < start_m + part_m - kReach_m; s_m += kStep_m) {
            double sharpest_1_m = 0.0;
            for (double off_m = -kReach_m; off_m <= kReach_m; off_m += kStep_m) {
                sharpest_1_m = std::max(sharpest_1_m, std::abs(path.at(s_m + off_m).curvature_1_m));
            }
            if (sharpest_1_m >= straightest_1_m) continue;
            straightest_1_m = sharpest_1_m;
            place_m = s_m;
        }
        gates.push_back({place_m, draw.uniform(5.0, 6.2), draw.uniform(0.2, 0.8)});
    }
    return gates;
}

/// A cone of a boundary, by its place along the path.
struct PlacedCone {
    double place_m;
    ConeColor color;
};

/// The cones of a boundary in their order, with the gaps and the orange cones of the gates.
std::vector<PlacedCone> with_gates(std::span<const double> places_m, ConeColor color,
                                   std::span<const Gate> gates) {
    std::vector<PlacedCone> cones;
    for (const double place_m : places_m) {
        const bool free = std::ranges::none_of(gates, [&](const Gate& gate) {
            // A cone on either side of the gap ends the boundary there.
            return std::abs(place_m - gate.place_m) < gate.half_gap_m + 1.0;
        });
        if (free) cones.push_back({place_m, color});
    }
    for (const Gate& gate : gates) {
        for (const double way : {-1.0, 1.0}) {
            cones.push_back({gate.place_m + way * gate.half_gap_m, color});
            cones.push_back({gate.place_m + way * gate.half_pair_m, ConeColor::orange});
        }
    }
    std::ranges::stable_sort(cones, {}, &PlacedCone::place_m);
    return cones;
}

std::vector<std::size_t> append_boundary(Track& track, const RoundedPath& path, const TrackStyle& style,
                                         const HalfWidth& half_width, std::span<const Gate> gates,
                                         double side, Draw& draw) {
    std::vector<std::size_t> boundary;
    const ConeColor color = side > 0.0 ? ConeColor::blue : ConeColor::yellow;
    const std::vector<double> places_m = cone_places_m(path, style, half_width, side, draw);
    for (const PlacedCone& cone : with_gates(places_m, color, gates)) {
        const double off_m = draw.uniform(-style.lateral_jitter_m, style.lateral_jitter_m);
        boundary.push_back(track.cones.size());
        append_cone(track, beside(path, cone.place_m, side * half_width.at(cone.place_m) + off_m),
                    cone.color);
    }
    return boundary;
}

/// Cones outside the lane. Each is drawn again until it is clear of every section and of the other cones.
void append_strays(Track& track, const RoundedPath& path, const TrackLayout& layout, Draw& draw) {
    const double nearest_m = layout.style.mean_width_m / 2.0 + kStrayOutside_m;  // from the centre line
    std::vector<Point> centre_line;
    const auto samples = static_cast<std::size_t>(path.length_m() / kSample_m);
    for (std::size_t i = 0; i <= samples; ++i) {
        centre_line.push_back(path.at(static_cast<double>(i) * kSample_m).position);
    }
    const std::size_t wanted = track.cones.size() + layout.stray_cones;
    while (track.cones.size() < wanted) {
        const double s_m = draw.uniform(0.0, path.length_m());
        const double side = draw.uniform(0.0, 1.0) < 0.5 ? -1.0 : 1.0;
        const Point position = beside(path, s_m, side * draw.uniform(nearest_m, kStrayFarthest_m));
        const bool near_cone = std::ranges::any_of(track.cones, [&](const Cone& cone) {
            return (cone.position - position).norm() < kStrayClearance_m;
        });
        if (near_cone) continue;
        if (foot_on_polyline(position, centre_line, path.closed()).distance_m < nearest_m) continue;
        append_cone(track, position, ConeColor::unknown);
    }
}

TrackLayout layout_of(const std::string& name, std::uint64_t seed) {
    const auto fixed = std::ranges::find(track_layouts(), name, &TrackLayout::name);
    if (fixed != track_layouts().end()) return *fixed;
    if (std::ranges::find(drawn_layout_names(), name) != drawn_layout_names().end()) {
        return draw_layout(name, seed);
    }
    throw InvalidInput("generated track",
                       fmt::format("'{}' is not one of {}", name, fmt::join(generated_track_names(), ", ")));
}

}  // namespace

std::vector<std::string> generated_track_names() {
    std::vector<std::string> names;
    for (const TrackLayout& layout : track_layouts()) names.push_back(layout.name);
    for (const std::string_view name : drawn_layout_names()) names.emplace_back(name);
    return names;
}

Track generate_track(const std::string& name, std::uint64_t seed) {
    const TrackLayout layout = layout_of(name, seed);
    Track track;
    track.name = seed == 0 ? name : fmt::format("{}@{}", name, seed);
    track.closed = layout.closed;
    const RoundedPath path(layout.centre_line, layout.closed);
    Draw draw(name, seed);
    const HalfWidth half_width(path.length_m(), layout.style, draw);
    const std::vector<Gate> gates = draw_gates(path, layout.style.gates, draw);
    track.left = append_boundary(track, path, layout.style, half_width, gates, 1.0, draw);
    track.right = append_boundary(track, path, layout.style, half_width, gates, -1.0, draw);
    append_strays(track, path, layout, draw);
    return track;
}

}  // namespace conelane
