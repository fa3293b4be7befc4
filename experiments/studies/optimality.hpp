#pragma once

#include "conelane/rld_parameters.hpp"
#include "conelane/solve_report.hpp"
#include "evaluation/scenes/annotated_scene.hpp"
#include "evaluation/scoring/score.hpp"

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace conelane::experiments {

class Study;

/// The best lane that CLC's search enumerates against the proven optimum of RLD's objective.
[[nodiscard]] std::unique_ptr<Study> make_optimality_study();

struct OptimalityOptions {
    std::string detector = "clc";        ///< one that enumerates
    std::optional<std::size_t> nearest;  ///< cone set of both; all cones if absent
    RldParameters parameters;
    double time_limit_ms = 400.0;  ///< of the exact search, a scene
    unsigned threads = 1;
};

/// A lane under RLD's objective and against the ground truth.
struct JudgedLane {
    std::optional<double> objective;  ///< (29); absent if RLD's constraints forbid the lane
    Category category = Category::none;
    double iou = 0.0;
};

/// One scene. Candidates are distinct as sets of edges.
struct OptimalityRow {
    const AnnotatedScene* scene = nullptr;
    SolveStatus status = SolveStatus::error;  ///< of the exact search
    std::optional<double> bound;
    std::size_t candidates = 0;
    std::size_t feasible = 0;             ///< of them, under RLD's constraints
    std::optional<JudgedLane> optimum;    ///< with status optimal and feasible
    std::optional<JudgedLane> candidate;  ///< the feasible one of least objective; of equal ones the first
    std::optional<JudgedLane> choice;     ///< the lane that the detector's own ranking chose

    /// (candidate - optimum) / max(1, |optimum|), at least 0; only if the optimum is proven and a candidate
    /// is feasible.
    [[nodiscard]] std::optional<double> gap() const;
    /// The gap is within the solvers' tolerance.
    [[nodiscard]] bool is_optimal() const;
};

/// A row for each scene with a ground truth, in order. Throws InvalidInput if the detector does not
/// enumerate. Also, naming the scene, if a candidate has a lower objective than a proven optimum, or if the
/// independent checker rejects the optimum or the best candidate.
[[nodiscard]] std::vector<OptimalityRow> optimality_rows(std::span<const AnnotatedScene> scenes,
                                                         const TrackBoundariesByName& tracks,
                                                         const OptimalityOptions& options);

/// A line per rate of false positives for a terminal.
[[nodiscard]] std::string optimality_table(std::span<const OptimalityRow> rows);

}  // namespace conelane::experiments
