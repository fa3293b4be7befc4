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

/// Who races, as a table names it.
struct RaceMethod {
    std::string name;    ///< `front`, or `front+planner`
    std::string method;  ///< truth, none, a method, or a command of a program from outside
    bool has_planner = false;
    bool takes_weights = false;                         ///< see DetectorOptions
    std::shared_ptr<OutsideProgramPool> programs = {};  ///< of a program from outside
};

/// The methods as a user lists them, each also or only with a planner. truth is the true centre line; none
/// answers no frame; neither gets a planner. Throws InvalidInput where a method is unknown, answers no frames
/// (`lanes:`), or cannot have a planner (one from outside, one that is not of the library).
enum class WithPlanner { no, only, both };
[[nodiscard]] std::vector<RaceMethod> race_methods(const std::vector<std::string>& texts,
                                                   WithPlanner with_planner);

/// A new entrant for one race. `course` must outlive it. `weights`: instead of the shipped ones, where the
/// method takes them; throws InvalidInput naming `weights` where they cannot be read.
[[nodiscard]] Entrant make_entrant(const RaceMethod& method, const RaceCourse& course,
                                   const RaceOptions& options,
                                   const std::optional<WeightsBytes>& weights = {});

}  // namespace conelane::experiments
