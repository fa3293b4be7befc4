#include "evaluation/world/course.hpp"

#include "evaluation/world/centre_line.hpp"
#include "model/geometry.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <boost/random/uniform_int_distribution.hpp>
#include <fmt/format.h>

namespace conelane {
namespace {

constexpr std::int64_t kMinIdSpace = 10'000;
constexpr std::int64_t kIdsPerCone = 128;

/// A boundary's run in a scene, and whether it shows the whole boundary.
struct Run {
    std::vector<ConeId> ids;
    bool whole = true;
};

/// The run of seen cones from the first one at or past the car's foot point on the boundary. It continues
/// past missed cones and single cones that the map lacks, and ends before the first cone out of view.
Run run_ahead(const Course& course, const std::vector<std::size_t>& side, const std::vector<Point>& polyline,
              const std::vector<Sight>& sights, const Point& car) {
    const PolylineFoot foot = foot_on_polyline(car, polyline, course.track.closed);
    const bool at_vertex = (foot.point - polyline[foot.segment]).norm() <= kTieTolerance;
    // An open boundary of one cone has no next vertex, so its vertex is the foot.
    const std::size_t first = at_vertex ? foot.segment : foot.segment + 1;
    const std::size_t steps = course.track.closed ? side.size() : side.size() - first;
    Run run;
    bool lacked_one = false;
    for (std::size_t step = 0; step < steps; ++step) {
        const std::size_t cone = side[(first + step) % side.size()];
        const bool lacked = sights[cone] == Sight::unmapped;
        if (sights[cone] == Sight::seen) {
            run.ids.push_back(course.cones[cone].id);
        } else if (!run.ids.empty() && (sights[cone] == Sight::out_of_view || (lacked && lacked_one))) {
            break;
        }
        lacked_one = lacked;
    }
    run.whole = std::ranges::none_of(side, [&](std::size_t cone) {
        return sights[cone] == Sight::out_of_view || sights[cone] == Sight::unmapped;
    });
    return run;
}

}  // namespace

std::int64_t id_space(const Track& track) {
    return std::max(kMinIdSpace, kIdsPerCone * static_cast<std::int64_t>(track.cones.size()));
}

ConeId draw_new_id(SceneGenerator& generator, std::int64_t space, std::unordered_set<ConeId>& used) {
    boost::random::uniform_int_distribution<ConeId> any(0, space - 1);
    ConeId id = any(generator);
    while (!used.insert(id).second) id = any(generator);
    return id;
}

Course make_course(const Track& track, const SceneOptions& options) {
    Course course{
        .track = track, .polylines = boundaries(track), .cones = track.cones, .boundary_ids = {}, .lap = {}};
    SceneGenerator generator = generator_for(fmt::format("{}/{}/ids", track.name, options.seed));
    std::unordered_set<ConeId> used;
    for (Cone& cone : course.cones) {
        cone.id = draw_new_id(generator, id_space(track), used);
        cone.confidence = 1.0;
        if (!options.with_color) cone.color = ConeColor::unknown;
    }
    for (const std::vector<std::size_t>* side : {&track.left, &track.right}) {
        for (const std::size_t index : *side) course.boundary_ids.insert(course.cones[index].id);
    }
    if (options.with_color) {
        const auto paint = [&](const std::vector<std::size_t>& side, ConeColor color) {
            for (const std::size_t index : side) {
                if (course.cones[index].color != ConeColor::orange) course.cones[index].color = color;
            }
        };
        paint(track.left, ConeColor::blue);
        paint(track.right, ConeColor::yellow);
    }
    return course;
}

std::vector<Viewpoint> viewpoints_at(std::span<const Pose> poses) {
    std::vector<Viewpoint> viewpoints;
    for (const Pose& pose : poses) viewpoints.push_back({pose});
    return viewpoints;
}

std::vector<Viewpoint> viewpoints_along(const Track& track, double every_m) {
    if (track.frames.empty()) return viewpoints_at(centre_line_poses(boundaries(track), every_m));
    std::vector<Viewpoint> viewpoints;
    double steps = 0.0;  // in units of every_m, to the place of the next frame
    for (const RunFrame& frame : track.frames) {
        if (frame.travelled_m < steps * every_m) continue;
        viewpoints.push_back({frame.pose, &frame});
        steps = std::floor(frame.travelled_m / every_m) + 1.0;
    }
    return viewpoints;
}

std::vector<std::optional<Point>> places_of(const Course& course, const Viewpoint& viewpoint) {
    std::vector<std::optional<Point>> places(course.cones.size());
    if (viewpoint.frame != nullptr) {
        for (const MapPlace& place : viewpoint.frame->map) places[place.cone] = place.position;
    } else {
        std::ranges::transform(course.cones, places.begin(), &Cone::position);
    }
    return places;
}

Lane seen_lane(const Course& course, const std::vector<Sight>& sights, const Point& car) {
    const Track& track = course.track;
    Run left = run_ahead(course, track.left, course.polylines.left, sights, car);
    Run right = run_ahead(course, track.right, course.polylines.right, sights, car);
    return {std::move(left.ids), std::move(right.ids), track.closed && left.whole && right.whole};
}

}  // namespace conelane
