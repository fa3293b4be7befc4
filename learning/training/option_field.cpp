#include "learning/training/option_field.hpp"

#include "conelane/invalid_input.hpp"

#include <cmath>
#include <type_traits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace conelane::learning {
namespace {

bool is_in(double value, const OptionRange& range) {
    return value <= range.most && (range.is_open ? value > range.least : value >= range.least) &&
           (std::isfinite(value) || (!std::isnan(value) && range.least < 0.0));
}

bool is_valid(const OptionField& field) {
    return std::visit(
        [&](const auto& value) {
            using Value = std::decay_t<decltype(value)>;
            if constexpr (std::is_same_v<Value, std::array<std::size_t, 2>*> ||
                          std::is_same_v<Value, std::array<double, 2>*>) {
                const auto [low, high] = *value;
                return is_in(static_cast<double>(low), field.range) &&
                       is_in(static_cast<double>(high), field.range) && low <= high;
            } else if constexpr (std::is_arithmetic_v<std::remove_pointer_t<Value>>) {
                return is_in(static_cast<double>(*value), field.range);
            }
            return true;
        },
        field.value);
}

std::string reason(const OptionRange& range) {
    if (std::isfinite(range.most))
        return fmt::format("must be in {}{}, {}]", range.is_open ? "(" : "[", range.least, range.most);
    return fmt::format("must be {} {}", range.is_open ? "above" : "at least", range.least);
}

}  // namespace

void require_in_range(const OptionFields& fields) {
    for (const OptionField& field : fields) {
        if (!is_valid(field))
            throw InvalidInput(*field.option != '\0' ? field.option : field.key, reason(field.range));
    }
}

nlohmann::ordered_json record_of(const OptionFields& fields) {
    nlohmann::ordered_json record = nlohmann::ordered_json::object();
    for (const OptionField& field : fields) {
        const std::string key = field.key;
        if (key.empty()) continue;
        const std::size_t dot = key.find('.');
        auto& place =
            dot == std::string::npos ? record[key] : record[key.substr(0, dot)][key.substr(dot + 1)];
        std::visit(
            [&](const auto& value) {
                if constexpr (std::is_same_v<std::decay_t<decltype(value)>, const char*>) {
                    place = value;
                } else {
                    place = *value;
                }
            },
            field.value);
    }
    return record;
}

}  // namespace conelane::learning
