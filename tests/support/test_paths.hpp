#pragma once

#include <filesystem>
#include <string>

namespace conelane {

/// The folder of the sources: weight files, stored instances, and beside it recorded tracks.
[[nodiscard]] std::filesystem::path source_directory();

/// The text of a file of this checkout.
[[nodiscard]] std::string source_text(const std::string& file);

/// The program `conelane`.
[[nodiscard]] std::string conelane_program();

/// A detector from outside that misbehaves when told to: tests/evaluation/outside/outside_child.cpp.
[[nodiscard]] std::string outside_child();

/// A solver from outside that misbehaves when told to: tests/evaluation/outside/solver_child.cpp.
[[nodiscard]] std::string solver_child();

/// The example of a detector from outside that answers a stream of scenes.
[[nodiscard]] std::string clc_stream();

}  // namespace conelane
