#pragma once

#include "tests/support/testing.hpp"

#include <bit>

namespace conelane::tests {

/// A transformation of a scene that has the same lane.
struct Change {
    std::string_view name;
    std::function<Scene(Scene)> apply;
    ConeId (*new_id)(ConeId) = [](ConeId id) { return id; };
    bool mirrors = false;  ///< left and right swap

    [[nodiscard]] Lane apply_to(Lane lane) const {
        for (ConeId& id : lane.left) id = new_id(id);
        for (ConeId& id : lane.right) id = new_id(id);
        if (mirrors) std::swap(lane.left, lane.right);
        return lane;
    }
    friend void PrintTo(const Change& change, std::ostream* out) { *out << change.name; }
};

/// The coordinates rounded to multiples of 2^-20 m, about a micrometre: such a scene can be moved by 2^32 m
/// without rounding.
inline Scene on_grid(Scene scene) {
    const auto round = [](Point& point) {
        constexpr double kPerMetre = 1 << 20;
        point = {std::round(point.x() * kPerMetre) / kPerMetre,
                 std::round(point.y() * kPerMetre) / kPerMetre};
    };
    round(scene.pose.position);
    for (Cone& cone : scene.cones) round(cone.position);
    return scene;
}

inline Scene moved(Scene scene, const Point& by) {
    scene.pose.position += by;
    for (Cone& cone : scene.cones) cone.position += by;
    return scene;
}

/// Around the origin.
inline Scene rotated(Scene scene, double angle_rad) {
    const double cosine = std::cos(angle_rad);
    const double sine = std::sin(angle_rad);
    const auto turn = [&](Point& point) {
        point = {cosine * point.x() - sine * point.y(), sine * point.x() + cosine * point.y()};
    };
    turn(scene.pose.position);
    for (Cone& cone : scene.cones) turn(cone.position);
    scene.pose.yaw_rad += angle_rad;
    return scene;
}

/// At the x axis.
inline Scene mirrored(Scene scene) {
    scene.pose.position.y() *= -1.0;
    scene.pose.yaw_rad *= -1.0;
    for (Cone& cone : scene.cones) {
        cone.position.y() *= -1.0;
        if (cone.color == ConeColor::blue) {
            cone.color = ConeColor::yellow;
        } else if (cone.color == ConeColor::yellow) {
            cone.color = ConeColor::blue;
        }
    }
    return scene;
}

inline Scene scaled(Scene scene, double factor) {
    scene.pose.position *= factor;
    for (Cone& cone : scene.cones) cone.position *= factor;
    return scene;
}

inline Scene shuffled(Scene scene) {
    boost::random::mt19937_64 random(scene.cones.size());
    for (std::size_t i = scene.cones.size(); i > 1; --i) {
        const std::size_t other = boost::random::uniform_int_distribution<std::size_t>(0, i - 1)(random);
        std::swap(scene.cones[i - 1], scene.cones[other]);
    }
    return scene;
}

/// A bijection that changes the order as if by chance.
inline ConeId scattered_id(ConeId id) {
    return std::bit_cast<ConeId>(std::bit_cast<std::uint64_t>(id) * 0x9e3779b97f4a7c15U);
}
inline Scene renumbered(Scene scene) {
    for (Cone& cone : scene.cones) cone.id = scattered_id(cone.id);
    return scene;
}

/// Adds one cone, as seen from the car.
inline Scene with_cone(Scene scene, double ahead_m, double left_m) {
    const Point heading = scene.pose.heading();
    scene.cones.push_back(
        {-1, scene.pose.position + ahead_m * heading + left_m * Point(-heading.y(), heading.x())});
    return scene;
}

/// The largest shift that doubles allow, on the grid: 2^32 m.
inline constexpr double kFarAway_m = 4294967296.0;

inline std::vector<Change> changes() {
    return {
        {"Rotated", [](Scene s) { return rotated(std::move(s), 1.0); }},
        {"RotatedByARightAngle", [](Scene s) { return rotated(std::move(s), std::acos(-1.0) / 2.0); }},
        {"Moved",
         [](Scene s) {
             return moved(std::move(s), {-731.0, 277.0});
         }},
        {"MovedFar",
         [](Scene s) {
             return moved(std::move(s), {kFarAway_m, -kFarAway_m});
         }},
        {"Mirrored", mirrored, [](ConeId id) { return id; }, true},
        {"Shuffled", shuffled},
        {"Renumbered", renumbered, scattered_id},
        {"WithAConeFarBehind", [](Scene s) { return with_cone(std::move(s), -18.0, 0.5); }},
        {"WithAConeFarAway", [](Scene s) { return with_cone(std::move(s), 2000.0, -3000.0); }},
    };
}

}  // namespace conelane::tests
