#pragma once

#include <csignal>
#include <cstdlib>
#include <iostream>
#include <string>

#include <unistd.h>

namespace conelane::tests {

/// Ignores the request to end, and waits until it is killed.
[[noreturn]] inline void sleep_on() {
    std::signal(SIGTERM, SIG_IGN);
    for (;;) ::pause();
}

/// Commits a fault that any program from outside may have; returns if `fault` names none of them.
/// `half_a_line`: the beginning of an answer.
inline void commit_process_fault(const std::string& fault, const std::string& half_a_line) {
    if (fault == "crash") {
        std::cerr << "what went wrong\n" << std::flush;
        std::abort();
    }
    if (fault == "exit") std::_Exit(3);
    if (fault == "hang") sleep_on();
    if (fault == "half-a-line") {
        std::cout << half_a_line << std::flush;
        sleep_on();
    }
    if (fault == "endless-line") {
        for (const std::string block(65536, 'x');;) std::cout << block << std::flush;
    }
}

}  // namespace conelane::tests
