#pragma once

#include <string_view>

namespace conelane {

// The files beside this one, byte by byte, embedded when the library was configured.
extern const std::string_view kLearnedWeightsFile;

/// NAME.json; empty if there is none.
[[nodiscard]] std::string_view parameter_file(std::string_view name);

}  // namespace conelane
