#pragma once

#include "conelane/solve_report.hpp"
#include "evaluation/world/annotated_scene.hpp"
#include "model/strip_problem.hpp"

#include <memory>
#include <optional>
#include <string>
#include <variant>

namespace conelane::experiments {

/// The costs of an objective whose optimum can be proven: (29) with what the parameters add to it, or those
/// of the strip.
struct NamedCosts {
    std::string name = "default";
    std::variant<RldParameters, StripParameters> costs = {};
};

struct PricedLane {
    Lane lane;
    double cost = 0.0;
};

struct ProvenLane {
    SolveStatus status = SolveStatus::error;
    std::optional<double> bound;
    std::optional<PricedLane> lane;  ///< the best that was found
};

/// One scene under one objective. The costs and the scene must outlive it.
class SceneObjective {
  public:
    virtual ~SceneObjective() = default;

    /// Of the exact search, accepted by the check of answers. Throws InvalidInput if it is not, or if the
    /// search ends in an error.
    [[nodiscard]] virtual ProvenLane optimum(double time_limit_ms) = 0;
    /// Nothing if the constraints forbid the lane. Call it after optimum().
    [[nodiscard]] virtual std::optional<double> cost(const Lane& lane) const = 0;
    /// The cheapest lane that a beam of that many partial lanes meets; nothing if it meets none, or if there
    /// is no beam for the costs.
    [[nodiscard]] virtual std::optional<Lane> beam(std::size_t width) const = 0;
    /// Throws InvalidInput if an independent check refuses the lane or its cost.
    virtual void check(const PricedLane& lane, const char* what) const = 0;
};

[[nodiscard]] std::unique_ptr<SceneObjective> objective_of(const Scene& cones, const NamedCosts& costs);

}  // namespace conelane::experiments
