// The program `conelane`: one sub-command for each stage from tracks to tables.

#include "experiments/commands/commands.hpp"
#include "experiments/provenance.hpp"

#include <exception>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace {

constexpr int kBadInput = 2;

/// Messages end up in one line whatever a library put into them.
std::string one_line(std::string text) {
    for (char& character : text) {
        if (character == '\n' || character == '\r') character = ' ';
    }
    while (!text.empty() && text.back() == ' ') text.pop_back();
    return text;
}

/// An unset variable of a script must not pass for an option that was not given.
void refuse_empty_values(CLI::App& program) {
    const CLI::Validator check([](const std::string& text) { return text.empty() ? "is empty" : ""; }, "");
    for (CLI::Option* option : program.get_options()) {
        // Transformations come before an option's own checks.
        if (option->get_items_expected_max() > 0) option->transform(check);
    }
    for (CLI::App* command : program.get_subcommands({})) refuse_empty_values(*command);
}

int run(int argument_count, char** arguments) {
    namespace experiments = conelane::experiments;
    CLI::App program("Finds the lane between cones, exactly and in real time, and compares methods that do.",
                     "conelane");
    program.set_version_flag("--version",
                             "conelane " CONELANE_VERSION ", commit " + experiments::provenance().commit);
    program.require_subcommand(0, 1);  // none is said below, after a misspelt one
    experiments::add_compare_command(program);
    experiments::add_report_command(program);
    experiments::add_sweep_command(program);
    experiments::add_merge_command(program);
    experiments::add_tune_command(program);
    experiments::add_scenes_command(program);
    experiments::add_detect_command(program);
    experiments::add_methods_command(program);
    experiments::add_drive_command(program);
    experiments::add_score_command(program);
    experiments::add_solve_command(program);
    experiments::add_solvers_command(program);
    experiments::add_check_command(program);
    experiments::add_certify_command(program);
    experiments::add_exchange_commands(program);
    experiments::add_study_command(program);
    experiments::add_train_command(program);
    refuse_empty_values(program);
    try {
        program.parse(argument_count, arguments);
    } catch (const CLI::Success& help) {
        return program.exit(help);
    } catch (const CLI::RuntimeError& failed) {
        return failed.get_exit_code();
    } catch (const CLI::ParseError& bad_option) {
        fmt::print(stderr, "conelane: {}\n", one_line(bad_option.what()));
        return kBadInput;
    } catch (const std::exception& failure) {
        fmt::print(stderr, "conelane: {}\n", one_line(failure.what()));
        return kBadInput;
    }
    if (program.get_subcommands().empty()) {
        fmt::print(stderr, "conelane: a subcommand is needed, see `conelane --help`\n");
        return kBadInput;
    }
    return 0;
}

}  // namespace

int main(int argument_count, char** arguments) {
    return run(argument_count, arguments);
}
