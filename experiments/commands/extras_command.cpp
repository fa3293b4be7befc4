#include "experiments/commands/commands.hpp"
#include "experiments/commands/shared_options.hpp"
#include "experiments/tuning/extras.hpp"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

namespace conelane::experiments {
namespace {

struct Options {
    std::string record;
    std::vector<std::string> tracks;
    std::vector<std::string> only;
    std::optional<double> every_m;
    std::optional<std::uint64_t> seed;
    std::string out;
    unsigned threads = 1;
};

void measure(const Options& options) {
    ExtrasOptions extras = read_tuning_record(options.record);
    if (!options.tracks.empty()) extras.tracks = options.tracks;
    extras.only = options.only;
    extras.scenes.every_m = options.every_m.value_or(extras.scenes.every_m);
    extras.scenes.seed = options.seed.value_or(extras.scenes.seed);
    extras.scenes.threads = options.threads;
    extras.evaluation.threads = options.threads;
    const std::vector<ExtrasRow> rows = extras_rows(extras);
    if (!options.out.empty()) write_extras_rows(options.out, rows, extras);
    fmt::print("{}", extras_table(rows));
}

}  // namespace

void add_extras_command(CLI::App& program) {
    CLI::App& command = *program.add_subcommand(
        "extras",
        "what confidences and colours are worth, on the tracks that each fold of a tuning held out");
    auto options = std::make_shared<Options>();
    command.add_option("--record", options->record, "P.record.json of `conelane tune`, with folds")
        ->required();
    command.add_option("--tracks", options->tracks,
                       "the record's tracks where they lie elsewhere; without it as in the record");
    command.add_option("--only", options->only, "names of the tracks that count; all without it");
    command.add_option("--every", options->every_m, "travel between poses instead of the record's [m]");
    add_seed_option(command, options->seed, "base seed instead of the record's");
    add_threads_option(command, options->threads, "nothing is timed");
    add_output_option(command, "--out", options->out,
                      "write the rows as JSON lines too; the page shows DIR/extras.jsonl of its results");
    command.callback([options] { measure(*options); });
}

}  // namespace conelane::experiments
