#include "evaluation/scoring/score.hpp"

#include "conelane/drivable_lane.hpp"
#include "conelane/invalid_input.hpp"
#include "evaluation/scoring/divergence.hpp"

#include <iterator>
#include <limits>
#include <numbers>
#include <set>

namespace conelane {
namespace {

/// Position relative to a centre line: distance, and heading of the line there.
struct Beside {
    double distance_m;
    double heading_rad;
};

/// Nothing if `point` is before the beginning of the line or past its end.
std::optional<Beside> beside(const Point& point, std::span<const CentreLinePoint> line) {
    std::optional<Beside> nearest;
    bool is_beyond = false;
    for (std::size_t i = 0; i + 1 < line.size(); ++i) {
        const Segment segment{line[i].position, line[i + 1].position};
        const FootPoint foot = foot_point(point, segment);
        if (nearest && nearest->distance_m <= foot.distance_m) continue;
        const double turn_rad =
            std::remainder(line[i + 1].heading_rad - line[i].heading_rad, 2.0 * std::numbers::pi);
        nearest = Beside{foot.distance_m, line[i].heading_rad + foot.parameter * turn_rad};
        const bool is_end =
            (i == 0 && foot.parameter <= 0.0) || (i + 2 == line.size() && foot.parameter >= 1.0);
        const double along_m = std::abs((point - foot.point).dot((segment.to - segment.from).normalized()));
        is_beyond = is_end && along_m > 0.5 * kCentreLineStep_m;
    }
    if (is_beyond) return std::nullopt;
    return nearest;
}

std::size_t points_of(double length_m) {
    return static_cast<std::size_t>(std::lround(length_m / kCentreLineStep_m)) + 1;
}

/// Positions of a scene's cones by id.
class ConePositions {
  public:
    explicit ConePositions(const Scene& scene) : scene_id_(scene.id) {
        for (const Cone& cone : scene.cones) position_of_.emplace(cone.id, cone.position);
    }
    /// Throws InvalidInput if an id is not in the scene; its key is "PREFIXleft[i]" or "PREFIXright[i]".
    [[nodiscard]] LaneOutline outline(const Lane& lane, const std::string& prefix) const {
        return {boundary(lane.left, prefix + "left"), boundary(lane.right, prefix + "right"), lane.closed};
    }

  private:
    [[nodiscard]] std::vector<Point> boundary(const std::vector<ConeId>& ids, const std::string& key) const {
        std::vector<Point> vertices;
        vertices.reserve(ids.size());
        for (std::size_t i = 0; i < ids.size(); ++i) {
            const auto found = position_of_.find(ids[i]);
            if (found == position_of_.end()) {
                throw InvalidInput(
                    key + "[" + std::to_string(i) + "]",
                    "cone " + std::to_string(ids[i]) + " is not in scene \"" + scene_id_ + "\"");
            }
            vertices.push_back(found->second);
        }
        return vertices;
    }

