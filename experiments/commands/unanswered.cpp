#include "experiments/commands/unanswered.hpp"

#include <cstdio>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace conelane::experiments {

void report_errors(const AnswerErrors& errors) {
    constexpr int kNothingAnswered = 1;
    for (const std::string& line : errors.lines()) fmt::print(stderr, "conelane: {}\n", line);
    if (errors.any_answered_nothing()) throw CLI::RuntimeError(kNothingAnswered);
}

}  // namespace conelane::experiments
