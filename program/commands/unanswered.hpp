#pragma once

#include "experiments/comparison/answer_errors.hpp"

namespace conelane::experiments {

/// The end of every command that answers scenes: a line on stderr for each detector with errors among its
/// answers. Throws CLI::RuntimeError of exit code 1 if a detector answered nothing at all. What the
/// command writes is in place by then.
void report_errors(const AnswerErrors& errors);

}  // namespace conelane::experiments
