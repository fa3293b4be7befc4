#pragma once

#include "conelane/planner.hpp"

#include <cstddef>
#include <string>

namespace conelane {

/// A plan as a line of JSON, without newline: `frame` is its line number in the input.
[[nodiscard]] std::string plan_line(std::size_t frame, double time_s, const Plan& plan);

/// The line for a frame that was refused.
[[nodiscard]] std::string refused_frame_line(std::size_t frame, const std::string& message);

}  // namespace conelane
