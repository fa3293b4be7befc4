#pragma once

#include "conelane/rld_parameters.hpp"
#include "experiments/tuning/evaluation.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace conelane::experiments {

struct TunerOptions {
    std::size_t folds = 4;          ///< number of groups of tracks; below two, none is held out
    std::size_t evaluations = 400;  ///< largest number in each fit
    std::uint64_t seed = 0;
};

/// A fit to the tracks of all folds but one.
struct Fold {
    std::vector<std::string> held_out;  ///< tracks that the fit has not seen
    RldParameters parameters;
    double training = 0.0;  ///< mean over the scenes of the other tracks
    std::vector<LapFigure> held_out_laps;
    std::vector<LapFigure> held_out_laps_of_start;
};

struct Tuned {
    RldParameters parameters;  ///< fitted to all tracks
    std::vector<LapFigure> laps;
    std::vector<LapFigure> laps_of_start;
    std::vector<Fold> folds;
};

/// The figures of parameters on every lap; the same laps in each call.
using Evaluate = std::function<std::vector<LapFigure>(const RldParameters&)>;

/// Parameters that may be better than the start on the named tracks; see fit_weights_in_rounds.
using Propose = std::function<std::vector<RldParameters>(const RldParameters& start,
                                                         const std::set<std::string>& tracks)>;

/// Mean over the scenes of the laps; 0 without laps.
[[nodiscard]] double mean_over_scenes(std::span<const LapFigure> laps);

/// Parameters that maximise the mean over scenes as far as the search finds, in the ranges of
/// tuned_parameters(start). Each fit evaluates the proposals, then from the best of these and the start runs
/// NLopt's controlled random search (GN_CRS2_LM) around it on 30 % of the evaluations, then Subplex
/// (LN_SBPLX) from the best point in the whole ranges; the best point evaluated counts. Track i, in the order
/// of the laps, belongs to fold i modulo `folds`. Every fit draws the same first points, so memory in
/// `evaluate` saves most of a fold's work. The same seed and figures give the same answer. Throws
/// InvalidInput if there are fewer tracks than folds, and the exceptions of `evaluate`.
[[nodiscard]] Tuned tune(const Evaluate& evaluate, const RldParameters& start, const TunerOptions& options,
                         const Propose& propose = {});

}  // namespace conelane::experiments
