#pragma once

#include <concepts>
#include <optional>
#include <string>
#include <string_view>

namespace conelane::playground {

/// JSON, written from front to back. Numbers have as many digits as needed to read back the same number; a
/// number that is not finite is null.
class JsonText {
  public:
    [[nodiscard]] const std::string& text() const { return text_; }
    void clear() { text_.clear(); }

    JsonText& begin(char bracket);  ///< [ or {
    JsonText& end(char bracket);    ///< ] or }
    JsonText& key(std::string_view key);
    JsonText& value(std::string_view text);
    JsonText& value(const char* text) { return value(std::string_view(text)); }
    JsonText& value(double number);
    JsonText& value(std::integral auto number) {
        if constexpr (std::same_as<decltype(number), bool>) {
            return literal(number ? "true" : "false");
        } else {
            return literal(std::to_string(number));
        }
    }

    /// A key and its value.
    template <class Value>
    JsonText& member(std::string_view name, const Value& given) {
        return key(name).value(given);
    }
    /// Nothing if the value is absent.
    template <class Value>
    JsonText& member(std::string_view name, const std::optional<Value>& given) {
        return given ? member(name, *given) : *this;
    }
    /// A key and a list of values.
    template <class List>
    JsonText& list(std::string_view name, const List& values) {
        key(name).begin('[');
        for (const auto& one : values) value(one);
        return end(']');
    }

  private:
    JsonText& literal(std::string_view text);
    void separate();

    std::string text_;
};

}  // namespace conelane::playground
