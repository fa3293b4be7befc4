#pragma once

#include "evaluation/scenes/annotated_scene.hpp"

#include <filesystem>
#include <span>
#include <vector>

namespace conelane::experiments {

/// Round trips of an echo program [ms]: it reads the line of a scene and answers at once that it found
/// nothing. What a program from outside takes more is its own. Empty where unknown.
using EchoFloor = std::vector<double>;

inline constexpr const char* kEchoFloorFile = "echo_floor.json";

/// Times `conelane echo`, this very program, as programs from outside are timed, alone on one processor, on
/// 200 scenes at most, spread over all. Empty where it cannot be started.
[[nodiscard]] EchoFloor measure_echo_floor(std::span<const AnnotatedScene> scenes);

/// Throws InputError. Empty where there is no such file.
[[nodiscard]] EchoFloor read_echo_floor(const std::filesystem::path& file);
void write_echo_floor(const std::filesystem::path& file, const EchoFloor& floor);

}  // namespace conelane::experiments
