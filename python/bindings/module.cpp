#include "conelane/version.hpp"
#include "experiments/files/input_error.hpp"
#include "python/bindings/bindings.hpp"

#include <exception>
#include <string>

namespace py = pybind11;

PYBIND11_MODULE(_core, module) {
    py::options options;
    options.disable_function_signatures();
    module.doc() = "The C++ part of the package conelane; use that.";
    module.attr("version") = std::string(conelane::version());
    // InvalidInput is a std::invalid_argument, which pybind11 turns into ValueError by itself.
    // NOLINTNEXTLINE(performance-unnecessary-value-param): what pybind11 takes
    py::register_local_exception_translator([](std::exception_ptr thrown) {
        try {
            if (thrown) std::rethrow_exception(thrown);
        } catch (const conelane::experiments::InputError& error) {
            PyErr_SetString(PyExc_ValueError, error.what());
        }
    });
    conelane::python::add_scenes(module);
    conelane::python::add_lanes(module);
    conelane::python::add_detector(module);
    conelane::python::add_rld(module);
    conelane::python::add_scoring(module);
}