    std::string scene_id_;
    std::unordered_map<ConeId, Point> position_of_;  // for look-up only
};

bool differs_by_one_cone_at_most(const Lane& lane, const Lane& ground_truth) {
    const auto cones = [](const Lane& of) {
        std::set<ConeId> ids(of.left.begin(), of.left.end());
        ids.insert(of.right.begin(), of.right.end());
        return ids;
    };
    std::vector<ConeId> different;
    std::ranges::set_symmetric_difference(cones(lane), cones(ground_truth), std::back_inserter(different));
    return different.size() <= kAllowedConeDifference;
}

/// A single vertex is an edge of zero length.
std::vector<Segment> edges(const std::vector<Point>& vertices, bool closed) {
    std::vector<Segment> result;
    if (vertices.size() == 1) result.push_back({vertices.front(), vertices.front()});
    for (std::size_t i = 1; i < vertices.size(); ++i) result.push_back({vertices[i - 1], vertices[i]});
    if (closed && vertices.size() > 2) result.push_back({vertices.back(), vertices.front()});
    return result;
}

bool is_each_on_its_side(const LaneOutline& lane, const Pose& pose) {
    const auto offset_m = [&](const std::vector<Point>& boundary) {
        return pose.left_m(foot_on_polyline(pose.position, boundary, lane.closed).point);
    };
    return offset_m(lane.left) > 0.0 && offset_m(lane.right) < 0.0;
}

bool is_free_of_crossings(const LaneOutline& lane) {
    std::vector<Segment> all = edges(lane.left, lane.closed);
    const std::vector<Segment> right = edges(lane.right, lane.closed);
    all.insert(all.end(), right.begin(), right.end());
    for (std::size_t i = 0; i < all.size(); ++i) {
        for (std::size_t j = i + 1; j < all.size(); ++j) {
            if (segments_cross(all[i], all[j])) return false;
        }
    }
    return true;
}

bool is_width_kept(const LaneOutline& lane) {
    double narrowest_m = std::numeric_limits<double>::infinity();
    for (const Segment& left : edges(lane.left, lane.closed)) {
        for (const Segment& right : edges(lane.right, lane.closed)) {
            narrowest_m = std::min(narrowest_m, segment_distance(left, right).distance_m);
        }
    }
    const auto near_enough = [&](const std::vector<Point>& side, const std::vector<Point>& other) {
        return std::ranges::all_of(side, [&](const Point& vertex) {
            return foot_on_polyline(vertex, other, lane.closed).distance_m <= kMaxLaneWidth_m;
        });
    };
    return narrowest_m >= kMinLaneWidth_m && near_enough(lane.left, lane.right) &&
           near_enough(lane.right, lane.left);
}

Accuracy accuracy_of(const Lane& lane, const LaneOutline& outline, const Lane& ground_truth,
                     const Pose& pose) {
    Accuracy result;
    result.cones = differs_by_one_cone_at_most(lane, ground_truth);
    result.crossings = is_free_of_crossings(outline);
    // A boundary without cones is on neither side and has no distance.
    if (!outline.left.empty() && !outline.right.empty()) {
        result.sides = is_each_on_its_side(outline, pose);
        result.width = is_width_kept(outline);
    }
    return result;
}

EnumerationScore score_of(const Enumeration& enumeration, const ConePositions& positions,
                          const LaneOutline& ground_truth) {
    EnumerationScore result;
    result.iterations = enumeration.iterations;
    result.complete = enumeration.complete;
    for (std::size_t i = 0; i < enumeration.candidates.size(); ++i) {
        const LaneCandidate& candidate = enumeration.candidates[i];
        const double iou = intersection_over_union(
            positions.outline(candidate.lane, "candidates[" + std::to_string(i) + "]."), ground_truth);
        result.best_iou = std::max(result.best_iou.value_or(0.0), iou);
        if (iou >= kNearGroundTruthIou) {
            std::optional<std::int64_t>& first = result.first_near_ground_truth_iteration;
            first = std::min(first.value_or(candidate.iteration), candidate.iteration);
        }
    }
    return result;
}

Category category_of(const SceneScore& score, bool equals_ground_truth) {
    if (equals_ground_truth) return Category::ground_truth;
    if (score.divergence_distance_m) {
        return *score.divergence_distance_m < kCriticalDivergence_m ? Category::diverging_below_20
                                                                    : Category::diverging_from_20;
    }
    return score.lane_length_m < kTooShortShare * score.ground_truth_length_m ? Category::too_short
                                                                              : Category::near_ground_truth;
}

bool has_ground_truth(const AnnotatedScene& scene) {
    return scene.ground_truth && scene.ground_truth->left.size() >= 2 &&
           scene.ground_truth->right.size() >= 2;
}

/// The truth that the lanes of a scene are compared with.
class Truth {
  public:
    /// Throws InvalidInput if the scene does not count.
    Truth(const AnnotatedScene& scene, const TrackBoundaries* boundaries)
        : pose_(scene.scene.pose), boundaries_(boundaries) {
        if (has_ground_truth(scene)) {
            ground_truth_ = ConePositions(scene.scene).outline(*scene.ground_truth, "ground_truth.");
            length_m_ = lane_length_m(ground_truth_);
            return;
        }
        if (boundaries != nullptr) {
            driven_ = driven_ahead(scene.scene, boundaries->driven, scene.range_m);
            length_m_ = polyline_length_m(driven_);
        }
        if (driven_.empty() || length_m_ < kMinDriven_m) {
            throw InvalidInput("ground_truth",
                               "scene \"" + scene.scene.id + "\" needs at least two cones on each side");
        }
    }

