#pragma once

#include "graph_search/clc/ranking.hpp"
#include "learning/training/candidate_lists.hpp"
#include "learning/training/option_field.hpp"

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace conelane::learning {

/// The parameters of a network in training; the output bias cancels in every difference of scores.
struct RankNetParameters {
    Eigen::MatrixXd hidden;  ///< a row for each unit, a column for each input
    Eigen::VectorXd hidden_bias;
    Eigen::VectorXd output;
};
/// Calls `use` with all numbers, block by block. `parameters`: RankNetParameters.
template <typename Parameters, typename Use>
requires std::same_as<std::remove_const_t<Parameters>, RankNetParameters>
void for_each_block(Parameters& parameters, const Use& use) {
    const auto block = [&](auto& numbers) {
        use(std::span(numbers.data(), static_cast<std::size_t>(numbers.size())));
    };
    block(parameters.hidden);
    block(parameters.hidden_bias);
    block(parameters.output);
}

/// Pairs of candidates of the same scene, a column each, standardised.
struct CandidatePairs {
    Eigen::MatrixXd first;
    Eigen::MatrixXd second;
    Eigen::RowVectorXd first_is_better;  ///< p_GT of equation (14)
};

/// Binary cross-entropy of p_pred = sigmoid(Net(first) - Net(second)) with p_GT, mean over the pairs; section
/// VII of the CLC paper. Writes the derivatives with respect to the parameters to `gradient` if that is not
/// null.
[[nodiscard]] double pair_loss(const RankNetParameters& parameters, const CandidatePairs& pairs,
                               RankNetParameters* gradient);

/// All candidates of some scenes, a column each, standardised.
struct CandidateScenes {
    Eigen::MatrixXd inputs;
    Eigen::RowVectorXd quality;        ///< the higher, the better
    std::vector<Eigen::Index> begins;  ///< of each scene, and the end of the last one
};

/// Minus the expected quality if a scene's lane is drawn with probabilities softmax(scores), mean over the
/// scenes. Equation (14) only compares two lanes; this is a smooth form of the final figure, the quality of
/// the chosen lane. Writes the derivatives as pair_loss does.
[[nodiscard]] double choice_loss(const RankNetParameters& parameters, const CandidateScenes& scenes,
                                 RankNetParameters* gradient);

enum class RankLoss {
    pairs,  ///< pair_loss, as in the paper
    choice  ///< choice_loss
};

/// Most are explained by option_fields.
struct RankNetTrainingOptions {
    std::size_t inputs = kPaperFeatureCount;  ///< the paper's features, or kLaneFeatureCount for all
    std::size_t units = 100;
    RankLoss loss = RankLoss::pairs;
    /// In each epoch, every candidate is the first of one pair; for choice_loss, every scene is used once.
    std::size_t epochs = 60;
    std::size_t pairs_a_step = 4096;  ///< a batch of 8192 candidates, as in VIII-B
    std::size_t scenes_a_step = 64;   ///< for choice_loss
    double learning_rate = 0.008;     ///< of Adam; falls to 0 along a cosine
    double weight_decay = 0.0;        ///< of every weight but the units' biases (decoupled weight decay)
    double iou_factor = 50.0;         ///< lambda_iou of equation (14); pairs only
    /// Subtracted from the IoU, the quality of a candidate, if it diverges below kCriticalDivergence_m, ...
    double divergence_penalty = 0.0;
    /// ... and if it diverges later. 0 in the paper. A short way off the lane costs little area.
    double late_divergence_penalty = 0.0;
    /// A stub that ends before it can go wrong is not an answer. 0 in the paper.
    double unusable_penalty = 0.0;
    /// Share of the pairs whose second candidate is the one that the network ranked first at the beginning of
    /// the epoch; the others use any candidate of the scene. In the end only the first rank counts. Pairs
    /// only.
    double leader_share = 0.5;
    std::uint64_t seed = 0;
    bool show_progress = true;
};
[[nodiscard]] OptionFields option_fields(RankNetTrainingOptions& options);

/// Trains a network from random weights. The same lists, options and build give the same weights to the last
/// bit; runs on one thread. Throws InvalidInput if no list has two candidates or an option is out of range.
[[nodiscard]] RankNetWeights train_rank_net(std::span<const CandidateList> lists,
                                            const RankNetTrainingOptions& options);

/// Quality of the candidates that a ranking chooses.
struct RankingFigures {
    std::size_t scenes = 0;
    double mean_iou = 0.0;              ///< of the chosen candidates; 0 for a scene without candidates
    double mean_best_iou = 0.0;         ///< the ceiling
    double near_best_share = 0.0;       ///< scenes with a candidate of IoU >= kNearGroundTruthIou
    double usable_share = 0.0;          ///< scenes whose chosen candidate can be driven by
    double most_usable_share = 0.0;     ///< scenes with a candidate that can
    double critical_share = 0.0;        ///< scenes without candidate or whose chosen one diverges below 20 m
    double least_critical_share = 0.0;  ///< scenes in which every candidate does

    static constexpr auto fields() {
        using Figures = RankingFigures;
        return std::array{std::pair{"mean_iou", &Figures::mean_iou},
                          std::pair{"mean_best_iou", &Figures::mean_best_iou},
                          std::pair{"near_best_share", &Figures::near_best_share},
                          std::pair{"usable_share", &Figures::usable_share},
                          std::pair{"most_usable_share", &Figures::most_usable_share},
                          std::pair{"critical_share", &Figures::critical_share},
                          std::pair{"least_critical_share", &Figures::least_critical_share}};
    }
};
/// All zero without lists.
[[nodiscard]] RankingFigures ranking_figures(std::span<const CandidateList> lists,
                                             const LaneRanking& ranking);

}  // namespace conelane::learning
