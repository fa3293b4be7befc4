#pragma once

#include "evaluation/scenes/scene_set.hpp"
#include "graph_search/clc/candidate_search.hpp"
#include "graph_search/clc/lane_features.hpp"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace conelane::experiments {

/// The candidates of one scene, as the ranking sees and the training judges them.
struct CandidateList {
    std::string track;
    double false_positive_rate = 0.0;
    double range_m = 0.0;
    std::vector<LaneFeatures> lanes;
    std::vector<double> iou;           ///< of each one with the ground truth
    std::vector<double> divergence_m;  ///< of each one, see divergence.hpp; infinite where it does not
    std::vector<bool> usable;          ///< whether each one can be driven by, see SceneScore::usable

    [[nodiscard]] double best_iou() const;  ///< the ceiling of any ranking; 0 where there is no candidate
};

struct CandidateListOptions {
    CandidateSearchOptions search;
    /// At most so many candidates of a scene are kept, drawn without replacement; 0 keeps all.
    std::size_t max_per_scene = 0;
    std::uint64_t seed = 0;  ///< of that draw, together with the id of the scene
    unsigned threads = 1;    ///< same lists with any number
    bool show_progress = true;
};

/// Enumerates the candidates of every scene of the set that counts, in its order.
[[nodiscard]] std::vector<CandidateList> enumerate_candidates(const SceneSet& set,
                                                              const CandidateListOptions& options);

}  // namespace conelane::experiments
