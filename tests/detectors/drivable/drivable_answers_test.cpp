// `make_detector` adds to a detector: a lane that is found can be driven, and has a trusted length.

#include "detectors/drivable/drivable_answers.hpp"

#include "tests/support/drivable_courses.hpp"
#include "tests/support/no_time_limit.hpp"

namespace conelane {
namespace {

using tests::Course;

/// Gives one answer, whatever it is asked.
class Says final : public LaneDetector {
  public:
    explicit Says(LaneAnswer answer) : answer_(std::move(answer)) {}

  private:
    LaneAnswer search(const Scene& /*scene*/, const DetectionLimits& /*limits*/) override { return answer_; }
    LaneAnswer answer_;
};

/// Finds nothing, and notes the time that it is given.
class NotesItsLimit final : public LaneDetector {
  public:
    explicit NotesItsLimit(double& time_limit_ms) : time_limit_ms_(&time_limit_ms) {}

  private:
    LaneAnswer search(const Scene& /*scene*/, const DetectionLimits& limits) override {
        *time_limit_ms_ = limits.time_limit_ms;
        return {};
    }
    double* time_limit_ms_;
};

LaneAnswer found(const Lane& lane) {
    return LaneAnswer{.status = LaneStatus::found, .lane = lane};
}

LaneAnswer answered(const LaneAnswer& said, const Scene& scene) {
    return answer_drivable_lanes(std::make_unique<Says>(said))->detect(scene, tests::kNoTimeLimit);
}

/// A lane with its boundaries exchanged.
Course swapped() {
    Course course = tests::straight(tests::range(0.0, 20.0, 4.0), tests::range(0.0, 20.0, 4.0));
    std::swap(course.lane.left, course.lane.right);
    return course;
}

TEST(DrivableAnswers, ALaneThatCannotBeDrivenIsNotFound) {
    const Course course = swapped();
    LaneAnswer said = found(course.lane);
    said.confidence = 0.5;
    said.optimality = Optimality{1.0, 1.0, true};
    ASSERT_TRUE(drivable(said, course.scene).points.empty());
    const LaneAnswer answer = answered(said, course.scene);
    EXPECT_EQ(answer.status, LaneStatus::stopped) << "nothing is proven";
    EXPECT_EQ(answer.stopped_by, StopReason::iterations);
    EXPECT_EQ(answer.lane, Lane{});
    EXPECT_FALSE(answer.message.empty());
    EXPECT_FALSE(answer.confidence);
    EXPECT_FALSE(answer.trusted_m);
    EXPECT_FALSE(answer.optimality);
    said.stopped_by = StopReason::time;
    EXPECT_EQ(answered(said, course.scene).stopped_by, StopReason::time);
}

TEST(DrivableAnswers, ALaneBeyondWhatCanBeDrivenAtAllIsNotFound) {
    Course course = tests::straight({0.0, 5.0, 30'000.0}, {0.0, 5.0});
    EXPECT_EQ(answered(found(course.lane), course.scene).status, LaneStatus::stopped);
}

/// Frame 176 of the run fsg_19_2_laps. Its map lacks cones at a bend: the left boundary continues along the
/// other one, once around the course and back to the car.
TEST(DrivableAnswers, ABoundarySeenAloneIsCutBeforeItsFirstGapIfItCannotBeDriven) {
    Course course = tests::course_of({{2.0, 1.75}, {6.0, 1.75}, {10.0, 1.75}, {18.0, -1.75}}, {});
    // The part beside the car, from the cone behind the gap on.
    for (const double x : tests::range(-18.0, 0.0, 3.0)) course.add({-x, -1.75}, true);
    ASSERT_TRUE(course.driven().points.empty());
    const LaneAnswer answer = answered(found(course.lane), course.scene);
    ASSERT_EQ(answer.status, LaneStatus::found);
    EXPECT_EQ(answer.lane.left, (std::vector<ConeId>{0, 1, 2}));
    EXPECT_FALSE(drivable(answer, course.scene).points.empty());
    EXPECT_NEAR(answer.trusted_m.value_or(-1.0), 8.0, 0.05);
}

TEST(DrivableAnswers, TheSearchLeavesTimeForTheCheck) {
    const auto given_ms = [](double time_limit_ms) {
        double given = -1.0;
        const Course course = tests::straight({0.0, 4.0}, {0.0, 4.0});
        (void)answer_drivable_lanes(std::make_unique<NotesItsLimit>(given))
            ->detect(course.scene, {.time_limit_ms = time_limit_ms});
        return given;
    };
    // Merging doubled cones takes some of it before.
    EXPECT_LE(given_ms(50.0), 48.0);
    EXPECT_LE(given_ms(1000.0), 998.0);
    EXPECT_LE(given_ms(10.0), 9.6);
    EXPECT_GT(given_ms(1e9), 0.9e9);
    EXPECT_EQ(given_ms(tests::kNoTimeLimit.time_limit_ms), tests::kNoTimeLimit.time_limit_ms);
    EXPECT_EQ(given_ms(-tests::kNoTimeLimit.time_limit_ms), -tests::kNoTimeLimit.time_limit_ms);
}

TEST(DrivableAnswers, OtherAnswersStayUnchanged) {
    LaneAnswer said{.status = LaneStatus::none};
    EXPECT_EQ(answered(said, swapped().scene).status, LaneStatus::none);
    said.status = LaneStatus::error;
    said.message = "a fault";
    EXPECT_EQ(answered(said, swapped().scene).message, "a fault");
}

TEST(DrivableAnswers, TrustIsKeptWhereItIsKnown) {
    const Course course = tests::straight(tests::range(0.0, 20.0, 4.0), tests::range(0.0, 20.0, 4.0));
    LaneAnswer said = found(course.lane);
    for (const double trusted_m : {0.0, 3.0, 50.0}) {
        said.trusted_m = trusted_m;
        EXPECT_EQ(answered(said, course.scene).trusted_m, trusted_m);
    }
}

TEST(DrivableAnswers, WithoutAProbabilityTrustEndsAtAGapOrAfterTenMetres) {
    const auto trusted_m = [](const std::vector<double>& left_x, const std::vector<double>& right_x) {
        const Course course = tests::straight(left_x, right_x);
        const LaneAnswer answer = answered(found(course.lane), course.scene);
        EXPECT_EQ(answer.lane, course.lane);
        EXPECT_FALSE(answer.confidence);
        return answer.trusted_m.value_or(-1.0);
    };
    const std::vector<double> whole = tests::range(0.0, 20.0, 4.0);
    EXPECT_EQ(trusted_m(whole, whole), 10.0);
    EXPECT_NEAR(trusted_m({0.0, 4.0, 8.0}, {0.0, 4.0, 8.0}), 8.0, 0.05) << "its length";
    EXPECT_NEAR(trusted_m({0.0, 4.0, 12.0, 16.0}, whole), 4.0, 0.3) << "a cone is missing behind 4 m";
    EXPECT_NEAR(trusted_m({0.0, 4.0, 8.0}, {}), 8.0, 0.05) << "a boundary seen alone";
    EXPECT_NEAR(trusted_m({}, {0.0, 4.0, 12.0, 16.0}), 4.0, 0.3) << "with a gap";
    EXPECT_EQ(trusted_m({-1.0, 9.0, 12.0}, {-1.0, 9.0, 12.0}), 0.0) << "the car stands in the gap";
}

}  // namespace
}  // namespace conelane
