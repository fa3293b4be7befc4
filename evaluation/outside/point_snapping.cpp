#include "evaluation/outside/point_snapping.hpp"

#include "evaluation/input_error.hpp"
#include "evaluation/outside/outside_program.hpp"
#include "evaluation/world/ground_truth.hpp"
#include "model/geometry.hpp"

#include <algorithm>
#include <optional>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include <fmt/format.h>

namespace conelane {
namespace {

/// The cones that the points represent; nothing if a point is at no cone.
std::optional<std::vector<ConeId>> cones_at(const std::vector<Point>& points, const Scene& scene) {
    std::vector<ConeId> ids;
    std::unordered_set<ConeId> taken;
    for (const Point& point : points) {
        const Cone* nearest = nullptr;
        double nearest_m = kSnapReach_m;
        for (const Cone& cone : scene.cones) {
            const double distance_m = (cone.position - point).norm();
            if (distance_m < nearest_m || (nearest == nullptr && distance_m == nearest_m)) {
                nearest = &cone;
                nearest_m = distance_m;
            }
        }
        if (nearest == nullptr) return std::nullopt;
        if (taken.insert(nearest->id).second) ids.push_back(nearest->id);
    }
    return ids;
}

std::string fault_of_ids(const char* key, const std::vector<ConeId>& ids,
                         const std::unordered_set<ConeId>& of_scene) {
    std::unordered_set<ConeId> seen;
    for (const ConeId id : ids) {
        if (!of_scene.contains(id)) return fmt::format("{}: no cone of the scene has id {}", key, id);
        if (!seen.insert(id).second) return fmt::format("{}: cone {} is there twice", key, id);
    }
    return "";
}

std::string fault_of_points(const char* key, const std::vector<Point>& points) {
    if (points.size() > kMaxPoints)
        return fmt::format("{}: {} points are more than {}", key, points.size(), kMaxPoints);
    for (const Point& point : points) {
        if (point.cwiseAbs().maxCoeff() > kMaxCoordinate_m)
            return fmt::format("{}: a point is farther than {} m", key, kMaxCoordinate_m);
    }
    return "";
}

struct Edge {
    Segment segment;
    bool of_left;
};

/// The edges of both boundaries with a positive length.
std::vector<Edge> edges_of(const LaneRecord& record, const Scene& scene) {
    std::vector<Edge> edges;
    const auto add = [&edges](const std::vector<Point>& vertices, bool of_left) {
        for (std::size_t i = 1; i < vertices.size(); ++i) {
            if (vertices[i - 1] != vertices[i]) edges.push_back({{vertices[i - 1], vertices[i]}, of_left});
        }
    };
    const auto positions = [&, index_of = index_by_id(scene)](const std::vector<ConeId>& ids) {
        std::vector<Point> all;
        for (const ConeId id : ids) all.push_back(scene.cones[index_of.at(id)].position);
        return all;
    };
    const Lane& lane = record.answer.lane;
    add(record.points ? record.points->left : positions(lane.left), true);
    add(record.points ? record.points->right : positions(lane.right), false);
    return edges;
}

}  // namespace

void snap_to_cones(LaneRecord& record, const Scene& scene) {
    if (!record.points) return;
    auto left = cones_at(record.points->left, scene);
    if (!left) return;
    auto right = cones_at(record.points->right, scene);
    if (!right) return;
    record.answer.lane.left = *std::move(left);
    record.answer.lane.right = *std::move(right);
    record.points.reset();
}

std::string fault_of(const LaneRecord& record, const Scene& scene) {
    std::unordered_set<ConeId> ids;
    for (const Cone& cone : scene.cones) ids.insert(cone.id);
    static const std::vector<Point> kNone;
    const Lane& lane = record.answer.lane;
    for (std::string fault : {fault_of_ids("left", lane.left, ids), fault_of_ids("right", lane.right, ids),
                              fault_of_points("left_points", record.points ? record.points->left : kNone),
                              fault_of_points("right_points", record.points ? record.points->right : kNone),
                              fault_of_points("centre_line", record.centre_line)}) {
        if (!fault.empty()) return fault;
    }
    return "";
}

std::string tangle_of(const LaneRecord& record, const Scene& scene) {
    const std::vector<Edge> edges = edges_of(record, scene);
    std::size_t meetings = 0;
    for (std::size_t i = 0; i < edges.size(); ++i) {
        for (std::size_t j = i + 1; j < edges.size(); ++j) {
            const bool are_neighbours = j == i + 1 && edges[i].of_left == edges[j].of_left;
            if (are_neighbours || !segments_intersect(edges[i].segment, edges[j].segment)) continue;
            if (++meetings > kMaxMeetings)
                return fmt::format("its boundaries cross more than {} times", kMaxMeetings);
        }
    }
    return "";
}

std::vector<LaneRecord> read_finished_lanes(const OutsideDetector& detector,
                                            std::span<const AnnotatedScene> scenes) {
    std::vector<LaneRecord> answers = read_foreign_lanes(detector.source);
    std::unordered_map<std::string, LaneRecord*> answer_to;
    for (LaneRecord& answer : answers) answer_to.emplace(answer.scene, &answer);
    std::vector<LaneRecord> records;
    records.reserve(scenes.size());
    std::size_t missing = 0;
    for (const AnnotatedScene& annotated : scenes) {
        const Scene& scene = annotated.scene;
        const auto found = answer_to.find(scene.id);
        if (found == answer_to.end()) {
            ++missing;
            records.push_back({.scene = scene.id,
                               .detector = detector.name,
                               .answer = {},
                               .latency_ms = OutsideLimits{}.answer_ms,
                               .nearest = {}});
            records.back().answer.status = LaneStatus::error;
            records.back().answer.message = "the lanes file has no answer to this scene";
            continue;
        }
        LaneRecord& record = *found->second;
        if (const std::string fault = fault_of(record, scene); !fault.empty())
            throw InputError(detector.source, record.line, "", fault);
        if (const std::string tangle = tangle_of(record, scene); !tangle.empty())
            throw InputError(detector.source, record.line, "", tangle);
        snap_to_cones(record, scene);
        record.detector = detector.name;
        record.latency_ms = record.self_timed_ms.value_or(0.0);
        records.push_back(std::move(record));
    }
    if (missing == scenes.size()) throw InputError(detector.source, 0, "scene", "answers none of the scenes");
    return records;
}

}  // namespace conelane
