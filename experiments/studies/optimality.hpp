#pragma once

#include "conelane/rld_parameters.hpp"
#include "conelane/solve_report.hpp"
#include "evaluation/formats/scene_set.hpp"
#include "evaluation/scoring/score.hpp"

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace conelane::experiments {

/// An objective: (29) with the costs that the parameters add to it.
struct NamedCosts {
    std::string name = "default";
    RldParameters parameters;
};

struct OptimalityOptions {
    std::string detector = "clc";        ///< one that enumerates
    std::string beside = "front";        ///< one whose lanes are compared with the optimum; none if empty
    std::optional<std::size_t> nearest;  ///< cone set of all; all cones if absent
    std::vector<NamedCosts> costs{{}};   ///< at least one
    std::size_t beam_width = 100;        ///< see beam_lane_graph
    double time_limit_ms = 400.0;        ///< of the exact search, a scene
    unsigned threads = 1;
};

/// A lane under an objective and against the ground truth.
struct JudgedLane {
    std::optional<double> objective;  ///< absent if RLD's constraints forbid the lane
    Category category = Category::none;
    double iou = 0.0;
    std::optional<bool> usable;  ///< absent where no boundaries are known
};

/// One scene under one objective. Candidates are distinct as sets of edges.
struct OptimalityRow {
    const AnnotatedScene* scene = nullptr;
    std::string costs;                        ///< the name of the objective
    SolveStatus status = SolveStatus::error;  ///< of the exact search
    std::optional<double> bound;
    std::size_t candidates = 0;
    std::size_t feasible = 0;             ///< of them, under RLD's constraints
    std::optional<JudgedLane> optimum;    ///< the best lane that the exact search found
    std::optional<JudgedLane> beam;       ///< of the beam search under the same objective
    std::optional<JudgedLane> candidate;  ///< the feasible one of least objective; of equal ones the first
    std::optional<JudgedLane> choice;     ///< what the method answers
    std::optional<JudgedLane> beside;     ///< what the method beside it answers

    /// (lane - optimum) / max(1, |optimum|), at least 0; where the optimum is proven and the lane has an
    /// objective.
    [[nodiscard]] std::optional<double> gap_of(const std::optional<JudgedLane>& lane) const;
    /// That of the candidate.
    [[nodiscard]] std::optional<double> gap() const { return gap_of(candidate); }
    /// Its gap is within the solvers' tolerance.
    [[nodiscard]] bool is_optimal(const std::optional<JudgedLane>& lane) const;
};

/// Each scene that counts (see `counts`) under each objective, in the order of the scenes, then of the
/// objectives; the same with any number of threads. `set` must outlive the rows. Throws InvalidInput where
/// there is no such detector or the one that has to enumerate does not, and naming the scene where a lane has
/// a lower objective than an optimum said to be proven or the independent checker rejects a lane graph.
[[nodiscard]] std::vector<OptimalityRow> optimality_rows(const SceneSet& set,
                                                         const OptimalityOptions& options);

/// By objective, condition and rate: how near the candidates are to the optimum; what all lanes are worth;
/// and what a lane is worth by its gap to the optimum, beside the optimum of the same scenes.
[[nodiscard]] std::string optimality_table(std::span<const OptimalityRow> rows);

}  // namespace conelane::experiments
