#pragma once

#include "graph_search/front/front_judge.hpp"
#include "learning/training/front_learner.hpp"

#include <cstddef>
#include <optional>
#include <vector>

namespace conelane::learning {

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
