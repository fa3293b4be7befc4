#include "experiments/tuning/weight_fit.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <nlopt.hpp>

namespace conelane::experiments {
namespace {

double objective_of(const RatedGraph& graph, const RldParameters& parameters) {
    double sum = 0.0;
    for (std::size_t term = 0; term < kObjectiveTermCount; ++term) {
        sum += parameters.*kObjectiveWeights[term] * graph.sums[term];
    }
    return sum;
}

/// Keeps the best point evaluated, whatever the algorithm returns.
class Fit {
  public:
    Fit(std::span<const RatedGraphs> scenes, const RldParameters& start)
        : scenes_(scenes), weights_(tuned_weights(start)), parameters_(start) {
        for (const auto& [parameter, term] : weights_) {
            lower_.push_back(std::log(parameter.lowest));
            upper_.push_back(std::log(parameter.highest));
            best_point_.push_back(std::clamp(std::log(start.*parameter.value), lower_.back(), upper_.back()));
        }
    }

    void run() {
        constexpr int kMaxSteps = 500;
        constexpr double kMinStep = 1e-6;
        nlopt::opt search(nlopt::LD_MMA, static_cast<unsigned>(best_point_.size()));
        search.set_lower_bounds(lower_);
        search.set_upper_bounds(upper_);
        search.set_max_objective(&Fit::value, this);
        search.set_maxeval(kMaxSteps);
        search.set_xtol_abs(kMinStep);
        std::vector<double> point = best_point_;
        double reached = 0.0;
        try {
            search.optimize(point, reached);
        } catch (const std::runtime_error&) {
            // If no step improved it, the best point is kept.
        }
    }

    [[nodiscard]] RldParameters parameters() {
        move_to(best_point_);
        for (const auto& [parameter, term] : weights_) {
            double& weight = parameters_.*parameter.value;
            weight = std::clamp(rounded(weight), parameter.lowest, parameter.highest);
        }
        return parameters_;
    }

  private:
    static double value(const std::vector<double>& point, std::vector<double>& gradient, void* self) {
        return static_cast<Fit*>(self)->value(point, gradient);
    }
    double value(const std::vector<double>& point, std::vector<double>& gradient) {
        move_to(point);
        ObjectiveSums by_term{};
        const double expected = expected_value(scenes_, parameters_, &by_term);
        for (std::size_t i = 0; i < gradient.size(); ++i) gradient[i] = by_term[weights_[i].term];
        if (expected > best_) {
            best_ = expected;
            best_point_ = point;
        }
        return expected;
    }
    void move_to(const std::vector<double>& point) {
        for (std::size_t i = 0; i < weights_.size(); ++i) {
            parameters_.*weights_[i].parameter.value = std::exp(point[i]);
        }
    }

    std::span<const RatedGraphs> scenes_;
    std::vector<TunedWeight> weights_;
    RldParameters parameters_;
    std::vector<double> lower_;
    std::vector<double> upper_;
    std::vector<double> best_point_;  ///< logarithms of the weights
    double best_ = -1.0;
};

}  // namespace

std::vector<TunedWeight> tuned_weights(const RldParameters& start) {
    std::vector<TunedWeight> weights;
    for (const TunedParameter& parameter : tuned_parameters(start)) {
        const auto weight = std::ranges::find(kObjectiveWeights, parameter.value);
        if (weight == kObjectiveWeights.end()) continue;
        weights.push_back({parameter, static_cast<std::size_t>(weight - kObjectiveWeights.begin())});
    }
    return weights;
}

double expected_value(std::span<const RatedGraphs> scenes, const RldParameters& parameters,
                      ObjectiveSums* gradient) {
    if (gradient != nullptr) gradient->fill(0.0);
    if (scenes.empty()) return 0.0;
    const double sharpness = kSharpness / parameters.w_b;
    double total = 0.0;
    std::vector<double> shares;
    for (const RatedGraphs& graphs : scenes) {
        shares.clear();
        for (const RatedGraph& graph : graphs) shares.push_back(objective_of(graph, parameters));
        const double least = std::ranges::min(shares);
        double sum = 0.0;
        for (double& share : shares) sum += share = std::exp(-sharpness * (share - least));
        double expected = 0.0;
        for (std::size_t i = 0; i < graphs.size(); ++i) {
            shares[i] /= sum;
            expected += shares[i] * graphs[i].value;
        }
        total += expected;
        if (gradient == nullptr) continue;
        for (std::size_t i = 0; i < graphs.size(); ++i) {
            const double by_objective = sharpness * shares[i] * (expected - graphs[i].value);
            for (std::size_t term = 0; term < kObjectiveTermCount; ++term) {
                (*gradient)[term] += by_objective * graphs[i].sums[term];
            }
        }
    }
    const auto count = static_cast<double>(scenes.size());
    if (gradient != nullptr) {
        for (std::size_t term = 0; term < kObjectiveTermCount; ++term) {
            (*gradient)[term] *= parameters.*kObjectiveWeights[term] / count;
        }
        (*gradient)[static_cast<std::size_t>(ObjectiveTerm::benefit)] = 0.0;
    }
    return total / count;
}

RldParameters fit_weights(std::span<const RatedGraphs> scenes, const RldParameters& start) {
    Fit fit(scenes, start);
    fit.run();
    return fit.parameters();
}

}  // namespace conelane::experiments
