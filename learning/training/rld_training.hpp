#pragma once

#include "conelane/rld_solver.hpp"
#include "detectors/parameters/learned_costs_reader.hpp"
#include "learning/training/front_scenes.hpp"
#include "model/learned_features.hpp"

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

/// The parameters for learning costs: all other costs are 0, and the limits allow most true lanes, also with
/// missed cones.
[[nodiscard]] RldParameters rld_learning_parameters();

/// The costs of the shipped set `shape` as linear learned costs, with a constant moved from edges to turns
/// and ends, which changes no optimum.
[[nodiscard]] LearnedCosts shape_as_learned_costs();

/// Linear costs with this number of hidden units, drawn by the seed, which contribute almost nothing. They do
/// not depend on colours and confidences.
/// Precondition: `linear` has none.
[[nodiscard]] LearnedCosts with_hidden_units(const LearnedCosts& linear, std::size_t units,
                                             std::uint64_t seed);

/// Most are explained by option_fields.
struct RldTrainingOptions : DrawnTrainingOptions {
    RldTrainingOptions() {
        scenes.colored_share = 0.0;
        scenes.noise_share = 0.0;
        scenes.highest_rate = 0.6;
    }
    /// Limits and costs to which the learned ones are added. If they have learned costs, the training begins
    /// with them, and linear ones get hidden units; otherwise it begins with shape_as_learned_costs.
    RldParameters parameters = rld_learning_parameters();
    std::string parameters_hash;  ///< set by option_fields
    RldMargin margin;
    std::size_t units = 16;
    std::int64_t max_work = 15'000'000;
    std::size_t steps = 2000;
    double learning_rate = 5e-3;  ///< of Adam, falls to 0 along a cosine
};
/// Those of the record, which determine the costs together with the courses, and how it is run.
[[nodiscard]] OptionFields option_fields(RldTrainingOptions& options);

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
