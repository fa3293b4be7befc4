#pragma once

#include <cstddef>

#include <CLI/CLI.hpp>

namespace conelane::experiments {

/// Largest size of a cone set.
inline constexpr std::size_t kMaxCones = 100'000;

/// Accepts the texts of whole numbers in a range. CLI::Range would report any other text as out of range.
[[nodiscard]] CLI::Validator whole_number(std::size_t least, std::size_t most);

}  // namespace conelane::experiments
