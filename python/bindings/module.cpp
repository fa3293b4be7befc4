#include "conelane/detectors.hpp"
#include "conelane/invalid_input.hpp"
#include "evaluation/input_error.hpp"
#include "python/bindings/bindings.hpp"

#include <cstring>
#include <exception>
#include <utility>

#include <pybind11/eval.h>

namespace conelane::python {

Signature::Signature(std::string_view doc) : name(doc.substr(0, doc.find('('))) {
    const std::string signature(doc.substr(0, doc.find("\n\n")));
    py::dict names;
    py::exec("from __future__ import annotations\ndef " + signature + ": pass", names);  // types stay text
    const py::module_ inspect = py::module_::import("inspect");
    const py::object empty = inspect.attr("Parameter").attr("empty");
    const py::object parameters = inspect.attr("signature")(names[name.c_str()]).attr("parameters");
    bool has_keywords_alone = false;
    for (const py::handle parameter : parameters.attr("values")()) {
        const std::string kind = py::str(parameter.attr("kind").attr("name"));
        if (kind == "VAR_KEYWORD") break;
        if (kind == "KEYWORD_ONLY" && !std::exchange(has_keywords_alone, true))
            arguments.push_back({"*", {}});
        const py::object value = parameter.attr("default");
        arguments.push_back({py::str(parameter.attr("name")), value.is(empty) ? py::object() : value});
    }
}

}  // namespace conelane::python

namespace py = pybind11;

namespace {

/// As ValueError. A message may quote a file that is not UTF-8; Python could not decode it.
void set_value_error(const char* message) {
    const auto text = py::reinterpret_steal<py::object>(
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
    conelane::python::add_rld(module);
#ifdef CONELANE_PYTHON_FILES
    conelane::python::add_files(module);
#endif
}
