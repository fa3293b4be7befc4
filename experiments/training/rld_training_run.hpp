#pragma once

#include "experiments/training/rld_training.hpp"

#include <functional>
#include <string>
#include <vector>

namespace conelane::experiments {

struct RldTrainingRunOptions {
    std::vector<std::string>
        tracks;  ///< SPECs of load_tracks; runs without annotated boundaries are left out
    RldTrainingOptions training;
};

struct RldTrainingRun {
    RldParameters parameters;  ///< those of the options, with the learned costs
    std::string record;        ///< JSON object: everything that determines the costs, the commit
};

/// From track names to parameters with learned costs. The record names tracks, not files. Throws InputError
/// or InvalidInput.
[[nodiscard]] RldTrainingRun run_rld_training(const RldTrainingRunOptions& options,
                                              const std::function<void(const RldProgress&)>& report);

}  // namespace conelane::experiments
