#pragma once

#include "learning/training/cost_training.hpp"
#include "model/strip_features.hpp"
#include "solvers/strip/strip_solver.hpp"

namespace conelane::learning {

/// The truth of a scene by the indices of its cones. Precondition: it has a ground truth with open
/// boundaries.
[[nodiscard]] StripLane true_strip_lane(const AnnotatedScene& scene);

/// Adds `factor` times the derivatives of the cost of a strip of the problem by all numbers.
void add_strip_gradient(const StripProblem& problem, const StripFeatures& features, const StripLane& lane,
                        const StripOfLane& strip, double factor, StripCosts& gradient);

/// Most are explained by option_fields.
struct StripTrainingOptions : CostTrainingOptions {
    StripTrainingOptions() {
        steps = 300;
        learning_rate = 0.02;
    }
    /// The training begins with their costs; linear ones get hidden units.
    StripParameters parameters = driving_strip_parameters();
    std::size_t lanes = 8;
    std::size_t max_cones = 120;
    std::size_t max_labels = 5'000;
};
/// Those of the record, which determine the costs together with the courses, and how it is run.
[[nodiscard]] OptionFields option_fields(StripTrainingOptions& options);

/// The loss of the truth among the cheapest lanes: the negative logarithm of its share of the sum of
/// exp(-cost). Reuses memory.
class StripLearner {
  public:
    using Costs = StripCosts;
    explicit StripLearner(const StripTrainingOptions& options)
        : search_{.lanes = options.lanes, .max_labels = options.max_labels}, max_cones_(options.max_cones) {}
    [[nodiscard]] static StripParameters with(StripParameters parameters, const StripCosts& costs) {
        parameters.costs = std::make_shared<const StripCosts>(costs);
        return parameters;
    }

    /// Adds the derivatives of the loss. Precondition: the scene has a ground truth with open boundaries.
    CostLoss add(const AnnotatedScene& scene, const StripParameters& parameters, StripCosts& gradient);

  private:
    StripOptions search_;
    std::size_t max_cones_;
    StripSolver solver_;
};

/// Learns costs from courses by StripLearner, with Adam. The same courses, options (except run_fields) and
/// build give the same costs to the last bit, also if a run was stopped and resumed from its checkpoint.
/// `say` gets a line now and then. Throws InvalidInput if an option is out of range, InputError if the
/// checkpoint is of another training.
[[nodiscard]] StripCosts train_strip(const std::vector<Track>& courses, const StripTrainingOptions& options,
                                     const std::function<void(const std::string&)>& say);

/// The file of the costs that were learned from SPECs of load_tracks, with their record. Runs without
/// annotated boundaries are left out. Throws InputError or InvalidInput.
[[nodiscard]] std::string run_strip_training(const std::vector<std::string>& tracks,
                                             const StripTrainingOptions& options,
                                             const std::function<void(const std::string&)>& say);

}  // namespace conelane::learning
