#pragma once

#include <string_view>

namespace conelane {

/// The library's version, MAJOR.MINOR.PATCH; docs/promises.md says which interfaces stay.
[[nodiscard]] std::string_view version();

}  // namespace conelane
