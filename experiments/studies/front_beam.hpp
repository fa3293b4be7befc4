#pragma once

#include "evaluation/formats/scene_set.hpp"
#include "graph_search/front/front_search.hpp"

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace conelane::experiments {

class Study;

/// The effect of a wider beam, and of the judge.
[[nodiscard]] std::unique_ptr<Study> make_front_beam_study();

struct FrontBeamOptions {
    FrontWeights weights;
    std::vector<std::size_t> beams{5, 10, 15, 30, 100};  ///< states a level, with the detector's other limits
    /// The last row except for those of `exhaustive_ms`: the widest search, with which the others are
    /// compared.
    std::size_t reference_beam = 400;
    double reference_drop = 12.0;
    /// A row for each: the search that leaves nothing out (no drop, no merge), stopped after this time.
    std::vector<double> exhaustive_ms;
};

/// One width over all scenes with a ground truth. Shares are of these.
struct FrontBeamRow {
    std::size_t beam = 0;  ///< 0: no limit
    double drop = 0.0;     ///< infinity: none
    std::size_t scenes = 0;
    double proven = 0.0;        ///< share whose search left nothing out: no lane has a higher score
    double best_score = 0.0;    ///< share with a lane of the highest score that any row has met
    double first_usable = 0.0;  ///< by score alone
    double usable = 0.0;        ///< as the judge orders the best lanes
    double any_usable = 0.0;    ///< share with a usable lane among those judged
    double iou = 0.0;           ///< mean, of the judge's first lane
    double median_ms = 0.0;     ///< of search and judge together
    double p95_ms = 0.0;
    double worst_ms = 0.0;
};

/// Throws InvalidInput if a width or drop is out of range, or no scene has a ground truth.
[[nodiscard]] std::vector<FrontBeamRow> front_beam_rows(const SceneSet& set, const FrontBeamOptions& options);

}  // namespace conelane::experiments
