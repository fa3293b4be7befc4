#include "experiments/options/argument_words.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace conelane::experiments {
namespace {

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
