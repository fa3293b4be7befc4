#pragma once

#include "conelane/lane_graph_problem.hpp"
#include "conelane/learned_costs.hpp"
#include "conelane/rld_parameters.hpp"
#include "conelane/rld_solver.hpp"
#include "detectors/parameters/learned_costs_reader.hpp"
#include "evaluation/world/annotated_scene.hpp"
#include "model/learned_features.hpp"

#include <concepts>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <type_traits>

namespace conelane::learning {

/// Calls `use` with the numbers of all networks, list by list. `costs`: LearnedCosts.
template <typename Costs, typename Use>
requires std::same_as<std::remove_const_t<Costs>, LearnedCosts>
void for_each_block(Costs& costs, const Use& use) {
    for_each_costs_list(costs, [&](const std::string& /*key*/, auto& numbers) { use(std::span(numbers)); });
}

/// The truth of a scene as a lane graph of its cones. Precondition: it has a ground truth with open
/// boundaries.
[[nodiscard]] LaneGraph true_lane_graph(const AnnotatedScene& scene);

/// While the rival of the truth is searched, this margin is subtracted from the cost of each edge that is not
/// in the truth, and added to the cost of each edge that is. The rival is a cheap lane graph that is wrong.
struct RldMargin {
    double near = 0.4;  ///< of an edge within near_m of the car
    double far = 0.2;   ///< of any other edge
    double near_m = 20.0;
};

/// Adds `factor` times the derivatives of the learned cost of a lane graph by all numbers. At a limit of
/// LearnedCosts, such as a turn that would gain, the derivative counts only if a step along it leaves the
/// limit.
void add_cost_gradient(const LaneGraphProblem& problem, const LearnedFeatures& features,
                       const LaneGraph& graph, double factor, LearnedCosts& gradient);

/// The structured hinge loss of one scene after another: the cost of the truth minus that of its cheapest
/// rival, with the margin. The rival comes from path-pair, which starts from the truth. If a limit of its
/// work ends the search, the rival is the best one found. Reuses memory.
class RldLearner {
  public:
    RldLearner(const RldMargin& margin, std::int64_t max_work);

    struct Loss {
        bool allowed = false;  ///< the truth is a lane graph of the problem; else the rest is unset
        bool proven = false;   ///< there is no cheaper rival
        bool found = false;    ///< the truth is its own cheapest rival
        double hinge = 0.0;    ///< not negative
    };
    /// Adds the derivatives of the loss. Precondition: the scene has a ground truth with open boundaries, and
    /// the parameters have learned costs.
    Loss add(const AnnotatedScene& scene, const RldParameters& parameters, LearnedCosts& gradient);

  private:
    RldMargin margin_;
    std::unique_ptr<RldSolver> solver_;
};

}  // namespace conelane::learning
