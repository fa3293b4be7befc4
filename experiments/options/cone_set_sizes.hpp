#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace conelane::experiments {

/// Sizes of cone sets as an option gives them: a number of cones, or `all` for all visible ones (absent).
/// Throws InvalidInput if a text is neither, or a size is there twice.
[[nodiscard]] std::vector<std::optional<std::size_t>> cone_set_sizes(const std::string& option,
                                                                     std::span<const std::string> texts);

/// At most `limit` of them, evenly spread.
template <typename Value>
[[nodiscard]] std::vector<Value> spread(const std::vector<Value>& all, std::optional<std::size_t> limit) {
    if (!limit || all.size() <= *limit) return all;
    std::vector<Value> some;
    for (std::size_t i = 0; i < *limit; ++i) some.push_back(all[i * all.size() / *limit]);
    return some;
}

}  // namespace conelane::experiments
