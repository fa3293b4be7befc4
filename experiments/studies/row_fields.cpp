#include "experiments/studies/row_fields.hpp"

#include <fmt/format.h>

namespace conelane::experiments {

std::string Shown::cell(const FieldValue& value) const {
    if (!value || value->is_null()) return "-";
    if (value->is_string()) return value->get<std::string>();
    if (as == As::fixed) return conelane::fixed(value->get<double>(), decimals);
    if (as == As::percent) return conelane::percent(value->get<double>(), decimals);
    return value->is_number_float() ? fmt::format("{:g}", value->get<double>()) : value->dump();
}

}  // namespace conelane::experiments
