#include "experiments/race/race.hpp"

#include "conelane/invalid_input.hpp"
#include "evaluation/seeded_random.hpp"
#include "experiments/race/vehicle.hpp"
#include "model/geometry.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <memory>
#include <numbers>
#include <set>
#include <utility>

#include <boost/random/uniform_01.hpp>
#include <boost/random/uniform_int_distribution.hpp>
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
constexpr double kTruthAhead_m = 20.0;
constexpr double kStopMargin_m = 0.5;  ///< tolerance for the driver `truth`, whose pose is noisy
constexpr double kMaxAcceleration_mps2 = 6.0;
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

/// The foot of a car on the true line, followed from step to step, so that other stretches of the line at the
/// same distance do not count.
class Follower {
  public:
    Follower(const RaceCourse& course, double at_m) : course_(course), at_m_(at_m) {}

    /// Moves by at most `reach_m`, forward or backward.
    void follow(const Point& point, double reach_m = 3.0) {
        const auto steps = static_cast<long>(std::ceil(reach_m / course_.step_m));
        const auto middle = static_cast<long>(std::floor(at_m_ / course_.step_m));
        double best_m = std::numeric_limits<double>::infinity();
        double best_at_m = at_m_;
        for (long i = middle - steps; i <= middle + steps; ++i) {
            const auto from = place(i);
            const auto to = place(i + 1);
            if (!from || !to) continue;
            const FootPoint foot = foot_point(point, {*from, *to});
            if (foot.distance_m >= best_m) continue;
            best_m = foot.distance_m;
            best_at_m = (static_cast<double>(i) + foot.parameter) * course_.step_m;
        }
        distance_m_ = best_m;
        at_m_ = best_at_m;
    }

    /// Arc length with completed rounds. A step counts as step_m, also a shorter last step of a round.
    [[nodiscard]] double at_m() const { return at_m_; }
    [[nodiscard]] double distance_m() const { return distance_m_; }
    [[nodiscard]] double round_m() const { return static_cast<double>(course_.line.size()) * course_.step_m; }

    [[nodiscard]] std::optional<Point> place(long i) const {
        const auto size = static_cast<long>(course_.line.size());
        if (course_.closed)
            return course_.line[static_cast<std::size_t>(((i % size) + size) % size)].position;
        if (i < 0 || i >= size) return std::nullopt;
        return course_.line[static_cast<std::size_t>(i)].position;
    }

  private:
    const RaceCourse& course_;
    double at_m_;
    double distance_m_ = 0.0;
};

bool crosses(const std::vector<Point>& boundary, const Segment& way) {
    for (std::size_t i = 0; i < boundary.size(); ++i) {
        const Segment edge{boundary[i], boundary[(i + 1) % boundary.size()]};
        // Skips the boundary points that are far away, which are most of them.
        if ((edge.from - way.from).squaredNorm() > 400.0 && (edge.to - way.from).squaredNorm() > 400.0 &&
            (edge.to - edge.from).squaredNorm() < 100.0) {
            continue;
        }
        if (segments_intersect(edge, way)) return true;
    }
    return false;
}

bool is_inside(const std::vector<Point>& polygon, const Point& point) {
    bool inside = false;
    for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
        const Point& a = polygon[i];
        const Point& b = polygon[j];
        if ((a.y() > point.y()) != (b.y() > point.y()) &&
            point.x() < (b.x() - a.x()) * (point.y() - a.y()) / (b.y() - a.y()) + a.x()) {
            inside = !inside;
        }
    }
    return inside;
}

/// Whether the segment between two points stays inside the lane of a circuit: it crosses no boundary between
/// neighbouring cones, and ends in the ring between the boundaries.
bool stays_in_ring(const TrackBoundaries& lane, const Segment& way) {
    if (crosses(lane.left, way) || crosses(lane.right, way)) return false;
    return is_inside(lane.left, way.to) != is_inside(lane.right, way.to);
}

