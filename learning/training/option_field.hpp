#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <variant>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace conelane::learning {

/// What a number may be.
struct OptionRange {
    double least = -std::numeric_limits<double>::infinity();
    double most = std::numeric_limits<double>::infinity();
    bool is_open = false;  ///< `least` itself is not allowed
};
inline constexpr OptionRange kAny{};
inline constexpr OptionRange kPositive{.least = 0.0, .is_open = true};
inline constexpr OptionRange kNotNegative{.least = 0.0};
inline constexpr OptionRange kShare{0.0, 1.0};
inline constexpr OptionRange kPositiveShare{0.0, 1.0, true};
inline constexpr OptionRange kCount{1.0, 1e7};
inline constexpr OptionRange kCountOrNone{0.0, 1e7};

/// Where the value is; a `const char*` is a text for the record.
using OptionValue = std::variant<double*, std::size_t*, std::int64_t*, unsigned*, bool*, std::string*,
                                 std::vector<std::string>*, std::vector<double>*, std::array<std::size_t, 2>*,
                                 std::array<double, 2>*, const char*>;

/// One option, said once: for the command line (add_field_options), the check of its range, and the record.
struct OptionField {
    const char* option;  ///< "--draws", or "!--no-warp" for a flag that switches off; empty: none
    const char* key;     ///< in the record, "scenes.per_draw"; empty: not there
    OptionValue value;
    OptionRange range = kAny;  ///< of a number; of two numbers, the first is not above the second
    const char* help = "";
};
using OptionFields = std::vector<OptionField>;

/// Throws InvalidInput naming the first option, or its key if it has none, that is out of its range.
void require_in_range(const OptionFields& fields);

/// The values by their keys, in this order.
[[nodiscard]] nlohmann::ordered_json record_of(const OptionFields& fields);

}  // namespace conelane::learning
