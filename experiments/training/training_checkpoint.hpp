#pragma once

#include "experiments/training/adam.hpp"

#include <cstddef>
#include <optional>
#include <string>

#include <Eigen/Core>

namespace conelane::experiments {

/// State of a training by Adam.
struct TrainingCheckpoint {
    std::size_t step = 0;  ///< steps done
    Eigen::ArrayXd values;
    Adam::State adam;
};

/// Nothing if there is no such file. Throws InputError if it is not a checkpoint of so many values, or one of
/// another training than `identity`.
[[nodiscard]] std::optional<TrainingCheckpoint> read_training_checkpoint(const std::string& file,
                                                                         const std::string& identity,
                                                                         Eigen::Index size);
void write_training_checkpoint(const std::string& file, const std::string& identity,
                               const TrainingCheckpoint& checkpoint);

}  // namespace conelane::experiments
