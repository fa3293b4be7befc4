#include "learning/training/strip_training.hpp"

#include "conelane/invalid_input.hpp"
#include "evaluation/formats/weights_file.hpp"
#include "model/geometry.hpp"

namespace conelane::learning {
namespace {

void add_boundary(const StripFeatures& features, const std::vector<std::size_t>& side, bool is_left,
                  const StripCosts& costs, double factor, StripCosts& gradient) {
    for (std::size_t m = 2; m < side.size(); ++m) {
        const auto [i, j, k] = std::array{side[m - 2], side[m - 1], side[m]};
        const double bend =
            cross(features.at(j) - features.at(i), features.at(k) - features.at(j));  // to the left
        add_gradient(costs.of(StripPart::turn), features.turn(i, j, k, is_left ? bend < 0.0 : bend > 0.0),
                     factor, gradient.of(StripPart::turn));
    }
    add_gradient(costs.of(StripPart::end), features.end(side[side.size() - 2], side.back()), factor,
                 gradient.of(StripPart::end));
}

StripCosts initial_costs(const StripTrainingOptions& options) {
    StripCosts costs = *options.parameters.costs;
    if (costs.networks.front().units() == 0) add_hidden_units(costs.networks, options.units, options.seed);
    return costs;
}

}  // namespace

StripLane true_strip_lane(const AnnotatedScene& scene) {
    const auto index_of = index_by_id(scene.scene);
    StripLane lane;
    for (const ConeId id : scene.ground_truth->left) lane.left.push_back(index_of.at(id));
    for (const ConeId id : scene.ground_truth->right) lane.right.push_back(index_of.at(id));
    return lane;
}

void add_strip_gradient(const StripProblem& problem, const StripFeatures& features, const StripLane& lane,
                        const StripOfLane& strip, double factor, StripCosts& gradient) {
    const StripCosts& costs = *problem.parameters.costs;
    const auto add = [&](StripPart part, const auto& of) {
        add_gradient(costs.of(part), of, factor, gradient.of(part));
    };
    add(StripPart::start, features.start(lane.left.front(), lane.right.front()));
    for (const std::size_t k : strip.triangles) {
        const StripTriangle& t = problem.triangles[k];
        const ProblemEdge& edge = problem.graph.edges[t.edge];
        const StripRung& rung = problem.rungs[t.from];
        const std::size_t across = rung.of(!t.is_left);
        add(StripPart::edge, features.edge(edge.i, edge.j));
        add(StripPart::triangle, features.triangle(rung.of(t.is_left), problem.entered(t), across,
                                                   features.inside_of(across, edge.i, edge.j)));
    }
    add_boundary(features, lane.left, true, costs, factor, gradient);
    add_boundary(features, lane.right, false, costs, factor, gradient);
}

CostLoss StripLearner::add(const AnnotatedScene& scene, const StripParameters& parameters,
                           StripCosts& gradient) {
    CostLoss loss;
    if (scene.scene.cones.size() > max_cones_) return loss;
    const StripProblem problem = make_strip_problem(scene.scene, parameters);
    const StripLane truth = true_strip_lane(scene);
    const std::optional<StripOfLane> true_strip = cheapest_strip(problem, truth);
    loss.allowed = true_strip.has_value();
    if (!loss.allowed) return loss;
    const StripReport report = solver_.solve(problem, search_);
    loss.proven = report.status == SolveStatus::optimal;
    std::vector<StripLane> lanes{truth};
    for (const StripLane& lane : report.lanes) {
        if (lane != truth) lanes.push_back(lane);
    }
    loss.found = report.lanes.empty() || report.lanes.front() == truth;
    std::vector<StripOfLane> strips;
    std::vector<double> shares;  // of the sum of exponentials
    for (const StripLane& lane : lanes) {
        strips.push_back(cheapest_strip(problem, lane).value());
        shares.push_back(-strips.back().cost);
    }
    const double of_truth = shares.front();
    loss.loss = to_probabilities(shares) - of_truth;
    const StripFeatures features(scene.scene, problem.graph, problem.reach_m);
    shares.front() -= 1.0;
    for (std::size_t k = 0; k < lanes.size(); ++k) {
        if (std::abs(shares[k]) > 1e-6)
            add_strip_gradient(problem, features, lanes[k], strips[k], -shares[k], gradient);
    }
    return loss;
}

OptionFields option_fields(StripTrainingOptions& options) {
    return cost_fields(
        options,
        {{"--lanes", "lanes", &options.lanes, kCount, "number of cheapest lanes that the truth has to beat"},
         {"--max-cones", "max_cones", &options.max_cones, kCount,
          "scenes with more cones teach nothing: their searches take most of the time"},
         {"--max-labels", "max_labels", &options.max_labels, kCount,
          "limit of each search, in partial strips; then the lanes that it has found count"}});
}

StripCosts train_strip(const std::vector<Track>& courses, const StripTrainingOptions& options,
                       const std::function<void(const std::string&)>& say) {
    StripTrainingOptions copy = options;
    require_in_range(option_fields(copy));
    validate(options.parameters);
    require_units(options.parameters.costs->networks, options.units);
    return CostTraining<StripLearner, StripTrainingOptions>(courses, options, initial_costs(options), say)
        .run(courses);
}

std::string run_strip_training(const std::vector<std::string>& tracks, const StripTrainingOptions& options,
                               const std::function<void(const std::string&)>& say) {
    const std::vector<Track> courses = annotated_tracks(tracks);
    return strip_costs_json(train_strip(courses, options, say), training_record(courses, options));
}

}  // namespace conelane::learning
