// The program `conelane`: one sub-command for each stage from tracks to tables.

#include "evaluation/formats/provenance.hpp"
#include "program/commands/commands.hpp"
#include "solvers/registry.hpp"

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <system_error>

#include <fcntl.h>
#include <fmt/ranges.h>
#include <unistd.h>

namespace {

constexpr int kBadInput = 2;

/// A message becomes one line, whatever a library put into it.
std::string one_line(std::string text) {
    for (char& character : text) {
        if (character == '\n' || character == '\r') character = ' ';
    }
    while (!text.empty() && text.back() == ' ') text.pop_back();
    return text;
}

/// If a standard stream was closed at the start, the next file that is opened would get its number and then
/// the program's messages. So the stream is replaced by one that refuses to be written.
void open_standard_streams() {
    for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
        if (fcntl(descriptor, F_GETFD) >= 0 || errno != EBADF) continue;
        // open returns the lowest free number, which is this one.
        if (open("/dev/null", descriptor == STDIN_FILENO ? O_WRONLY : O_RDONLY) != descriptor) std::abort();
    }
}

/// Why a write to standard output failed, if known: the stream itself does not keep the reason.
int write_error = 0;

/// The exit code, or that of a failure if the output could not be written.
int flushed(int exit_code) {
    errno = 0;
    std::cout.flush();
    const bool failed_before = std::ferror(stdout) != 0 || !std::cout;
    if (std::fflush(stdout) == 0 && !failed_before) return exit_code;
    if (errno == 0) errno = write_error;
    fmt::print(stderr, "conelane: standard output cannot be written to its end{}\n",
               errno == 0 ? "" : ": " + std::generic_category().message(errno));
    return kBadInput;
}

/// An empty value, for example from an unset variable of a script, must not count as a missing option.
void refuse_empty_values(CLI::App& program) {
    const CLI::Validator check([](const std::string& text) { return text.empty() ? "is empty" : ""; }, "");
    for (CLI::Option* option : program.get_options()) {
        // Transformations run before an option's own checks.
        if (option->get_items_expected_max() > 0) option->transform(check);
    }
    for (CLI::App* command : program.get_subcommands({})) refuse_empty_values(*command);
}

std::string version() {
    const conelane::Provenance origin = conelane::provenance();
    std::string solvers;
    for (const conelane::RldSolverEntry& solver : conelane::rld_solvers()) {
        solvers += (solvers.empty() ? "" : ", ") + std::string(solver.name);
    }
    return fmt::format("conelane {}\ncommit {}\ncompiler {}\nsolvers {}", CONELANE_VERSION, origin.commit,
                       origin.compiler, solvers);
}

/// Adds the commands by what they are for, in the order of the help.
void add_commands(CLI::App& program) {
    using namespace conelane::program;
    struct Group {
        const char* name;
        std::vector<void (*)(CLI::App&)> commands;
    };
    const std::vector<Group> groups{
        {"Detect", {add_scenes_command, add_detect_command, add_methods_command, add_plot_command}},
        {"Compare",
         {add_compare_command, add_score_command, add_report_command, add_study_command,
          add_cross_validate_command}},
        {"Solve",
         {add_solve_command, add_check_command, add_certify_command, add_export_command,
          add_instances_command}},
        {"Learn", {add_train_command, add_tune_command}},
        {"Drive", {add_drive_command, add_race_command}}};
    for (const Group& group : groups) {
        for (const auto add : group.commands) {
            add(program);
            program.get_subcommands({}).back()->group(group.name);
        }
    }
}

/// A command that has become a part of another one. Its name still works, and on a terminal it says the new
/// one.
struct OldName {
    std::string_view name;
    std::vector<const char*> words;
};

