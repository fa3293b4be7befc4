#include "experiments/cross_check/cross_check.hpp"
#include "program/commands/commands.hpp"

namespace conelane::program {
namespace {

struct CrossCheckCommandOptions {
    CrossCheckOptions cross_check;
    std::string directory;
    std::string replay;
    std::size_t repetitions = 1;
};

/// The number of cases that differ.
std::size_t run(const CrossCheckCommandOptions& options) {
    if (options.replay.empty()) {
        const CrossCheckSummary summary = cross_check(options.cross_check, options.directory);
        fmt::print("{}", to_text(summary));
        const auto differ = summary.outcomes.find(CrossCheckOutcome::differ);
        return differ == summary.outcomes.end() ? 0 : differ->second;
    }
    const CrossCheckVerdict verdict = judge_stored_case(options.replay, options.repetitions);
    for (const std::string& finding : verdict.findings) fmt::print("{}\n", finding);
    fmt::print("{}\n", to_string(verdict.outcome));
    return verdict.findings.empty() ? 0 : 1;
}

}  // namespace

void add_cross_check_command(CLI::App& study) {
    CLI::App& command = *study.add_subcommand(
        "cross-check",
        "compares all exact solvers with each other and with the independent checker, on random scenes and "
        "parameters (also degenerate and extreme ones), under generous and tight time limits. A case on "
        "which they differ is shrunk and written to DIR/NAME.case.json with its scene, parameters and "
        "program; exit code 1 if there is one");
    auto options = std::make_shared<CrossCheckCommandOptions>();
    CrossCheckOptions& drawn = options->cross_check;
    CLI::Option_group& what = *command.add_option_group("what to do");
    what.add_option("--out", options->directory,
                    "directory of cases.jsonl; a run that was stopped there resumes");
    what.add_option("--replay", options->replay, "*.case.json to judge again");
    what.require_option(1);
    command.add_option("--scenes", drawn.scenes, "*.scenes.jsonl: three of ten cases are drawn from it");
    command.add_option("--seed", drawn.seed, "seed of the cases")
        ->check(seed_number())
        ->capture_default_str();
    command.add_option("--first", drawn.first, "number of the first case, to cut a run into parts")
        ->capture_default_str();
    command.add_option("--cases", drawn.cases, "number of cases, with those of a stopped run")
        ->check(whole_number(1, 100'000'000))
        ->capture_default_str();
    command
        .add_option("--solvers", drawn.solvers, "exact solvers; the objectives of the first one are stored")
        ->delimiter(',')
        ->capture_default_str();
    add_time_limit_option(command, drawn.time_limit_ms);
    add_threads_option(command, drawn.threads,
                       "number of threads; with more than one, fewer cases are proven under tight limits");
    command
        .add_option("--repeat", options->repetitions,
                    "largest number of replays; the first difference ends them")
        ->check(whole_number(1, 1'000'000))
        ->capture_default_str();
    command.callback([options] {
        if (run(*options) > 0) throw CLI::RuntimeError(1);
    });
}

}  // namespace conelane::program
