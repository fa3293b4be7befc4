#pragma once

#include "conelane/rld_parameters.hpp"
#include "conelane/scene.hpp"

#include <cstddef>
#include <limits>
#include <set>

#include <fuzzer/FuzzedDataProvider.h>

namespace conelane::fuzz {

/// Any finite number, the rare ones as likely as the usual ones.
inline double any_number(FuzzedDataProvider& input) {
    double value = 0.0;
    const auto bits = input.ConsumeIntegral<std::uint64_t>();
    static_assert(sizeof(value) == sizeof(bits));
    __builtin_memcpy(&value, &bits, sizeof(value));
    return std::isfinite(value) ? value : 0.0;
}

/// A length that is usual among cones: a multiple of 5 cm up to 6.4 m, with sign.
inline double usual_length_m(FuzzedDataProvider& input) {
    return 0.05 * static_cast<double>(input.ConsumeIntegral<std::int8_t>());
}

/// A cone's place relative to earlier ones: where a lane would have it, on top of one, on a line with two, on
/// a grid where distances tie, mirrored at the car's axis, or anywhere.
inline Point place_of_cone(FuzzedDataProvider& input, const std::vector<Point>& earlier) {
    enum class Place { lane, top, line, grid, mirrored, far, anywhere, kMaxValue = anywhere };
    const auto place = input.ConsumeEnum<Place>();
    const auto some_earlier = [&] {
        return earlier.empty() ? Point{0.0, 0.0}
                               : earlier[input.ConsumeIntegralInRange<std::size_t>(0, earlier.size() - 1)];
    };
    switch (place) {
        case Place::lane: {
            const double side = earlier.size() % 2 == 0 ? 1.0 : -1.0;
            const auto along = static_cast<double>(earlier.size() / 2);
            const double sideways_m = 0.3 * usual_length_m(input);
            return {1.0 + 3.2 * along + 0.1 * usual_length_m(input), 1.8 * side + sideways_m};
        }
        case Place::top:
            return some_earlier();
        case Place::line: {
            const Point a = some_earlier();
            const Point b = some_earlier();
            return a + static_cast<double>(input.ConsumeIntegral<std::int8_t>()) * (b - a);
        }
        case Place::grid: {
            const double x = input.ConsumeIntegralInRange<int>(-8, 8);
            return {3.0 * x, 3.0 * input.ConsumeIntegralInRange<int>(-8, 8)};
        }
        case Place::mirrored: {
            const Point other = some_earlier();
            return {other.x(), -other.y()};
        }
        case Place::far: {
            const double x_m = 10.0 * usual_length_m(input);
            return {x_m, 10.0 * usual_length_m(input)};
        }
        case Place::anywhere:
            break;
    }
    const double x = any_number(input);
    return {x, any_number(input)};
}

inline Cone fuzzed_cone(FuzzedDataProvider& input, const Point& position, std::set<ConeId>& ids) {
    Cone cone;
    cone.position = position;
    if (input.ConsumeProbability<double>() > 0.5) {
        constexpr ConeColor kColors[]{ConeColor::unknown, ConeColor::blue, ConeColor::yellow,
                                      ConeColor::orange};
        cone.color = kColors[input.ConsumeIntegralInRange<std::size_t>(0, 3)];
        cone.confidence = input.ConsumeProbability<double>();
        cone.id = input.ConsumeIntegral<ConeId>();
    } else {
        cone.id = static_cast<ConeId>(ids.size());
    }
    while (!ids.insert(cone.id).second) {
        cone.id = static_cast<ConeId>(static_cast<std::uint64_t>(cone.id) + 1);
    }
    return cone;
}

/// Readers of tracks reject points farther from the origin. There, neighbouring doubles are 2e-9 m apart.
constexpr double kMaxMapDistance_m = 1e7;

inline bool is_on_a_map(const Scene& scene) {
    const auto is_near = [](const Point& point) { return point.cwiseAbs().maxCoeff() <= kMaxMapDistance_m; };
    return is_near(scene.pose.position) &&
           std::ranges::all_of(scene.cones, [&](const Cone& cone) { return is_near(cone.position); });
}

/// A scene made of the bytes that `validate` accepts: a drawing of up to `max_cones` cones, rotated with the
/// car, scaled and moved away from the origin.
inline Scene fuzzed_scene(FuzzedDataProvider& input, std::size_t max_cones) {
    constexpr double kUnits[]{1.0, 1.0, 1.0, 1.0, 1e-9, 1e-3, 0.3, 3.0, 1e3, 1e6, 1e150, 1e300};
    constexpr double kAway_m[]{0.0, 0.0, 0.0, 0.0, 1.0, 1e3, 1e6, 1e9, 1e15, 1e200};
    const double unit = input.PickValueInArray(kUnits);
    const double away_m = input.PickValueInArray(kAway_m);
    Scene scene;
    scene.id = "fuzzed";
    const double turn = std::numbers::pi / 8.0 * input.ConsumeIntegralInRange<int>(0, 15);
    scene.pose.yaw_rad = input.ConsumeBool() ? turn : any_number(input);
    scene.pose.position = {away_m, -away_m};
    const double cosine = std::cos(turn);
    const double sine = std::sin(turn);

    const auto cones = input.ConsumeIntegralInRange<std::size_t>(0, max_cones);
    std::vector<Point> drawing;
    std::set<ConeId> ids;
    for (std::size_t i = 0; i < cones && input.remaining_bytes() > 0; ++i) {
        const Point place = place_of_cone(input, drawing);
        const Point turned =
            Point{cosine * place.x() - sine * place.y(), sine * place.x() + cosine * place.y()};
        const Point position = unit * turned + scene.pose.position;
        if (!place.allFinite() || !position.allFinite()) continue;
        drawing.push_back(place);
        scene.cones.push_back(fuzzed_cone(input, position, ids));
    }
    return scene;
}

/// Parameters within their ranges: the defaults, some of them changed.
inline RldParameters fuzzed_parameters(FuzzedDataProvider& input) {
    RldParameters parameters;
    if (input.ConsumeBool()) parameters = with_shape_costs(parameters);
    if (input.ConsumeBool()) parameters.pairing = Pairing::paper;
    if (input.ConsumeBool()) parameters.use_confidence = true;
    if (input.ConsumeBool()) parameters.forbid_crossing = true;
    for (const auto& fields : {rld_parameter_fields(), rld_extra_fields()}) {
        for (const RldParameterField& field : fields) {
            if (input.ConsumeIntegral<std::uint8_t>() < 224) continue;
            const double highest = std::min(field.highest, 100.0);
            const auto share = input.ConsumeProbability<double>();
            parameters.*field.value = field.lowest + share * share * share * (highest - field.lowest);
        }
    }
    return parameters;
}

}  // namespace conelane::fuzz
