#include "conelane/invalid_input.hpp"
#include "python/bindings/bindings.hpp"

#include <unordered_set>
#include <utility>

namespace conelane::python {
namespace {

using Sides = std::optional<std::pair<py::object, py::object>>;

std::shared_ptr<AnnotatedScene> make_scene(const py::object& cones, const py::object& pose,
                                           const py::object& ids, const py::object& colors,
                                           const py::object& confidences, const std::string& id,
                                           const Sides& ground_truth, bool closed, const std::string& track,
                                           const py::object& covariances) {
    auto scene = std::make_shared<AnnotatedScene>();
    scene->scene = {id, python::pose(pose), python::cones(cones, ids, colors, confidences, covariances)};
    validate(scene->scene);
    scene->track = track;
    if (ground_truth) {
        scene->ground_truth =
            Lane{ids_at(ground_truth->first, scene->scene.cones, "ground_truth.left"),
                 ids_at(ground_truth->second, scene->scene.cones, "ground_truth.right"), closed};
        std::unordered_set<ConeId> once;  // as files have it
        for (const auto* side : {&scene->ground_truth->left, &scene->ground_truth->right}) {
            for (const ConeId cone : *side) {
                if (!once.insert(cone).second)
                    throw InvalidInput("ground_truth", "cone id " + std::to_string(cone) + " is there twice");
            }
        }
    }
    return scene;
}

std::optional<std::pair<Indices, Indices>> ground_truth(const AnnotatedScene& scene) {
    if (!scene.ground_truth) return std::nullopt;
    return std::pair(array(indices_of(scene.ground_truth->left, scene.scene.cones, "ground_truth.left")),
                     array(indices_of(scene.ground_truth->right, scene.scene.cones, "ground_truth.right")));
}

constexpr const char* kScene =
    R"(Scene(cones: ArrayLike, pose: ArrayLike, ids: Optional[ArrayLike] = None, colors: Optional[ArrayLike] = None,
      confidences: Optional[ArrayLike] = None, *, id: str = '',
      ground_truth: Optional[Tuple[ArrayLike, ArrayLike]] = None, closed: bool = False, track: str = '',
      covariances: Optional[ArrayLike] = None)

The input of one call of a detector, and the truth for scoring. Every attribute is a copy.

cones, pose, ids, colors, confidences, covariances: As `Detector.detect` takes them.
id: Id of the scene.
ground_truth: The true left and right boundary from the car outward, as indices into `cones`.
closed: Whether the ground truth is a whole circuit.
track: Name of its course.

>>> import conelane
>>> scene = conelane.Scene([[0, 1.5], [0, -1.5], [4, 1.5], [4, -1.5]], (0, 0, 0), ground_truth=([0, 2], [1, 3]), id="start")
>>> scene
<conelane.Scene 'start': 4 cones>
)";

}  // namespace

void add_scenes(py::module_& module) {
    Class<AnnotatedScene, std::shared_ptr<AnnotatedScene>>(module, "Scene", kScene)
        .init(make_scene)
        .get("id", "str: of the scene", &AnnotatedScene::scene, &Scene::id)
        .get("pose", "NDArray[float64]: (3,), x, y [m] and yaw [rad]", &AnnotatedScene::scene, &Scene::pose,
             kArray)
        .cones(&AnnotatedScene::scene, &Scene::cones)
        .get("color_probabilities",
             "NDArray[float64]: (N, 5), probabilities of unknown, blue, yellow, orange, big orange; 1 and 0 "
             "for a label",
             &AnnotatedScene::scene, &Scene::cones, python::color_probabilities)
        .get("confidences", "NDArray[float64]: (N,), of the detections", &AnnotatedScene::scene,
             &Scene::cones, python::confidences)
        .get("covariances",
             "Optional[NDArray[float64]]: (N, 2, 2), of the positions [m^2]; 0 for a cone without one, None "
             "if no cone has one",
             &AnnotatedScene::scene, &Scene::cones, python::covariances)
        .get("ground_truth",
             "Optional[Tuple[NDArray[int64], NDArray[int64]]]: left and right, as indices into `cones`",
             ground_truth)
        .get("closed", "bool: whether the ground truth is a whole circuit",
             [](const AnnotatedScene& s) { return s.ground_truth && s.ground_truth->closed; })
        .get("track", "str: name of the course", &AnnotatedScene::track)
        .get("condition", "str: its name, or empty", &AnnotatedScene::condition)
        .get("false_positive_rate", "Optional[float]: share of false cones among all",
             &AnnotatedScene::false_positive_rate)
        .get("range_m", "Optional[float]: how far the car sees [m]", &AnnotatedScene::range_m)
        .repr([](const AnnotatedScene& s) {
            return py::str("<conelane.Scene '{}': {} cones>").format(s.scene.id, s.scene.cones.size());
        });
}

}  // namespace conelane::python
