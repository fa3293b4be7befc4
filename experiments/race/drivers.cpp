#include "experiments/race/drivers.hpp"

#include "conelane/invalid_input.hpp"
#include "evaluation/outside/outside_program.hpp"
#include "evaluation/outside/point_snapping.hpp"

namespace conelane::experiments {
namespace {

/// A path is due in 100 ms. The limit is longer, so that the wall clock does not influence answers.
constexpr double kNoLimit_ms = 10'000.0;
constexpr double kStopMargin_m = 0.5;  ///< tolerance for the driver `truth`, whose pose is noisy

std::vector<Point> points_of(const DrivableLane& lane) {
    std::vector<Point> path;
    for (const DrivablePoint& point : lane.points) path.push_back(point.position);
    return path;
}

/// A detector needs distinct ids.
Scene scene_of(const Frame& frame) {
    Scene scene{"race", frame.pose, frame.cones};
    if (std::ranges::any_of(scene.cones, [](const Cone& cone) { return cone.id == kNoId; })) {
        for (std::size_t i = 0; i < scene.cones.size(); ++i) scene.cones[i].id = static_cast<ConeId>(i);
    }
    return scene;
}

/// The path of one answer.
Drive drive_by(const LaneAnswer& answer, const Scene& scene) {
    Drive drive;
    if (answer.status != LaneStatus::found) return drive;
    const DrivableLane lane = drivable(answer, scene);
    drive.path = points_of(lane);
    if (lane.trusted_m) drive.safe_m = *lane.trusted_m;
    return drive;
}

Driver detector_driver(const DetectorRecipe& recipe, const DetectorOptions& options) {
    return [detector = std::shared_ptr<LaneDetector>(make_detector(recipe, options))](const Frame& frame) {
        const Scene scene = scene_of(frame);
        return drive_by(detector->detect(scene, {.time_limit_ms = kNoLimit_ms}), scene);
    };
}

/// Boundaries that are positions become cones of a scene of their own.
Drive drive_by_points(const BoundaryPoints& points, bool closed, const Frame& frame) {
    Scene scene{"race", frame.pose, {}};
    LaneAnswer answer;
    answer.status = LaneStatus::found;
    answer.lane.closed = closed;
    const auto add = [&](const std::vector<Point>& from, std::vector<ConeId>& ids) {
        for (const Point& point : from) {
            ids.push_back(static_cast<ConeId>(scene.cones.size()));
            scene.cones.push_back({ids.back(), point});
        }
    };
    add(points.left, answer.lane.left);
    add(points.right, answer.lane.right);
    return drive_by(answer, scene);
}

Driver outside_driver(const std::shared_ptr<OutsideProgramPool>& programs) {
    std::shared_ptr<OutsideProgram> program(programs->take().release(), [programs](OutsideProgram* used) {
        programs->give_back(std::unique_ptr<OutsideProgram>(used));
    });
    return [program](const Frame& frame) {
        const Scene scene = scene_of(frame);
        LaneRecord record = program->answer(scene);
        if (record.answer.status != LaneStatus::found) return Drive{};
        snap_to_cones(record, scene);
        try {
            if (record.points) return drive_by_points(*record.points, record.answer.lane.closed, frame);
            return drive_by(record.answer, scene);
        } catch (const InvalidInput&) {
            return Drive{};  // its answer bounds no lane
        }
    };
}

Driver planner_driver(const std::string& detector, const DetectorOptions& detector_options,
                      const RaceCourse& course, const RaceOptions& options) {
    PlannerOptions wanted{
        .mission = course.mission, .detector = detector, .detector_options = detector_options};
    if (course.mission == Mission::trackdrive) wanted.laps = options.laps;
    return [planner = std::shared_ptr<Planner>(make_planner(wanted))](const Frame& frame) {
        Drive drive;
        try {
            const Plan plan = planner->update(frame, {.time_limit_ms = kNoLimit_ms});
            drive.path = points_of(plan.lane);
            drive.stop = plan.stop;
            drive.is_flagged = plan.state != PlanState::following;
            drive.age_s = plan.age_s;
            drive.safe_m = plan.safe_m;
            drive.state = to_string(plan.state);
            drive.phase = plan.phase;
            drive.lap = plan.lap;
            drive.brake = plan.state == PlanState::lost;
        } catch (const InvalidInput&) {
            drive.is_refused = true;  // for example if a frame is older than the last one
        }
        return drive;
    };
}

bool is_of_library(const Method& method) {
    return std::ranges::any_of(detector_recipes(),
                               [&](const DetectorRecipe& recipe) { return &recipe == method.recipe; });
}

/// Throws InvalidInput if the method cannot drive.
void require_driving(const Method& method, const std::string& text, WithPlanner with_planner) {
    if (method.outside && !method.programs)
        throw InvalidInput("--methods", "'" + text + "' cannot answer the frames of a race");
    if (method.outside && with_planner == WithPlanner::only) {
        throw InvalidInput("--planner",
                           "'" + method.name + "' is a program from outside, which cannot have a planner");
    }
    if (!method.outside && with_planner != WithPlanner::no && !is_of_library(method))
        throw InvalidInput("--planner", "'" + text + "' is not a detector of the library");
}

}  // namespace

std::vector<Racer> racers(const std::vector<std::string>& texts, WithPlanner with_planner) {
    std::vector<Racer> all;
    for (const std::string& text : split_detectors(texts)) {
        if (text == "truth" || text == "none") {
            all.push_back({text});
            continue;
        }
        const Method method = parse_method(text);
        require_driving(method, text, with_planner);
        if (method.outside || with_planner != WithPlanner::only) all.push_back({method.name, method});
        if (!method.outside && with_planner != WithPlanner::no)
            all.push_back({method.name + "+planner", method, true});
    }
    for (auto racer = all.begin(); racer != all.end(); ++racer) {
        if (std::ranges::find(all.begin(), racer, racer->name, &Racer::name) != racer)
            throw InvalidInput("--methods", "'" + racer->name + "' is there twice");
    }
    return all;
}

Driver truth_driver(const RaceCourse& course, int laps, double ahead_m) {
    return [&course, laps, ahead_m, at = CourseFoot(course, course.start_m),
            finish_m = std::optional<double>{}](const Frame& frame) mutable {
        at.follow(frame.pose.position, 6.0);
        if (!finish_m) {
            finish_m = course.finish_m.value_or(at.at_m() + laps * at.round_m()) + kStopMargin_m;
        }
        Drive drive;
        const auto first = static_cast<long>(std::floor(at.at_m() / course.step_m));
        for (long i = 0; i <= static_cast<long>(ahead_m / course.step_m); ++i) {
            if (const std::optional<Point> point = at.place(first + i)) drive.path.push_back(*point);
        }
        drive.stop = at.at_m() >= *finish_m;
        return drive;
    };
}

Driver make_driver(const Racer& racer, const RaceCourse& course, const RaceOptions& options,
                   const WeightsBytes* weights) {
    if (!racer.method) {
        if (racer.name == "truth") return truth_driver(course, options.laps, options.by_safe ? 60.0 : 20.0);
        return [](const Frame& /*frame*/) { return Drive{}; };
    }
    if (racer.method->programs) return outside_driver(racer.method->programs);
    DetectorOptions detector_options;
    if (weights != nullptr) detector_options.weights = *weights;
    if (racer.has_planner) return planner_driver(racer.method->name, detector_options, course, options);
    return detector_driver(*racer.method->recipe, detector_options);
}

}  // namespace conelane::experiments
