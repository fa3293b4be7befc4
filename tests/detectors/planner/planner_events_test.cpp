// Whole events with the planner: laps, phases, the last line, the stop; generated events and recorded runs.

#include "conelane/invalid_input.hpp"
#include "evaluation/formats/frame_file.hpp"
#include "tests/support/no_time_limit.hpp"
#include "tests/support/plan_checks.hpp"
#include "tests/support/planner_frames.hpp"
#include "tests/support/recorded_tracks.hpp"

namespace conelane {
namespace {

using tests::DrivenCourse;
using tests::frame_at;
using tests::kNoTimeLimit;
using tests::Sight;

/// The states, phases and laps of a drive at constant speed.
struct Told {
    std::vector<PlanState> states;         ///< without repetitions
    std::vector<std::string_view> phases;  ///< without repetitions
    std::optional<double> stop_m;          ///< first place with a stop
    std::vector<double> laps_m;            ///< places at which laps counted
    int frames = 0;
    int without_path = 0;
    double farthest_m = 0.0;  ///< largest distance of the first metres of a path from the middle
    Plan last;
};

Told drive(Planner& planner, const DrivenCourse& course, double to_m, const Sight& sight = {},
           double from_m = 0.0) {
    Told told;
    std::mt19937 random(5);
    constexpr double kStep_m = 0.6;
    for (int i = 0; from_m + kStep_m * i <= to_m; ++i) {
        const double s_m = from_m + kStep_m * i;
        SCOPED_TRACE(s_m);
        const Frame frame = frame_at(course, s_m, 0.1 * i, sight, &random);
        Plan plan = planner.update(frame, kNoTimeLimit);
        tests::expect_consistent(plan, course.mission, frame.pose);
        if (told.states.empty() || told.states.back() != plan.state) told.states.push_back(plan.state);
        if (told.phases.empty() || told.phases.back() != plan.phase) told.phases.push_back(plan.phase);
        if (plan.stop && !told.stop_m) told.stop_m = s_m;
        while (static_cast<std::size_t>(plan.lap) > told.laps_m.size()) told.laps_m.push_back(s_m);
        ++told.frames;
        if (plan.lane.points.empty()) ++told.without_path;
        DrivableLane near = plan.lane;
        std::erase_if(near.points, [](const DrivablePoint& point) { return point.s_m > 5.0; });
        told.farthest_m = std::max(told.farthest_m, tests::farthest_from_middle_m(course, s_m, near));
        told.last = std::move(plan);
    }
    return told;
}

/// How far a closed line is from the middle of a course at most.
double course_error_m(const DrivableLane& line, const DrivenCourse& course) {
    double farthest_m = 0.0;
    for (const DrivablePoint& point : line.points) {
        double nearest_m = std::numeric_limits<double>::infinity();
        for (double s_m = 0.0; s_m < course.lap_m; s_m += 0.1) {
            nearest_m = std::min(nearest_m, (course.pose(s_m).position - point.position).norm());
        }
        farthest_m = std::max(farthest_m, nearest_m);
    }
    return farthest_m;
}

/// Expects a stop at most so far past the line: a stop before it loses the run.
void expect_stop_behind_line(const Told& told, const DrivenCourse& course, double within_m) {
    ASSERT_TRUE(told.stop_m);
    EXPECT_GE(*told.stop_m, course.finish_m - 1e-9);
    EXPECT_LT(*told.stop_m, course.finish_m + within_m);
}

TEST(PlannerEvent, LapsAreCountedAtTheLineAndTheLastOneEndsTheRun) {
    const DrivenCourse course = tests::oval(2);
    const auto planner = make_planner({.mission = Mission::trackdrive, .laps = 2});
    EXPECT_FALSE(planner->course());
    const Told told = drive(*planner, course, course.finish_m + 6.0);
    EXPECT_LE(told.without_path, 1);
    EXPECT_LT(told.farthest_m, 0.5);
    ASSERT_EQ(told.laps_m.size(), 2U);
    EXPECT_NEAR(told.laps_m[0], course.lap_m, 1.5);
    EXPECT_NEAR(told.laps_m[1], 2.0 * course.lap_m, 1.5);
    expect_stop_behind_line(told, course, 5.0);
    EXPECT_EQ(told.last.state, PlanState::finished);
    EXPECT_EQ(told.last.lap, 2);
    // The rest of the path ends within 30 m past the line.
    EXPECT_GT(told.last.lane.length_m, 5.0);
    EXPECT_LE(told.last.lane.length_m, 30.0 - 5.0);
}

TEST(PlannerEvent, TheCourseIsClosedAfterALapAndIsTheMiddleOfTheLane) {
    const DrivenCourse course = tests::oval(2);
    const auto planner = make_planner({.mission = Mission::trackdrive, .laps = 2});
    (void)drive(*planner, course, course.lap_m / 2.0);
    EXPECT_FALSE(planner->course());
    planner->reset();
    (void)drive(*planner, course, course.lap_m + 10.0);
    const auto known = planner->course();
    ASSERT_TRUE(known);
    EXPECT_TRUE(known->closed);
    EXPECT_NEAR(known->length_m, course.lap_m, 1.0);
    EXPECT_LT(course_error_m(*known, course), 0.25);
    for (const DrivablePoint& point : known->points) {
        EXPECT_NEAR(point.width_left_m, 1.75, 0.4);
        EXPECT_NEAR(point.width_right_m, 1.75, 0.4);
    }
}

/// Also 8 m before the gate of orange cones: then the start counts when the car crosses it.
TEST(PlannerEvent, AnAutocrossEndsAfterOneLapWhereverTheRunBegins) {
    const DrivenCourse course = tests::oval(1);
    for (const bool is_before_gate : {false, true}) {
        const auto planner = make_planner({.mission = Mission::autocross});
        const Told told = drive(*planner, course, course.finish_m + 5.0, {.with_color = is_before_gate},
                                is_before_gate ? -8.0 : 0.0);
        expect_stop_behind_line(told, course, 4.0);
        EXPECT_EQ(told.last.lap, 1);
    }
}

TEST(PlannerEvent, AnAutocrossEndsAtAFinishElsewhere) {
    for (const double beyond_m : {0.0, 20.0}) {
        for (const double range_m : {12.0, 20.0}) {
            SCOPED_TRACE(testing::Message() << beyond_m << " m beyond, range " << range_m);
            const DrivenCourse course = tests::from_gate_to_gate(beyond_m);
            const auto planner = make_planner({.mission = Mission::autocross});
            const Sight sight{.range_m = range_m, .with_color = true, .noise_m = 0.05};
            const Told told = drive(*planner, course, course.finish_m + beyond_m + 3.0, sight, -6.0);
            EXPECT_LE(told.without_path, 1) << "there is a way across the line";
            EXPECT_LT(told.farthest_m, 0.5);
            ASSERT_TRUE(told.stop_m);
            EXPECT_GE(*told.stop_m, course.finish_m - 0.3);
            EXPECT_LT(*told.stop_m, course.finish_m + beyond_m + 2.0) << "the course ends";
            EXPECT_EQ(told.last.state, PlanState::finished);
            EXPECT_EQ(told.last.lap, 1);
            EXPECT_GT(told.last.lane.length_m, 4.0) << "to come to rest on";
            EXPECT_LE(told.last.lane.length_m, 30.0 - beyond_m);
        }
    }
}

TEST(PlannerEvent, ACarThatIsLostBesideAFinishStaysLost) {
    const DrivenCourse course = tests::from_gate_to_gate();
    for (const bool turned : {false, true}) {
        const auto planner = make_planner({.mission = Mission::autocross});
        (void)drive(*planner, course, course.finish_m - 4.0, {.with_color = true}, -6.0);
        Pose pose = course.pose(course.finish_m - 1.0);
        if (turned) pose.yaw_rad += std::numbers::pi;
        if (!turned) pose.position += 10.0 * Point(-pose.heading().y(), pose.heading().x());
        const Plan plan = planner->update({60.0, pose, {}}, kNoTimeLimit);
        EXPECT_EQ(plan.state, PlanState::lost);
        EXPECT_TRUE(plan.lane.points.empty());
    }
}

// Nothing tells a second gate of a circuit from a finish but what is behind it.
TEST(PlannerEvent, AGateThatIsPassedOnACircuitEndsNothing) {
    DrivenCourse course = tests::oval(1);
    for (Cone& cone : course.cones) {
        if (cone.color == ConeColor::orange)
            cone.color = cone.position.y() > 0.0 ? ConeColor::blue : ConeColor::yellow;
        if (std::abs(cone.position.x()) < 1.6 && cone.position.y() > 8.0) cone.color = ConeColor::orange;
    }
    ASSERT_GE(std::ranges::count(course.cones, ConeColor::orange, &Cone::color), 2);
    const auto planner = make_planner({.mission = Mission::autocross});
    const Told told = drive(*planner, course, course.finish_m + 4.0, {.with_color = true});
    expect_stop_behind_line(told, course, 4.0);
}

TEST(PlannerEvent, NoiseWithoutIdsLeavesTheLapsAsTheyAre) {
    const DrivenCourse course = tests::oval(2);
    const auto planner = make_planner({.mission = Mission::trackdrive, .laps = 2});
    const Told told = drive(*planner, course, course.finish_m + 6.0,
                            {.with_ids = false, .with_color = true, .noise_m = 0.08});
    EXPECT_EQ(told.last.state, PlanState::finished);
    EXPECT_EQ(told.laps_m.size(), 2U);
    EXPECT_LT(told.farthest_m, 0.8);
    ASSERT_TRUE(planner->course());
    EXPECT_LT(course_error_m(*planner->course(), course), 0.35);
}

TEST(PlannerEvent, AtRestAtTheEndNothingIsLeftToDrive) {
    for (const Mission mission : {Mission::autocross, Mission::acceleration, Mission::skidpad}) {
        SCOPED_TRACE(to_string(mission));
        const DrivenCourse course = tests::course_of(mission);
        const auto planner = make_planner({.mission = mission});
        const double rest_m = mission == Mission::acceleration ? 100.0
                              : mission == Mission::skidpad    ? 25.0
                                                               : 30.0;
        const Told told = drive(*planner, course, course.finish_m + rest_m + 0.5);
        EXPECT_EQ(told.last.state, PlanState::finished);
        EXPECT_TRUE(told.last.stop);
        EXPECT_LT(told.last.lane.length_m, 1.5);
    }
}

/// Resident memory of this process [KiB]; 0 if unknown.
long resident_kib() {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);) {
        if (line.starts_with("VmRSS:")) return std::stol(line.substr(6));
    }
    return 0;
}

