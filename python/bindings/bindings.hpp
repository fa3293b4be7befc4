#pragma once

#include "evaluation/formats/lane_file.hpp"
#include "evaluation/world/annotated_scene.hpp"

#include <functional>
#include <type_traits>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

/// The module conelane._core. Each function adds its part. A docstring begins with the Python signature, from
/// which the arguments are read, because pybind11's own one would have C++ types. That of an attribute begins
/// with its type. stubs.py reads both.
namespace conelane::python {

namespace py = pybind11;

// Conversions from and to NumPy. An invalid array is an InvalidInput that names the argument; Python gets it
// as ValueError.

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

/// A scene as Python holds it: immutable, so lanes may refer to it.
using SceneObject = std::shared_ptr<const AnnotatedScene>;

/// An answer and the scene that it is about.
struct LaneObject {
    LaneRecord record;
    std::shared_ptr<const Scene> scene;
};

/// A pointer that Python gave, which is null for None. Throws TypeError, naming the argument.
template <typename Pointer>
const Pointer& required(const Pointer& pointer, const char* key) {
    if (!pointer) throw py::type_error(std::string(key) + ": must not be None");
    return pointer;
}

/// The arguments of a function, by the first paragraph of its docstring, as Python has them behind `def`.
struct Signature {
    struct Argument {
        std::string name;
        py::object value;  ///< by default; none without one
    };

    explicit Signature(std::string_view doc);

    std::string name;
    std::vector<Argument> arguments;
};

template <typename Call>
void add_function(py::module_& module, const char* doc, Call call) {
    const Signature signature(doc);
    module.def(signature.name.c_str(), call, signature, doc);
}

template <typename Value>
Value through(Value value) {
    return value;
}
template <typename Value, typename Step, typename... Rest>
auto through(const Value& value, Step step, Rest... rest) {
    return through(std::invoke(step, value), rest...);
}

/// A class of the module.
template <typename Object, typename... Options>
class Class : public py::class_<Object, Options...> {
  public:
    Class(py::module_& module, const char* name, const char* doc)
        : py::class_<Object, Options...>(module, name, doc), doc_(doc) {}

    template <typename Make>
    Class& init(Make make) {
        this->def(py::init(make), Signature(doc_));
        return *this;
    }
    /// An attribute, which is a copy: what a chain of members and functions, each of the last, makes of the
    /// object.
    template <typename... Steps>
    Class& get(const char* name, const char* doc, Steps... steps) {
        this->def_property_readonly(
            name, [=](const Object& one) { return through(one, steps...); }, doc);
        return *this;
    }
    /// What there is of cones; `steps` lead to them.
    template <typename... Steps>
    Class& cones(Steps... steps) {
        return get("cones", "NDArray[float64]: (N, 2), positions [m]", steps..., positions)
            .get("ids", "NDArray[int64]: (N,), ids of the cones", steps..., ids)
            .get("colors", "NDArray[uint8]: (N,), codes, see `Color`", steps..., colors);
    }
    template <typename Function>
    Class& method(const char* doc, Function function) {
        const Signature signature(doc);
        this->def(signature.name.c_str(), function, signature, doc);
        return *this;
    }
    template <typename Text>
    Class& repr(Text text) {
        this->def("__repr__", text);
        return *this;
    }

  private:
    const char* doc_;
};

/// Last steps of attributes: the name of an enumerator that may be missing, and an array.
inline constexpr auto kName = [](const auto& value) {
    if constexpr (std::is_enum_v<std::decay_t<decltype(value)>>) {
        return to_string(value);
    } else {
        return value ? std::optional(to_string(*value)) : std::nullopt;
    }
};
inline constexpr auto kArray = [](const auto& value) { return array(value); };

[[nodiscard]] inline double limit_of(std::optional<double> time_limit_ms) {
    return time_limit_ms.value_or(std::numeric_limits<double>::infinity());
}

void add_scenes(py::module_& module);
void add_lanes(py::module_& module);
void add_detector(py::module_& module);
void add_rld(py::module_& module);
void add_files(py::module_& module);  ///< not in a build of the core alone

}  // namespace conelane::python

template <>
struct pybind11::detail::process_attribute<conelane::python::Signature>
    : process_attribute_default<conelane::python::Signature> {
    static void init(const conelane::python::Signature& signature, function_record* record) {
        for (const auto& [name, value] : signature.arguments) {
            if (name == "*") {
                process_attribute<kw_only>::init({}, record);
            } else if (value) {
                process_attribute<arg_v>::init(arg_v(name.c_str(), value), record);
            } else {
                process_attribute<arg>::init(arg(name.c_str()), record);
            }
        }
    }
};
