#pragma once

#include <span>
#include <string_view>

namespace conelane::experiments {

/// A file of this folder as the build took it in.
struct ParameterText {
    std::string_view name;  ///< without .json
    std::string_view json;
};
[[nodiscard]] std::span<const ParameterText> parameter_texts();

}  // namespace conelane::experiments