// New false positives in each frame, for as long as an hour of driving in circles.
TEST(PlannerHour, MemoryIsBounded) {
    const DrivenCourse course = tests::oval(100000, 4.0);
    const auto planner = make_planner({.mission = Mission::trackdrive, .laps = 100000});
    std::mt19937 random(3);
    std::uniform_real_distribution<double> place(-30.0, 30.0);
    constexpr int kFrames = 36000;
    long warm_kib = 0;
    ConeId id = 100000;
    for (int i = 0; i < kFrames; ++i) {
        Frame frame = frame_at(course, 0.6 * i, 0.1 * i, {.range_m = 12.0});
        for (int k = 0; k < 3; ++k) frame.cones.push_back({id++, {place(random), 8.0 + place(random)}});
        (void)planner->update(frame, kNoTimeLimit);
        if (i == kFrames / 10) warm_kib = resident_kib();
    }
    if (warm_kib == 0) GTEST_SKIP() << "the system does not tell resident memory";
    EXPECT_LT(resident_kib() - warm_kib, 4096);
}

/// Frames of a run of ft-fsd, ten a second, without ids; none if the data are missing.
std::vector<Frame> recorded_frames(const std::string& name) {
    const std::filesystem::path file = recorded_data() / "ft_fsd" / (name + ".json");
    std::vector<Frame> frames;
    if (!std::filesystem::exists(file)) return frames;
    for (const FrameLine& line : read_frames(file, 0.1)) frames.push_back(*line.frame);
    return frames;
}

