#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace conelane {

/// Reads JSON from front to back; the core has no JSON library. Throws InvalidInput naming the line that is
/// not JSON.
class JsonReader {
  public:
    /// `key`: what errors name. Both views must outlive the object.
    JsonReader(std::string_view text, std::string_view key) : text_(text), key_(key) {}

    [[noreturn]] void fail(const std::string& reason) const;

    /// What the next value begins with; 0 at the end.
    [[nodiscard]] char next() {
        pass_blanks();
        return peek();
    }
    void require_end();

    /// Calls `read(key)` at each value of an object.
    template <typename Read>
    void object(const Read& read) {
        list('{', '}', [&] {
            const std::string key = string();
            expect(':');
            read(key);
        });
    }
    /// Calls `read()` at each value of an array.
    template <typename Read>
    void array(const Read& read) {
        list('[', ']', read);
    }

    /// The string with its escapes unchanged: names that are compared have none.
    std::string string();

    [[nodiscard]] bool is_number();
    /// The nearest double; infinite if it is out of range.
    double number();

    /// Passes over any value.
    void skip();
    /// Number of characters read so far.
    [[nodiscard]] std::size_t position() const { return at_; }

  private:
    void pass_blanks();
    [[nodiscard]] char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }
    char character();
    void expect(char wanted);

    template <typename Read>
    void list(char open, char close, const Read& read) {
        constexpr int kMaxDepth = 64;  // of the recursion too
        expect(open);
        if (++depth_ > kMaxDepth) fail("values are nested too deep");
        bool is_first = true;
        while (next() != close || !is_first) {
            read();
            is_first = false;
            if (next() == close) break;
            expect(',');
        }
        ++at_;
        --depth_;
    }

    void escape();
    void digits();
    void word();

    std::string_view text_;
    std::string_view key_;
    std::size_t at_ = 0;
    int depth_ = 0;
};

}  // namespace conelane
