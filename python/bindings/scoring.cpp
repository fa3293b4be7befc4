#include "conelane/invalid_input.hpp"
#include "evaluation/scoring/score.hpp"
#include "python/bindings/arrays.hpp"
#include "python/bindings/bindings.hpp"

#include <optional>
#include <string>

#include <fmt/format.h>
#include <pybind11/stl.h>

namespace conelane::python {
namespace {

CentreLine line_of(const LaneObject& lane, const AnnotatedScene& scene) {
    const LaneRecord& record = lane.record;
    const Pose& pose = scene.scene.pose;
    if (record.points) {
        return centre_line_of(
            LaneOutline{record.points->left, record.points->right, record.answer.lane.closed}, pose);
    }
    if (!record.centre_line.empty()) return centre_line_of(record.centre_line, pose);
    return centre_line_of(outline_of(record.answer.lane, scene.scene), pose);
}

SceneScore score_of(const LaneObject& lane, const AnnotatedScene& scene, const TrackBoundaries* boundaries) {
    const LaneRecord& record = lane.record;
    if (record.points) {
        return score_outline(scene, {record.points->left, record.points->right, record.answer.lane.closed},
                             record.latency_ms, boundaries);
    }
    if (!record.centre_line.empty())
        return score_centre_line(scene, record.centre_line, record.latency_ms, boundaries);
    return score(scene, record.answer, record.latency_ms, record.nearest, boundaries);
}

SceneScore score(const AnnotatedScene& scene, const LaneObject& lane, const TrackBoundaries* boundaries) {
    const py::gil_scoped_release unlocked;
    conelane::validate(scene.scene);
    SceneScore score = score_of(lane, scene, boundaries);
    if (score.usable().value_or(false) && scene.ground_truth) {
        const auto truth = centre_line_of(outline_of(*scene.ground_truth, scene.scene), scene.scene.pose);
        score.centre_line_error = centre_line_error(line_of(lane, scene), truth);
    }
    return score;
}

std::optional<bool> accurate(const SceneScore& score) {
    if (!score.accuracy) return std::nullopt;
    return score.accuracy->accurate();
}

std::optional<py::array_t<float>> lateral_error_m(const SceneScore& score) {
    if (!score.centre_line_error) return std::nullopt;
    const std::vector<float>& values = score.centre_line_error->lateral_m;
    return py::array_t<float>(static_cast<py::ssize_t>(values.size()), values.data());
}

std::optional<double> heading_error_rad(const SceneScore& score) {
    if (!score.centre_line_error) return std::nullopt;
    return score.centre_line_error->heading_rad;
}

constexpr const char* kScore = R"(score(scene, lane, boundaries=None)

Compares a lane with the true one. The measures are defined in docs/measures.md.

Parameters
----------
scene : Scene
    With a ground truth, or of a run whose boundaries have the driven path.
lane : Lane
    Of this scene: cones are compared by their ids.
boundaries : Boundaries, optional
    Of the whole course. Without them divergence is unknown.

Returns
-------
Score

Raises
------
ValueError
    If the scene has no ground truth with two cones on each side, or if the lane names a cone that the
    scene does not have.

Examples
--------
>>> import conelane
>>> track = conelane.load_tracks("generated:circle")[0]
>>> scene = conelane.generate_scenes(track, every_m=20.0)[0]
>>> result = conelane.score(scene, conelane.Detector("front").detect_scene(scene), track.boundaries)
>>> result.usable, result.category
(True, 'ground_truth')
)";

}  // namespace

void add_scoring(py::module_& module) {
    Class<SceneScore>(module, "Score", "What one lane is worth, by the measures of both papers.")
        .get("usable", "bool or None: whether a car can drive by the lane; None without boundaries",
             &SceneScore::usable)
        .get(
            "category",
            R"(str: "none", "ground_truth", "diverging_below_20", "diverging_from_20", "too_short" or "near_ground_truth")",
            &SceneScore::category, kName)
        .get("success", "bool: any category but none and diverging_below_20", &SceneScore::success)
        .get("accurate", "bool or None: passes the four checks of the RLD paper; None if they do not apply",
             accurate)
        .get("error", "bool: the method failed", &SceneScore::error)
        .get("iou", "float or None: intersection over union with the true lane, in [0, 1]", &SceneScore::iou)
        .get("lane_length_m", "float: of the lane [m]", &SceneScore::lane_length_m)
        .get("ground_truth_length_m", "float: of the true lane [m]", &SceneScore::ground_truth_length_m)
        .get("divergence_distance_m",
             "float or None: distance at which the lane leaves the course [m]; None if it does not",
             &SceneScore::divergence_distance_m)
        .get("lateral_error_m",
             "(K,) ndarray of float32 or None: lateral error of the centre line every 0.5 m [m]; for usable "
             "lanes",
             lateral_error_m)
        .get("heading_error_rad",
             "float or None: heading error of the centre line 10 m ahead [rad]; for usable lanes",
             heading_error_rad)
        .repr([](const SceneScore& s) { return fmt::format("<conelane.Score {}>", to_string(s.category)); });

    add_function(module, kScore, score);
}

}  // namespace conelane::python
