#pragma once

#include "model/geometry.hpp"

#include <array>
#include <cstddef>
#include <memory>
#include <span>

#include <Eigen/Core>

namespace conelane {

/// What the ranking of candidates sees of a lane, section VII of the CLC paper, in its order: (1) length, the
/// mean of both boundaries' [m]; (2), (3) number of cones left, right; (4) variance of the lane width, over
/// W(L, R) of equation (12) with every query counted [m^2]; (5), (6) variance of the segment lengths left,
/// right [m^2]; (7), (8) variance of the signed turning angles between consecutive segments left, right
/// [rad^2]. Variances are those of the whole population, 0 where there is nothing to vary.
using LaneFeatures = std::array<double, 8>;

/// The features of a lane by definition. A closed lane includes its closing segments and their angles.
/// Precondition: no boundary is empty; for a closed lane, at least three points each.
[[nodiscard]] LaneFeatures lane_features(std::span<const Point> left, std::span<const Point> right,
                                         bool closed = false);

/// Count, sum and sum of squares of what a variance is taken of.
struct Moments {
    double count = 0.0;
    double sum = 0.0;
    double sum_of_squares = 0.0;

    void add(double value) {
        count += 1.0;
        sum += value;
        sum_of_squares += value * value;
    }
    [[nodiscard]] double variance() const;
};

/// A judge of candidate lanes: the higher the score, the likelier the lane. Stateless, so one object may
/// serve many threads.
class LaneRanking {
  public:
    virtual ~LaneRanking() = default;
    /// Writes one score for each lane.
    virtual void score(std::span<const LaneFeatures> lanes, std::span<double> scores) const = 0;
};

/// The network of section VII: 8 standardised features, 100 rectified linear units, one output; 1001
/// parameters at that width, others are allowed.
struct RankNetWeights {
    LaneFeatures mean{};                             ///< subtracted from each feature, ...
    LaneFeatures deviation{};                        ///< ... which is then divided by this; positive
    Eigen::Matrix<float, Eigen::Dynamic, 8> hidden;  ///< a row for each unit
    Eigen::VectorXf hidden_bias;
    Eigen::VectorXf output;
    float output_bias = 0.0F;
};
/// Throws InvalidInput where sizes do not fit, a number is not finite or a deviation is not positive.
[[nodiscard]] std::shared_ptr<const LaneRanking> make_rank_net(const RankNetWeights& weights);

}  // namespace conelane
