#include "experiments/race/race.hpp"

#include "conelane/invalid_input.hpp"
#include "detectors/planner/lane_stretch.hpp"
#include "evaluation/seeded_random.hpp"
#include "experiments/race/dynamic_car.hpp"
#include "model/deadline.hpp"

#include <set>

#include <boost/random/uniform_01.hpp>
#include <boost/random/uniform_real_distribution.hpp>
#include <fmt/format.h>

namespace conelane::experiments {
namespace {

constexpr double kStep_s = 0.01;
constexpr int kStepsPerFrame = 10;  // 10 Hz
constexpr double kFrame_s = kStepsPerFrame * kStep_s;
constexpr double kOldestPath_s = 1.0;
constexpr double kHalfWidth_m = 0.75;
constexpr double kHalfLength_m = 1.4;
constexpr double kMiddleAhead_m = 0.775;  ///< of the rear axle
constexpr double kUnsteady_m = 0.3;
constexpr double kNear_m = 10.0;  ///< length ahead of the car in which a path is compared
constexpr double kMaxAcceleration_mps2 = 6.0;
constexpr double kSpeedLag_s = 0.1;    ///< in which a car with slip is to reach the speed wanted
constexpr double kCreep_mps = 1.5;     ///< on a path that is not trusted, where the speed follows the trust
constexpr double kSafeAhead_m = 60.0;  ///< longest part of a path that is driven by
constexpr double kSteadyAt_m = 5.0;
constexpr double kShort_m = 3.0;
constexpr double kMaxHalt_s = 5.0;

constexpr double kJump_m = 0.5;
constexpr double kFaultEvery_s = 5.0;
constexpr double kBlackoutEvery_s = 8.0;
constexpr double kBlackout_s = 1.0;
constexpr double kFaultyShare = 0.2;

double lookahead_m(double speed_mps) {
    return std::clamp(0.5 * speed_mps, 2.0, 6.0);
}

Point middle_of(const Pose& rear_axle) {
    return rear_axle.position + kMiddleAhead_m * rear_axle.heading();
}

Point left_of(const Pose& pose) {
    return {-pose.heading().y(), pose.heading().x()};
}

/// Whether a line moved by more than kUnsteady_m within kNear_m of the car, where both lines exist.
bool moved(const std::vector<Point>& before, const std::vector<Point>& now) {
    double along_m = 0.0;
    for (std::size_t i = 0; i < now.size(); ++i) {
        if (i > 0) along_m += (now[i] - now[i - 1]).norm();
        if (along_m > kNear_m) break;
        const PolylineFoot foot = foot_on_polyline(now[i], before);
        const bool past_end = (foot.point - before.back()).norm() < 1e-6;
        const bool before_start = (foot.point - before.front()).norm() < 1e-6;
        if (!past_end && !before_start && foot.distance_m > kUnsteady_m) return true;
    }
    return false;
}

/// 95 of 100 numbers are at most this; nothing of none.
std::optional<double> p95(std::vector<double> values) {
    if (values.empty()) return std::nullopt;
    const auto rank = static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(values.size() - 1));
    std::ranges::nth_element(values, values.begin() + rank);
    return values[static_cast<std::size_t>(rank)];
}

using Generator = boost::random::mt19937_64;

double uniform(Generator& random, double low, double high) {
    return low < high ? boost::random::uniform_real_distribution<double>(low, high)(random) : low;
}

/// An answer on its way to the car; then the path that the car drives by.
struct Answer {
    Drive drive;
    double frame_s = 0.0;
    int arrives = 0;                      ///< the step
    double from_m = 0.0;                  ///< how far the path has been followed
    std::vector<SpeedPoint> speeds = {};  ///< along it, if the speed follows the trust
};

/// The car drives by the path of the newest frame. Between frames it knows its own motion, so the error of
/// the pose that it believes stays constant.
struct Car {
    Vehicle vehicle;
    double speed_mps = 0.0;
    double error_left_m = 0.0;
    double error_yaw_rad = 0.0;
    std::optional<Answer> path = {};
    double newest_s = -1.0;  ///< time of the newest frame with an answer
    bool has_begun = false;  ///< it has had a path
    bool is_stopping = false;
    bool is_braking = false;
    std::optional<DynamicCar> with_slip = {};  ///< moves `vehicle`, if present

