#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>

namespace conelane::experiments {

/// Columns of every line of help.
inline constexpr std::size_t kHelpColumns = 100;

/// The text in lines of at most `width` characters, broken at spaces; a longer word is broken after a comma,
/// bar or slash, else at the end of the line. A newline in the text stays. Returns at least one line.
/// Precondition: `width` > 0.
[[nodiscard]] std::vector<std::string> wrapped(std::string_view text, std::size_t width);

/// CLI11's help with lines of at most kHelpColumns columns. A list of commands has the first sentence of each
/// description.
class HelpFormatter : public CLI::Formatter {
  public:
    std::string make_option(const CLI::Option* option, bool is_positional) const override;
    std::string make_subcommand(const CLI::App* command) const override;
    std::string make_description(const CLI::App* command) const override;
    std::string make_usage(const CLI::App* command, std::string name) const override;
    std::string make_expanded(const CLI::App* command) const override;
    std::string make_footer(const CLI::App* command) const override;
};

/// Checks the words of the command line before they are parsed, for errors that CLI11 would ignore or report
/// in a misleading way: an empty part in a list, such as "," or "0,,0.3", a name that is not a sub-command,
/// and a value behind an option that does not take it. `arguments`: those after the program's name. Throws
/// CLI::ParseError.
void refuse_misread_words(CLI::App& program, std::span<const char* const> arguments);

}  // namespace conelane::experiments
