#pragma once

#include "conelane/formulation.hpp"
#include "evaluation/world/annotated_scene.hpp"
#include "experiments/studies/cone_sets.hpp"

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace conelane::experiments {

class Study;

/// Both formulations of the RLD program on the same cone sets: the tight one by `cbc`, the printed one by
/// `cbc-main`, each the faster of the two on it.
[[nodiscard]] std::unique_ptr<Study> make_formulations_study();

struct FormulationOptions : ConeSetOptions {
    FormulationOptions() {
        sizes = {6, 8, 10, 12, 16, 20, 24, 30};
        time_limit_ms = 10'000.0;
    }
};

/// One formulation at one cone-set size. Rows and columns are means over the scenes. Times and nodes are over
/// all scenes; a solve that reached the time limit counts with its time.
struct FormulationRow {
    std::size_t cones = 0;
    Formulation formulation = Formulation::tight;
    std::string solver;
    std::size_t scenes = 0;
    std::size_t optimal = 0;
    std::size_t infeasible = 0;
    double columns = 0.0;
    double rows = 0.0;
    double entries = 0.0;
    /// (optimum - relaxation) / max(1, |optimum|), over the scenes with a proven optimum; absent without one
    std::optional<double> median_gap;
    std::optional<double> mean_gap;
    double mean_nodes = 0.0;
    double median_build_ms = 0.0;
    double median_ms = 0.0;  ///< build and solve
    double p95_ms = 0.0;
};

/// Rows by size, tight before paper; sizes that no scene has are left out. Throws InvalidInput naming the
/// scene if the optima of the two formulations differ by more than 1e-6, or a solver fails.
[[nodiscard]] std::vector<FormulationRow> formulation_rows(std::span<const AnnotatedScene> scenes,
                                                           const FormulationOptions& options);

/// Of these rows, for a terminal.
[[nodiscard]] std::string formulation_table(std::span<const FormulationRow> rows);

}  // namespace conelane::experiments
