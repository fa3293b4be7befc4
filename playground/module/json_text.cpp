#include "playground/module/json_text.hpp"

#include <array>
#include <charconv>
#include <cmath>

namespace conelane::playground {

void JsonText::separate() {
    if (text_.empty()) return;
    const char last = text_.back();
    if (last != '[' && last != '{' && last != ':') text_ += ',';
}

JsonText& JsonText::literal(std::string_view text) {
    separate();
    text_ += text;
    return *this;
}

JsonText& JsonText::begin(char bracket) {
    separate();
    text_ += bracket;
    return *this;
}

JsonText& JsonText::end(char bracket) {
    text_ += bracket;
    return *this;
}

JsonText& JsonText::key(std::string_view key) {
    value(key);
    text_ += ':';
    return *this;
}

JsonText& JsonText::value(std::string_view text) {
    separate();
    text_ += '"';
    for (const char c : text) {
        if (c == '"' || c == '\\') {
            text_ += '\\';
            text_ += c;
        } else if (static_cast<unsigned char>(c) < 0x20) {
            constexpr std::string_view kDigits = "0123456789abcdef";
            text_ += "\\u00";
            text_ += kDigits[static_cast<unsigned char>(c) >> 4U];
            text_ += kDigits[static_cast<unsigned char>(c) & 15U];
        } else {
            text_ += c;
        }
    }
    text_ += '"';
    return *this;
}

JsonText& JsonText::value(double number) {
    if (!std::isfinite(number)) return literal("null");
    std::array<char, 40> digits{};
    const auto written = std::to_chars(digits.data(), digits.data() + digits.size(), number);
    return literal({digits.data(), written.ptr});
}

}  // namespace conelane::playground