    [[nodiscard]] Point middle() const { return middle_of(vehicle.pose); }

    /// In the frame of the world.
    [[nodiscard]] Pose believed() const {
        const Pose& pose = vehicle.pose;
        return {pose.position + error_left_m * left_of(pose), pose.yaw_rad + error_yaw_rad};
    }

    void believe(const Pose& believed) {
        error_left_m = vehicle.pose.left_m(believed.position);
        error_yaw_rad = believed.yaw_rad - vehicle.pose.yaw_rad;
    }

    /// By the speeds along the path, but no slower than a creep.
    [[nodiscard]] double safe_speed_mps() const {
        if (!path) return 0.0;
        const auto next = std::ranges::find_if(
            path->speeds, [&](const SpeedPoint& point) { return point.s_m > path->from_m; });
        return std::max(kCreep_mps, next == path->speeds.end() ? 0.0 : next->v_mps);
    }

    void take(Answer answer) {
        newest_s = answer.frame_s;
        is_stopping = answer.drive.stop;
        is_braking = answer.drive.brake;
        if (answer.drive.path.size() >= 2) {
            path = std::move(answer);
            has_begun = true;
        } else if (is_braking) {
            path.reset();
        }
    }

    void drop_old_path(double time_s) {
        if (path && !path->drive.stop && time_s - path->frame_s > kOldestPath_s + 1e-9) path.reset();
    }

    void drive(const RaceOptions& options, const MapFrame& map) {
        VehicleLimits limits{.a_brake_mps2 = kMaxAcceleration_mps2, .a_drive_mps2 = kMaxAcceleration_mps2};
        double wanted_mps = speed_mps;
        if (is_braking || (is_stopping && options.with_stop)) {
            wanted_mps = 0.0;
        } else if (options.by_safe) {
            wanted_mps = safe_speed_mps();
            limits = options.limits;
        } else if (has_begun || !options.with_stop) {
            wanted_mps = options.speed_mps;
        }
        if (!with_slip) {
            speed_mps = std::clamp(wanted_mps, std::max(0.0, speed_mps - limits.a_brake_mps2 * kStep_s),
                                   speed_mps + limits.a_drive_mps2 * kStep_s);
        }
        const double wanted_rad =
            path ? pursue(map.to_map(believed()), path->drive.path, lookahead_m(speed_mps), path->from_m)
                 : 0.0;  // straight on without a path
        if (with_slip) {
            const double change_mps2 = (wanted_mps - speed_mps) / kSpeedLag_s;
            with_slip->drive(std::clamp(change_mps2, -limits.a_brake_mps2, limits.a_drive_mps2), wanted_rad,
                             kStep_s);
            speed_mps = with_slip->speed_mps();
            vehicle.pose = with_slip->rear_axle();
        } else {
            vehicle.drive(speed_mps, wanted_rad, kStep_s);
        }
    }
};

/// Whether the car fits into the lane beside its start.
bool fits(const RaceCourse& course, const Pose& pose, const Pose& start) {
    const Point middle = middle_of(pose);
    if (course.half_width_m) return std::abs(start.left_m(middle)) <= *course.half_width_m - kHalfWidth_m;
    const Point aside = kHalfWidth_m * left_of(pose);
    return stays_in_ring(course.lane, {start.position, middle}) &&
           stays_in_ring(course.lane, {middle, middle + aside}) &&
           stays_in_ring(course.lane, {middle, middle - aside});
}

/// The pose at the start, with the error of the start.
Pose start_pose(const RaceCourse& course, const RaceOptions& options, Generator& random) {
    const Pose at = course.line.at(static_cast<std::size_t>(std::lround(course.start_m / course.step_m)));
    if (!(options.start_error_m > 0.0 || options.start_error_rad > 0.0)) return at;
    const double angle_rad = uniform(random, -std::numbers::pi, std::numbers::pi);
    const double distance_m = options.start_error_m * std::sqrt(boost::random::uniform_01<double>()(random));
    const Point along = distance_m * std::cos(angle_rad) * at.heading();
    Pose moved = at;
    moved.yaw_rad += uniform(random, -options.start_error_rad, options.start_error_rad);
    // The largest offset at which the car still fits into the lane.
    double left_m = distance_m * std::sin(angle_rad);
    for (int i = 0; i < 20; ++i, left_m *= 0.8) {
        moved.position = at.position + along + left_m * left_of(at);
        if (fits(course, moved, at)) break;
    }
    return moved;
}

/// What the car sees, in a map that drifts and jumps.
class Sensor {
  public:
    Sensor(const RaceCourse& course, const RaceOptions& options, const Point& start, Generator& random)
        : options_(options),
          start_(start),
          random_(random),
          world_(course, options.sight),
          drift_direction_rad_(uniform(random, -std::numbers::pi, std::numbers::pi)),
          drift_sense_(boost::random::uniform_01<double>()(random) < 0.5 ? -1.0 : 1.0) {
        if (!options_.with_any_map) return;
        const double x_m = uniform(random, -100.0, 100.0);
        const double y_m = uniform(random, -100.0, 100.0);
        first_map_ = {uniform(random, -std::numbers::pi, std::numbers::pi), {x_m, y_m}};
    }

