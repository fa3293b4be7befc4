#pragma once

#include "conelane/invalid_input.hpp"
#include "graph_search/shared/json_reader.hpp"

#include <algorithm>
#include <set>
#include <string>
#include <string_view>

namespace conelane {

/// Sets the parameters that a flat JSON object has, and returns their keys. An element of `fields` has `key`
/// and `value`, a pointer to a member. `read_other(json, key)` reads the value of another key and returns
/// false for an unknown key. Throws InvalidInput naming the key, or the line that is not JSON.
template <typename Parameters, typename Fields, typename ReadOther>
std::set<std::string, std::less<>> read_parameters(std::string_view file, const Fields& fields,
                                                   Parameters& parameters, const ReadOther& read_other) {
    std::set<std::string, std::less<>> seen;
    JsonReader json(file, "parameters");
    json.object([&](const std::string& key) {
        if (!seen.insert(key).second) throw InvalidInput(key, "is there twice");
        const auto field = std::ranges::find_if(fields, [&](const auto& known) { return known.key == key; });
        if (field != std::ranges::end(fields)) {
            parameters.*(field->value) = json.number();
        } else if (!read_other(json, key)) {
            throw InvalidInput(key, "is not a parameter");
        }
    });
    json.require_end();
    return seen;
}

}  // namespace conelane
