#pragma once

#include "conelane/point.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace conelane {

using ConeId = std::int64_t;

/// Position and heading of the car in the frame of reference of the cones; yaw counter-clockwise, 0 along +x.
struct Pose {
    Point position{0.0, 0.0};  ///< [m]
    double yaw_rad = 0.0;

    /// Unit vector h_c of the driving direction.
    [[nodiscard]] Point heading() const;
    /// Distance of `point` ahead of the car, along the heading [m]; negative behind.
    [[nodiscard]] double ahead_m(const Point& point) const;
    /// Distance of `point` to the left of the car's axis [m]; negative to the right.
    [[nodiscard]] double left_m(const Point& point) const;
};

/// `orange` does not tell the size; as start line the planner prefers `big_orange` cones.
enum class ConeColor { unknown, blue, yellow, orange, big_orange };
[[nodiscard]] std::string_view to_string(ConeColor color);
[[nodiscard]] constexpr bool is_orange(ConeColor color) {
    return color == ConeColor::orange || color == ConeColor::big_orange;
}

/// How likely a cone is of each class, each in [0, 1], all together 1.
struct ColorProbabilities {
    double unknown = 0.0;  ///< that the class cannot be recognised
    double blue = 0.0;
    double yellow = 0.0;
    double orange = 0.0;  ///< a small one
    double big_orange = 0.0;

    bool operator==(const ColorProbabilities&) const = default;
};
/// 1 for this color, 0 for all others. `orange` counts as small.
[[nodiscard]] ColorProbabilities probabilities_of(ConeColor color);
/// The most probable color, small and big orange together; unknown if two colors are equally probable.
[[nodiscard]] ConeColor most_probable_color(const ColorProbabilities& probabilities);

/// Covariance of the measured position of a cone [m^2].
struct PositionCovariance {
    double xx_m2 = 0.0;
    double xy_m2 = 0.0;
    double yy_m2 = 0.0;

    bool operator==(const PositionCovariance&) const = default;
    /// Finite and positive semidefinite; rounding may put a correlation beyond 1 or -1 by at most 1e-6.
    [[nodiscard]] bool is_valid() const;
    /// Variance along a unit vector [m^2], at least 0.
    [[nodiscard]] double along_m2(const Point& direction) const;
};

struct Cone {
    ConeId id = 0;
    Point position{0.0, 0.0};  ///< [m]
    ConeColor color = ConeColor::unknown;
    double confidence = 1.0;  ///< of the detection, in [0, 1]
    /// Class probabilities. If present, `front`, `front-warm` and ProblemEdge::color_cost use them instead of
    /// `color`. The planner and the learned feature `same_color` use `color` alone.
    std::optional<ColorProbabilities> color_probabilities{};
    /// How uncertain the position is. Only `front` and `front-warm` use it; the planner in trackdrive and
    /// autocross drops it. Absent: as 0.
    std::optional<PositionCovariance> position_covariance{};

    /// `color_probabilities`, or else those of `color`.
    [[nodiscard]] ColorProbabilities probabilities() const {
        return color_probabilities ? *color_probabilities : probabilities_of(color);
    }
};

/// The input of a lane detector, without ground truth. Cones are unordered; their ids are distinct.
struct Scene {
    std::string id;
    Pose pose;
    std::vector<Cone> cones;
};

/// Throws InvalidInput, naming the key, if a number is not finite, a confidence or a probability is outside
/// [0, 1], the probabilities of a cone add up to less than 0.999 or more than 1.001, a covariance is not
/// valid, or an id occurs twice. A scene without cones is valid; scenes files refuse it.
void validate(const Scene& scene);
/// The same, with `ids` as workspace: it allocates only if `ids` has too little capacity.
void validate(const Scene& scene, std::vector<ConeId>& ids);

/// The scene with the `count` cones nearest to the car among those ahead of it (in the closed half-plane
/// along the heading), in their old order. Of two equally near cones the one with the smaller id comes first.
[[nodiscard]] Scene nearest_ahead(const Scene& scene, std::size_t count);

}  // namespace conelane
