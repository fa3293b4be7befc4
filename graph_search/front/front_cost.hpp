#pragma once

#include "graph_search/front/front_features.hpp"
#include "graph_search/front/front_state.hpp"
#include "graph_search/front/front_weights.hpp"

#include <array>
#include <optional>
#include <span>
#include <vector>

namespace conelane {

/// Judges starts and moves; the score of a lane is the sum of theirs, a high one is good. Keeps memory from
/// call to call.
class FrontCost {
  public:
    /// Throws as `validate`.
    explicit FrontCost(const FrontWeights& weights);

    /// Scores of all pairs, in their order.
    [[nodiscard]] std::span<const float> score_starts(FrontMap& map, const FrontStarts& starts);
    /// Scores of all extensions, in their order, then of stopping where the side may stop.
    [[nodiscard]] std::span<const float> score_moves(FrontMap& map, const FrontState& state, Side side,
                                                     const FrontMoves& moves);

    // The features that the last call of score_moves computed.
    [[nodiscard]] const StateFeatures& state_features_seen() const { return state_; }
    [[nodiscard]] std::span<const float> extend_features_seen() const { return extensions_; }
    [[nodiscard]] const StopFeatures& stop_features_seen() const { return stop_; }
    /// The features of the last call of score_starts: two rows for each pair, the left boundary's first.
    [[nodiscard]] std::span<const float> start_features_seen() const { return starts_; }

  private:
    struct Networks {
        explicit Networks(const FrontWeightSet& weights);
        FrontNetwork extend;
        FrontNetwork stop;
        FrontNetwork start;
    };
    [[nodiscard]] const Networks& networks_for(const FrontMap& map) const {
        return colored_ && map.has_colors() ? *colored_ : plain_;
    }

    Networks plain_;
    std::optional<Networks> colored_;
    StateFeatures state_{};
    StopFeatures stop_{};
    std::vector<float> extensions_;
    std::vector<float> starts_;
    std::vector<float> scores_;
    std::array<std::vector<StartCone>, 2> start_cones_;
};

}  // namespace conelane
