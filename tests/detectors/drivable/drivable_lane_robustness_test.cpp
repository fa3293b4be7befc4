#include "tests/support/drivable_checks.hpp"
#include "tests/support/refusal.hpp"

namespace conelane::tests {
namespace {

TEST(DrivableLane, DoubledAndCoincidentConesChangeLittle) {
    const Course course = winding();
    Course doubled = course;
    const auto add_beside = [&](const Point& shift) {
        Cone cone = doubled.scene.cones[10];  // the sixth on the left
        cone.id = 77;
        cone.position += shift;
        doubled.scene.cones.push_back(cone);
        doubled.lane.left.insert(doubled.lane.left.begin() + 6, cone.id);
    };
    const DrivableLane lane = course.driven();
    for (const Point& shift : {Point(0.0, 0.0), Point(0.2, 0.05), Point(-0.1, -0.1)}) {
        doubled = course;
        add_beside(shift);
        const DrivableLane other = doubled.driven();
        expect_drivable(doubled, other);
        ASSERT_EQ(other.points.size(), lane.points.size());
        for (std::size_t i = 0; i < lane.points.size(); ++i)
            EXPECT_LT((other.points[i].position - lane.points[i].position).norm(), 0.15);
    }
}

TEST(DrivableLane, ConesOfNoLaneDoNotMatter) {
    Course course = winding();
    const DrivableLane lane = course.driven();
    course.scene.cones.push_back({.id = 99, .position = {3.0, std::numeric_limits<double>::quiet_NaN()}});
    std::ranges::reverse(course.scene.cones);
    const DrivableLane other = course.driven();
    ASSERT_EQ(other.points.size(), lane.points.size());
    for (std::size_t i = 0; i < lane.points.size(); ++i)
        EXPECT_EQ(other.points[i].position, lane.points[i].position);
}

TEST(DrivableLane, ALaneWithoutExtentHasNoPoints) {
    const auto expect_none = [](const Course& course) {
        const DrivableLane lane = course.driven();
        EXPECT_TRUE(lane.points.empty());
        EXPECT_EQ(lane.length_m, 0.0);
        EXPECT_FALSE(lane.closed);
    };
    expect_none({});
    expect_none(straight({}, {4.0}));
    expect_none(straight({4.0, 4.0}, {}));
    expect_none(straight({4.0}, {4.0}));
    expect_none(straight({4.0, 4.0, 4.0}, {4.0, 4.0}));
    expect_none(straight({4.0, 4.1}, {4.0, 4.2}));
    expect_none(course_of({{4, 0}, {4, 0}}, {{4, 0}, {4, 0}}));
    expect_none(course_of({{0, 0}, {4, 0}, {8, 0}}, {{0, 0}, {4, 0}, {8, 0}}));     // no width
    expect_none(course_of({{0, -2}, {4, -2}, {8, -2}}, {{0, 2}, {4, 2}, {8, 2}}));  // swapped sides
    expect_none(course_of({{0, 0}, {4, 0}, {8, 0}}, {{0, 0.6}, {4, 0.6}, {8, 0.6}}));
}

TEST(DrivableLane, EndsWhereItsBoundariesMeet) {
    const Course crossing =
        course_of({{0, 2}, {10, 2}, {20, -2}, {30, -2}}, {{0, -2}, {10, -2}, {20, 2}, {30, 2}});
    const DrivableLane lane = crossing.driven();
    EXPECT_GT(lane.length_m, 10.0);
    EXPECT_LT(lane.length_m, 15.0);
    for (const DrivablePoint& point : lane.points) {
        EXPECT_GT(point.width_left_m, 0.2);
        EXPECT_GT(point.width_right_m, 0.2);
        EXPECT_LT(point.position.x(), 15.0);
    }
    // A closed lane with a narrow place is open: it runs from the car to that place.
    Course closed = circle(12.0, 1.0, 2.0, 2.0 * kPi, true);
    Cone& inner = closed.scene.cones[closed.lane.left.size() / 2];
    inner.position = Point(0.0, 12.0) + (inner.position - Point(0.0, 12.0)) * 13.4 / 10.4;
    const DrivableLane open = closed.driven();
    EXPECT_FALSE(open.closed);
    EXPECT_GT(open.length_m, 30.0);
    EXPECT_LT(open.length_m, 38.0);
}

void expect_refused(const Course& course, const std::string& key, const DrivableOptions& options = {}) {
    EXPECT_EQ(refused_key([&] { (void)course.driven(options); }), key);
}

TEST(DrivableLane, RefusesInvalidLanes) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const double infinity = std::numeric_limits<double>::infinity();
    const Course good = straight(range(0.0, 20.0, 4.0), range(0.0, 20.0, 4.0));
    const auto with = [&](const std::function<void(Course&)>& change) {
        Course course = good;
        change(course);
        return course;
    };
    expect_refused(with([](Course& c) { c.lane.left[2] = 555; }), "left[2]");
    expect_refused(with([](Course& c) { c.lane.right[1] = c.lane.left[0]; }), "right[1]");
    expect_refused(with([](Course& c) { c.lane.right.push_back(c.lane.right[0]); }), "right[6]");
    expect_refused(with([](Course& c) { c.scene.cones.push_back(c.scene.cones[3]); }), "left[3]");
    expect_refused(with([&](Course& c) { c.scene.cones[1].position.x() = nan; }), "left[1]");
    expect_refused(with([&](Course& c) { c.scene.cones[1].position.y() = -infinity; }), "left[1]");
    expect_refused(with([](Course& c) { c.scene.cones[1].position.y() = 2e6; }), "left[1]");
    expect_refused(with([](Course& c) { c.scene.cones[1].position.x() = 1e5; }), "left");
    expect_refused(with([&](Course& c) { c.scene.pose.position.x() = nan; }), "pose");
    expect_refused(with([&](Course& c) { c.scene.pose.yaw_rad = infinity; }), "pose.yaw");
    expect_refused(with([](Course& c) {
                       c.lane.closed = true;
                       c.lane.right.resize(2);
                   }),
                   "right");
    for (const double step : {0.0, -1.0, 0.009, 100.1, nan, infinity})
        expect_refused(good, "step_m", {.step_m = step});
    for (const double smoothing : {0.2, 5.1, nan})
        expect_refused(good, "smoothing_m", {.smoothing_m = smoothing});
    for (const double width : {0.9, 6.6, nan})
        expect_refused(good, "default_width_m", {.default_width_m = width});
    for (const double gap : {0.0, nan}) expect_refused(good, "max_gap_m", {.max_gap_m = gap});
}

TEST(DrivableLane, AnyLaneGivesFiniteNumbers) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> anywhere(-15.0, 15.0);
    std::uniform_int_distribution<int> count(1, 9);
    std::size_t with_points = 0;
    for (int trial = 0; trial < 2000; ++trial) {
        SCOPED_TRACE(trial);
        Course course;
        for (const bool on_left : {true, false}) {
            for (int i = count(random); i > 0; --i) {
                const bool on_grid = trial % 3 == 0;  // collinear and coincident cones
                const Point place(anywhere(random), anywhere(random));
                course.add(
                    on_grid ? 5.0 * Point(std::round(place.x() / 5.0), std::round(place.y() / 5.0)) : place,
                    on_left);
            }
        }
        course.lane.closed = trial % 2 == 0 && course.lane.left.size() > 4 && course.lane.right.size() > 4;
        course.scene.pose = {{anywhere(random), anywhere(random)}, anywhere(random)};
        DrivableLane lane;
        try {
            lane = course.driven();
        } catch (const InvalidInput&) {  // closed, and too few cones at different places
            EXPECT_TRUE(course.lane.closed);
            continue;
        }
        EXPECT_TRUE(all_finite(lane));
        EXPECT_EQ(lane.points.empty(), lane.length_m == 0.0);
        with_points += lane.points.empty() ? 0 : 1;
        for (const DrivablePoint& point : lane.points)
            EXPECT_GT(std::min(point.width_left_m, point.width_right_m), 0.0);
    }
    EXPECT_GT(with_points, 300U);
}

}  // namespace
}  // namespace conelane::tests
