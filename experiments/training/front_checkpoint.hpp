#pragma once

#include "experiments/training/front_training.hpp"

#include <string>

namespace conelane::experiments {

/// Everything that determines the weights of `front`, as one line of JSON.
[[nodiscard]] std::string describe_training(const std::vector<Track>& courses,
                                            const FrontTrainingOptions& options);

}  // namespace conelane::experiments
