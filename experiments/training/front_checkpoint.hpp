#pragma once

#include "experiments/training/adam.hpp"
#include "experiments/training/front_training.hpp"

#include <cstddef>
#include <optional>
#include <string>

#include <Eigen/Core>

namespace conelane::experiments {

/// State of a training of `front`.
struct FrontCheckpoint {
    std::size_t step = 0;  ///< steps done
    Eigen::ArrayXd values;
    Adam::State adam;
};

/// Everything that determines the weights, as one line of JSON.
[[nodiscard]] std::string describe_training(const std::vector<Track>& courses,
                                            const FrontTrainingOptions& options);

/// Nothing if there is no such file. Throws InputError if it is not a checkpoint, or one of another training
/// than `identity`.
[[nodiscard]] std::optional<FrontCheckpoint> read_front_checkpoint(const std::string& file,
                                                                   const std::string& identity);
void write_front_checkpoint(const std::string& file, const std::string& identity,
                            const FrontCheckpoint& checkpoint);

}  // namespace conelane::experiments
