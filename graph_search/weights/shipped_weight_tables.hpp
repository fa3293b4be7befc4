// Private to shipped_weights.cpp: what the build makes of the files in weights/, see weights.cmake.
#pragma once

#include <span>
#include <string_view>

namespace conelane {

/// A network's file: names of the features and the numbers, those of the hidden layer unit by unit.
struct RankNetTable {
    std::span<const std::string_view> features;
    std::span<const double> mean;
    std::span<const double> deviation;
    std::span<const double> hidden;
    std::span<const double> hidden_bias;
    std::span<const double> output;
    double output_bias;
};
extern const RankNetTable kPaperRankNet;
extern const RankNetTable kExtendedRankNet;

/// The scores of one measure, see StepMeasure; the tables are in no order.
struct StepScoreTable {
    std::string_view measure;
    double first;
    double spacing;
    std::span<const double> scores;
};
extern const std::span<const StepScoreTable> kStepScores;

/// A network of `front`, see FrontNetworkWeights.
struct FrontNetworkTable {
    std::span<const double> hidden;
    std::span<const double> hidden_bias;
    std::span<const double> output;
    std::span<const double> linear;
    std::span<const double> output_bias;  ///< one number
};
struct FrontTable {
    std::span<const std::string_view> features;  ///< of the state, a move, a stop, a start, a cone, a lane
    FrontNetworkTable extend;
    FrontNetworkTable stop;
    FrontNetworkTable start;
    FrontNetworkTable rank;
    FrontNetworkTable usable;
    FrontNetworkTable right;
    double least_trust;
};
extern const FrontTable kFront;

}  // namespace conelane
