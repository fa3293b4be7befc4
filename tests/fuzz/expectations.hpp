#pragma once

#include "conelane/invalid_input.hpp"
#include "evaluation/input_error.hpp"

#include <cstdlib>
#include <iostream>
#include <string_view>

namespace conelane::fuzz {

/// Ends the program; the fuzzer counts this as a crash and keeps the input.
inline void require(bool holds, std::string_view what) {
    if (holds) return;
    std::cerr << "broken promise: " << what << '\n';
    std::abort();
}

/// Calls a reader, which may return or reject; any other exception ends the program. True if it returned.
template <typename Read>
bool answers(const Read& read) {
    std::string message;
    try {
        read();
        return true;
    } catch (const InputError& error) {
        message = error.what();
    } catch (const InvalidInput& error) {
        message = error.what();
    }
    require(!message.empty(), "who refuses says why");
    return false;
}

}  // namespace conelane::fuzz
