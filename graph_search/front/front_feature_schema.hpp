#pragma once

#include <array>
#include <cstddef>
#include <string_view>
#include <utility>

namespace conelane {

/// An input of a network. Turns and sides are seen from the boundary that moves, with inward, towards the
/// other boundary, as positive: so a scene and its mirror image are judged alike.
struct FrontFeature {
    std::string_view name;
    std::string_view unit;    ///< of what is measured, before it is scaled to about 1
    std::string_view reason;  ///< what it tells, with what a high value means
};

/// A feature with the function that finds it. A schema is an array of these, and the only place that says in
/// which order the features of a network stand: tables, places and values all come from it.
template <typename Seen>
struct FrontFeatureOf {
    std::string_view name;
    std::string_view unit;
    std::string_view reason;
    float (*value)(const Seen&);  ///< of what was measured
};

template <typename Seen, std::size_t count>
constexpr std::array<FrontFeature, count> table_of(const std::array<FrontFeatureOf<Seen>, count>& schema) {
    std::array<FrontFeature, count> table{};
    for (std::size_t i = 0; i < count; ++i) table[i] = {schema[i].name, schema[i].unit, schema[i].reason};
    return table;
}

/// The place of a feature, found when this is compiled; an error there where none has the name.
template <typename Seen, std::size_t count>
consteval std::size_t place_of(const std::array<FrontFeatureOf<Seen>, count>& schema, std::string_view name) {
    for (std::size_t i = 0; i < count; ++i) {
        if (schema[i].name == name) return i;
    }
    throw "the schema has no feature of this name";
}

/// The values of all features of a schema.
template <const auto& schema, typename Seen>
std::array<float, schema.size()> values_of(const Seen& seen) {
    return [&seen]<std::size_t... place>(std::index_sequence<place...>) {
        return std::array<float, sizeof...(place)>{schema[place].value(seen)...};
    }
    (std::make_index_sequence<schema.size()>());
}

}  // namespace conelane
