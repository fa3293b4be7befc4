#pragma once

#include "evaluation/world/annotated_scene.hpp"
#include "experiments/comparison/answer_errors.hpp"
#include "experiments/studies/cone_sets.hpp"

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace conelane::experiments {

class Study;

/// Every solver of the registry that proves nothing, compared with the optimum of path-pair.
[[nodiscard]] std::unique_ptr<Study> make_relaxations_study();

struct RelaxationOptions : ConeSetOptions {
    RelaxationOptions() {
        sizes = {8, 12, 16, 20, 30};
        time_limit_ms = 400.0;  // as in the RLD paper
    }
};

/// One solver at one cone-set size. Times and `accurate` are over all scenes; a solve without an answer is
/// inaccurate and counts with its time.
struct RelaxationRow {
    std::size_t cones = 0;
    std::string solver;
    std::size_t scenes = 0;
    std::size_t feasible = 0;  ///< scenes with a lane graph of proven least cost
    std::size_t answered = 0;  ///< of those, with a lane graph by this solver
    std::size_t optimal = 0;   ///< of those, within 1e-6 of the least cost
    /// (objective - least cost) / max(1, |least cost|), over the answered ones; absent without one
    std::optional<double> mean_gap;
    std::optional<double> worst_gap;
    double accurate = 0.0;  ///< share (RLD paper, IV-B)
    double median_ms = 0.0;
    double p95_ms = 0.0;
    double worst_ms = 0.0;
};

/// Rows by size, path-pair first; sizes that no scene has are left out. Throws InvalidInput naming the scene
/// if a solver answers below the least cost. `errors` counts answers, and errors among them.
[[nodiscard]] std::vector<RelaxationRow> relaxation_rows(std::span<const AnnotatedScene> scenes,
                                                         const RelaxationOptions& options,
                                                         AnswerErrors& errors);

/// Of these rows, for a terminal.
[[nodiscard]] std::string relaxation_table(std::span<const RelaxationRow> rows);

}  // namespace conelane::experiments
