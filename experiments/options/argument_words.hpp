#pragma once

#include <span>

#include <CLI/CLI.hpp>

namespace conelane::experiments {

/// Checks the words of the command line before they are parsed, for errors that CLI11 would ignore or report
/// in a misleading way: an empty part in a list, such as "," or "0,,0.3", a name that is not a sub-command,
/// and a value behind an option that does not take it. `arguments`: those after the program's name. Throws
/// CLI::ParseError.
void refuse_misread_words(CLI::App& program, std::span<const char* const> arguments);

}  // namespace conelane::experiments