/// A word that is no longer there, and what serves its purpose.
struct Removed {
    std::string_view command;  ///< empty: any
    std::string_view word;     ///< or a part of a list
    std::string_view instead;
};
constexpr std::array<Removed, 15> kRemoved{{
    {"", "rld-shape-context", "rld-context with --params shape"},
    {"", "astar-lane", "clc"},
    {"", "clc-no-beam", "clc"},
    {"", "clc-longest", "clc"},
    {"", "clc-delaunay", "clc-paper"},
    {"", "delaunay-beam", "clc"},
    {"", "tune-method", "tune, for the parameters of RLD"},
    {"study", "anytime", "study backends --solvers path-pair --sizes all --gap-limits"},
    {"study", "confidence-and-colour", "compare --confidence and --color"},
    {"study", "differential", "study cross-check"},
    {"study", "features", "instances, whose index.csv has the features of each problem"},
    {"study", "noise", "the test that docs/limits.md names"},
    {"study", "--aslib", "--out, whose rows have every run"},
    {"tune", "--folds", "cross-validate, which holds out families of courses"},
    {"tune", "--rounds", "--evaluations, whose search changes the weights too"},
}};

/// Throws CLI::ParseError naming a removed word and what to use instead.
void refuse_removed_words(std::span<const char* const> words) {
    for (const std::string word : words) {
        for (const std::string& part : CLI::detail::split(word, ',')) {
            const auto removed = std::ranges::find_if(kRemoved, [&](const Removed& one) {
                return (one.command.empty() || one.command == words.front()) && part == one.word;
            });
            if (removed == kRemoved.end()) continue;
            throw CLI::ParseError(fmt::format("'{}' is no longer there; use {}", part, removed->instead),
                                  CLI::ExitCodes::ExtrasError);
        }
    }
}

/// The words of the command line, an old name replaced by the new words.
std::vector<const char*> current_words(std::span<char* const> arguments) {
    static const std::vector<OldName> kOldNames{{"sweep", {"compare", "--by-size"}},
                                                {"merge", {"compare", "--merge"}},
                                                {"solvers", {"methods", "--solvers"}},
                                                {"import-solution", {"export"}},
                                                {"cross-check", {"study", "cross-check"}}};
    std::vector<const char*> words(arguments.begin(), arguments.end());
    if (words.size() < 2) return words;
    const auto old = std::ranges::find(kOldNames, std::string_view(words[1]), &OldName::name);
    if (old == kOldNames.end()) return words;
    if (isatty(STDERR_FILENO) != 0)
        fmt::print(stderr, "conelane: {} is now {}\n", old->name, fmt::join(old->words, " "));
    words.erase(words.begin() + 1);
    words.insert(words.begin() + 1, old->words.begin(), old->words.end());
    return words;
}

int run(int argument_count, char** arguments) {
    namespace experiments = conelane::experiments;
    CLI::App program("Finds the lane between cones, exactly and in real time, and compares methods that do.",
                     "conelane");
    program.formatter(std::make_shared<experiments::HelpFormatter>());  // its commands inherit it
    program.set_version_flag("--version", version());
    program.require_subcommand(0, 1);  // a missing command is reported below, after a misspelt one
    add_commands(program);
    refuse_empty_values(program);
    // All options have been read, and no command has begun.
    program.parse_complete_callback([&program] {
        for (CLI::App* command : program.get_subcommands()) experiments::refuse_lost_inputs(*command);
    });
    const std::vector<const char*> words =
        current_words(std::span(arguments, static_cast<std::size_t>(argument_count)));
    try {
        if (words.size() > 1) refuse_removed_words(std::span(words).subspan(1));
        experiments::refuse_misread_words(program, std::span(words).subspan(1));
        program.parse(static_cast<int>(words.size()), words.data());
    } catch (const CLI::Success& help) {
        errno = 0;
        const int exit_code = program.exit(help);
        if (!std::cout || std::ferror(stdout) != 0) write_error = errno;
        return exit_code;
    } catch (const CLI::RuntimeError& failed) {
        return failed.get_exit_code();
    } catch (const CLI::ParseError& bad_option) {
        fmt::print(stderr, "conelane: {}\n", one_line(bad_option.what()));
        return kBadInput;
    } catch (const std::exception& failure) {
        if (std::ferror(stdout) != 0) {  // `flushed` reports it
            const auto* const known = dynamic_cast<const std::system_error*>(&failure);
            if (known != nullptr) write_error = known->code().value();
            return kBadInput;
        }
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
    open_standard_streams();
    conelane::end_cleanly_on_signals();
    return flushed(run(argument_count, arguments));
}
