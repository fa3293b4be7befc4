#pragma once

#include "conelane/drivable_lane.hpp"
#include "conelane/rld_parameters.hpp"
#include "conelane/scene.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

/// Conversions from and to NumPy. An invalid array is an InvalidInput that names the argument; Python gets it
/// as ValueError.
namespace conelane::python {

namespace py = pybind11;

using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Indices = py::array_t<std::int64_t>;

/// Floating-point or whole numbers, as double.
[[nodiscard]] Numbers numbers(py::handle object, const char* key);
[[nodiscard]] double number(py::handle object, const std::string& key);
/// An (N, 2) array; an empty one may have any shape.
[[nodiscard]] std::vector<Point> points(py::handle object, const char* key);
/// (x, y, yaw)
[[nodiscard]] Pose pose(py::handle object);
/// An (N, 2) array and, unless they are None, N ids, colors, confidences and covariances. Without ids a cone
/// has its index.
[[nodiscard]] std::vector<Cone> cones(py::handle positions, py::handle ids, py::handle colors,
                                      py::handle confidences, py::handle covariances);
/// Ids of the cones that an array of indices names.
[[nodiscard]] std::vector<ConeId> ids_at(py::handle indices, std::span<const Cone> cones, const char* key);
[[nodiscard]] std::size_t positive_count(py::handle object, const char* key);
/// None, the name of a parameter set, or a dict of the values that differ from the defaults.
[[nodiscard]] std::optional<RldParameters> rld_parameters(py::handle object);
[[nodiscard]] Pairing pairing_of(std::string_view name);

[[nodiscard]] py::array_t<double> array(std::span<const Point> points);
[[nodiscard]] py::array_t<double> array(const Pose& pose);
[[nodiscard]] Indices array(std::span<const std::int64_t> values);
/// (N, 7): s, x, y, heading, curvature, width to the left and to the right.
[[nodiscard]] py::array_t<double> array(const DrivableLane& lane);
[[nodiscard]] py::array_t<double> positions(std::span<const Cone> cones);
[[nodiscard]] Indices ids(std::span<const Cone> cones);
[[nodiscard]] py::array_t<std::uint8_t> colors(std::span<const Cone> cones);
/// (N, 5): unknown, blue, yellow, orange, big orange.
[[nodiscard]] py::array_t<double> color_probabilities(std::span<const Cone> cones);
[[nodiscard]] py::array_t<double> confidences(std::span<const Cone> cones);
/// (N, 2, 2), 0 for a cone without one; nothing where no cone has one.
[[nodiscard]] std::optional<py::array_t<double>> covariances(std::span<const Cone> cones);
/// Positions of the cones with these ids in the list. Throws InvalidInput naming `key` for an unknown id.
[[nodiscard]] std::vector<std::int64_t> indices_of(std::span<const ConeId> ids, std::span<const Cone> cones,
                                                   std::string_view key);

}  // namespace conelane::python
