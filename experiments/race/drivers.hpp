#pragma once

#include "experiments/methods/method.hpp"
#include "experiments/race/race.hpp"

namespace conelane::experiments {

/// What drives a car in a race.
struct Racer {
    std::string name;                   ///< in tables: `front`, or `front+planner`
    std::optional<Method> method = {};  ///< absent: `truth` or `none`
    bool has_planner = false;

    [[nodiscard]] bool takes_weights() const { return method && method->takes_weights(); }
};

/// The methods as a user lists them, each with or without a planner. truth is the true centre line; none
/// answers no frame; neither gets a planner. Throws InvalidInput if a method is unknown, does not answer
/// frames (`lanes:`), or cannot have a planner (one from outside, or one that is not in the library).
enum class WithPlanner { no, only, both };
[[nodiscard]] std::vector<Racer> racers(const std::vector<std::string>& texts, WithPlanner with_planner);

/// A driver that returns the next `ahead_m` of the true centre line, from the pose that the car believes, and
/// stops past the last line. Its map frame is that of the world: no random map frame, drift or jumps.
[[nodiscard]] Driver truth_driver(const RaceCourse& course, int laps, double ahead_m = 20.0);

/// A new driver for one race. `course` must outlive it. `weights`: instead of the shipped weights, if not
/// null. Throws InvalidInput naming `weights` if they cannot be read or the method takes none.
[[nodiscard]] Driver make_driver(const Racer& racer, const RaceCourse& course, const RaceOptions& options,
                                 const WeightsBytes* weights = nullptr);

}  // namespace conelane::experiments
