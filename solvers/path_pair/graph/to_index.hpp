#pragma once

#include <cstddef>

namespace conelane::path_pair {

/// A number of an arc, an edge, a cone or a frontier, as containers take it.
[[nodiscard]] constexpr std::size_t to_index(int number) {
    return static_cast<std::size_t>(number);
}

}  // namespace conelane::path_pair
