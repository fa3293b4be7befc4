#pragma once

#include "conelane/planner.hpp"

#include <memory>

namespace conelane {

/// Trackdrive and autocross: laps of a course that is not known in advance.
[[nodiscard]] std::unique_ptr<Planner> make_lap_planner(const PlannerOptions& options);
/// By this detector, whatever `options` names.
[[nodiscard]] std::unique_ptr<Planner> make_lap_planner(const PlannerOptions& options,
                                                        std::unique_ptr<LaneDetector> detector);

}  // namespace conelane
