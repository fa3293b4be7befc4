#pragma once

#include <cmath>
#include <numbers>

#include <Eigen/Core>

namespace conelane::experiments {

/// The running means of Adam (Kingma, Ba 2015) over the derivatives of some parameters, with its authors'
/// constants. A step is learning rate * mean() / deviation().
class Adam {
  public:
    /// `smallest_deviation` keeps the quotient from noise if a derivative is nearly always 0.
    Adam(Eigen::Index parameters, double smallest_deviation)
        : first_(Eigen::ArrayXd::Zero(parameters)),
          second_(Eigen::ArrayXd::Zero(parameters)),
          smallest_deviation_(smallest_deviation) {}

    /// Adds the derivatives of the next step.
    void add(const Eigen::Ref<const Eigen::ArrayXd>& derivatives) {
        first_power_ *= kFirstDecay;
        second_power_ *= kSecondDecay;
        first_ = kFirstDecay * first_ + (1.0 - kFirstDecay) * derivatives;
        second_ = kSecondDecay * second_ + (1.0 - kSecondDecay) * derivatives * derivatives;
    }

    /// Mean of the derivatives, unbiased. Precondition: something was added.
    [[nodiscard]] auto mean() const { return first_ / (1.0 - first_power_); }
    /// Root mean square of the derivatives, unbiased. Precondition: something was added.
    [[nodiscard]] auto deviation() const {
        return (second_ / (1.0 - second_power_)).sqrt() + smallest_deviation_;
    }

    /// The whole state, for a training that resumes later.
    struct State {
        Eigen::ArrayXd first;
        Eigen::ArrayXd second;
        double first_power;
        double second_power;
    };
    [[nodiscard]] State state() const { return {first_, second_, first_power_, second_power_}; }
    void restore(const State& state) {
        first_ = state.first;
        second_ = state.second;
        first_power_ = state.first_power;
        second_power_ = state.second_power;
    }

  private:
    static constexpr double kFirstDecay = 0.9;
    static constexpr double kSecondDecay = 0.999;

    Eigen::ArrayXd first_;
    Eigen::ArrayXd second_;
    double smallest_deviation_;
    double first_power_ = 1.0;
    double second_power_ = 1.0;
};

/// Falls from the learning rate to 0 along a cosine. `done`: the share of the training, from 0 to 1.
[[nodiscard]] inline double cosine_rate(double learning_rate, double done) {
    return learning_rate * 0.5 * (1.0 + std::cos(std::numbers::pi * done));
}

}  // namespace conelane::experiments