class RecordedEvent : public testing::Test {
  protected:
    void read(const std::string& name) {
        frames_ = recorded_frames(name);
        if (frames_.empty()) GTEST_SKIP() << "no " << name << " in CONELANE_DATA or in ../shared/data";
    }
    std::vector<Frame> frames_;
};

/// Two laps of FSG 2019. The recording ends 1 m before its start, 7 m before the gate. The poses of the first
/// crossing, with the cones of the last map, complete the second lap.
class RecordedLaps : public RecordedEvent {
  protected:
    void SetUp() override {
        read("fsg_19_2_laps");
        if (IsSkipped()) return;
        const std::vector<Frame> first(frames_.begin() + 246, frames_.begin() + 254);
        const std::vector<Cone> map = frames_.back().cones;
        for (const Frame& frame : first) frames_.push_back({frames_.back().time_s + 0.1, frame.pose, map});
    }
    std::unique_ptr<Planner> planner_ = make_planner({.mission = Mission::trackdrive, .laps = 2});
};

TEST_F(RecordedLaps, AreBothCountedAndTheCourseIsClosed) {
    int without_path = 0;
    std::vector<std::size_t> frame_of_lap;
    Plan plan;
    for (std::size_t i = 0; i < frames_.size(); ++i) {
        plan = planner_->update(frames_[i], kNoTimeLimit);
        if (plan.lane.points.empty()) ++without_path;
        if (static_cast<std::size_t>(plan.lap) > frame_of_lap.size()) frame_of_lap.push_back(i);
    }
    EXPECT_LE(without_path, 4);
    EXPECT_EQ(plan.lap, 2);
    EXPECT_EQ(plan.state, PlanState::finished);
    ASSERT_EQ(frame_of_lap.size(), 2U);
    EXPECT_NEAR(static_cast<double>(frame_of_lap.front()), 250.0, 5.0) << "the first crossing";
    const auto course = planner_->course();
    ASSERT_TRUE(course);
    EXPECT_TRUE(course->closed);
}