    /// `share`: of a lap that has been driven. The car believes another pose from now on.
    [[nodiscard]] Frame look(Car& car, double share, int step) {
        const double time_s = step * kStep_s;
        const auto comes = [&](double every_s) {
            return step > 0 && std::fmod(time_s + 1e-9, every_s) < kFrame_s / 2.0;
        };
        if (options_.fault == RaceFault::jump && comes(kFaultEvery_s)) {
            first_map_.shift +=
                kJump_m * Pose{{0.0, 0.0}, uniform(random_, -std::numbers::pi, std::numbers::pi)}.heading();
        }
        if (options_.fault == RaceFault::ids && comes(kFaultEvery_s)) world_.change_ids();
        map_ = first_map_.turned(drift_sense_ * options_.drift_rad * share, start_,
                                 options_.drift_m * share * Pose{{0.0, 0.0}, drift_direction_rad_}.heading());
        const Pose believed = world_.disturbed(car.vehicle.pose, kFrame_s);
        car.believe(believed);
        Frame frame = world_.look(believed, map_, time_s);
        const bool is_dark = options_.fault == RaceFault::blackout && time_s >= kBlackoutEvery_s &&
                             std::fmod(time_s + 1e-9, kBlackoutEvery_s) < kBlackout_s - 1e-6;
        if (is_dark) frame.cones.clear();
        last_frame_s_ = time_s;
        return frame;
    }

    [[nodiscard]] const MapFrame& map() const { return map_; }
    [[nodiscard]] double last_frame_s() const { return last_frame_s_; }
    [[nodiscard]] const std::vector<Point>& false_positives() const { return world_.false_positives(); }
    [[nodiscard]] std::vector<Point> to_world(std::vector<Point> places) const {
        for (Point& place : places) place = map_.to_world(place);
        return places;
    }

  private:
    const RaceOptions& options_;
    Point start_;
    Generator& random_;
    World world_;
    double drift_direction_rad_;
    double drift_sense_;
    MapFrame first_map_;
    MapFrame map_;
    double last_frame_s_ = 0.0;
};

/// Delivers frames, some of them late, twice or in another order, and answers after their latency.
class Transport {
  public:
    Transport(const RaceOptions& options, Generator& random)
        : fault_(options.fault),
          latency_(static_cast<int>(std::lround(options.latency_s / kStep_s))),
          random_(random) {}

    void send(Frame frame, int step) {
        int due = step;
        const bool is_faulty = boost::random::uniform_01<double>()(random_) < kFaultyShare;
        const int delay = boost::random::uniform_int_distribution<int>(1, 3)(random_) * kStepsPerFrame;
        if (is_faulty && (fault_ == RaceFault::late || fault_ == RaceFault::order)) due += delay;
        if (fault_ == RaceFault::late) due = std::max(due, last_due_);
        last_due_ = due;
        if (is_faulty && fault_ == RaceFault::twice) frames_.push_back({due, frame});
        frames_.push_back({due, std::move(frame)});
        // Behind all frames that are due earlier; of frames due together, the latest of the run is first.
        std::ranges::stable_sort(frames_, {}, &Waiting::due);
        if (fault_ == RaceFault::order) {
            std::ranges::stable_sort(frames_, [](const Waiting& a, const Waiting& b) {
                return a.due != b.due ? a.due < b.due : a.frame.time_s > b.frame.time_s;
            });
        }
    }
    [[nodiscard]] std::optional<Frame> next_frame(int step) {
        if (frames_.empty() || frames_.front().due > step) return std::nullopt;
        Frame frame = std::move(frames_.front().frame);
        frames_.pop_front();
        return frame;
    }

