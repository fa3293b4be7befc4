#pragma once

#include "experiments/studies/solve_rows.hpp"

namespace conelane::experiments {

/// Adds the measures of docs/measures.md: for a file, rows with "row": summary, pair, selection or gap; for a
/// terminal, tables of the first three. First all scenes of each size; then, if scenes have several
/// conditions, each condition. A run is a scene in one order of its cones, rows and columns. It is solved if
/// its optimum, or that there is none, was proven within the limit, the checker passes it and no other
/// backend refutes it. Intervals are of 95 %, courses drawn again (course_mean). A pair is a backend and the
/// one labelled `reference`, the first one without it; its test is on the means of courses. Backends that did
/// not solve the same runs as the first one (a warm start has no permutations) are compared on the scenes in
/// their original order.
void add_measures(StudyResult& result, const SolveResults& results, double time_limit_ms,
                  const std::string& reference = {});

}  // namespace conelane::experiments
