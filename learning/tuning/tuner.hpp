#pragma once

#include "conelane/rld_parameters.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>

namespace conelane::learning {

struct TunerOptions {
    std::size_t evaluations = 400;
    std::uint64_t seed = 0;
};

struct Tuned {
    RldParameters parameters;
    double figure = 0.0;
    double figure_of_start = 0.0;
};

/// The figure of parameters, as Evaluation gives it.
using Evaluate = std::function<double(const RldParameters&)>;

/// Parameters that maximise the figure as far as the search finds, in the ranges of tuned_parameters(start).
/// NLopt's controlled random search (GN_CRS2_LM) runs around the start on 30 % of the evaluations, then
/// Subplex (LN_SBPLX) from the best point in the whole ranges; the best point evaluated counts, the start
/// included. The same seed and figures give the same answer. Throws the exceptions of `evaluate`.
[[nodiscard]] Tuned tune(const Evaluate& evaluate, const RldParameters& start, const TunerOptions& options);

}  // namespace conelane::learning