    void send(Drive drive, double frame_s, int step) {
        answers_.push_back({std::move(drive), frame_s, step + latency_});
    }
    [[nodiscard]] std::optional<Answer> next_answer(int step) {
        if (answers_.empty() || answers_.front().arrives > step) return std::nullopt;
        Answer answer = std::move(answers_.front());
        answers_.pop_front();
        return answer;
    }

  private:
    struct Waiting {
        int due;
        Frame frame;
    };
    RaceFault fault_;
    int latency_;  ///< in steps
    Generator& random_;
    int last_due_ = 0;
    std::deque<Waiting> frames_;
    std::deque<Answer> answers_;
};

/// Watches the car and the answers, and says how the race ended.
class Referee {
  public:
    Referee(const RaceCourse& course, const RaceOptions& options, const Point& middle)
        : course_(course), options_(options), foot_(course, course.start_m) {
        foot_.follow(middle, options.start_error_m + 3.0);
        start_m_ = foot_.at_m();
        const double way_m = course.closed ? foot_.round_m() * options.laps : *course.finish_m - start_m_;
        finish_m_ = course.closed ? start_m_ + way_m : *course.finish_m;
        lap_m_ = course.closed ? foot_.round_m() : way_m;
        // A car that drives in circles does not finish.
        longest_s_ = 2.5 * way_m / options.speed_mps + 10.0 + (options.with_stop ? 20.0 : 0.0);
    }

    [[nodiscard]] bool has_ended(double time_s) const { return ended_ || time_s >= longest_s_; }
    /// Of a lap that has been driven.
    [[nodiscard]] double lap_share() const { return driven_m() / lap_m_; }

    void note_time(double answer_ms) {
        ++result_.frames;
        result_.answer_ms.push_back(answer_ms);
    }
    void note_refusal() { ++result_.frames_refused; }
    /// `whole`: the path of the answer in the world; empty: none.
    void note_answer(const Drive& drive, const std::vector<Point>& whole) {
        note_trust(drive, whole);
        const std::vector<Point> path = beginning(whole, 20.0);
        is_planner_ = is_planner_ || !drive.state.empty();
        if (path.empty()) {
            ++result_.frames_without_path;
        } else {
            if (!path_before_.empty()) {
                ++pairs_;
                if (moved(path_before_, path)) ++unsteady_;
            }
            if (!drive.is_flagged && leaves(course_, path, std::min(kNear_m, drive.safe_m), foot_)) {
                ++result_.wrong_unflagged;
            }
        }
        path_before_ = path;
        result_.laps_told = std::max(result_.laps_told, drive.lap);
        if (!drive.phase.empty() && (result_.phases.empty() || result_.phases.back() != drive.phase)) {
            result_.phases.push_back(drive.phase);
        }
    }
    void keep(ReplayFrame frame) { result_.replay.push_back(std::move(frame)); }
    void note_old_path() { result_.old_path_s += kStep_s; }

    void note_stop() {
        if (!options_.with_stop || result_.stop_said_m) return;
        result_.stop_said_m = foot_.at_m() - finish_m_;
        if (*result_.stop_said_m < 0.0) end(RaceEnd::stopped_early);
    }

    /// The car has come from a place to where it is now.
    void watch(const Point& before, const Car& car) {
        const Point middle = car.middle();
        foot_.follow(middle);
        note_hits({middle, car.vehicle.pose.yaw_rad});
        errors_m_.push_back(foot_.distance_m());
        LapFigures& lap = of_lap();
        ++lap_steps_;
        if (driven_m() >= (laps_done_ + 1) * lap_m_) {
            ++lap.laps;
            ++laps_done_;
            lap.time_s += std::exchange(lap_steps_, 0) * kStep_s;
        }
        const bool is_out = course_.half_width_m ? foot_.distance_m() > *course_.half_width_m
                                                 : !stays_in_ring(course_.lane, {before, middle});
        if (is_out) {
            result_.departure_m = driven_m();
            return end(RaceEnd::departed);
        }
        const double past_m = foot_.at_m() - finish_m_;
        halted_steps_ = car.speed_mps > 0.0 ? 0 : halted_steps_ + 1;
        if (!options_.with_stop) {
            if (past_m >= 0.0) end(RaceEnd::finished);
        } else if (past_m > course_.rest_m) {
            end(RaceEnd::not_stopped);
        } else if (car.speed_mps <= 0.0 && result_.stop_said_m && past_m >= 0.0) {
            result_.rest_m = past_m;
            const bool tells_phases = is_planner_ && !course_.phases.empty();
            end(tells_phases && result_.phases != course_.phases ? RaceEnd::wrong_phases : RaceEnd::finished);
        }
        if (halted_steps_ * kStep_s >= kMaxHalt_s) end(RaceEnd::halted);
    }

