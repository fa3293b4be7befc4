#include "experiments/options/help_formatter.hpp"

#include <algorithm>

namespace conelane::experiments {
namespace {

constexpr std::size_t kIndent = 2;        ///< indentation of a name
constexpr std::size_t kMoreIndent = 6;    ///< indentation of the second line of a name
constexpr std::size_t kDescription = 30;  ///< the column where descriptions begin, as CLI11 has it

/// Place of the break in a line without a space.
std::size_t break_within(std::string_view text, std::size_t width) {
    const std::size_t mark = text.substr(0, width).find_last_of(",|/");
    return mark == std::string_view::npos || mark == 0 ? width : mark + 1;
}

void wrap_line(std::string_view text, std::size_t width, std::vector<std::string>& lines) {
    while (text.size() > width) {
        std::size_t end = text.substr(0, width + 1).find_last_of(' ');
        const bool at_space = end != std::string_view::npos && end > 0;
        if (!at_space) end = break_within(text, width);
        lines.emplace_back(text.substr(0, end));
        text.remove_prefix(at_space ? end + 1 : end);
    }
    lines.emplace_back(text);
}

/// A name on the left and its description on the right, or below a long name.
std::string entry(const std::string& name, const std::string& description) {
    std::string text;
    std::size_t at = 0;  // position in the last line
    std::vector<std::string> names = wrapped(name, kHelpColumns - kIndent);
    if (names.size() > 1) {
        names = wrapped(name, kHelpColumns - kMoreIndent);
    }
    for (std::size_t i = 0; i < names.size(); ++i) {
        const std::size_t indent = i == 0 ? kIndent : kMoreIndent;
        text += (i == 0 ? "" : "\n") + std::string(indent, ' ') + names[i];
        at = indent + names[i].size();
    }
    if (description.empty()) return text + '\n';
    bool is_first = true;
    for (const std::string& line : wrapped(description, kHelpColumns - kDescription)) {
        const bool continues = is_first && at < kDescription;
        text += continues ? std::string(kDescription - at, ' ') : '\n' + std::string(kDescription, ' ');
        text += line;
        is_first = false;
    }
    return text + '\n';
}

std::string in_lines(const std::string& text) {
    std::string all;
    for (const std::string& line : wrapped(text, kHelpColumns)) all += line + '\n';
    if (all.ends_with("\n\n") && text.ends_with('\n')) all.pop_back();
    return text.empty() ? "" : all;
}

}  // namespace

std::vector<std::string> wrapped(std::string_view text, std::size_t width) {
    std::vector<std::string> lines;
    for (std::size_t begin = 0;;) {
        const std::size_t end = std::min(text.find('\n', begin), text.size());  // npos is larger
        wrap_line(text.substr(begin, end - begin), width, lines);
        if (end == text.size()) return lines;
        begin = end + 1;
    }
}

std::string HelpFormatter::make_option(const CLI::Option* option, bool is_positional) const {
    return entry(make_option_name(option, is_positional) + make_option_opts(option),
                 make_option_desc(option));
}

std::string HelpFormatter::make_subcommand(const CLI::App* command) const {
    const std::string& description = command->get_description();
    const std::size_t end = std::min(description.find(". "), description.find('\n'));
    return entry(command->get_display_name(true), description.substr(0, end));
}

std::string HelpFormatter::make_description(const CLI::App* command) const {
    return in_lines(Formatter::make_description(command));
}

std::string HelpFormatter::make_usage(const CLI::App* command, std::string name) const {
    return in_lines(Formatter::make_usage(command, std::move(name)));
}

std::string HelpFormatter::make_expanded(const CLI::App* command) const {
    std::string text;
    for (std::string line : wrapped(Formatter::make_expanded(command), kHelpColumns)) {
        line.erase(line.find_last_not_of(' ') + 1);
        if (!line.empty()) text += line + '\n';  // CLI11 indents empty lines
    }
    return text;
}

std::string HelpFormatter::make_footer(const CLI::App* command) const {
    return in_lines(Formatter::make_footer(command));
}

}  // namespace conelane::experiments
