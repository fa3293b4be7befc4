#include "learning/training/front_truth.hpp"

#include "evaluation/scoring/divergence.hpp"
#include "evaluation/scoring/score.hpp"
#include "evaluation/world/ground_truth.hpp"

#include <algorithm>

namespace conelane::learning {
namespace {

/// Number of cones in one of the lanes but not in the other, as a share of the true ones.
double cone_error(const FrontTruth::Cones& lane, const FrontTruth::Cones& truth) {
    std::size_t shared = 0;
    for (const Side side : {kLeft, kRight}) {
        for (const Vertex cone : lane[side])
            shared += static_cast<std::size_t>(std::ranges::count(truth[side], cone));
    }
    const std::size_t all = lane[kLeft].size() + lane[kRight].size();
    const std::size_t right = truth[kLeft].size() + truth[kRight].size();
    return std::min(1.0, static_cast<double>(all + right - 2 * shared) / static_cast<double>(right));
}

}  // namespace

void FrontTruth::set(const AnnotatedScene& scene, const FrontMap& map) {
    scene_ = &scene;
    map_ = &map;
    // From cones of the scene to cones of the map.
    std::vector<Vertex> vertex_of(map.size());
    for (Vertex cone = 0; cone < vertex_of.size(); ++cone) vertex_of[map.scene_index(cone)] = cone;
    const auto index_of = index_by_id(scene.scene);
    for (const Side side : {kLeft, kRight}) {
        cones_[side].clear();
        for (const ConeId id : side == kLeft ? scene.ground_truth->left : scene.ground_truth->right) {
            cones_[side].push_back(vertex_of[index_of.at(id)]);
        }
    }
}

LaneOutline FrontTruth::outline(const Cones& lane) const {
    LaneOutline result;
    for (const Vertex cone : lane[kLeft]) result.left.push_back(map_->position(cone));
    for (const Vertex cone : lane[kRight]) result.right.push_back(map_->position(cone));
    return result;
}

LaneOutline FrontTruth::outline_in_world(const Cones& lane) const {
    LaneOutline result;
    const auto place = [&](const std::vector<Vertex>& from, std::vector<Point>& to) {
        for (const Vertex cone : from) to.push_back(scene_->scene.cones[map_->scene_index(cone)].position);
    };
    place(lane[kLeft], result.left);
    place(lane[kRight], result.right);
    return result;
}

double FrontTruth::risk(const Cones& lane, const TrackBoundaries& boundaries,
                        const FrontRiskOptions& options) const {
    if (lane[kLeft].size() < 2 || lane[kRight].size() < 2) return options.worst();
    if (lane == cones_) return 0.0;
    const double iou = intersection_over_union_of_simple(outline(lane), outline(cones_));
    const double risk = 1.0 - iou + options.cones * cone_error(lane, cones_);
    constexpr double kSurelyUsable = 0.985;
    return iou > kSurelyUsable || is_usable(lane, boundaries) ? risk : risk + options.unusable;
}

bool FrontTruth::is_usable(const Cones& lane, const TrackBoundaries& boundaries) const {
    if (lane[kLeft].size() < 2 || lane[kRight].size() < 2) return false;
    const LaneOutline predicted = outline_in_world(lane);
    const LaneOutline truth = outline_in_world(cones_);
    return conelane::is_usable(lane_length_m(predicted), lane_length_m(truth),
                               conelane::divergence_m(predicted, truth, boundaries));
}

std::array<std::size_t, 2> FrontTruth::right_cones(const Cones& lane,
                                                   const TrackBoundaries& boundaries) const {
    const LaneOutline predicted = outline_in_world(lane);
    const LaneOutline truth = outline_in_world(cones_);
    const auto right = [&](const std::vector<Point>& boundary, const std::vector<Point>& annotated,
                           const Point& first) {
        const auto divergence = boundary_divergence(boundary, annotated, boundaries.closed, first);
        return divergence ? divergence->vertex_off : boundary.size();
    };
    return {right(predicted.left, boundaries.left, truth.left.front()),
            right(predicted.right, boundaries.right, truth.right.front())};
}

std::optional<double> FrontTruth::divergence_m(const Cones& lane, const TrackBoundaries& boundaries) const {
    return conelane::divergence_m(outline_in_world(lane), outline_in_world(cones_), boundaries);
}

}  // namespace conelane::learning