    [[nodiscard]] RaceResult result(double time_s, const std::vector<Point>& false_positives) {
        result_.time_s = time_s;
        result_.false_positives = false_positives;
        result_.driven_m = driven_m();
        result_.finished_laps = result_.finished() ? 1 : 0;
        if (course_.closed) {
            result_.finished_laps = static_cast<int>(std::floor(result_.driven_m / foot_.round_m() + 1e-9));
        }
        result_.cones_hit = static_cast<int>(hit_.size());
        result_.lateral_error_p95_m = p95(std::move(errors_m_));
        for (std::size_t i = 0; i < 2; ++i) result_.by_lap[i].sideways_p95_m = p95(std::move(sideways_m_[i]));
        if (pairs_ > 0) result_.unsteady_share = static_cast<double>(unsteady_) / pairs_;
        return std::move(result_);
    }

  private:
    [[nodiscard]] double driven_m() const { return std::max(0.0, foot_.at_m() - start_m_); }

    [[nodiscard]] LapFigures& of_lap() { return result_.by_lap[laps_done_ > 0 ? 1 : 0]; }

    void note_trust(const Drive& drive, const std::vector<Point>& path) {
        LapFigures& lap = of_lap();
        ++lap.frames;
        if (path.empty() || drive.safe_m < kShort_m) {
            ++lap.short_frames;
            if (!path.empty() && !leaves(course_, path, kNear_m, foot_)) ++lap.right_untrusted;
        }
        if (!path.empty() && leaves(course_, path, std::min(kSafeAhead_m, drive.safe_m), foot_))
            ++lap.wrong_trusted;
        const std::vector<Point> near = beginning(path, kSteadyAt_m);
        if (!near.empty() && !path_before_.empty())
            sideways_m_[laps_done_ > 0 ? 1 : 0].push_back(
                foot_on_polyline(near.back(), path_before_).distance_m);
        for (const DrivablePoint& point : lane_along(beginning(path, kNear_m)).points) {
            lap.max_curvature_1pm = std::max(lap.max_curvature_1pm, std::abs(point.curvature_1pm));
        }
    }

    void note_hits(const Pose& middle) {
        for (std::size_t i = 0; i < course_.cones.size(); ++i) {
            const Point& cone = course_.cones[i].position;
            if ((cone - middle.position).squaredNorm() > 4.0) continue;
            if (std::abs(middle.ahead_m(cone)) <= kHalfLength_m &&
                std::abs(middle.left_m(cone)) <= kHalfWidth_m) {
                hit_.insert(i);
            }
        }
    }

    /// The first end counts.
    void end(RaceEnd how) {
        if (!ended_) result_.end = how;
        ended_ = true;
    }

    const RaceCourse& course_;
    const RaceOptions& options_;
    CourseFoot foot_;
    double start_m_ = 0.0;
    double finish_m_ = 0.0;
    double lap_m_ = 0.0;
    double longest_s_ = 0.0;
    bool is_planner_ = false;  ///< answers have a state
    int halted_steps_ = 0;
    std::vector<Point> path_before_;  ///< in the world
    int pairs_ = 0;
    int unsteady_ = 0;
    std::set<std::size_t> hit_;
    std::vector<double> errors_m_;
    std::array<std::vector<double>, 2> sideways_m_;
    int laps_done_ = 0;
    int lap_steps_ = 0;  ///< since the last line
    bool ended_ = false;
    RaceResult result_;
};

/// One race in progress.
class Run {
  public:
    Run(const RaceCourse& course, const RaceOptions& options, const Driver& driver)
        : options_(options),
          driver_(driver),
          random_(generator_of(fmt::format("{}/{}/run", course.name, options.sight.false_positive_rate),
                               options.sight.seed)),
          car_{.vehicle = {start_pose(course, options, random_)},
               .speed_mps = options.with_stop || options.by_safe ? 0.0 : options.speed_mps},
          sensor_(course, options, car_.vehicle.pose.position, random_),
          transport_(options, random_),
          referee_(course, options, car_.middle()) {
        if (options.with_slip) car_.with_slip.emplace(car_.vehicle.pose, car_.speed_mps);
    }