/// Whether the first metres of a path leave the lane. `at`: the car's position.
bool leaves(const RaceCourse& course, const std::vector<Point>& path, double up_to_m, Follower at) {
    double along_m = 0.0;
    for (std::size_t i = 1; i < path.size(); ++i) {
        const double step_m = (path[i] - path[i - 1]).norm();
        along_m += step_m;
        if (along_m > up_to_m) return false;
        if (course.half_width_m) {
            at.follow(path[i], 2.0 + step_m);
            if (at.distance_m() > *course.half_width_m) return true;
        } else if (!stays_in_ring(course.lane, {path[i - 1], path[i]})) {
            return true;
        }
    }
    return false;
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

/// The beginning of a path, of about this length.
std::vector<Point> beginning(const std::vector<Point>& path, double length_m) {
    std::vector<Point> points;
    double along_m = 0.0;
    for (const Point& point : path) {
        if (!points.empty()) along_m += (point - points.back()).norm();
        points.push_back(point);
        if (along_m >= length_m) break;
    }
    return points;
}

using Generator = boost::random::mt19937_64;

double uniform(Generator& random, double low, double high) {
    return low < high ? boost::random::uniform_real_distribution<double>(low, high)(random) : low;
}

/// Delivers frames, some of them late, twice or in another order.
class Delivery {
  public:
    Delivery(RaceFault fault, Generator& random) : fault_(fault), random_(random) {}

    void put(Frame frame, int step) {
        int due = step;
        const bool is_faulty = boost::random::uniform_01<double>()(random_) < kFaultyShare;
        const int delay = boost::random::uniform_int_distribution<int>(1, 3)(random_) * kStepsPerFrame;
        if (is_faulty && (fault_ == RaceFault::late || fault_ == RaceFault::order)) due += delay;
        if (fault_ == RaceFault::late) due = std::max(due, last_due_);
        last_due_ = due;
        if (is_faulty && fault_ == RaceFault::twice) waiting_.push_back({due, frame});
        waiting_.push_back({due, std::move(frame)});
        // Behind all frames that are due earlier; of frames due together, the latest of the run is first.
        std::ranges::stable_sort(waiting_, {}, &Waiting::due);
        if (fault_ == RaceFault::order) {
            std::ranges::stable_sort(waiting_, [](const Waiting& a, const Waiting& b) {
                return a.due != b.due ? a.due < b.due : a.frame.time_s > b.frame.time_s;
            });
        }
    }
    [[nodiscard]] std::optional<Frame> next(int step) {
        if (waiting_.empty() || waiting_.front().due > step) return std::nullopt;
        Frame frame = std::move(waiting_.front().frame);
        waiting_.erase(waiting_.begin());
        return frame;
    }

  private:
    struct Waiting {
        int due;
        Frame frame;
    };
    RaceFault fault_;
    Generator& random_;
    int last_due_ = 0;
    std::vector<Waiting> waiting_;
};

/// One race in progress.
class Run {
  public:
    Run(const RaceCourse& course, const RaceOptions& options, const Driver& driver)
        : course_(course),
          options_(options),
          driver_(driver),
          random_(generator_of(fmt::format("{}/{}/run", course.name, options.sight.false_positive_rate),
                               options.sight.seed)),
          world_(course, options.sight),
          delivery_(options.fault, random_),
          foot_(course, course.start_m) {
        place_car();
        const double way_m = course_.closed ? foot_.round_m() * options_.laps : *course_.finish_m - start_m_;
        finish_m_ = course_.closed ? start_m_ + way_m : *course_.finish_m;
        // A car that drives in circles does not finish.
        longest_s_ = 2.5 * way_m / options_.speed_mps + 10.0 + (options_.with_stop ? 20.0 : 0.0);
        lap_m_ = course_.closed ? foot_.round_m() : way_m;
        drift_direction_rad_ = uniform(random_, -std::numbers::pi, std::numbers::pi);
        drift_sense_ = boost::random::uniform_01<double>()(random_) < 0.5 ? -1.0 : 1.0;
        if (options_.with_any_map) {
            const double x_m = uniform(random_, -100.0, 100.0);
            const double y_m = uniform(random_, -100.0, 100.0);
            first_map_ = {uniform(random_, -std::numbers::pi, std::numbers::pi), {x_m, y_m}};
        }
    }

    RaceResult drive() {
        int step = 0;
        for (; step * kStep_s < longest_s_ && !ended_; ++step) {
            if (step % kStepsPerFrame == 0) sense(step);
            while (std::optional<Frame> frame = delivery_.next(step)) answer(*frame, step);
            take_path(step);
            move();
        }
        result_.time_s = step * kStep_s;
        finish_result();
        return std::move(result_);
    }

  private:
    struct Path {
        Drive drive;
        double frame_s = 0.0;
        int arrives = 0;
        double from_m = 0.0;
    };

    void place_car() {
        const auto index = static_cast<std::size_t>(std::lround(course_.start_m / course_.step_m));
        car_.pose = course_.line.at(index);
        if (options_.start_error_m > 0.0 || options_.start_error_rad > 0.0) {
            const double angle_rad = uniform(random_, -std::numbers::pi, std::numbers::pi);
            const double distance_m =
                options_.start_error_m * std::sqrt(boost::random::uniform_01<double>()(random_));
            const double ahead_m = distance_m * std::cos(angle_rad);
            const Pose at = car_.pose;
            Pose moved = at;
            moved.yaw_rad += uniform(random_, -options_.start_error_rad, options_.start_error_rad);
            // The largest offset at which the car still fits into the lane.
            double left_m = distance_m * std::sin(angle_rad);
            for (int i = 0; i < 20; ++i, left_m *= 0.8) {
                moved.position = at.position + ahead_m * at.heading() +
                                 left_m * Point(-at.heading().y(), at.heading().x());
                if (fits(moved, at)) break;
            }
            car_.pose = moved;
        }
        foot_.follow(middle_of(car_.pose), options_.start_error_m + 3.0);
        start_m_ = foot_.at_m();
        start_ = car_.pose.position;
        speed_mps_ = options_.with_stop ? 0.0 : options_.speed_mps;
    }

    [[nodiscard]] bool fits(const Pose& pose, const Pose& start) const {
        const Point middle = middle_of(pose);
        if (course_.half_width_m) {
            return std::abs(start.left_m(middle)) <= *course_.half_width_m - kHalfWidth_m;
        }
        const Point to_left(-pose.heading().y(), pose.heading().x());
        return stays_in_ring(course_.lane, {start.position, middle}) &&
               stays_in_ring(course_.lane, {middle, middle + kHalfWidth_m * to_left}) &&
               stays_in_ring(course_.lane, {middle, middle - kHalfWidth_m * to_left});
    }

    void sense(int step) {
        const double time_s = step * kStep_s;
        const auto comes = [&](double every_s) {
            return step > 0 && std::fmod(time_s + 1e-9, every_s) < kFrame_s / 2.0;
        };
        if (options_.fault == RaceFault::jump && comes(kFaultEvery_s)) {
            const double angle_rad = uniform(random_, -std::numbers::pi, std::numbers::pi);
            first_map_.shift += kJump_m * Point(std::cos(angle_rad), std::sin(angle_rad));
        }
        if (options_.fault == RaceFault::ids && comes(kFaultEvery_s)) world_.change_ids();
        const double share = std::max(0.0, foot_.at_m() - start_m_) / lap_m_;
        map_ = first_map_.turned(
            drift_sense_ * options_.drift_rad * share, start_,
            options_.drift_m * share * Point(std::cos(drift_direction_rad_), std::sin(drift_direction_rad_)));
        const Pose believed = world_.disturbed(car_.pose);
        error_left_m_ = car_.pose.left_m(believed.position);
        error_yaw_rad_ = believed.yaw_rad - car_.pose.yaw_rad;
        Frame frame = world_.look(believed, map_, time_s);
        const bool is_dark = options_.fault == RaceFault::blackout && time_s >= kBlackoutEvery_s &&
                             std::fmod(time_s + 1e-9, kBlackoutEvery_s) < kBlackout_s - 1e-6;
        if (is_dark) frame.cones.clear();
        last_frame_s_ = time_s;
        delivery_.put(std::move(frame), step);
    }

    /// Between frames the car knows its own motion, so the error of the pose stays constant.
    [[nodiscard]] Pose believed() const {
        const Point heading = car_.pose.heading();
        return map_.to_map(Pose{car_.pose.position + error_left_m_ * Point(-heading.y(), heading.x()),
                                car_.pose.yaw_rad + error_yaw_rad_});
    }

    void answer(const Frame& frame, int step) {
        ++result_.frames;
        const auto begin = std::chrono::steady_clock::now();
        Drive drive = driver_(frame);
        result_.answer_ms.push_back(
            std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
        if (drive.is_refused) {
            ++result_.frames_refused;
            return;
        }
        is_planner_ = is_planner_ || !drive.state.empty();
        const bool has_path = drive.path.size() >= 2;
        std::vector<Point> seen_path;
        if (has_path) {
            drive.path = beginning(drive.path, 60.0);
            for (const Point& point : beginning(drive.path, 20.0)) seen_path.push_back(map_.to_world(point));
            if (!path_before_.empty()) {
                ++pairs_;
                if (moved(path_before_, seen_path)) ++unsteady_;
            }
            if (!drive.is_flagged && leaves(course_, seen_path, std::min(kNear_m, drive.safe_m), foot_)) {
                ++result_.wrong_unflagged;
            }
        } else {
            ++result_.frames_without_path;
        }
        path_before_ = seen_path;
        result_.laps_told = std::max(result_.laps_told, drive.lap);
        if (!drive.phase.empty() && (result_.phases.empty() || result_.phases.back() != drive.phase)) {
            result_.phases.push_back(drive.phase);
        }
        if (options_.keep_replay) {
            ReplayFrame kept{step * kStep_s, car_.pose, seen_path, {}, drive.state};
            for (const Cone& cone : frame.cones) kept.seen.push_back(map_.to_world(cone.position));
            result_.replay.push_back(std::move(kept));
        }
        coming_.push_back({std::move(drive), frame.time_s,
                           step + static_cast<int>(std::lround(options_.latency_s / kStep_s))});
    }

    void take_path(int step) {
        while (!coming_.empty() && coming_.front().arrives <= step) {
            Path next = std::move(coming_.front());
            coming_.erase(coming_.begin());
            // An answer to an older frame is worth less than the path that is being driven.
            if (next.frame_s < newest_s_) continue;
            newest_s_ = next.frame_s;
            is_stopping_ = next.drive.stop;
            is_braking_ = next.drive.brake;
            if (next.drive.stop && options_.with_stop && !result_.stop_said_m) {
                result_.stop_said_m = foot_.at_m() - finish_m_;
                if (*result_.stop_said_m < 0.0) end(RaceEnd::stopped_early);
            }
            if (next.drive.path.size() >= 2) {
                driven_ = std::move(next);
                has_begun_ = true;
            } else if (next.drive.brake) {
                driven_.reset();
            }
        }
        const double time_s = step * kStep_s;
        // While a frame is being answered, the path of the frame before it is the latest one.
        const bool is_old =
            driven_ && driven_->frame_s - driven_->drive.age_s < last_frame_s_ - kFrame_s - 1e-9;
        if (is_old) result_.old_path_s += kStep_s;
        if (driven_ && !driven_->drive.stop && time_s - driven_->frame_s > kOldestPath_s + 1e-9) {
            driven_.reset();
        }
    }

    void change_speed() {
        if (is_braking_ || (is_stopping_ && options_.with_stop)) {
            speed_mps_ = std::max(0.0, speed_mps_ - kMaxAcceleration_mps2 * kStep_s);
        } else if (has_begun_ || !options_.with_stop) {
            speed_mps_ = std::min(options_.speed_mps, speed_mps_ + kMaxAcceleration_mps2 * kStep_s);
        }
    }

    void move() {
        change_speed();
        const double wanted_rad = driven_ ? pursue(believed(), driven_->drive.path, lookahead_m(speed_mps_),
                                                   driven_->from_m)
                                          : 0.0;  // straight on without a path
        const Point before = middle_of(car_.pose);
        car_.drive(speed_mps_, wanted_rad, kStep_s);
        const Point middle = middle_of(car_.pose);
        foot_.follow(middle);
        note_hits(middle);
        errors_m_.push_back(foot_.distance_m());
        const bool is_out = course_.half_width_m ? foot_.distance_m() > *course_.half_width_m
                                                 : !stays_in_ring(course_.lane, {before, middle});
        if (is_out) {
            result_.departure_m = std::max(0.0, foot_.at_m() - start_m_);
            end(RaceEnd::departed);
            return;
        }
        const double past_m = foot_.at_m() - finish_m_;
        halted_steps_ = speed_mps_ > 0.0 ? 0 : halted_steps_ + 1;
        const bool has_halted = halted_steps_ * kStep_s >= kMaxHalt_s;
        if (!options_.with_stop) {
            if (past_m >= 0.0) end(RaceEnd::finished);
            if (has_halted) end(RaceEnd::halted);
            return;
        }
        if (past_m > course_.rest_m) {
            end(RaceEnd::not_stopped);
            return;
        }
        if (speed_mps_ <= 0.0 && result_.stop_said_m && past_m >= 0.0) {
            result_.rest_m = past_m;
            const bool tells_phases = is_planner_ && !course_.phases.empty();
            end(tells_phases && result_.phases != course_.phases ? RaceEnd::wrong_phases : RaceEnd::finished);
        } else if (has_halted) {
            end(RaceEnd::halted);
        }
    }

    void note_hits(const Point& middle) {
        const Pose pose{middle, car_.pose.yaw_rad};
        for (std::size_t i = 0; i < course_.cones.size(); ++i) {
            const Point& cone = course_.cones[i].position;
            if ((cone - middle).squaredNorm() > 4.0) continue;
            if (std::abs(pose.ahead_m(cone)) <= kHalfLength_m &&
                std::abs(pose.left_m(cone)) <= kHalfWidth_m) {
                hit_.insert(i);
            }
        }
    }

    void end(RaceEnd how) {
        if (ended_) return;
        result_.end = how;
        ended_ = true;
    }

    void finish_result() {
        result_.driven_m = std::max(0.0, foot_.at_m() - start_m_);
        if (course_.closed) {
            result_.finished_laps = static_cast<int>(std::floor(result_.driven_m / foot_.round_m() + 1e-9));
        } else {
            result_.finished_laps = result_.finished() ? 1 : 0;
        }
        result_.cones_hit = static_cast<int>(hit_.size());
        result_.false_positives = world_.false_positives();
        if (!errors_m_.empty()) {
            const auto rank = static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(errors_m_.size() - 1));
            std::ranges::nth_element(errors_m_, errors_m_.begin() + rank);
            result_.lateral_error_p95_m = errors_m_[static_cast<std::size_t>(rank)];
        }
        if (pairs_ > 0) result_.unsteady_share = static_cast<double>(unsteady_) / pairs_;
    }

    const RaceCourse& course_;
    const RaceOptions& options_;
    const Driver& driver_;
    Generator random_;
    World world_;
    Delivery delivery_;
    Follower foot_;
    Vehicle car_;
    double speed_mps_ = 0.0;
    Point start_{0.0, 0.0};
    double start_m_ = 0.0;
    double finish_m_ = 0.0;
    double lap_m_ = 0.0;
    double longest_s_ = 0.0;

    MapFrame first_map_;
    MapFrame map_;
    double drift_direction_rad_ = 0.0;
    double drift_sense_ = 1.0;
    double error_left_m_ = 0.0;
    double error_yaw_rad_ = 0.0;
    double last_frame_s_ = 0.0;

    std::vector<Path> coming_;
    std::optional<Path> driven_;
    double newest_s_ = -1.0;
    bool has_begun_ = false;
    bool is_stopping_ = false;
    bool is_braking_ = false;
    bool is_planner_ = false;  ///< whether answers have a state
    int halted_steps_ = 0;

    std::vector<Point> path_before_;  ///< in the world
    int pairs_ = 0;
    int unsteady_ = 0;
    std::set<std::size_t> hit_;
    std::vector<double> errors_m_;
    bool ended_ = false;
    RaceResult result_;
};

constexpr std::array kFaults{RaceFault::none,  RaceFault::jump,     RaceFault::late, RaceFault::twice,
                             RaceFault::order, RaceFault::blackout, RaceFault::ids};

}  // namespace

