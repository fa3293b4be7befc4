// Private to readers and writers. A function `fields_of(record, fields)` lists the keys of a record once, for
// reading and writing: `fields(key, value)` for what is always there, `fields.maybe(key, value)` for what is
// left out if it is empty.
#pragma once

#include "conelane/formulation.hpp"
#include "conelane/rld_parameters.hpp"
#include "evaluation/formats/known_keys.hpp"

#include <array>
#include <concepts>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <nlohmann/json.hpp>

namespace conelane {

constexpr std::array<Pairing, 2> choices(Pairing /*of*/) {
    return {Pairing::near_far, Pairing::paper};
}
constexpr std::array<Formulation, 2> choices(Formulation /*of*/) {
    return {Formulation::tight, Formulation::paper};
}

/// A value that is only passed on, as JSON.
struct JsonText {
    std::string text;
    [[nodiscard]] bool empty() const { return text.empty(); }
};

template <typename T>
concept Optional = requires(T value) {
    value.has_value();
};
template <typename T>
concept List = requires(T value) {
    value.emplace_back();
};

/// Writes the fields of a record.
struct JsonFieldWriter {
    nlohmann::ordered_json json = nlohmann::ordered_json::object();

    template <typename T>
    void operator()(std::string_view key, const T& value) {
        json[std::string(key)] = written(value);
    }
    template <typename T>
    void maybe(std::string_view key, const T& value) {
        if constexpr (Optional<T>) {
            if (value) (*this)(key, *value);
        } else {
            if (!value.empty()) (*this)(key, value);
        }
    }
    template <typename T>
    [[nodiscard]] static nlohmann::ordered_json written(const T& value) {
        if constexpr (Optional<T>) {
            return written(*value);
        } else if constexpr (List<T>) {
            nlohmann::ordered_json list = nlohmann::ordered_json::array();
            for (const auto& element : value) list.push_back(written(element));
            return list;
        } else if constexpr (std::is_enum_v<T>) {
            return to_string(value);
        } else if constexpr (std::same_as<T, JsonText>) {
            return nlohmann::ordered_json::parse(value.text);
        } else if constexpr (requires(JsonFieldWriter writer) { fields_of(value, writer); }) {
            JsonFieldWriter writer;
            fields_of(value, writer);
            return writer.json;
        } else {
            return value;
        }
    }
};

/// Reads the fields of a record. Errors are those of JsonNode.
class JsonFieldReader {
  public:
    explicit JsonFieldReader(const JsonNode& json) : json_(json) {}

    template <typename T>
    void operator()(std::string_view key, T& value) {
        keys_.push_back(key);
        read(json_.member(key), value);
    }
    template <typename T>
    void maybe(std::string_view key, T& value) {
        keys_.push_back(key);
        if (const auto found = json_.find(key)) read(*found, value);
    }
    /// Refuses a key that no field has.
    void finish() const { require_known_keys(json_, keys_); }

    template <typename T>
    static void read(const JsonNode& json, T& value) {
        if constexpr (std::same_as<T, bool>) {
            value = json.boolean();
        } else if constexpr (std::integral<T>) {
            value = static_cast<T>(json.unsigned_integer());
        } else if constexpr (std::floating_point<T>) {
            value = json.number();
        } else if constexpr (std::same_as<T, std::string>) {
            value = json.string();
        } else if constexpr (std::same_as<T, JsonText>) {
            json.require_object();  // a JsonNode does not pass it on: the caller reads it
        } else if constexpr (std::is_enum_v<T>) {
            value = json.one_of(choices(T{}));
        } else if constexpr (Optional<T>) {
            read(json, value.emplace());
        } else if constexpr (List<T>) {
            value.clear();
            const std::size_t size = json.array_size();
            for (std::size_t i = 0; i < size; ++i) read(json.element(i), value.emplace_back());
        } else {
            JsonFieldReader reader(json);
            fields_of(value, reader);
            reader.finish();
        }
    }

  private:
    const JsonNode& json_;
    std::vector<std::string_view> keys_;
};

}  // namespace conelane
