#pragma once

#include "evaluation/formats/provenance.hpp"
#include "experiments/comparison/runner.hpp"

namespace conelane::experiments {

/// Everything that the answers of a comparison depend on, and whether they may replace others.
struct ComparisonOptions {
    std::vector<std::string> tracks;  ///< SPECs of load_tracks
    std::vector<Method> methods;
    SceneOptions scenes;
    RunOptions run;
    Shard shard;
    bool overwrite = false;  ///< whether results of another run in the directory are replaced
    /// Preparation of the methods, called once the directory is locked and ready.
    std::function<void()> prepare = {};
    std::string cross_validation = {};  ///< JSON object: what the folds depend on; empty without folds
};

/// What the record of a run says of a method.
struct MethodRecord {
    std::string name;
    // The source of a method from outside, by its kind: the command, or the file. Empty for other kinds.
    std::string exec = {};
    std::string lanes = {};
    std::string solver = {};
    std::optional<Formulation> formulation = {};  ///< of a solver from outside, if its text names one
    std::optional<DetectorCard> card = {};
    std::string hash = {};  ///< of the file `lanes`
    std::optional<std::size_t> nearest = {};
    struct Rld {
        RldParameters parameters;
        std::string learned_costs;  ///< their hash
    };
    std::optional<Rld> rld_parameters = {};
    /// Not on the disk: the courses that it has learned from, none if they were held out.
    std::set<std::string> training_courses = {};

    /// "exec", "lanes" or "solver"; empty for a method of this program.
    [[nodiscard]] std::string outside() const;
    /// NAME.lanes.jsonl or NAME.n012.lanes.jsonl
    [[nodiscard]] std::string lanes_file() const;
};

/// The method as the record of a run has it. Throws InputError if its lanes file cannot be read.
[[nodiscard]] MethodRecord record_of(const Method& method, const DetectorOptions& options = {},
                                     bool is_cross_validated = false);

/// What the results of a run depend on, as in run.json.
struct RunRecord {
    Provenance origin;
    std::vector<std::string> tracks;
    std::vector<MethodRecord> methods;
    SceneOptions scenes;
    unsigned threads = 1;
    bool candidates = false;
    std::string cross_validation = {};  ///< as in ComparisonOptions
    std::string program = {};  ///< a hash of it, if the commit does not identify it: changed sources, or none
    std::optional<double> time_limit_ms = {};
    Shard shard = {};

    /// A JSON object in one line.
    [[nodiscard]] std::string text() const;
    /// The keys of run.json in which two records differ.
    [[nodiscard]] std::vector<std::string> differences(const RunRecord& other) const;
};

/// Throws InputError if a lanes file cannot be read.
[[nodiscard]] RunRecord record_of(const ComparisonOptions& options);

/// The content of run.json of a directory. Throws InputError.
[[nodiscard]] RunRecord read_run_record(const std::filesystem::path& directory);

/// Prepares the directory for a run and locks it. If its run.json holds the same record, existing
/// answers stay. If it holds results of another run, these are removed with `overwrite`; otherwise
/// nothing is changed and InputError is thrown. Throws InputError also if another process is writing
/// there.
[[nodiscard]] FolderLock open_run(const std::filesystem::path& directory, const RunRecord& record,
                                  bool overwrite);

}  // namespace conelane::experiments
