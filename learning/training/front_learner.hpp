#pragma once

#include "evaluation/world/annotated_scene.hpp"
#include "evaluation/world/track.hpp"
#include "graph_search/front/front_search.hpp"
#include "learning/training/front_truth.hpp"

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace conelane::learning {

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

}  // namespace conelane::learning
