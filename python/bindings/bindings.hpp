#pragma once

#include "conelane/detectors.hpp"
#include "evaluation/formats/lane_file.hpp"
#include "evaluation/world/annotated_scene.hpp"

#include <memory>
#include <string>

#include <pybind11/pybind11.h>

/// The module conelane._core. Each function adds its part. Docstrings begin with the Python signature,
/// because pybind11's own signature would have C++ types.
namespace conelane::python {

namespace py = pybind11;

/// A scene as Python holds it: immutable, so lanes may refer to it.
using SceneObject = std::shared_ptr<const AnnotatedScene>;

/// An answer and the scene that it is about.
struct LaneObject {
    LaneRecord record;
    std::shared_ptr<const Scene> scene;
};

/// The options that Python gives a detector of that name. Throws InvalidInput if the detector does not use an
/// option. make_detector reports an unknown name.
[[nodiscard]] DetectorOptions detector_options(const std::string& name, const py::kwargs& given);

void add_scenes(py::module_& module);
void add_lanes(py::module_& module);
void add_detector(py::module_& module);
void add_planner(py::module_& module);
void add_rld(py::module_& module);
void add_scoring(py::module_& module);

}  // namespace conelane::python
