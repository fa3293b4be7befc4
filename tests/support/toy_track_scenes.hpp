#pragma once

#include "evaluation/formats/scene_file.hpp"
#include "evaluation/world/scene_generation.hpp"
#include "tests/support/testing.hpp"

#include <iterator>

#include <unistd.h>

namespace conelane {

/// Boundaries at y = +-1.5 m with a cone every 5 m from x = 0 to `left_end` and `right_end`, and a stray
/// point of the map at (12, 8).
inline Track straight(double left_end = 95.0, double right_end = 95.0) {
    Track track{"toy", {}, {}, {}, false};
    const auto add = [&](const Point& position) {
        track.cones.push_back({static_cast<ConeId>(track.cones.size()), position});
        return track.cones.size() - 1;
    };
    for (double x = 0.0; x <= left_end; x += 5.0) track.left.push_back(add({x, 1.5}));
    add({12.0, 8.0});
    for (double x = 0.0; x <= right_end; x += 5.0) track.right.push_back(add({x, -1.5}));
    return track;
}

/// A closed course around (0, 0), driven counter-clockwise: 12 cones a side, radius 8.5 m left, 11.5 m right.
inline Track circle() {
    Track track{"circle", {}, {}, {}, true};
    for (int i = 0; i < 12; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / 12.0;
        const Point direction(std::cos(angle), std::sin(angle));
        track.left.push_back(track.cones.size());
        track.cones.push_back({i, 8.5 * direction});
        track.right.push_back(track.cones.size());
        track.cones.push_back({100 + i, 11.5 * direction});
    }
    return track;
}

inline SceneOptions options(std::vector<double> rates, std::vector<double> ranges_m) {
    return SceneOptions{.false_positive_rates = std::move(rates), .ranges_m = std::move(ranges_m)};
}

inline SceneOptions in_conditions(std::vector<std::string> names, double rate = 0.0) {
    SceneOptions result = options({rate}, {15.0});
    result.conditions = std::move(names);
    return result;
}

inline std::vector<AnnotatedScene> generate(const Track& track, const std::vector<Pose>& poses,
                                            const SceneOptions& wanted) {
    return generate_scenes(track, poses, wanted);
}

inline const Cone& cone_of(const AnnotatedScene& scene, ConeId id) {
    return *std::ranges::find(scene.scene.cones, id, &Cone::id);
}

/// x of the cones of a run, which tells cones of a straight boundary apart.
inline std::vector<double> xs(const AnnotatedScene& scene, const std::vector<ConeId>& run) {
    return mapped(run, [&](const ConeId id) { return cone_of(scene, id).position.x(); });
}

/// The bytes of a scenes file.
inline std::string bytes(const std::vector<AnnotatedScene>& scenes) {
    const std::filesystem::path file =
        std::filesystem::path(testing::TempDir()) / ("conelane_" + std::to_string(::getpid()) + ".jsonl");
    write_scenes(file, scenes);
    std::ifstream stream(file, std::ios::binary);
    std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
    std::filesystem::remove(file);
    return text;
}

}  // namespace conelane
