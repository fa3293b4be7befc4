#include "evaluation/world/generated_tracks.hpp"

#include "conelane/invalid_input.hpp"
#include "evaluation/seeded_random.hpp"

#include <array>
#include <iterator>
#include <numbers>
#include <sstream>

#include <boost/random/uniform_real_distribution.hpp>
#include <fmt/format.h>

namespace conelane {
namespace {

/// Tolerance for arcs that fill their side exactly, as in a circle [m].
constexpr double kTouching_m = 1e-9;

struct Arc {
    Point start;
    Point end;
    Point start_direction;
    Point end_direction;
    double curvature_1_m = 0.0;
    double length_m = 0.0;
    double tangent_m = 0.0;  ///< from the corner to either end
};

Arc arc_at(const Point& before, const Corner& corner, const Point& after, const std::string& key) {
    if (!(corner.radius_m > 0.0)) throw InvalidInput(key + ".radius_m", "is not positive");
    Arc arc;
    arc.start_direction = (corner.at - before).normalized();
    arc.end_direction = (after - corner.at).normalized();
    const double turn_rad = turning_angle(arc.start_direction, arc.end_direction);
    arc.tangent_m = corner.radius_m * std::tan(std::abs(turn_rad) / 2.0);
    arc.length_m = corner.radius_m * std::abs(turn_rad);
    arc.curvature_1_m = (turn_rad < 0.0 ? -1.0 : 1.0) / corner.radius_m;
    arc.start = corner.at - arc.tangent_m * arc.start_direction;
    arc.end = corner.at + arc.tangent_m * arc.end_direction;
    return arc;
}

struct FixedLayout {
    const char* name;
    bool closed;
    std::size_t stray_cones;
    const char* corners;  ///< x [m], y [m] and radius [m] of each
};
constexpr FixedLayout kFixedLayouts[]{
    {"straight", false, 0, "0 0 1, 250 0 1"},
    {"circle", true, 0, "25 0 25, 25 50 25, -25 50 25, -25 0 25"},
    {"curvy", false, 0,
     "0 0 1, 30 0 25, 55 22 12, 85 8 14, 108 34 10, 140 30 9, 152 4 11, 182 0 18, 210 20 1"},
    {"hairpins", true, 0,
     "0 0 8, 62 -2 8, 64 13 5.5, 22 12 4.8, 22 22.5 4.8, 64 24 5, 63 38 6.5, 26 36 16, 2 40 9"},
    {"slalom", true, 0,
     "0 0 12, 92 0 11, 94 26 10, 80 28.5 12, 67 23 11, 54 28.5 11, 41 23 11, 28 28.5 11, 15 23.5 12, "
     "-4 28 8.5"},
    {"kidney", true, 0, "0 0 14, -6 34 13, 20 40 11, 38 20 12, 52 38 11, 78 34 14, 72 -2 15, 34 -6 40"},
    {"chicanes", true, 0,
     "0 0 9, 0 32 10, 36 32 8, 44 24 8, 62 24 8, 70 32 8, 98 32 10, 98 0 9, 76 0 9, 66 -6 9, 38 -6 9, "
     "28 0 9"},
    {"long_lap", true, 0,
     "0 0 14, 88 0 12, 104 24 9, 84 38 6, 96 56 8, 120 62 7, 118 82 8, 74 80 9, 60 52 11, 62 26 9, "
     "38 20 7, 34 44 12, 44 74 9, 18 84 10, 10 60 14, -14 48 10, -16 14 14"},
    {"infield", true, 24,
     "0 0 12, 70 0 12, 84 22 10, 70 46 9, 44 46 5.5, 44 33 5.5, 62 30 5, 60 15 6, 24 15 7, 28 44 12, "
     "4 54 10, -14 26 14"},
    {"serpentine", true, 30,
     "0 0 8, -14 20 12, -8 44 8, 12 30 9, 30 20 9, 34 46 7, 50 46 6, 52 14 5.5, 66 14 5.5, 66 46 5.5, "
     "80 46 5.5, 82 14 5.5, 96 14 5.5, 98 46 6, 112 46 6, 110 -4 9"},
};

TrackLayout fixed_layout(const FixedLayout& fixed) {
    TrackLayout layout{fixed.name, fixed.closed, {}, fixed.stray_cones};
    std::istringstream text(fixed.corners);
    for (double x_m = 0.0, y_m = 0.0, radius_m = 0.0; text >> x_m >> y_m >> radius_m; text.ignore())
        layout.centre_line.push_back({{x_m, y_m}, radius_m});
    return layout;
}

/// Random numbers of one track. They depend on its name and its seed, so that tracks of one seed differ from
/// each other.
class Draw {
  public:
    Draw(const std::string& name, std::uint64_t seed) : generator_(generator_of(name, seed)) {}
    double uniform(double low, double high) {
        return boost::random::uniform_real_distribution<double>(low, high)(generator_);
    }
    int integer(int low, int high) {
        return boost::random::uniform_int_distribution<int>(low, high)(generator_);
    }

