#pragma once

#include "conelane/invalid_input.hpp"

#include <span>
#include <string_view>

namespace conelane {

/// One numeric parameter of a detector: how files spell it, where it is, and what it may be.
template <typename Parameters>
struct ParameterField {
    std::string_view key;
    double Parameters::*value;
    std::string_view unit;  ///< "m", "rad", "1" or "1/m"
    double lowest;          ///< valid, as `highest` is
    double highest;
    bool logarithmic;  ///< tuning takes equal steps in ratio; `lowest` is positive
    std::string_view description;
};

/// Throws InvalidInput naming the first parameter that is not a number in its range.
template <typename Parameters>
void require_in_range(const Parameters& parameters, std::span<const ParameterField<Parameters>> fields) {
    for (const ParameterField<Parameters>& field : fields) {
        const double value = parameters.*field.value;
        if (value >= field.lowest && value <= field.highest) continue;
        throw InvalidInput(std::string(field.key), "must be between " + std::to_string(field.lowest) +
                                                       " and " + std::to_string(field.highest));
    }
}

}  // namespace conelane
