#pragma once

#include "conelane/rld_parameter_sets.hpp"
#include "conelane/rld_solver.hpp"
#include "learning/training/cost_training.hpp"
#include "model/learned_features.hpp"

namespace conelane::learning {

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

/// The parameters for learning costs: all other costs are 0, and the limits allow most true lanes, also with
/// missed cones.
[[nodiscard]] RldParameters rld_learning_parameters();

/// The costs of a lane's shape, such as those of the shipped set `shape`, as linear learned costs, with a
/// constant moved from edges to turns and ends, which changes no optimum.
[[nodiscard]] LearnedCosts as_learned_costs(const RldParameters& shape);

/// Linear costs with this number of hidden units, drawn by the seed, which contribute almost nothing. They do
/// not depend on colours and confidences.
/// Precondition: `linear` has none.
[[nodiscard]] LearnedCosts with_hidden_units(const LearnedCosts& linear, std::size_t units,
                                             std::uint64_t seed);

/// Most are explained by option_fields.
struct RldTrainingOptions : CostTrainingOptions {
    /// Limits and costs to which the learned ones are added. If they have learned costs, the training begins
    /// with them, and linear ones get hidden units; otherwise it begins with the costs of `start`.
    RldParameters parameters = rld_learning_parameters();
    /// `shape` was tuned on recorded courses: a training that must not know those begins with other costs.
    RldParameters start = rld_parameter_set("shape").value();
    std::string parameters_hash;  ///< set by option_fields
    std::string start_hash;       ///< the same
    RldMargin margin;
    std::int64_t max_work = 15'000'000;
};
/// Those of the record, which determine the costs together with the courses, and how it is run.
[[nodiscard]] OptionFields option_fields(RldTrainingOptions& options);

/// The structured hinge loss of one scene after another: the cost of the truth minus that of its cheapest
/// rival, with the margin. The rival comes from path-pair, which starts from the truth. If a limit of its
/// work ends the search, the rival is the best one found. Reuses memory.
class RldLearner {
  public:
    using Costs = LearnedCosts;
    explicit RldLearner(const RldTrainingOptions& options);
    [[nodiscard]] static RldParameters with(RldParameters parameters, const LearnedCosts& costs) {
        parameters.learned_costs = std::make_shared<const LearnedCosts>(costs);
        return parameters;
    }

    /// Adds the derivatives of the loss. Precondition: the scene has a ground truth with open boundaries, and
    /// the parameters have learned costs.
    CostLoss add(const AnnotatedScene& scene, const RldParameters& parameters, LearnedCosts& gradient);

  private:
    RldMargin margin_;
    std::unique_ptr<RldSolver> solver_;
};

/// Learns costs from courses by the structured hinge loss of RldLearner, with Adam. The same courses, options
/// (except run_fields) and build give the same costs to the last bit, also if a run was stopped and resumed
/// from its checkpoint. `say` gets a line now and then. Throws InvalidInput if an option is out of range,
/// InputError if the checkpoint is of another training.
[[nodiscard]] LearnedCosts train_rld(const std::vector<Track>& courses, const RldTrainingOptions& options,
                                     const std::function<void(const std::string&)>& say);

struct RldTrainingRun {
    RldParameters parameters;  ///< those of the options, with the learned costs
    std::string record;        ///< JSON object: everything that determines the costs, the commit
};
/// From SPECs of load_tracks to parameters with learned costs. The record names tracks, not files. Runs
/// without annotated boundaries are left out. Throws InputError or InvalidInput.
[[nodiscard]] RldTrainingRun run_rld_training(const std::vector<std::string>& tracks,
                                              const RldTrainingOptions& options,
                                              const std::function<void(const std::string&)>& say);

}  // namespace conelane::learning
