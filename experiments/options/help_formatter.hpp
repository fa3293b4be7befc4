#pragma once

#include <cstddef>
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

}  // namespace conelane::experiments
