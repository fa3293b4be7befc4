#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace conelane::learning {

/// The running means of Adam (Kingma, Ba 2015) over the derivatives of some parameters, with its authors'
/// constants. A step is learning rate * mean() / deviation().
class Adam {
  public:
    /// `smallest_deviation` keeps the quotient from noise if a derivative is nearly always 0.
    Adam(Eigen::Index parameters, double smallest_deviation)
        : state_{Eigen::ArrayXd::Zero(parameters), Eigen::ArrayXd::Zero(parameters), 1.0, 1.0},
          smallest_deviation_(smallest_deviation) {}

    /// Adds the derivatives of the next step.
    void add(const Eigen::Ref<const Eigen::ArrayXd>& derivatives);
    /// Mean of the derivatives, unbiased. Precondition: something was added.
    [[nodiscard]] auto mean() const { return state_.first / (1.0 - state_.first_power); }
    /// Root mean square of the derivatives, unbiased. Precondition: something was added.
    [[nodiscard]] auto deviation() const {
        return (state_.second / (1.0 - state_.second_power)).sqrt() + smallest_deviation_;
    }

    /// The whole state, for a training that resumes later.
    struct State {
        Eigen::ArrayXd first;
        Eigen::ArrayXd second;
        double first_power;
        double second_power;
    };
    [[nodiscard]] const State& state() const { return state_; }
    void restore(State state) { state_ = std::move(state); }

  private:
    State state_;
    double smallest_deviation_;
};

/// Falls from the learning rate to 0 along a cosine. `done`: the share of the training, from 0 to 1.
[[nodiscard]] inline double cosine_rate(double learning_rate, double done) {
    return learning_rate * 0.5 * (1.0 + std::cos(std::numbers::pi * done));
}

/// Turns scores into probabilities in place; returns the logarithm of the sum of exponentials. Precondition:
/// at least one score.
template <typename Number>
double to_probabilities(std::vector<Number>& scores) {
    const double highest = *std::ranges::max_element(scores);
    double sum = 0.0;
    for (Number& score : scores) {
        score = static_cast<Number>(std::exp(static_cast<double>(score) - highest));
        sum += static_cast<double>(score);
    }
    for (Number& score : scores) score = static_cast<Number>(static_cast<double>(score) / sum);
    return highest + std::log(sum);
}

/// Figures, listed by Figures::fields(), from sums over the scenes to means; nothing without scenes.
template <typename Figures>
void divide_by_scenes(Figures& figures) {
    if (figures.scenes == 0) return;
    for (const auto& [name, figure] : Figures::fields())
        figures.*figure /= static_cast<double>(figures.scenes);
}

/// All numbers of some weights, block by block. for_each_block(weights, use) calls `use` with each block.
template <typename Weights>
[[nodiscard]] Eigen::ArrayXd flat(const Weights& weights) {
    std::vector<double> all;
    for_each_block(weights, [&](const auto& block) {
        for (const auto number : block) all.push_back(static_cast<double>(number));
    });
    return Eigen::Map<const Eigen::ArrayXd>(all.data(), static_cast<Eigen::Index>(all.size()));
}
/// Precondition: as many values as `flat` gives.
template <typename Weights>
void set(Weights& weights, const Eigen::ArrayXd& values) {
    Eigen::Index at = 0;
    for_each_block(weights, [&](auto&& block) {
        for (auto& number : block) number = static_cast<std::decay_t<decltype(number)>>(values[at++]);
    });
}

/// The mean of derivatives from their sum, shortened to a length of `most`: single scenes may be completely
/// wrong.
[[nodiscard]] Eigen::ArrayXd limited_mean(const Eigen::ArrayXd& sum, double count, double most);

/// What a training learns: the exchangeable part of `learn`. Steps are counted from 0.
class GradientLearner {
  public:
    virtual ~GradientLearner() = default;

    /// Whether this many steps are all.
    [[nodiscard]] virtual bool is_done(std::size_t steps) const = 0;
    /// Whether Adam begins again with that step.
    [[nodiscard]] virtual bool begins_stage(std::size_t /*step*/) const { return false; }

    struct Step {
        Eigen::ArrayXd derivatives = {};  ///< of the mean loss at the present values; empty: nothing to learn
        double rate = 0.0;                ///< learning rate
    };
    [[nodiscard]] virtual Step step(std::size_t number) = 0;
    /// Moves the values along a step of Adam.
    virtual void move(const Adam& adam, double rate, Eigen::ArrayXd& values) const {
        values -= rate * adam.mean() / adam.deviation();
    }
    virtual void set_values(const Eigen::ArrayXd& values) = 0;
    /// What follows the last step.
    virtual void finish() {}
    /// Says what has happened since the last report.
    virtual void report(std::size_t /*steps*/) {}
};

struct LearningLoop {
    double smallest_deviation = 1e-8;  ///< of Adam
    unsigned threads = 1;              ///< of the arena in which steps run
    std::size_t report_every = 0;      ///< steps, and after the last one; 0: no reports
    std::string identity = {};         ///< everything that determines the result, for the checkpoint
    std::string checkpoint = {};       ///< file to resume from, written regularly; none if empty
    std::size_t checkpoint_every = 1;  ///< steps
};

/// Learns from the values on, step by step. A loop that was stopped and resumes from its checkpoint gives the
/// same to the last bit. Throws InputError if the checkpoint is not one of that identity and size.
void learn(GradientLearner& learner, Eigen::ArrayXd values, const LearningLoop& loop);

}  // namespace conelane::learning
