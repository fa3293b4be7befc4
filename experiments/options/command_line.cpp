#include "experiments/options/command_line.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <fmt/ranges.h>

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

bool has_empty_part(std::string_view list, char delimiter) {
    const std::string twice(2, delimiter);
    return list.starts_with(delimiter) || list.ends_with(delimiter) ||
           list.find(twice) != std::string_view::npos;
}

void require_whole_list(const CLI::Option* option, std::string_view text) {
    if (option == nullptr || option->get_delimiter() == '\0') return;
    if (has_empty_part(text, option->get_delimiter()))
        throw CLI::ValidationError(option->get_name(),
                                   fmt::format("'{}' is a list with an empty part", text));
}

/// A program from outside behind a list of other things would be taken for one of these, and a value too many
/// would be "not expected", without the reason. With positionals it may be one of them.
void require_own_value(const CLI::Option* option, int values_before, bool with_positionals,
                       const std::string& word) {
    constexpr std::array<std::string_view, 4> kMethods{"--method", "--methods", "--solver", "--solvers"};
    constexpr std::array<std::string_view, 3> kOutside{"exec:", "solver:", "lanes:"};
    if (option == nullptr) return;
    const int most = option->get_items_expected_max();
    const bool is_outside =
        std::ranges::any_of(kOutside, [&](std::string_view kind) { return word.starts_with(kind); });
    const bool is_foreign =
        most > 1 && is_outside && std::ranges::find(kMethods, option->get_name()) == kMethods.end();
    if ((values_before < most || with_positionals) && !is_foreign) return;
    throw CLI::ValidationError(
        option->get_name(),
        fmt::format("does not take '{}'; write the values of an option directly behind its name", word));
}

/// The sub-command of that name; null if there is none.
CLI::App* find_command(CLI::App& app, const std::string& name) {
    for (CLI::App* command : app.get_subcommands({})) {
        if (!command->get_name().empty() && command->check_name(name)) return command;
    }
    return nullptr;
}

bool takes_positionals(const CLI::App& app) {
    return std::ranges::any_of(app.get_options({}),
                               [](const CLI::Option* option) { return option->get_positional(); });
}

[[noreturn]] void refuse_name(CLI::App& app, const std::string& name) {
    std::vector<std::string> known;
    for (const CLI::App* command : app.get_subcommands({})) known.push_back(command->get_name());
    // The program's own name begins every message.
    const std::string of = app.get_parent() == nullptr ? "" : app.get_name() + ": ";
    throw CLI::ParseError(fmt::format("{}there is no '{}', it has {}", of, name, fmt::join(known, ", ")),
                          CLI::ExitCodes::ExtrasError);
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

void refuse_misread_words(CLI::App& program, std::span<const char* const> arguments) {
    CLI::App* app = &program;
    const CLI::Option* option = nullptr;  // the option that was named last
    int values = 0;                       // number of its values so far
    bool names_a_command = true;          // whether the next word, directly behind a command, names a command
    for (const std::string word : arguments) {
        if (word.starts_with("-") && word.size() > 1) {
            const std::size_t equals = word.find('=');
            option = app->get_option_no_throw(word.substr(0, equals));
            values = equals != std::string::npos ? 1 : 0;
            if (values == 1) require_whole_list(option, word.substr(equals + 1));
            names_a_command = false;
            continue;
        }
        if (CLI::App* const command = find_command(*app, word)) {
            app = command;
            option = nullptr;
            names_a_command = true;
            continue;
        }
        const bool with_positionals = takes_positionals(*app);
        if (names_a_command && !app->get_subcommands({}).empty() && !with_positionals)
            refuse_name(*app, word);
        require_own_value(option, values++, with_positionals, word);
        names_a_command = false;
        require_whole_list(option, word);
    }
}

}  // namespace conelane::experiments