    [[nodiscard]] SceneScore nothing_found(double latency_ms) const {
        SceneScore score;
        score.latency_ms = latency_ms;
        score.ground_truth_length_m = length_m_;
        score.divergence_known = boundaries_ != nullptr;
        if (driven_.empty()) score.iou = 0.0;
        return score;
    }

    void judge(const LaneOutline& lane, bool equals_ground_truth, SceneScore& score) const {
        score.lane_length_m = lane_length_m(lane);
        if (!driven_.empty()) {
            score.divergence_distance_m = driven_divergence_m(lane, driven_);
        } else {
            score.iou = intersection_over_union(lane, ground_truth_);
            if (boundaries_ != nullptr)
                score.divergence_distance_m = divergence_m(lane, ground_truth_, *boundaries_);
        }
        score.category = category_of(score, equals_ground_truth);
    }

    void judge(std::span<const Point> centre_line, SceneScore& score) const {
        const std::vector<Point> truth =
            driven_.empty() ? positions_of(centre_line_of(ground_truth_, pose_, length_m_)) : driven_;
        const Follow follow = follow_of(centre_line, truth);
        score.lane_length_m = follow.length_m;
        if (boundaries_ != nullptr && follow.leaves) score.divergence_distance_m = follow.length_m;
        score.category = category_of(score, false);
    }

    /// Empty sides if the scene has only the driven path.
    [[nodiscard]] const LaneOutline& ground_truth() const { return ground_truth_; }

  private:
    static std::vector<Point> positions_of(const CentreLine& line) {
        std::vector<Point> positions;
        positions.reserve(line.size());
        for (const CentreLinePoint& point : line) positions.push_back(point.position);
        return positions;
    }

    /// How far the line follows the true line, as arc length of the true line, and whether it then leaves it.
    struct Follow {
        double length_m = 0.0;
        bool leaves = false;
    };
    /// Walks the line in short steps: what lies between two of its points counts too. The foot of a step is
    /// looked for near that of the step before, as in boundary_divergence, so a leap, a way back or the
    /// neighbouring stretch of a hairpin leave the true line.
    static Follow follow_of(std::span<const Point> line, std::span<const Point> truth) {
        constexpr double kStep_m = 0.1;
        constexpr double kRounding_m = 1e-6;
        Follow follow;
        if (truth.size() < 2) return {0.0, true};
        std::vector<double> arc_m{0.0};
        for (std::size_t i = 1; i < truth.size(); ++i)
            arc_m.push_back(arc_m.back() + (truth[i] - truth[i - 1]).norm());
        const Point first_way = (truth[1] - truth[0]).normalized();
        double least_m = 0.0;
        double most_m = kFirstFootAhead_m;
        for (std::size_t i = 0; i < line.size(); ++i) {
            const Point& from = line[i == 0 ? 0 : i - 1];
            const Point way = line[i] - from;
            const double way_m = std::hypot(way.x(), way.y());  // norm() overflows
            double on_m = std::min(kStep_m, way_m);
            while (true) {
                const Point point = on_m < way_m ? from + on_m / way_m * way : line[i];
                const auto first = std::ranges::upper_bound(arc_m, least_m) - arc_m.begin() - 1;
                const auto last = std::ranges::lower_bound(arc_m, most_m) - arc_m.begin();
                const auto count =
                    std::min<std::ptrdiff_t>(last, static_cast<std::ptrdiff_t>(arc_m.size()) - 1) - first + 1;
                const PolylineFoot foot = foot_on_polyline(
                    point, truth.subspan(static_cast<std::size_t>(first), static_cast<std::size_t>(count)));
                const double foot_m = arc_m[static_cast<std::size_t>(first)] + foot.arc_length_m;
                // Shortly before the beginning of the true line, only the lateral offset counts.
                const bool is_before = foot_m <= 0.0 && foot.distance_m <= kFirstFootBack_m;
                const double off_m =
                    is_before ? std::abs(cross(first_way, point - truth[0])) : foot.distance_m;
                const bool leaps = foot_m < least_m || foot_m > most_m;
                if (leaps || !(off_m <= kOffCentreLine_m)) return {follow.length_m, true};
                follow.length_m = std::max(follow.length_m, foot_m);
                // Beyond the end is the unknown part.
                if (foot_m >= arc_m.back() - kRounding_m) return {arc_m.back(), false};
                least_m = std::max(0.0, follow.length_m - kFootBack_m);
                most_m = follow.length_m + kFootPerChord * kStep_m + kFootAhead_m;
                if (on_m >= way_m) break;
                on_m = std::min(on_m + kStep_m, way_m);
            }
        }
        return follow;
    }

