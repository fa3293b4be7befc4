#include "graph_search/shared/json_reader.hpp"

#include "conelane/invalid_input.hpp"

#include <algorithm>
#include <charconv>
#include <limits>
#include <locale>
#include <sstream>
#include <system_error>

namespace conelane {
namespace {

/// The double nearest to a number of JSON; infinite if it is out of range.
double double_of(std::string_view number) {
    double value = 0.0;
#if defined(__cpp_lib_to_chars)
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), value);
    if (error == std::errc::result_out_of_range) return std::numeric_limits<double>::infinity();
#else  // libc++ before version 20 has no from_chars for double
    std::istringstream stream{std::string(number)};
    stream.imbue(std::locale::classic());
    if (!(stream >> value)) return std::numeric_limits<double>::infinity();
#endif
    return value;
}

bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

bool is_hex_digit(char c) {
    return is_digit(c) || (c >= 'a' && c <= 'f') || (c >= 'A' && c <= 'F');
}

}  // namespace

void JsonReader::fail(const std::string& reason) const {
    const auto line = 1 + std::ranges::count(text_.substr(0, std::min(at_, text_.size())), '\n');
    throw InvalidInput(std::string(key_), "line " + std::to_string(line) + ": " + reason);
}

void JsonReader::require_end() {
    pass_blanks();
    if (at_ < text_.size()) fail("there is more after the object");
}

std::string JsonReader::string() {
    expect('"');
    const std::size_t begin = at_;
    while (true) {
        const char c = character();
        if (c == '"') return std::string(text_.substr(begin, at_ - 1 - begin));
        if (static_cast<unsigned char>(c) < 0x20) fail("a string holds a control character");
        if (c == '\\') escape();
    }
}

bool JsonReader::is_number() {
    const char c = next();
    return c == '-' || is_digit(c);
}

double JsonReader::number() {
    pass_blanks();
    const std::size_t begin = at_;
    if (peek() == '-') ++at_;
    if (peek() == '0') {
        ++at_;
    } else {
        digits();
    }
    if (peek() == '.') {
        ++at_;
        digits();
    }
    if (peek() == 'e' || peek() == 'E') {
        ++at_;
        if (peek() == '+' || peek() == '-') ++at_;
        digits();
    }
    return double_of(text_.substr(begin, at_ - begin));
}

void JsonReader::skip() {
    const char c = next();
    if (c == '{') {
        object([&](const std::string&) { skip(); });
    } else if (c == '[') {
        array([&] { skip(); });
    } else if (c == '"') {
        (void)string();
    } else if (is_number()) {
        (void)number();
    } else {
        word();
    }
}

void JsonReader::pass_blanks() {
    while (at_ < text_.size() && std::string_view(" \t\r\n").find(text_[at_]) != std::string_view::npos)
        ++at_;
}

char JsonReader::character() {
    if (at_ >= text_.size()) fail("the file ends in the middle");
    return text_[at_++];
}

void JsonReader::expect(char wanted) {
    if (next() == wanted && at_ < text_.size()) {
        ++at_;
        return;
    }
    if (at_ >= text_.size()) fail("the file ends in the middle");
    fail(std::string("expected '") + wanted + "'");
}

void JsonReader::escape() {
    const char c = character();
    if (c == 'u') {
        for (int i = 0; i < 4; ++i) {
            if (!is_hex_digit(character())) fail("\\u needs four hexadecimal digits");
        }
    } else if (std::string_view("\"\\/bfnrt").find(c) == std::string_view::npos) {
        fail("a string holds an unknown escape");
    }
}

void JsonReader::digits() {
    if (!is_digit(peek())) fail("a number is incomplete");
    while (is_digit(peek())) ++at_;
}

void JsonReader::word() {
    for (const std::string_view known : {"true", "false", "null"}) {
        if (!text_.substr(at_).starts_with(known)) continue;
        at_ += known.size();
        return;
    }
    if (at_ >= text_.size()) fail("the file ends in the middle");
    fail("expected a value");
}

}  // namespace conelane
