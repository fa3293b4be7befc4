#pragma once

#include "evaluation/scoring/lane_iou.hpp"
#include "evaluation/world/annotated_scene.hpp"
#include "evaluation/world/track.hpp"
#include "graph_search/front/front_judge.hpp"

#include <type_traits>

namespace conelane::learning {

/// Adds `factor` times the derivatives of the network's score for these inputs, with respect to its weights,
/// to `derivatives`, which has the same shape.
void add_derivatives(const FrontNetworkWeights& network, std::span<const float> inputs, float factor,
                     FrontNetworkWeights& derivatives);

/// Calls `use` with all numbers of the networks, block by block, always in the same order. `weights`: a
/// FrontWeights.
template <typename Weights, typename Use>
requires std::derived_from<std::remove_const_t<Weights>, FrontWeightSet>
void for_each_block(Weights& weights, const Use& use) {
    for_each_weights_list(weights, [&](const FrontNetworkPlace& /*place*/, const char* /*key*/, auto numbers,
                                       std::size_t /*each*/) { use(numbers); });
}

/// a += b
void add(FrontWeights& a, const FrontWeights& b);
void set_zero(FrontWeights& weights);

/// Weights of the risk of a lane in training.
struct FrontRiskOptions {
    double unusable = 0.5;  ///< added for an unusable lane
    double cones = 0.3;     ///< added for cones too many and too few, as a share of the true ones
    /// The risk of a scene without a lane.
    [[nodiscard]] double worst() const { return 1.0 + unusable + cones; }
};

/// The ground truth of a scene in FrontMap, and the risk of other lanes compared with it. The scene and the
/// map must outlive it. Reuses memory from call to call.
class FrontTruth {
  public:
    using Cones = std::array<std::vector<Vertex>, 2>;

    /// Precondition: the scene has a ground truth.
    void set(const AnnotatedScene& scene, const FrontMap& map);
    [[nodiscard]] const Cones& cones() const { return cones_; }

    /// 1 - IoU, plus the terms of FrontRiskOptions; 0 for the truth itself.
    [[nodiscard]] double risk(const Cones& lane, const TrackBoundaries& boundaries,
                              const FrontRiskOptions& options) const;
    /// As SceneScore::usable.
    [[nodiscard]] bool is_usable(const Cones& lane, const TrackBoundaries& boundaries) const;
    /// For each boundary, the number of cones before the first one that is off (see boundary_divergence).
    [[nodiscard]] std::array<std::size_t, 2> right_cones(const Cones& lane,
                                                         const TrackBoundaries& boundaries) const;
    /// As SceneScore::divergence_distance_m.
    [[nodiscard]] std::optional<double> divergence_m(const Cones& lane,
                                                     const TrackBoundaries& boundaries) const;

  private:
    [[nodiscard]] LaneOutline outline(const Cones& lane) const;
    /// In the frame of the course.
    [[nodiscard]] LaneOutline outline_in_world(const Cones& lane) const;

    const AnnotatedScene* scene_ = nullptr;
    const FrontMap* map_ = nullptr;
    Cones cones_;
};

/// The weights are explained by option_fields(FrontTrainingOptions&).
struct FrontLossOptions {
    FrontSearchOptions search;
    std::size_t listed = 20;  ///< number of best lanes that the loss of a whole lane compares
    double fall_out = 1.0;
    double minimum_risk = 3.0;
    double listwise = 0.5;
    double risk_scale = 0.05;  ///< a lane with this much more risk should be e times less likely
    FrontRiskOptions risk;
};

/// The losses over the lanes of a list: minimum risk, and the cross-entropy between their probabilities and
/// those that follow from their risks.
struct ListLoss {
    double expected_risk = 0.0;
    std::vector<double> by_score;  ///< derivatives of the weighted losses by each score
};
[[nodiscard]] ListLoss list_loss(std::vector<double> scores, std::span<const double> risks,
                                 const FrontLossOptions& options);

/// The loss of the true lane in one scene and its derivatives. Keeps memory from scene to scene; one object
/// serves one thread.
class FrontLearner {
  public:
    struct Loss {
        double sum = 0.0;
        std::size_t decisions = 0;  ///< terms in the sum
        bool reached = false;       ///< whether the rules allow the whole true lane
        bool kept = false;          ///< whether the beam kept it to the end
        bool found = false;         ///< whether it has the highest score of all
        double risk = 0.0;          ///< of the best lane; FrontRiskOptions::worst without a lane
    };

