#include "evaluation/formats/known_keys.hpp"

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace conelane {
namespace {

constexpr std::size_t kMaxDistance = 2;

/// Levenshtein distance without case: the number of letters to change, insert or leave out.
std::size_t distance(std::string_view a, std::string_view b) {
    const auto lower = [](char c) { return std::tolower(static_cast<unsigned char>(c)); };
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 0; i < a.size(); ++i) {
        std::size_t diagonal = std::exchange(row[0], i + 1);
        for (std::size_t j = 0; j < b.size(); ++j) {
            const std::size_t changed = diagonal + (lower(a[i]) == lower(b[j]) ? 0 : 1);
            diagonal = row[j + 1];
            row[j + 1] = std::min({changed, diagonal + 1, row[j] + 1});
        }
    }
    return row.back();
}

}  // namespace

std::string_view closest_name(std::string_view misspelt, std::span<const std::string_view> names) {
    std::string_view closest;
    // A short name has no similar one: every other short name is two letters away.
    std::size_t least = std::min(kMaxDistance, misspelt.size() / 2) + 1;
    for (const std::string_view name : names) {
        if (misspelt.size() > name.size() + kMaxDistance) continue;
        const std::size_t letters = distance(misspelt, name);
        if (letters >= least) continue;
        least = letters;
        closest = name;
    }
    return closest;
}

void require_known_keys(const JsonNode& object, std::span<const std::string_view> keys) {
    for (const std::string& key : object.keys()) {
        if (std::ranges::find(keys, key) != keys.end()) continue;
        const std::string_view meant = closest_name(key, keys);
        object.member(key).fail(meant.empty()
                                    ? fmt::format("is not a key here, only {}", fmt::join(keys, ", "))
                                    : fmt::format("is not a key here; {} is", meant));
    }
}

}  // namespace conelane
