#pragma once

#include "evaluation/formats/scene_set.hpp"
#include "graph_search/clc/candidate_search.hpp"
#include "graph_search/clc/lane_features.hpp"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace conelane::learning {

/// The candidates of one scene with their features and their quality for the training.
struct CandidateList {
    std::string track;
    double false_positive_rate = 0.0;
    double range_m = 0.0;
    std::vector<LaneFeatures> lanes;
    std::vector<double> iou;           ///< of each one with the ground truth
    std::vector<double> divergence_m;  ///< of each one, see divergence.hpp; infinite if it does not diverge
    std::vector<bool> usable;          ///< whether each one can be driven by, see SceneScore::usable

    [[nodiscard]] double best_iou() const;  ///< the best possible result of a ranking; 0 without candidates
};

struct CandidateListOptions {
    CandidateSearchOptions search;
    /// Largest number of candidates of a scene, drawn without replacement; 0 keeps all.
    std::size_t max_per_scene = 0;
    std::uint64_t seed = 0;  ///< of that draw, together with the id of the scene
    unsigned threads = 1;    ///< same lists with any number
    bool show_progress = true;
};

/// Enumerates the candidates of every scene of the set that counts, in its order.
[[nodiscard]] std::vector<CandidateList> enumerate_candidates(const SceneSet& set,
                                                              const CandidateListOptions& options);

}  // namespace conelane::learning
