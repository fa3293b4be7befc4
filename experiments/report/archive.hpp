#pragma once

#include <span>

namespace conelane::experiments {

/// The Python package `report` of this folder as a zip archive that Python can import.
[[nodiscard]] std::span<const unsigned char> report_archive();

}  // namespace conelane::experiments
