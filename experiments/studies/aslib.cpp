#include "experiments/studies/aslib.hpp"

#include "conelane/invalid_input.hpp"
#include "evaluation/input_error.hpp"
#include "experiments/instances/files_together.hpp"
#include "experiments/instances/instance_features.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace conelane::experiments {
namespace {

constexpr double kMsPerS = 1000.0;

using SizeAndScene = std::pair<std::size_t, const AnnotatedScene*>;

std::string instance_name(const SizeAndScene& instance) {
    return fmt::format("'{} n={}'", instance.second->scene.id, size_name(instance.first));
}

/// ARFF requires quotes around names with blanks and slashes.
std::string quoted(const std::string& name) {
    return "'" + name + "'";
}

std::string_view run_status(const SolveRow& row, double limit_ms) {
    if (row.refuted) return "other";  // a wrong answer
    switch (row.status) {
        case SolveStatus::optimal:
        case SolveStatus::infeasible:
            return row.latency_ms <= limit_ms ? "ok" : "timeout";
        case SolveStatus::feasible:
        case SolveStatus::stopped:
            return row.stopped_by == StopReason::memory ? "memout" : "timeout";
        case SolveStatus::error:
            break;
    }
    return "crash";
}

std::string number(double value) {
    return std::isfinite(value) ? fmt::format("{:.9g}", value) : "?";
}

std::string description(std::span<const std::string> algorithms, const SolveOptions& options) {
    std::vector<std::string> problem, relaxation;
    for (const NamedFeature& feature : named({})) {
        auto& group = problem.size() < kProblemFeatures ? problem : relaxation;
        group.emplace_back(feature.name);
    }
    std::string text = fmt::format(
        "scenario_id: CONELANE-RLD\nperformance_measures: [runtime]\nmaximize: [false]\nperformance_type: "
        "[runtime]\n"
        "algorithm_cutoff_time: {:g}\nalgorithm_cutoff_memory: '?'\nfeatures_cutoff_time: '?'\n"
        "features_cutoff_memory: '?'\nnumber_of_feature_steps: 2\ndefault_steps: [problem, relaxation]\n"
        "feature_steps:\n  problem:\n    provides: [{}]\n  relaxation:\n    requires: [problem]\n    "
        "provides: [{}]\n"
        "features_deterministic: [{}]\nfeatures_stochastic: []\nmetainfo_algorithms:\n",
        options.time_limit_ms / kMsPerS, fmt::join(problem, ", "), fmt::join(relaxation, ", "),
        fmt::format("{}, {}", fmt::join(problem, ", "), fmt::join(relaxation, ", ")));
    for (const std::string& algorithm : algorithms)
        text += fmt::format("  {}:\n    deterministic: true\n", quoted(algorithm));
    return text;
}

/// The fold of each track, from 1.
std::map<std::string, std::size_t> folds_of(const std::set<SizeAndScene>& instances) {
    constexpr std::size_t kMaxFolds = 10;
    std::map<std::string, std::size_t> folds;
    for (const auto& [size, scene] : instances) folds.emplace(scene->track, 0);
    std::size_t next = 0;
    for (auto& [track, fold] : folds) fold = 1 + next++ % kMaxFolds;
    return folds;
}

/// A table of instances in the format ARFF.
struct ArffTable {
    std::string text;

    ArffTable(std::string_view relation, const std::vector<std::string>& attributes)
        : text(fmt::format("@RELATION {}_CONELANE\n\n@ATTRIBUTE instance_id STRING\n@ATTRIBUTE repetition "
                           "NUMERIC\n@ATTRIBUTE {}\n\n@DATA\n",
                           relation, fmt::join(attributes, "\n@ATTRIBUTE "))) {}

    void add(const SizeAndScene& instance, std::size_t repetition, const std::vector<std::string>& cells) {
        text += fmt::format("{},{},{}\n", instance_name(instance), repetition, fmt::join(cells, ","));
    }
};

}  // namespace

void write_aslib_scenario(const std::filesystem::path& folder, std::span<const SolveRow> rows,
                          const SolveOptions& options) {
    ArffTable runs("ALGORITHM_RUNS", {"algorithm STRING", "runtime NUMERIC",
                                      "runstatus {ok,timeout,memout,not_applicable,crash,other}"});
    std::set<SizeAndScene> instances;
    std::vector<std::string> algorithms;
    for (const SolveRow& row : rows) {
        if (row.backend.warm_start) continue;
        instances.emplace(row.size, row.scene);
        const std::string label = row.backend.label();
        if (std::ranges::find(algorithms, label) == algorithms.end()) algorithms.push_back(label);
        runs.add({row.size, row.scene}, row.permutation + 1,
                 {quoted(label), number(std::min(row.latency_ms, options.time_limit_ms) / kMsPerS),
                  std::string(run_status(row, options.time_limit_ms))});
    }
    if (instances.empty()) throw InvalidInput("--aslib", "there is no run without a start");
    std::vector<std::string> features;
    for (const NamedFeature& feature : named({})) features.push_back(fmt::format("{} NUMERIC", feature.name));
    const std::string statuses = " {ok,timeout,memout,presolved,crash,other,unknown}";
    ArffTable values("FEATURE_VALUES", features);
    ArffTable status("FEATURE_RUNSTATUS", {"problem" + statuses, "relaxation" + statuses});
    ArffTable costs("FEATURE_COSTS", {"problem NUMERIC", "relaxation NUMERIC"});
    ArffTable cv("CV", {"fold NUMERIC"});
    const std::map<std::string, std::size_t> folds = folds_of(instances);
    for (const SizeAndScene& instance : instances) {
        const auto& [size, scene] = instance;
        const InstanceFeatures of = features_of(cones_of(*scene, size), options.parameters);
        std::vector<std::string> numbers;
        for (const NamedFeature& feature : named(of)) numbers.push_back(number(feature.value));
        values.add(instance, 1, numbers);
        status.add(instance, 1, {"ok", of.relaxation ? "ok" : "other"});
        costs.add(instance, 1, {number(of.problem_ms / kMsPerS), number(of.relaxation_ms / kMsPerS)});
        cv.add(instance, 1, {std::to_string(folds.at(scene->track))});
    }
    std::error_code failure;
    std::filesystem::create_directories(folder, failure);
    if (failure) throw InputError(folder, 0, "", "cannot be made: " + failure.message());
    FilesTogether files;
    files.add(folder / "description.txt", description(algorithms, options));
    files.add(folder / "algorithm_runs.arff", runs.text);
    files.add(folder / "feature_values.arff", values.text);
    files.add(folder / "feature_runstatus.arff", status.text);
    files.add(folder / "feature_costs.arff", costs.text);
    files.add(folder / "cv.arff", cv.text);
    files.commit();
}

}  // namespace conelane::experiments