    RaceResult drive() {
        int step = 0;
        for (; !referee_.has_ended(step * kStep_s); ++step) {
            if (step % kStepsPerFrame == 0)
                transport_.send(sensor_.look(car_, referee_.lap_share(), step), step);
            while (const std::optional<Frame> frame = transport_.next_frame(step)) answer(*frame, step);
            while (std::optional<Answer> arrived = transport_.next_answer(step)) take(*std::move(arrived));
            // While a frame is being answered, the path of the frame before it is the latest one.
            const double old_s = sensor_.last_frame_s() - kFrame_s - 1e-9;
            if (car_.path && car_.path->frame_s - car_.path->drive.age_s < old_s) referee_.note_old_path();
            car_.drop_old_path(step * kStep_s);
            const Point before = car_.middle();
            car_.drive(options_, sensor_.map());
            referee_.watch(before, car_);
        }
        return referee_.result(step * kStep_s, sensor_.false_positives());
    }

  private:
    void answer(const Frame& frame, int step) {
        const Stopwatch watch;
        Drive drive = driver_(frame);
        referee_.note_time(watch.elapsed_ms());
        if (drive.is_refused) return referee_.note_refusal();
        std::vector<Point> path;
        if (drive.path.size() >= 2) {
            drive.path = beginning(drive.path, kSafeAhead_m);
            path = sensor_.to_world(drive.path);
        }
        referee_.note_answer(drive, path);
        if (options_.keep_replay) {
            std::vector<Point> seen;
            for (const Cone& cone : frame.cones) seen.push_back(cone.position);
            referee_.keep({.time_s = step * kStep_s,
                           .pose = car_.vehicle.pose,
                           .path = beginning(path, 20.0),
                           .seen = sensor_.to_world(std::move(seen)),
                           .state = drive.state});
        }
        transport_.send(std::move(drive), frame.time_s, step);
    }

    /// An answer to an older frame is worth less than the path that is being driven.
    void take(Answer answer) {
        if (answer.frame_s < car_.newest_s) return;
        if (answer.drive.stop) referee_.note_stop();
        if (options_.by_safe)  // the largest speeds, whatever the speed now
            answer.speeds = speed_profile(lane_along(answer.drive.path), options_.limits,
                                          {options_.limits.v_max_mps, answer.drive.safe_m});
        car_.take(std::move(answer));
    }

    const RaceOptions& options_;
    const Driver& driver_;
    Generator random_;
    Car car_;
    Sensor sensor_;
    Transport transport_;
    Referee referee_;
};

using Fault = std::pair<RaceFault, std::string_view>;
constexpr std::array kFaults{Fault{RaceFault::none, "none"},   Fault{RaceFault::jump, "jump"},
                             Fault{RaceFault::late, "late"},   Fault{RaceFault::twice, "twice"},
                             Fault{RaceFault::order, "order"}, Fault{RaceFault::blackout, "blackout"},
                             Fault{RaceFault::ids, "ids"}};
constexpr std::array<std::string_view, 7> kEnds{"finished", "departed",     "stopped early", "not stopped",
                                                "halted",   "wrong phases", "too long"};

}  // namespace

std::string_view to_string(RaceFault fault) {
    return kFaults[static_cast<std::size_t>(fault)].second;
}

RaceFault race_fault(std::string_view name) {
    const auto fault = std::ranges::find(kFaults, name, &Fault::second);
    if (fault != kFaults.end()) return fault->first;
    throw InvalidInput(
        "--fault", "'" + std::string(name) + "' is not one of none, jump, late, twice, order, blackout, ids");
}

std::string_view to_string(RaceEnd end) {
    return kEnds[static_cast<std::size_t>(end)];
}

RaceResult race(const RaceCourse& course, const RaceOptions& options, const Driver& driver) {
    return Run(course, options, driver).drive();
}

}  // namespace conelane::experiments
