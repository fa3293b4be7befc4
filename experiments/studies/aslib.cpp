#include "experiments/studies/aslib.hpp"

#include "conelane/invalid_input.hpp"
#include "evaluation/input_error.hpp"
#include "experiments/instances/files_together.hpp"
#include "experiments/instances/instance_features.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <sstream>
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

}  // namespace

void write_aslib_scenario(const std::filesystem::path& folder, std::span<const SolveRow> rows,
                          const SolveOptions& options) {
    std::set<SizeAndScene> instances;
    std::vector<std::string> algorithms;
    std::ostringstream runs;
    for (const SolveRow& row : rows) {
        if (row.backend.warm_start) continue;
        instances.emplace(row.size, row.scene);
        const std::string label = row.backend.label();
        if (std::ranges::find(algorithms, label) == algorithms.end()) algorithms.push_back(label);
        runs << instance_name({row.size, row.scene}) << ',' << row.permutation + 1 << ',' << quoted(label)
             << ',' << number(std::min(row.latency_ms, options.time_limit_ms) / kMsPerS) << ','
             << run_status(row, options.time_limit_ms) << '\n';
    }
    if (instances.empty()) throw InvalidInput("--aslib", "there is no run without a start");
    const std::string instance_attributes = "@ATTRIBUTE instance_id STRING\n@ATTRIBUTE repetition NUMERIC\n";
    std::ostringstream values, status, costs, cv;
    values << "@RELATION FEATURE_VALUES_CONELANE\n\n" << instance_attributes;
    for (const NamedFeature& feature : named({})) values << "@ATTRIBUTE " << feature.name << " NUMERIC\n";
    values << "\n@DATA\n";
    status << "@RELATION FEATURE_RUNSTATUS_CONELANE\n\n" << instance_attributes;
    costs << "@RELATION FEATURE_COSTS_CONELANE\n\n" << instance_attributes;
    for (const char* const step : {"problem", "relaxation"}) {
        status << "@ATTRIBUTE " << step << " {ok,timeout,memout,presolved,crash,other,unknown}\n";
        costs << "@ATTRIBUTE " << step << " NUMERIC\n";
    }
    status << "\n@DATA\n";
    costs << "\n@DATA\n";
    cv << "@RELATION CV_CONELANE\n\n" << instance_attributes << "@ATTRIBUTE fold NUMERIC\n\n@DATA\n";
    const std::map<std::string, std::size_t> folds = folds_of(instances);
    for (const SizeAndScene& instance : instances) {
        const auto& [size, scene] = instance;
        const InstanceFeatures features = features_of(cones_of(*scene, size), options.parameters);
        const std::string start = instance_name(instance) + ",1";
        values << start;
        for (const NamedFeature& feature : named(features)) values << ',' << number(feature.value);
        values << '\n';
        status << start << ",ok," << (features.relaxation ? "ok" : "other") << '\n';
        costs << start << ',' << number(features.problem_ms / kMsPerS) << ','
              << number(features.relaxation_ms / kMsPerS) << '\n';
        cv << start << ',' << folds.at(scene->track) << '\n';
    }
    const std::string runs_text =
        "@RELATION ALGORITHM_RUNS_CONELANE\n\n" + instance_attributes +
        "@ATTRIBUTE algorithm STRING\n@ATTRIBUTE runtime NUMERIC\n@ATTRIBUTE runstatus "
        "{ok,timeout,memout,not_applicable,crash,other}\n\n@DATA\n" +
        runs.str();
    std::error_code failure;
    std::filesystem::create_directories(folder, failure);
    if (failure) throw InputError(folder, 0, "", "cannot be made: " + failure.message());
    FilesTogether files;
    files.add(folder / "description.txt", description(algorithms, options));
    files.add(folder / "algorithm_runs.arff", runs_text);
    files.add(folder / "feature_values.arff", values.str());
    files.add(folder / "feature_runstatus.arff", status.str());
    files.add(folder / "feature_costs.arff", costs.str());
    files.add(folder / "cv.arff", cv.str());
    files.commit();
}

}  // namespace conelane::experiments