  private:
    boost::random::mt19937_64 generator_;
};

/// The same for a layout. Rounded, so that the last bit of a drawn number has no influence.
struct LayoutDraw : Draw {
    LayoutDraw(std::string_view name, std::uint64_t seed) : Draw(std::string(name) + " layout", seed) {}
    double uniform(double low, double high) { return std::round(Draw::uniform(low, high) * 1e3) / 1e3; }
};

/// Corners of an even number of parallel legs, `pitch_m` from centre to centre. A straight along their left
/// ends closes them.
std::vector<Corner> legs(int count, double length_m, double pitch_m, LayoutDraw& draw) {
    const double hairpin_m = 0.49 * pitch_m;
    const double ends_m = std::min(5.0, hairpin_m + 1.0);
    std::vector<Corner> corners{{{0.0, 0.0}, ends_m}};
    for (int leg = 0; leg < count; ++leg) {
        // Alternates between right and left, one leg at a time.
        const bool right = leg % 2 == 0;
        if (leg + 1 == count) {
            corners.push_back({{0.0, leg * pitch_m}, ends_m});
            break;
        }
        double x_m = right ? length_m + draw.uniform(-3.0, 3.0) : 1.2 * pitch_m + draw.uniform(0.0, 3.0);
        // A leg is at least as long as the hairpins at its ends need.
        const double before_m = corners.back().at.x();
        if (leg > 0)
            x_m =
                right ? std::max(x_m, before_m + 2.0 * hairpin_m) : std::min(x_m, before_m - 2.0 * hairpin_m);
        corners.push_back({{x_m, leg * pitch_m}, hairpin_m});
        corners.push_back({{x_m, (leg + 1) * pitch_m}, hairpin_m});
    }
    return corners;
}

/// The radii of a loop: of its polygon around its centre, and of its arcs.
struct LoopRadii {
    double least_m;
    double most_m = 16.0;
    double nearest_m = 28.0;
    double farthest_m = 38.0;
};

/// The corners of a star-shaped polygon, each rounded off as far as its sides and `most_m` allow; nothing if
/// that is less than `least_m`.
std::optional<std::vector<Corner>> loop(int count, double radius_m, const LoopRadii& radii,
                                        LayoutDraw& draw) {
    std::vector<Point> vertices;
    for (int k = 0; k < count; ++k) {
        const double angle_rad = 2.0 * std::numbers::pi * (k + draw.uniform(-0.2, 0.2)) / count;
        const double out_m = radius_m * draw.uniform(0.5, 1.5);
        vertices.emplace_back(std::round(10.0 * out_m * std::cos(angle_rad)) / 10.0,
                              std::round(10.0 * out_m * std::sin(angle_rad)) / 10.0);
    }
    std::vector<Corner> corners;
    const std::size_t n = vertices.size();
    for (std::size_t k = 0; k < n; ++k) {
        const Point before = vertices[k] - vertices[(k + n - 1) % n];
        const Point after = vertices[(k + 1) % n] - vertices[k];
        const double half_turn_rad = std::abs(turning_angle(before, after)) / 2.0;
        const double room_m = 0.48 * std::min(before.norm(), after.norm());
        const double fitting_m = room_m / std::max(std::tan(half_turn_rad), 1e-3);
        if (fitting_m < radii.least_m) return std::nullopt;
        corners.push_back({vertices[k], std::floor(10.0 * std::min(fitting_m, radii.most_m)) / 10.0});
    }
    return corners;
}

std::vector<Corner> drawn_loop(int fewest, int most, const LoopRadii& radii, LayoutDraw& draw) {
    while (true) {
        const int count = draw.integer(fewest, most);
        const double radius_m = draw.uniform(radii.nearest_m, radii.farthest_m);
        if (auto corners = loop(count, radius_m, radii, draw)) return *corners;
    }
}

constexpr double kSpacingJitter = 0.11;    ///< of a cone along its boundary, as a share of the spacing
constexpr double kBendNotice_m = 2.5;      ///< cones stand denser from this far before a bend
constexpr double kSample_m = 0.1;          ///< along the centre line
constexpr double kStrayOutside_m = 1.4;    ///< at least, from the mean boundary: outside the widest lane
constexpr double kStrayFarthest_m = 10.0;  ///< from the centre line at most
constexpr double kStrayClearance_m = 1.0;  ///< from every other cone at least

/// Half the lane width along a path, which must outlive it: two sinusoids around the mean, with whole numbers
/// of periods, and what bends add.
class HalfWidth {
  public:
    HalfWidth(const RoundedPath& path, const TrackStyle& style, Draw& draw)
        : path_(path),
          swells_{{{style.slow_swell_m, std::floor(draw.uniform(2.0, 4.0)), draw.uniform(0.0, 1.0)},
                   {style.quick_swell_m, std::floor(draw.uniform(5.0, 9.0)), draw.uniform(0.0, 1.0)}}},
          mean_width_m_(style.mean_width_m),
          wider_in_bends_m_(style.wider_in_bends_m) {}