/// The nearest segment of a closed boundary.
Segment nearest_segment(const std::vector<Point>& boundary, const Point& place) {
    Segment nearest{boundary.back(), boundary.front()};
    for (std::size_t i = 0; i + 1 < boundary.size(); ++i) {
        const Segment segment{boundary[i], boundary[i + 1]};
        if (foot_point(place, segment).distance_m < foot_point(place, nearest).distance_m) nearest = segment;
    }
    return nearest;
}

// In the map, the right boundary lacks 15 m of cones on the inside of a bend. A straight line across this gap
// is not a boundary: the middle between it and the left boundary is up to 1.3 m off the middle of a lane of
// the usual width. Beside the gap, the course must be that middle, along the left boundary; elsewhere it must
// be the middle of the map.
TEST_F(RecordedLaps, GiveTheMiddleOfTheMapAsCourseAndConsistentPlans) {
    for (std::size_t i = 0; i < frames_.size(); ++i) {
        SCOPED_TRACE(i);
        tests::expect_consistent(planner_->update(frames_[i], kNoTimeLimit), Mission::trackdrive,
                                 frames_[i].pose);
    }
    const auto course = planner_->course();
    ASSERT_TRUE(course);
    const std::filesystem::path file = recorded_data() / "ft_fsd" / "fsg_19_2_laps.json";
    const experiments::RaceCourse map = experiments::circuit(load_tracks("ftlog:" + file.string()).front());
    constexpr double kGap_m = 10.0;
    const double half_width_m = 0.5 * DrivableOptions{}.default_width_m;
    double beside_gap_m = 0.0;
    for (std::size_t i = 0; i < course->points.size(); ++i) {
        const DrivablePoint& point = course->points[i];
        SCOPED_TRACE(point.s_m);
        double nearest_m = std::numeric_limits<double>::infinity();
        for (const Pose& pose : map.line) {
            nearest_m = std::min(nearest_m, (pose.position - point.position).norm());
        }
        const Segment right = nearest_segment(map.lane.right, point.position);
        if ((right.to - right.from).norm() < kGap_m) {
            EXPECT_LT(nearest_m, 0.3);
            continue;
        }
        beside_gap_m += course->length_m / static_cast<double>(course->points.size());
        const Segment left = nearest_segment(map.lane.left, point.position);
        EXPECT_NEAR(foot_point(point.position, left).distance_m, half_width_m, 0.3);
    }
    EXPECT_LT(beside_gap_m, 20.0);
    EXPECT_NEAR(course->length_m, map.length_m, 0.02 * map.length_m);
}

TEST_F(RecordedEvent, ARealSkidpadIsDrivenInItsPhases) {
    read("skidpad");
    if (IsSkipped()) return;
    const std::vector<Frame>& frames = frames_;
    const auto planner = make_planner({.mission = Mission::skidpad});
    std::vector<std::string_view> phases;
    int without_path = 0;
    for (std::size_t i = 0; i < frames.size(); ++i) {
        SCOPED_TRACE(i);
        const Plan plan = planner->update(frames[i], kNoTimeLimit);
        tests::expect_consistent(plan, Mission::skidpad, frames[i].pose);
        if (phases.empty() || phases.back() != plan.phase) phases.push_back(plan.phase);
        if (plan.lane.points.empty() && !frames[i].cones.empty()) ++without_path;
    }
    EXPECT_EQ(phases, std::vector<std::string_view>(tests::kPhases.begin(), tests::kPhases.end()));
    EXPECT_LE(without_path, 10);
}

}  // namespace
}  // namespace conelane
