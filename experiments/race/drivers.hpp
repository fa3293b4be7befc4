#pragma once

#include "conelane/detectors.hpp"
#include "evaluation/outside/outside_program.hpp"
#include "experiments/race/race.hpp"

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace conelane::experiments {

/// A method in a race, with its name in tables.
struct RaceDetector {
    std::string name;      ///< `front`, or `front+planner`
    std::string detector;  ///< truth, none, a detector, or a command of a program from outside
    bool has_planner = false;
    bool takes_weights = false;                         ///< see DetectorOptions
    std::shared_ptr<OutsideProgramPool> programs = {};  ///< of a program from outside
};

/// The detectors as a user lists them, each with or without a planner. truth is the true centre line; none
/// answers no frame; neither gets a planner. Throws InvalidInput if a detector is unknown, does not answer
/// frames (`lanes:`), or cannot have a planner (one from outside, or one that is not in the library).
enum class WithPlanner { no, only, both };
[[nodiscard]] std::vector<RaceDetector> race_detectors(const std::vector<std::string>& texts,
                                                       WithPlanner with_planner);

/// A new driver for one race. `course` must outlive it. `weights`: instead of the shipped weights, if the
/// detector takes weights. Throws InvalidInput naming `weights` if they cannot be read.
[[nodiscard]] Driver make_driver(const RaceDetector& detector, const RaceCourse& course,
                                 const RaceOptions& options, const std::optional<WeightsBytes>& weights = {});

}  // namespace conelane::experiments
