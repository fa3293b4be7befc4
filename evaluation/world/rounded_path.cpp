#include "evaluation/world/rounded_path.hpp"

#include "conelane/invalid_input.hpp"

#include <algorithm>
#include <cmath>
#include <string>

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

}  // namespace conelane
