// Private to readers and writers: the only header that includes all of nlohmann-json.
#pragma once

#include "conelane/invalid_input.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

namespace conelane {

struct JsonOrigin {
    std::filesystem::path file;
    std::size_t line = 0;  ///< 0 if a value has no line
};

/// A JSON value and the path to it, so that every error names file, line and key. Refers to the value and its
/// origin, which must outlive it. All readers throw InputError if the value has another type.
class JsonNode {
  public:
    JsonNode(const nlohmann::json& value, const JsonOrigin& origin, std::string key = {})
        : value_(&value), origin_(&origin), key_(std::move(key)) {}

    [[nodiscard]] JsonNode member(std::string_view key) const;
    [[nodiscard]] std::optional<JsonNode> find(std::string_view key) const;
    [[nodiscard]] std::size_t array_size() const;
    [[nodiscard]] JsonNode element(std::size_t index) const;  ///< precondition: index < array_size()

    [[nodiscard]] double number() const;
    [[nodiscard]] double number_in(double lowest, double highest) const;
    [[nodiscard]] double non_negative_number() const;
    [[nodiscard]] std::int64_t integer() const;
    [[nodiscard]] std::uint64_t unsigned_integer() const;
    [[nodiscard]] std::int64_t non_negative_integer() const;
    [[nodiscard]] bool boolean() const;
    [[nodiscard]] const std::string& string() const;
    /// Index of the name that the JSON spells.
    [[nodiscard]] std::size_t index_in(std::span<const std::string_view> names) const;
    /// The value of `choices` that `to_string`, found by argument-dependent look-up, spells like the JSON.
    template <typename Choice, std::size_t count>
    [[nodiscard]] Choice one_of(const std::array<Choice, count>& choices) const;
    void require_object() const;
    [[nodiscard]] std::vector<std::string> keys() const;
    /// Turns an InvalidInput from `check` into the InputError of this file and line.
    void require_valid(const std::function<void()>& check) const;

    [[nodiscard]] std::size_t line() const { return origin_->line; }
    [[noreturn]] void fail(const std::string& reason) const;
    /// The same about a member, which may be absent.
    [[noreturn]] void fail_in(std::string_view key, const std::string& reason) const;

  private:
    [[nodiscard]] std::string member_key(std::string_view key) const;
    const nlohmann::json* value_;
    const JsonOrigin* origin_;
    std::string key_;  ///< such as "cones[3].x"; empty at the root
};

template <typename Choice, std::size_t count>
Choice JsonNode::one_of(const std::array<Choice, count>& choices) const {
    std::array<std::string_view, count> names;
    for (std::size_t i = 0; i < count; ++i) names[i] = to_string(choices[i]);
    return choices[index_in(names)];
}

/// The known name that a misspelt one most likely means: at most two letters wrong, missing, too many or in
/// the wrong case. Empty if there is none.
[[nodiscard]] std::string_view closest_name(std::string_view misspelt,
                                            std::span<const std::string_view> names);

/// Throws InputError if the object has a key that is not in `keys`. The error names the first such key and
/// the most similar known one.
void require_known_keys(const JsonNode& object, std::span<const std::string_view> keys);

/// Calls `read` with the object of each line that is not blank, in order. Throws InputError if the file
/// cannot be read or a line is not a JSON object.
void for_each_json_line(const std::filesystem::path& file, const std::function<void(const JsonNode&)>& read);

/// The same for one line that was read before, with its number. Errors name `file`.
void with_json_line(std::string_view text, const std::filesystem::path& file, std::size_t line,
                    const std::function<void(const JsonNode&)>& read);

/// Calls `read` with the object that a whole file holds. Throws like for_each_json_line.
void with_json_file(const std::filesystem::path& file, const std::function<void(const JsonNode&)>& read);

/// The same for a file that holds a list.
void with_json_list_file(const std::filesystem::path& file, const std::function<void(const JsonNode&)>& read);

/// The same for a text in place of the file.
void with_json_text(std::string_view text, const std::filesystem::path& file,
                    const std::function<void(const JsonNode&)>& read);

/// Whether a line is blank; blank lines are skipped.
[[nodiscard]] bool is_blank(std::string_view line);

/// JSON on one line, keys in their order; bytes that are not UTF-8 are replaced.
[[nodiscard]] std::string to_line(const nlohmann::ordered_json& json);

/// The reason of an InvalidInput, without its key.
[[nodiscard]] std::string reason_of(const InvalidInput& error);

/// The value itself. Throws InvalidInput naming `key` if it is not finite: JSON has no such number.
[[nodiscard]] double require_finite(double value, const std::string& key);

/// Sets `json["bound"]` to a proven lower bound, or leaves it out if that is minus infinity. For any other
/// number that is not finite it throws InvalidInput naming `key`.
void put_bound(nlohmann::ordered_json& json, double bound, const std::string& key);

}  // namespace conelane
