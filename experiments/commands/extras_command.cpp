#include "experiments/commands/commands.hpp"
#include "experiments/commands/shared_options.hpp"
#include "experiments/tuning/extras.hpp"

#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

namespace conelane::experiments {
namespace {

struct Options {
    std::string record;
    std::vector<std::string> tracks;
    std::string out;
    unsigned threads = 1;
};

void measure(const Options& options) {
    ExtrasOptions extras = read_tuning_record(options.record);
    if (!options.tracks.empty()) extras.tracks = options.tracks;
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
    add_threads_option(command, options->threads, "nothing is timed");
    add_output_option(command, "--out", options->out,
                      "write the rows as JSON lines too; the page shows DIR/extras.jsonl of its results");
    command.callback([options] { measure(*options); });
}

}  // namespace conelane::experiments
