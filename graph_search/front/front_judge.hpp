#pragma once

#include "graph_search/front/front_features.hpp"
#include "graph_search/front/front_search.hpp"
#include "graph_search/front/front_weights.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace conelane {

/// Compares the best lanes of a search as wholes: which is the best, how certain it is, and how far. It sees
/// what a beam cannot: the least certain cone of a lane, the number of cones inside it, and where the lanes
/// part. Keeps memory from call to call.
class FrontJudge {
  public:
    /// Number of lanes that are compared.
    static constexpr std::size_t kContenders = 20;

    struct Contender {
        std::size_t node;   ///< of the search: the last state before its last stop
        double score;       ///< of the search
        bool ended = true;  ///< false for a lane that was still growing when the time ended
    };
    /// A cone that a lane adds, or its first pair.
    struct Step {
        std::size_t node;
        std::size_t parent;  ///< place among `steps`; FrontSearch::kNone of the first pair
        RightInputs inputs;
        double right;  ///< probability that it is right where all before it are
    };

    /// Throws as `validate`.
    explicit FrontJudge(const FrontWeights& weights);

    /// The bonuses of FrontEvidence count when the contenders are ordered, and nowhere else: the networks do
    /// not see them.
    ///
    /// Precondition: at least one contender and at most kContenders, the one with the highest score first,
    /// each with at least two cones a side.
    void compare(FrontSearch& search, std::span<const Contender> contenders);

    /// Indices of the contenders, the best first; of equal ones the earlier one.
    [[nodiscard]] std::span<const std::size_t> order() const { return order_; }
    /// Probability that the contender is usable.
    [[nodiscard]] double confidence(std::size_t contender) const;
    /// The contender up to one of its cones.
    struct Reach {
        double trust;  ///< probability that it is usable and all its cones so far are right
        /// How far a lane is trusted that is trusted up to this cone: half a metre less than the boundary
        /// that is shorter so far, for the next cone may be off beside the right one. At the last cone the
        /// whole length, the mean of both boundaries.
        double trusted_m;
    };
    /// Cone by cone, the first pair first; trust never rises. `cones`: how many of each boundary count. Valid
    /// until the next call.
    [[nodiscard]] std::span<const Reach> reaches(const FrontSearch& search, std::size_t contender,
                                                 const std::array<std::size_t, 2>& cones);
    /// How far the contender is trusted: up to the last cone whose trust is least_trust of the scene's set
    /// of weights. Where covariances of positions are known, an uncertain cone lowers the trust more.
    [[nodiscard]] double trusted_m(const FrontSearch& search, std::size_t contender,
                                   const std::array<std::size_t, 2>& cones);

    // For training.
    [[nodiscard]] const WholeLaneFeatures& features(std::size_t contender) const {
        return features_[contender];
    }
    [[nodiscard]] double rank(std::size_t contender) const { return rank_[contender]; }
    [[nodiscard]] std::span<const Step> steps() const { return steps_; }
    /// Indices in `steps` of a contender's steps, the first pair first.
    [[nodiscard]] const std::vector<std::uint32_t>& path(std::size_t contender) const {
        return paths_[contender];
    }

  private:
    /// A segment of a boundary, whichever lanes it is on.
    struct Shared {
        std::uint64_t segment;  ///< side and both cones
        std::uint32_t step;
        std::uint32_t contenders;  ///< a bit each
    };
    void find_steps(const FrontSearch& search, std::span<const Contender> contenders);
    void find_shared(FrontSearch& search);
    void see_cones(FrontSearch& search);
    void see_lane(FrontSearch& search, const Contender& lane, std::size_t contender);

    struct Networks {
        explicit Networks(const FrontWeightSet& weights);
        FrontNetwork rank;
        FrontNetwork usable;
        FrontNetwork right;
        double least_trust;
    };
    /// The networks for the scene of the last call of `compare`.
    [[nodiscard]] const Networks& networks() const { return sees_colors_ ? *colored_ : plain_; }

    Networks plain_;
    std::optional<Networks> colored_;
    bool sees_colors_ = false;  ///< whether the scene has colors and there are weights for them
    std::vector<Step> steps_;
    std::vector<std::uint32_t> step_of_node_;
    std::vector<std::uint32_t> on_contenders_;  ///< of each step: a bit for each lane that shares its segment
    std::vector<float> min_share_;              ///< by step: the least share up to and with it
    std::vector<Shared> shared_;
    std::array<std::vector<std::uint32_t>, kContenders> paths_;
    std::vector<double> scores_;  ///< of the contenders, without bonus
    std::array<double, kContenders> probability_{};
    std::array<double, kContenders> rank_{};
    std::array<WholeLaneFeatures, kContenders> features_{};
    std::vector<Reach> reaches_;
    std::vector<std::size_t> order_;
    double expected_m_ = 0.0;  ///< length of both boundaries together, weighted by probability
};

}  // namespace conelane
