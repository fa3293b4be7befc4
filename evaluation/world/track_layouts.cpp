#include "evaluation/world/track_layouts.hpp"

#include "conelane/invalid_input.hpp"
#include "evaluation/seeded_random.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <numbers>
#include <optional>
#include <sstream>
#include <vector>

#include <boost/random/uniform_int_distribution.hpp>
#include <boost/random/uniform_real_distribution.hpp>

namespace conelane {
namespace {

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

TrackLayout layout_of(const FixedLayout& fixed) {
    TrackLayout layout{fixed.name, fixed.closed, {}, fixed.stray_cones};
    std::istringstream text(fixed.corners);
    for (double x_m = 0.0, y_m = 0.0, radius_m = 0.0; text >> x_m >> y_m >> radius_m; text.ignore())
        layout.centre_line.push_back({{x_m, y_m}, radius_m});
    return layout;
}

}  // namespace

std::span<const TrackLayout> track_layouts() {
    static const std::vector<TrackLayout> layouts = [] {
        std::vector<TrackLayout> all;
        std::ranges::transform(kFixedLayouts, std::back_inserter(all), layout_of);
        return all;
    }();
    return layouts;
}

namespace {

class Draw {
  public:
    Draw(std::string_view name, std::uint64_t seed)
        : random_(generator_of(std::string(name) + " layout", seed)) {}

    double uniform(double low, double high) {
        // Rounded, so that the last bit of a drawn number has no influence.
        const double drawn = boost::random::uniform_real_distribution<double>(low, high)(random_);
        return std::round(drawn * 1e3) / 1e3;
    }
    int integer(int low, int high) {
        return boost::random::uniform_int_distribution<int>(low, high)(random_);
    }

  private:
    boost::random::mt19937_64 random_;
};

/// Corners of an even number of parallel legs, `pitch_m` from centre to centre. A straight along their left
/// ends closes them.
std::vector<Corner> legs(int count, double length_m, double pitch_m, Draw& draw) {
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
        const double x_m =
            right ? length_m + draw.uniform(-3.0, 3.0) : 1.2 * pitch_m + draw.uniform(0.0, 3.0);
        corners.push_back({{x_m, leg * pitch_m}, hairpin_m});
        corners.push_back({{x_m, (leg + 1) * pitch_m}, hairpin_m});
    }
    return corners;
}

/// The corners of a star-shaped polygon, each rounded off as far as its sides allow; nothing if that is
/// less than `least_radius_m`.
std::optional<std::vector<Corner>> loop(int count, double radius_m, double least_radius_m, Draw& draw) {
    constexpr double kMaxRadius_m = 16.0;
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
        if (fitting_m < least_radius_m) return std::nullopt;
        corners.push_back({vertices[k], std::floor(10.0 * std::min(fitting_m, kMaxRadius_m)) / 10.0});
    }
    return corners;
}

std::vector<Corner> drawn_loop(int fewest, int most, double least_radius_m, Draw& draw) {
    while (true) {
        const int count = draw.integer(fewest, most);
        if (auto corners = loop(count, draw.uniform(28.0, 38.0), least_radius_m, draw)) return *corners;
    }
}

}  // namespace

std::span<const std::string_view> drawn_layout_names() {
    static constexpr std::array<std::string_view, 4> kNames{"legs", "tight_hairpins", "gates", "wide"};
    return kNames;
}

TrackLayout draw_layout(std::string_view name, std::uint64_t seed) {
    Draw draw(name, seed);
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
        layout.centre_line = drawn_loop(8, 10, 6.5, draw);
    } else {
        style.mean_width_m = draw.uniform(5.2, 5.5);
        style.slow_swell_m = 0.3;
        style.quick_swell_m = 0.1;
        style.widest_spacing_m = draw.uniform(4.8, 5.4);
        style.spacing_per_curvature_m = 3.0;
        layout.stray_cones = static_cast<std::size_t>(draw.integer(4, 12));
        layout.centre_line = drawn_loop(7, 9, 8.0, draw);
    }
    if (draw.integer(0, 1) == 1) {
        for (Corner& corner : layout.centre_line) corner.at.y() = -corner.at.y();  // driven clockwise
    }
    return layout;
}

}  // namespace conelane