    Pose pose_;
    const TrackBoundaries* boundaries_;
    LaneOutline ground_truth_;
    std::vector<Point> driven_;  ///< empty if there is a ground truth
    double length_m_ = 0.0;
};

/// Share of yes among the scenes with a known answer; nothing if no answer is known. The other scenes do not
/// count.
template <typename Of>
std::optional<double> share_among_known(std::span<const SceneScore> scores, Of of) {
    std::size_t known = 0;
    std::size_t yes = 0;
    for (const SceneScore& score : scores) {
        const std::optional<bool> answer = of(score);
        if (answer) ++known;
        if (answer.value_or(false)) ++yes;
    }
    if (known == 0) return std::nullopt;
    return static_cast<double>(yes) / static_cast<double>(known);
}

/// The errors of all centre lines of a sample.
class Steering {
  public:
    void add(const SceneScore& score) {
        if (!score.centre_line_error) return;
        const CentreLineError& error = *score.centre_line_error;
        lateral_m_.insert(lateral_m_.end(), error.lateral_m.begin(), error.lateral_m.end());
        if (error.heading_rad) heading_rad_.push_back(*error.heading_rad);
    }
    void summarise(ScoreSummary& summary) const {
        constexpr double kMax = 0.95;
        if (!lateral_m_.empty()) {
            summary.lateral_median_m = median(lateral_m_);
            summary.lateral_p95_m = quantile(lateral_m_, kMax);
        }
        if (!heading_rad_.empty()) {
            summary.heading_median_rad = median(heading_rad_);
            summary.heading_p95_rad = quantile(heading_rad_, kMax);
        }
    }

