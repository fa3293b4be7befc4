#pragma once

#include <string_view>

namespace conelane {

/// The library's version, MAJOR.MINOR.PATCH; what may change between versions is said in CONTRIBUTING.md.
[[nodiscard]] std::string_view version();

}  // namespace conelane
