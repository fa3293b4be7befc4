#pragma once

#include "conelane/invalid_input.hpp"
#include "tests/support/testing.hpp"

namespace conelane {

/// The message with which `call` refuses its input; "accepted" if it does not.
template <typename Error = InvalidInput>
std::string refusal(const std::function<void()>& call) {
    try {
        call();
    } catch (const Error& error) {
        return error.what();
    }
    return "accepted";
}

/// The key that `call` names as invalid; "accepted" if it names none.
inline std::string refused_key(const std::function<void()>& call) {
    try {
        call();
    } catch (const InvalidInput& error) {
        return error.key();
    }
    return "accepted";
}

/// `text` with another `part`, which has to be in it.
inline std::string with_other(std::string text, const std::string& part, const std::string& other) {
    const std::size_t at = text.find(part);
    EXPECT_NE(at, std::string::npos) << part;
    return at == std::string::npos ? text : text.replace(at, part.size(), other);
}

}  // namespace conelane