std::string_view to_string(RaceFault fault) {
    switch (fault) {
        case RaceFault::none:
            return "none";
        case RaceFault::jump:
            return "jump";
        case RaceFault::late:
            return "late";
        case RaceFault::twice:
            return "twice";
        case RaceFault::order:
            return "order";
        case RaceFault::blackout:
            return "blackout";
        case RaceFault::ids:
            return "ids";
    }
    return "";
}

RaceFault race_fault(std::string_view name) {
    for (const RaceFault fault : kFaults) {
        if (to_string(fault) == name) return fault;
    }
    throw InvalidInput(
        "--fault", "'" + std::string(name) + "' is not one of none, jump, late, twice, order, blackout, ids");
}

std::string_view to_string(RaceEnd end) {
    switch (end) {
        case RaceEnd::finished:
            return "finished";
        case RaceEnd::departed:
            return "departed";
        case RaceEnd::stopped_early:
            return "stopped early";
        case RaceEnd::not_stopped:
            return "not stopped";
        case RaceEnd::halted:
            return "halted";
        case RaceEnd::wrong_phases:
            return "wrong phases";
        case RaceEnd::too_long:
            return "too long";
    }
    return "";
}

Driver truth_driver(const RaceCourse& course, int laps) {
    return [&course, laps, at = Follower(course, course.start_m),
            finish_m = std::optional<double>{}](const Frame& frame) mutable {
        at.follow(frame.pose.position, 6.0);
        if (!finish_m) {
            finish_m = course.finish_m.value_or(at.at_m() + laps * at.round_m()) + kStopMargin_m;
        }
        Drive drive;
        const auto first = static_cast<long>(std::floor(at.at_m() / course.step_m));
        for (long i = 0; i <= static_cast<long>(kTruthAhead_m / course.step_m); ++i) {
            if (const std::optional<Point> point = at.place(first + i)) drive.path.push_back(*point);
        }
        drive.stop = at.at_m() >= *finish_m;
        return drive;
    };
}

RaceResult race(const RaceCourse& course, const RaceOptions& options, const Driver& driver) {
    return Run(course, options, driver).drive();
}

}  // namespace conelane::experiments
