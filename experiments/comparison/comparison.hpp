#pragma once

#include "evaluation/formats/scene_set.hpp"
#include "experiments/comparison/answer_errors.hpp"
#include "experiments/comparison/run_record.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace conelane::experiments {

/// The output of a comparison apart from its files.
struct ComparisonOutcome {
    std::string summary;  ///< for a terminal; the wide table is in table.txt
    AnswerErrors errors;
};

/// Runs every detector on the same scenes, scores all in the same way, and writes everything to files in the
/// directory:
///   run.json               what the run depends on
///   scenes.scenes.jsonl    what the detectors saw
///   scenes.tracks.json     the boundaries that they are compared with
///   METHOD.lanes.jsonl     their answers; METHOD.lanes.jsonl.part until it is complete
///   scores.jsonl           a line per scene and detector
///   results.jsonl          a line per detector, rate and range, with provenance
///   table.txt              the same as a wide table for reading
///
/// A run that was stopped resumes after its last complete lap. Throws InputError or InvalidInput, also if the
/// directory holds another run (see open_run).
[[nodiscard]] ComparisonOutcome compare(const ComparisonOptions& options,
                                        const std::filesystem::path& directory);

/// Joins the shards of one run. The result is what the whole run would have written, except for times. Throws
/// InputError unless they are all shards of one run, each once, with equal commit, compiler and options; and
/// if the directory is one of them, or holds another run that may not be overwritten.
[[nodiscard]] ComparisonOutcome merge(const std::vector<std::filesystem::path>& shards,
                                      const std::filesystem::path& directory, bool overwrite = false);

/// Scores the lanes in the directory of a run and writes scores.jsonl, results.jsonl and table.txt there.
[[nodiscard]] ComparisonOutcome score_directory(const std::filesystem::path& directory, const SceneSet& set,
                                                const RunRecord& record);

}  // namespace conelane::experiments