    [[nodiscard]] double at(double arc_length_m) const {
        double width_m = mean_width_m_;
        for (const Swell& swell : swells_) {
            const double periods = swell.periods * arc_length_m / path_.length_m() + swell.phase;
            width_m += swell.amplitude_m * std::sin(2.0 * std::numbers::pi * periods);
        }
        if (wider_in_bends_m_ > 0.0) width_m += wider_in_bends_m_ * bend_at(arc_length_m);
        return width_m / 2.0;
    }

  private:
    struct Swell {
        double amplitude_m;
        double periods;
        double phase;
    };
    /// The mean curvature of 8 m of the path, as a share of that of a bend of 5 m; at most 1.
    [[nodiscard]] double bend_at(double arc_length_m) const {
        constexpr int kSteps = 10;
        constexpr double kStep_m = 0.4;
        constexpr double kSharp_1_m = 0.2;
        double sum_1_m = 0.0;
        for (int step = -kSteps; step <= kSteps; ++step)
            sum_1_m += std::abs(path_.at(arc_length_m + step * kStep_m).curvature_1_m);
        return std::min(1.0, sum_1_m / (2 * kSteps + 1) / kSharp_1_m);
    }

    const RoundedPath& path_;
    std::array<Swell, 2> swells_;
    double mean_width_m_;
    double wider_in_bends_m_;
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

RoundedPath::RoundedPath(const std::vector<Corner>& corners, bool closed) : closed_(closed) {
    const std::size_t n = corners.size();
    if (n < (closed ? 3U : 2U)) throw InvalidInput("corners", "too few");
    const auto key = [](std::size_t i) { return "corners[" + std::to_string(i) + "]"; };
    std::vector<Arc> arcs(n);
    for (std::size_t i = 0; i < n; ++i) {
        if (closed || (i > 0 && i + 1 < n)) {
            arcs[i] = arc_at(corners[(i + n - 1) % n].at, corners[i], corners[(i + 1) % n].at, key(i));
        } else {
            arcs[i].start = arcs[i].end = corners[i].at;
        }
    }
    for (std::size_t i = 0; i < (closed ? n : n - 1); ++i) {
        const std::size_t next = (i + 1) % n;
        const Point side = corners[next].at - corners[i].at;
        const double straight_m = side.norm() - arcs[i].tangent_m - arcs[next].tangent_m;
        if (!(straight_m >= -kTouching_m)) throw InvalidInput(key(i), "its arc meets the next one's");
        if (straight_m > kTouching_m) append(arcs[i].end, side.normalized(), 0.0, straight_m);
        if (arcs[next].length_m > 0.0) {
            append(arcs[next].start, arcs[next].start_direction, arcs[next].curvature_1_m,
                   arcs[next].length_m);
        }
    }
}

void RoundedPath::append(const Point& from, const Point& direction, double curvature_1_m,
                         double piece_length_m) {
    pieces_.push_back({length_m_, from, direction, curvature_1_m});
    length_m_ += piece_length_m;
}

RoundedPath::Place RoundedPath::at(double arc_length_m) const {
    if (closed_) {
        arc_length_m -= length_m_ * std::floor(arc_length_m / length_m_);
    } else {
        arc_length_m = std::clamp(arc_length_m, 0.0, length_m_);
    }
    const auto next = std::upper_bound(pieces_.begin() + 1, pieces_.end(), arc_length_m,
                                       [](double s, const Piece& piece) { return s < piece.start_m; });
    const Piece& piece = *(next - 1);
    const double along_m = arc_length_m - piece.start_m;
    const Point left_of_start(-piece.direction.y(), piece.direction.x());
    if (piece.curvature_1_m == 0.0) {
        return {piece.from + along_m * piece.direction, piece.direction, 0.0};
    }
    const double turned_rad = piece.curvature_1_m * along_m;
    const double radius_m = 1.0 / piece.curvature_1_m;
    const double sine = std::sin(turned_rad);
    const double cosine = std::cos(turned_rad);
    return {piece.from + radius_m * (sine * piece.direction + (1.0 - cosine) * left_of_start),
            cosine * piece.direction + sine * left_of_start, piece.curvature_1_m};
}

std::span<const TrackLayout> track_layouts() {
    static const std::vector<TrackLayout> layouts = [] {
        std::vector<TrackLayout> all;
        std::ranges::transform(kFixedLayouts, std::back_inserter(all), fixed_layout);
        return all;
    }();
    return layouts;
}

std::span<const std::string_view> drawn_layout_names() {
    static constexpr std::array<std::string_view, 7> kNames{
        "legs", "tight_hairpins", "gates", "wide", "wide_hairpins", "sparse", "sharp"};
    return kNames;
}

TrackLayout draw_layout(std::string_view name, std::uint64_t seed) {
    LayoutDraw draw(name, seed);
    TrackLayout layout{
        .name = std::string(name), .closed = true, .centre_line = {}, .stray_cones = 0, .style = {}};
    TrackStyle& style = layout.style;
    if (name == "legs") {
        style.mean_width_m = draw.uniform(3.2, 4.4);
        style.slow_swell_m = 0.2;
        style.quick_swell_m = 0.1;
        style.widest_spacing_m = draw.uniform(2.2, 3.6);
        style.spacing_per_curvature_m = 1.5;
        const double apart_m = draw.uniform(3.6, 6.0);
        const int count = draw.integer(0, 1) == 0 ? 4 : 6;
        const double length_m = draw.uniform(30.0, 40.0);
        layout.centre_line = legs(count, length_m, style.mean_width_m + apart_m, draw);
    } else if (name == "tight_hairpins") {
        style.mean_width_m = draw.uniform(2.9, 3.1);
        style.slow_swell_m = 0.05;
        style.quick_swell_m = 0.05;
        style.widest_spacing_m = draw.uniform(1.6, 2.0);
        style.spacing_per_curvature_m = 0.5;
        style.lateral_jitter_m = 0.04;
        const double apart_m = draw.uniform(2.9, 3.4);
        const int count = draw.integer(0, 1) == 0 ? 6 : 8;
        const double length_m = draw.uniform(20.0, 26.0);
        layout.centre_line = legs(count, length_m, style.mean_width_m + apart_m, draw);
    } else if (name == "gates") {
        style.mean_width_m = draw.uniform(3.3, 4.0);
        style.slow_swell_m = 0.3;
        style.widest_spacing_m = draw.uniform(3.0, 4.2);
        style.gates = 2;
        layout.stray_cones = static_cast<std::size_t>(draw.integer(4, 12));
        layout.centre_line = drawn_loop(8, 10, {6.5}, draw);
    } else if (name == "wide_hairpins") {
        style.mean_width_m = draw.uniform(3.2, 4.4);
        style.slow_swell_m = 0.1;
        style.quick_swell_m = 0.1;
        style.wider_in_bends_m = draw.uniform(2.5, 3.5);
        style.widest_spacing_m = draw.uniform(2.8, 4.8);
        style.spacing_per_curvature_m = draw.uniform(0.0, 2.0);
        const double hairpin_m = style.mean_width_m + style.wider_in_bends_m;
        const int count = draw.integer(0, 1) == 0 ? 4 : 6;
        const double length_m = draw.uniform(34.0, 46.0);
        layout.centre_line = legs(count, length_m, hairpin_m + draw.uniform(3.0, 6.5), draw);
    } else if (name == "sparse") {
        style.mean_width_m = draw.uniform(2.9, 3.8);
        style.slow_swell_m = 0.1;
        style.quick_swell_m = 0.1;
        style.widest_spacing_m = draw.uniform(4.0, 5.0);
        style.spacing_per_curvature_m = draw.uniform(-4.5, -2.5);
        layout.centre_line = drawn_loop(6, 9, {8.0, 16.0, 36.0, 50.0}, draw);
    } else if (name == "sharp") {
        style.mean_width_m = draw.uniform(2.9, 4.0);
        style.slow_swell_m = 0.1;
        style.quick_swell_m = 0.1;
        style.widest_spacing_m = draw.uniform(2.5, 4.5);
        style.spacing_per_curvature_m = draw.uniform(0.3, 2.0);
        const double radius_m = style.mean_width_m / 2.0 + draw.uniform(0.3, 1.5);
        layout.centre_line = drawn_loop(5, 8, {radius_m, radius_m, 20.0, 32.0}, draw);
    } else {
        style.mean_width_m = draw.uniform(5.2, 5.5);
        style.slow_swell_m = 0.3;
        style.quick_swell_m = 0.1;
        style.widest_spacing_m = draw.uniform(4.8, 5.4);
        style.spacing_per_curvature_m = 3.0;
        layout.stray_cones = static_cast<std::size_t>(draw.integer(4, 12));
        layout.centre_line = drawn_loop(7, 9, {8.0}, draw);
    }
    if (draw.integer(0, 1) == 1) {
        for (Corner& corner : layout.centre_line) corner.at.y() = -corner.at.y();  // driven clockwise
    }
    return layout;
}

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
    const HalfWidth half_width(path, layout.style, draw);
    const std::vector<Gate> gates = draw_gates(path, layout.style.gates, draw);
    track.left = append_boundary(track, path, layout.style, half_width, gates, 1.0, draw);
    track.right = append_boundary(track, path, layout.style, half_width, gates, -1.0, draw);
    append_strays(track, path, layout, draw);
    return track;
}

}  // namespace conelane
