#pragma once

#include "evaluation/world/annotated_scene.hpp"

#include <filesystem>
#include <span>
#include <vector>

namespace conelane::experiments {

/// Round-trip times of an echo program [ms]: it reads the line of a scene and answers at once with status
/// none. The rest of a program's latency is its own. Empty if unknown.
using EchoFloor = std::vector<double>;

inline constexpr const char* kEchoFloorFile = "echo_floor.json";

/// Times `conelane echo` as programs from outside are timed, alone on one processor, on at most 200 scenes,
/// spread over all. Empty if it cannot be started.
[[nodiscard]] EchoFloor measure_echo_floor(std::span<const AnnotatedScene> scenes);

/// Throws InputError. Empty if there is no such file.
[[nodiscard]] EchoFloor read_echo_floor(const std::filesystem::path& file);
void write_echo_floor(const std::filesystem::path& file, const EchoFloor& floor);

}  // namespace conelane::experiments
