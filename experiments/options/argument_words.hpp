#pragma once

#include <span>

#include <CLI/CLI.hpp>

namespace conelane::experiments {

/// Looks at the words of the command line before they are parsed, for what CLI11 would pass over or give a
/// misleading message: an empty part in a list, such as "," or "0,,0.3", and a name that is not a
/// sub-command. `arguments`: those behind the program's name. Throws CLI::ParseError.
void refuse_misread_words(CLI::App& program, std::span<char* const> arguments);

}  // namespace conelane::experiments
