#pragma once

#include "experiments/training/front_training.hpp"

#include <functional>
#include <string>
#include <vector>

namespace conelane::experiments {

struct FrontTrainingRunOptions {
    std::vector<std::string>
        tracks;  ///< SPECs of load_tracks; runs without annotated boundaries are left out
    std::vector<std::string> hold_out;  ///< the same; never trained on, only measured
    /// The same; least_trust is chosen on them. Never trained on. Empty: it is chosen on the tracks trained
    /// on.
    std::vector<std::string> trust_tracks;
    double hold_out_every_m = 10.0;
    std::vector<std::string> conditions{"paper", "car"};  ///< a set of held-out scenes each
    std::vector<double> rates{0.0, 0.1, 0.3, 0.5};        ///< of these scenes
    FrontTrainingOptions training;
};

struct FrontTrainingRun {
    FrontWeights weights;
    std::string record;  ///< JSON object: everything that determines the result, the last figures, the commit
};

/// From track names to weights and the record of their training. The record names tracks, not files. Throws
/// InputError or InvalidInput; also if a track is both trained on and held out.
[[nodiscard]] FrontTrainingRun run_front_training(const FrontTrainingRunOptions& options,
                                                  const std::function<void(const FrontProgress&)>& report);

}  // namespace conelane::experiments
