#pragma once

#include "conelane/detectors.hpp"
#include "evaluation/formats/lane_file.hpp"
#include "evaluation/world/annotated_scene.hpp"
#include "python/bindings/arrays.hpp"

#include <chrono>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <pybind11/pybind11.h>

/// The module conelane._core. Each function adds its part. A docstring begins with the Python signature, from
/// which the arguments are read, because pybind11's own one would have C++ types. That of an attribute begins
/// with its type. stubs.py reads both.
namespace conelane::python {

namespace py = pybind11;

/// A scene as Python holds it: immutable, so lanes may refer to it.
using SceneObject = std::shared_ptr<const AnnotatedScene>;

/// An answer and the scene that it is about.
struct LaneObject {
    LaneRecord record;
    std::shared_ptr<const Scene> scene;
};

/// The arguments of a function, by the first line of its docstring: NAME(ARGUMENT, ARGUMENT=DEFAULT, *, ...).
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
        return get("cones", "(N, 2) ndarray of float64: positions [m]", steps..., positions)
            .get("ids", "(N,) ndarray of int64: ids of the cones", steps..., ids)
            .get("colors", "(N,) ndarray of uint8: codes, see `Color`", steps..., colors);
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

/// Calls of one object from several threads wait for each other; the interpreter is free meanwhile. The lock
/// of the interpreter is released first: the owner of the mutex may need it to finish.
template <typename Work>
auto alone(std::mutex& mutex, const Work& work) {
    const py::gil_scoped_release unlocked;
    const std::scoped_lock lock(mutex);
    return work();
}

/// How long the work takes [ms].
template <typename Work>
double timed_ms(const Work& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

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
