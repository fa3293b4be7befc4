#include "conelane/invalid_input.hpp"
#include "conelane/version.hpp"
#include "evaluation/input_error.hpp"
#include "python/bindings/bindings.hpp"

#include <cstring>
#include <exception>
#include <string>

namespace py = pybind11;

namespace {

/// As ValueError. A message may quote a file that is not UTF-8; Python could not decode it.
void set_value_error(const char* message) {
    const py::object text = py::reinterpret_steal<py::object>(
        PyUnicode_DecodeUTF8(message, std::strlen(message), "backslashreplace"));
    if (text) PyErr_SetObject(PyExc_ValueError, text.ptr());
}

}  // namespace

PYBIND11_MODULE(_core, module) {
    py::options options;
    options.disable_function_signatures();
    module.doc() = "The C++ part of the package conelane; use that.";
    module.attr("version") = std::string(conelane::version());
    // NOLINTNEXTLINE(performance-unnecessary-value-param): what pybind11 takes
    py::register_local_exception_translator([](std::exception_ptr thrown) {
        try {
            if (thrown) std::rethrow_exception(thrown);
        } catch (const conelane::InputError& error) {
            set_value_error(error.what());
        } catch (const conelane::InvalidInput& error) {
            set_value_error(error.what());
        }
    });
    conelane::python::add_scenes(module);
    conelane::python::add_lanes(module);
    conelane::python::add_detector(module);
    conelane::python::add_planner(module);
    conelane::python::add_rld(module);
    conelane::python::add_scoring(module);
}
