#pragma once

#include "evaluation/scenes/scene_set.hpp"
#include "experiments/comparison/answer_errors.hpp"
#include "experiments/comparison/run_record.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace conelane::experiments {

/// What a comparison has to say beside its files.
struct ComparisonOutcome {
    std::string summary;  ///< for a terminal; the wide table is in table.txt
    AnswerErrors errors;
};

/// The main job. Every detector on the same scenes, scored in the same way, everything on file in the
/// directory:
///   run.json                                 what the run depends on
///   scenes.scenes.jsonl    what the detectors saw
///   scenes.tracks.json     the boundaries they are scored against
///   METHOD.lanes.jsonl     what they answered; METHOD.lanes.jsonl.part until it is whole
///   echo_floor.json                          what an echo program takes, where a program from outside ran
///   scores.jsonl           a line per scene and detector
///   results.jsonl          a line per detector, rate and range, with provenance
///   table.txt              the same as a wide table for reading
///
/// A run that was stopped goes on after its last whole lap. Throws InputError or
/// InvalidInput, so where the directory holds another run (see open_run).
[[nodiscard]] ComparisonOutcome compare(const ComparisonOptions& options,
                                        const std::filesystem::path& directory);

/// Joins the shards of one run into what the whole run would have written, but for the times. Throws
/// InputError where they are not all shards of one run: other commit, compiler or options, one missing, one
/// twice; where the directory is one of them, or holds another run that may not be overwritten.
[[nodiscard]] ComparisonOutcome merge(const std::vector<std::filesystem::path>& shards,
                                      const std::filesystem::path& directory, bool overwrite = false);

/// Scores the lanes in a directory and writes scores.jsonl, results.jsonl and table.txt there.
[[nodiscard]] ComparisonOutcome score_directory(const std::filesystem::path& directory, const SceneSet& set,
                                                const std::vector<std::string>& lanes_files,
                                                const std::string& run_record);

}  // namespace conelane::experiments
