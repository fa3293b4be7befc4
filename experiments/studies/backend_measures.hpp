#pragma once

#include "experiments/studies/solve_rows.hpp"
#include "experiments/studies/study.hpp"

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace conelane::experiments {

/// The rows that a figure is of.
struct MeasuredGroup {
    std::size_t size = 0;
    std::string condition = {};  ///< empty: all scenes
};

/// Summary of the runs of one backend at one size and condition. A run is a scene in one order of its cones,
/// rows and columns. It is solved if its optimum, or that there is none, was proven within the limit, the
/// checker passes it and no other backend refutes it. Definitions: docs/measures.md.
struct BackendSummary : MeasuredGroup {
    std::string backend;
    std::size_t scenes = 0;
    std::size_t runs = 0;
    std::size_t solved = 0;
    std::size_t errors = 0;     ///< of all runs of this backend, with refuted claims
    std::size_t refuted = 0;    ///< likewise
    double geometric_ms = 0.0;  ///< shifted by 1 ms, failures at the limit
    double par1_ms = 0.0;       ///< mean, failures at the limit
    double par2_ms = 0.0;
    double par10_ms = 0.0;
    std::size_t common = 0;                     ///< runs that every backend solved
    std::optional<double> common_geometric_ms;  ///< over these
    double median_ms = 0.0;                     ///< failures at the limit
    std::optional<double> median_engine_ms;     ///< the solver's own time, in runs that report it
    std::optional<double> variability;          ///< median over scenes of the coefficient of variation
    std::optional<double> spread;               ///< median over scenes of largest / smallest time
    std::size_t integrals = 0;                  ///< scenes with steps and a known lane graph
    std::optional<double> primal_integral_ms;   ///< means over these
    std::optional<double> dual_integral_ms;
    std::vector<double> profile;  ///< at profile_ratios()
    std::size_t won = 0;          ///< runs that it solves first
    std::optional<std::size_t> peak_bytes;  ///< of its block
};

/// Multiples of the fastest time at which profiles are evaluated: 1 to 1000, 25 a decade.
[[nodiscard]] std::span<const double> profile_ratios();

/// Wilcoxon's test on two backends: geometric means of a scene's times, failures at the limit.
struct BackendPair : MeasuredGroup {
    std::string first;
    std::string second;
    std::size_t scenes = 0;  ///< whose times differ
    double ratio = 1.0;      ///< geometric mean of first / second
    double p_value = 1.0;
    double corrected_p_value = 1.0;  ///< Holm, over the pairs of this size and condition
};

/// Single best against virtual best solver.
struct BackendSelection : MeasuredGroup {
    std::string single_best;
    double single_par10_ms = 0.0;
    double virtual_par10_ms = 0.0;
};

/// Gaps after some time, over all scenes with steps and a known lane graph.
struct BackendGap : MeasuredGroup {
    std::string backend;
    double time_ms = 0.0;
    double mean_primal_gap = 0.0;
    double mean_dual_gap = 0.0;
};

struct BackendMeasures {
    std::vector<BackendSummary> summaries;  ///< by size, condition and backend
    std::vector<BackendPair> pairs;
    std::vector<BackendSelection> selections;
    std::vector<BackendGap> gaps;

    /// For a terminal: summaries, pairs and selections.
    [[nodiscard]] std::string table() const;
    /// Rows for a file, each with "row": summary, pair, selection or gap.
    void add_rows_to(StudyResult& result) const;
};

/// First all scenes of each size; then, if scenes have several conditions, each condition. Backends that did
/// not solve the same runs as the first one (a warm start has no permutations) are compared on the scenes in
/// their original order.
[[nodiscard]] BackendMeasures measures_of(const SolveResults& results, double time_limit_ms);

}  // namespace conelane::experiments