  private:
    std::vector<double> lateral_m_;
    std::vector<double> heading_rad_;
};

/// Share of all scenes for which `holds`; nothing if no scene is `known`. Unknown scenes count as
/// failures.
template <typename Known, typename Holds>
std::optional<double> share_of_all(std::span<const SceneScore> scores, Known known, Holds holds) {
    if (std::ranges::none_of(scores, known)) return std::nullopt;
    return static_cast<double>(std::ranges::count_if(scores, holds)) / static_cast<double>(scores.size());
}

}  // namespace

CentreLine centre_line_of(const LaneOutline& outline, const Pose& pose, double length_m) {
    Scene scene;
    scene.pose = pose;
    Lane lane;
    lane.closed = outline.closed;
    const auto add = [&scene](const std::vector<Point>& vertices, std::vector<ConeId>& ids) {
        for (const Point& vertex : vertices) {
            ids.push_back(static_cast<ConeId>(scene.cones.size()));
            scene.cones.push_back({.id = ids.back(), .position = vertex});
        }
    };
    add(outline.left, lane.left);
    add(outline.right, lane.right);
    CentreLine line;
    if (lane.left.empty() || lane.right.empty()) return line;
    try {
        const DrivableLane driven = drivable(lane, scene, {.step_m = kCentreLineStep_m});
        const std::size_t count = std::min(points_of(length_m), driven.points.size());
        line.reserve(count);
        for (const DrivablePoint& point : std::span(driven.points).first(count))
            line.push_back({point.position, point.heading_rad});
    } catch (const InvalidInput&) {
        line.clear();  // for example a boundary of 20 km: nothing can be driven
    }
    return line;
}

CentreLine centre_line_of(std::span<const Point> polyline, const Pose& pose, double length_m) {
    CentreLine line;
    if (polyline.size() < 2) return line;
    const PolylineFoot foot = foot_on_polyline(pose.position, polyline);
    std::size_t segment = foot.segment;
    Point at = foot.point;
    double left_m = 0.0;  // distance to the next point of the line
    const std::size_t most = points_of(length_m);
    while (line.size() < most && segment + 1 < polyline.size()) {
        const Point way = polyline[segment + 1] - at;
        const double way_m = way.norm();
        if (way_m <= left_m) {
            left_m -= way_m;
            at = polyline[++segment];
            continue;
        }
        at += left_m / way_m * way;
        line.push_back({at, std::atan2(way.y(), way.x())});
        left_m = kCentreLineStep_m;
    }
    return line;
}

CentreLineError centre_line_error(std::span<const CentreLinePoint> lane,
                                  std::span<const CentreLinePoint> truth) {
    CentreLineError error;
    const std::size_t count = std::min(points_of(kCentreLineStretch_m), lane.size());
    const std::size_t heading_at = points_of(kHeadingAt_m) - 1;
    for (std::size_t i = 0; i < count; ++i) {
        const std::optional<Beside> true_line = beside(lane[i].position, truth);
        if (!true_line) continue;
        error.lateral_m.push_back(static_cast<float>(true_line->distance_m));
        if (i == heading_at) {
            error.heading_rad = std::abs(
                std::remainder(lane[i].heading_rad - true_line->heading_rad, 2.0 * std::numbers::pi));
        }
    }
    return error;
}

bool is_steady(std::span<const CentreLinePoint> before, std::span<const CentreLinePoint> now) {
    std::size_t compared = 0;
    for (const CentreLinePoint& point : now) {
        const std::optional<Beside> earlier = beside(point.position, before);
        if (!earlier) continue;
        if (earlier->distance_m > kSteady_m) return false;
        if (++compared == points_of(kSteadyStretch_m)) break;
    }
    return compared > 0;
}

std::string_view to_string(Category category) {
    constexpr std::array<std::string_view, kCategoryCount> kNames{
        "none", "ground_truth", "diverging_below_20", "diverging_from_20", "too_short", "near_ground_truth"};
    return kNames[static_cast<std::size_t>(category)];
}

bool is_success(Category category) {
    return category != Category::none && category != Category::diverging_below_20;
}

bool is_usable(double lane_length_m, double ground_truth_length_m,
               std::optional<double> divergence_distance_m) {
    if (divergence_distance_m) return *divergence_distance_m >= kCriticalDivergence_m;
    return lane_length_m >= std::min(kUsableLength_m, kTooShortShare * ground_truth_length_m);
}

LaneOutline outline_of(const Lane& lane, const Scene& scene) {
    return ConePositions(scene).outline(lane, "");
}

bool counts(const AnnotatedScene& scene, const TrackBoundaries* boundaries) {
    return has_ground_truth(scene) ||
           (boundaries != nullptr && !boundaries->driven.empty() &&
            polyline_length_m(driven_ahead(scene.scene, boundaries->driven, scene.range_m)) >= kMinDriven_m);
}

std::optional<bool> SceneScore::usable() const {
    if (!divergence_known) return std::nullopt;
    if (category == Category::ground_truth) return true;
    if (!success()) return false;
    return is_usable(lane_length_m, ground_truth_length_m, divergence_distance_m);
}

SceneScore score(const AnnotatedScene& scene, const LaneAnswer& answer, double latency_ms,
                 std::optional<std::size_t> nearest, const TrackBoundaries* boundaries) {
    const Truth truth(scene, boundaries);
    const ConePositions positions(scene.scene);
    const bool found =
        answer.status == LaneStatus::found && !answer.lane.left.empty() && !answer.lane.right.empty();

    SceneScore result = truth.nothing_found(latency_ms);
    result.error = answer.status == LaneStatus::error;
    if (answer.optimality) {
        result.solved_to_optimality =
            found && latency_ms <= kRldTimeLimit_ms &&
            answer.optimality->objective - answer.optimality->bound <= kRldAbsoluteGap;
    }
    if (answer.enumeration)
        result.enumeration = score_of(*answer.enumeration, positions, truth.ground_truth());
    std::optional<Lane> of_cone_set;
    if (has_ground_truth(scene))
        of_cone_set = nearest ? ground_truth_of_nearest(scene, *nearest) : scene.ground_truth;
    if (of_cone_set) result.accuracy = Accuracy{};
    if (!found) return result;

    const LaneOutline lane = positions.outline(answer.lane, "");
    truth.judge(lane, answer.lane == scene.ground_truth, result);
    result.confidence = answer.confidence;
    result.trusted_m = answer.trusted_m;
    if (of_cone_set) result.accuracy = accuracy_of(answer.lane, lane, *of_cone_set, scene.scene.pose);
    return result;
}

SceneScore score_outline(const AnnotatedScene& scene, const LaneOutline& lane, double latency_ms,
                         const TrackBoundaries* boundaries) {
    const Truth truth(scene, boundaries);
    SceneScore result = truth.nothing_found(latency_ms);
    if (!lane.left.empty() && !lane.right.empty()) truth.judge(lane, false, result);
    return result;
}

SceneScore score_centre_line(const AnnotatedScene& scene, std::span<const Point> centre_line,
                             double latency_ms, const TrackBoundaries* boundaries) {
    const Truth truth(scene, boundaries);
    SceneScore result = truth.nothing_found(latency_ms);
    result.iou.reset();
    if (!centre_line.empty()) truth.judge(centre_line, result);
    return result;
}

ScoreSummary summarise(std::span<const SceneScore> scores) {
    if (scores.empty()) throw InvalidInput("scores", "there is nothing to summarise");
    ScoreSummary result;
    result.scenes = scores.size();
    std::array<std::size_t, kCategoryCount> of_category{};
    std::size_t successes = 0;
    std::size_t accurate = 0;
    double best_iou_sum = 0.0;
    Steering steering;
    std::vector<double> ious;
    std::vector<double> latencies_ms;
    for (const SceneScore& score : scores) {
        ++of_category[static_cast<std::size_t>(score.category)];
        if (score.error) ++result.errors;
        if (score.trained_on) ++result.trained_on;
        if (!score.divergence_known) ++result.divergence_unknown;
        if (score.success()) ++successes;
        if (score.accuracy) ++result.accuracy_scenes;
        if (score.accurate()) ++accurate;
        if (score.enumeration) best_iou_sum += score.enumeration->best_iou.value_or(0.0);
        if (score.iou) ious.push_back(*score.iou);
        steering.add(score);
        if (const auto usable = score.usable()) {
            if (score.confidence) result.calibration.add(*score.confidence, *usable);
            if (score.confidence && score.trusted_m) {  // otherwise it is a rule, which is not calibrated
                result.calibration.add_trust(*score.trusted_m, score.lane_length_m,
                                             score.divergence_distance_m);
            }
        }
        latencies_ms.push_back(score.latency_ms);
    }
    const auto count = static_cast<double>(scores.size());
    for (std::size_t i = 0; i < kCategoryCount; ++i) {
        result.category_share[i] = static_cast<double>(of_category[i]) / count;
    }
    result.success_share = static_cast<double>(successes) / count;
    result.usable_share = share_among_known(scores, [](const SceneScore& score) { return score.usable(); });
    const std::optional<double> steady_share =
        share_among_known(scores, [](const SceneScore& score) { return score.steady; });
    if (steady_share) result.unsteady_share = 1.0 - *steady_share;
    steering.summarise(result);
    if (!ious.empty()) result.mean_iou = mean(ious);
    if (result.accuracy_scenes > 0) {
        result.accurate_share = static_cast<double>(accurate) / static_cast<double>(result.accuracy_scenes);
    }
    result.solved_share = share_of_all(
        scores, [](const SceneScore& score) { return score.solved_to_optimality.has_value(); },
        [](const SceneScore& score) { return score.solved_to_optimality.value_or(false); });
    result.complete_share = share_of_all(
        scores, [](const SceneScore& score) { return score.enumeration.has_value(); },
        [](const SceneScore& score) { return score.enumeration && score.enumeration->complete; });
    result.best_candidate_near_share = share_of_all(
        scores, [](const SceneScore& score) { return score.enumeration && score.enumeration->best_iou; },
        [](const SceneScore& score) {
            return score.enumeration && score.enumeration->best_iou.value_or(0.0) >= kNearGroundTruthIou;
        });
    if (result.best_candidate_near_share) result.best_candidate_mean_iou = best_iou_sum / count;
    result.latency = latency_statistics(latencies_ms);
    return result;
}

}  // namespace conelane
