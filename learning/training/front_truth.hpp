#pragma once

#include "evaluation/scoring/lane_iou.hpp"
#include "evaluation/world/annotated_scene.hpp"
#include "evaluation/world/track.hpp"
#include "graph_search/front/front_map.hpp"

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

namespace conelane::learning {

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

}  // namespace conelane::learning