    /// Teacher forcing: the softmax over the starts, then over the moves of each state of the true lane.
    Loss imitate(const AnnotatedScene& scene, const FrontWeights& weights, FrontCost& cost,
                 const FrontSearchOptions& search, FrontWeights& derivatives);
    /// Through the search: cross-entropy at the level where the true lane falls out of the beam, and minimum
    /// risk and listwise loss over the best lanes that the search ends with.
    Loss search(const AnnotatedScene& scene, const TrackBoundaries& boundaries, const FrontWeights& weights,
                FrontCost& cost, const FrontLossOptions& options, FrontWeights& derivatives);

  private:
    /// Position of the true pair among the starts; kNone if it is not among them.
    [[nodiscard]] std::size_t true_start() const;
    /// The true move of a state with the true cones so far; its `edge` is not set.
    [[nodiscard]] FrontMove true_move(const FrontState& state, Side side) const;
    /// Adds the derivatives of the scores of nodes and their ancestors, each times its coefficient.
    void add_coefficients(const FrontWeights& weights, FrontCost& cost, FrontWeights& derivatives);
    void add_move(const FrontState& state, Side side, const FrontMove& move, double factor,
                  const FrontWeights& weights, FrontCost& cost, FrontWeights& derivatives);
    void add_start(std::size_t start, double factor, const FrontWeights& weights, FrontWeights& derivatives);
    /// Follows the true lane by one step; whether it is still in the beam.
    struct Follow {
        std::size_t node = FrontSearch::kNone;  ///< the last true state kept
        std::size_t level = 0;                  ///< where the next one belongs
        FrontSearch::Candidate next{};          ///< that next one
        bool reachable = true;
        bool lost = false;
        bool ended = false;
    };
    Follow begin_truth(FrontCost& cost);
    void follow(Follow& truth, FrontCost& cost);
    void foresee(Follow& truth, std::size_t level, FrontCost& cost);
    Loss& add_fall_out(const Follow& truth, const FrontLossOptions& options, Loss& loss);
    std::vector<FrontSearch::Finished> listed_lanes(const Follow& truth, const FrontLossOptions& options,
                                                    Loss& loss) const;
    void add_list_loss(std::span<const FrontSearch::Finished> lanes, const TrackBoundaries& boundaries,
                       const FrontLossOptions& options, Loss& loss);

    FrontSearch front_;
    FrontMoves moves_;
    FrontTruth truth_;
    std::array<std::vector<Vertex>, 2> cones_;
    std::vector<float> start_rows_;
    std::vector<double> coefficients_;
    struct FinishingStop {
        std::size_t parent;
        Side side;
        double factor;
    };
    std::vector<FinishingStop> finishing_;
};

/// The loss of FrontJudge in one scene and its derivatives: of `rank` as FrontLearner has it for the lanes of
/// a search, of `usable` and `right` the cross-entropy for the answered lane. FrontCost stays unchanged.
/// Keeps memory from scene to scene; one object serves one thread.
class FrontJudgeLearner {
  public:
    struct Loss {
        double sum = 0.0;
        bool found = false;
        bool is_usable = false;
        double confidence = 0.0;
        double risk = 0.0;  ///< of the answered lane
        /// The highest FrontWeights::least_trust with which the answered lane is trusted farther than it is
        /// right; below 0 if all of it is right.
        double trust_where_wrong = -1.0;
    };

    /// `derivatives` absent: only the loss.
    Loss judge(const AnnotatedScene& scene, const TrackBoundaries& boundaries, const FrontWeights& weights,
               FrontCost& cost, FrontJudge& judge, const FrontLossOptions& options,
               FrontWeights* derivatives);

    /// The same for a scene of false cones only, where no lane is usable and no first pair right: the
    /// cross-entropy of `usable`, and of `right` for the first pair. 0 if no lane is found.
    double judge_noise(const Scene& scene, const FrontWeights& weights, FrontCost& cost, FrontJudge& judge,
                       const FrontLossOptions& options, FrontWeights& derivatives);

  private:
    void search(const Scene& scene, FrontCost& cost, const FrontLossOptions& options);
    [[nodiscard]] std::optional<std::size_t> answered(const FrontJudge& judge) const;
    void add_rank(const FrontWeights& weights, const FrontJudge& judge, const FrontLossOptions& options,
                  Loss& loss, FrontWeights* derivatives) const;
    void add_right(const TrackBoundaries& boundaries, const FrontWeights& weights, const FrontJudge& judge,
                   std::size_t chosen, Loss& loss, FrontWeights* derivatives) const;
    [[nodiscard]] double trust_where_wrong(const TrackBoundaries& boundaries, FrontJudge& judge,
                                           std::size_t chosen) const;

    FrontSearch front_;
    FrontTruth truth_;
    std::vector<FrontJudge::Contender> contenders_;
    std::vector<FrontTruth::Cones> lanes_;
    std::vector<double> risks_;
};

}  // namespace conelane::learning
