// The registration of a known course: compared with a search of the test's own over all poses, with false
// positives, and without a course.

#include "detectors/planner/known_gates.hpp"
#include "tests/detectors/planner/known_event.hpp"
#include "tests/support/testing.hpp"

namespace conelane {
namespace {

using known_event::in_map;
using known_event::Sight;

struct Seen {
    Frame frame;
    std::vector<SeenCone> cones;
    std::vector<SeenView> views;
};

Seen seen_from(const std::vector<Point>& cones, const Pose& pose, const Pose& course, double noise_m,
               unsigned seed) {
    Seen seen;
    seen.frame = Sight(cones, noise_m, 0.0, seed).look(pose, course, 0.0);
    for (const Cone& cone : seen.frame.cones) seen.cones.push_back({cone.position, cone.color, 1, 0.0});
    seen.views.push_back(view_of(seen.frame));
    return seen;
}

/// The registration that explains the cones alone.
std::optional<RegistrationFit> search(const KnownRegistration& known, const Seen& seen, const Pose& car,
                                      const Pose& expected, const Deadline& deadline = Deadline()) {
    const auto found = known.contenders(seen.cones, seen.views, car, expected, {}, deadline);
    return found.size() == 1 ? std::optional(found.front()) : std::nullopt;
}

std::vector<Point> with_false(std::vector<Point> cones, int count, const Point& about, unsigned seed) {
    for (const Point& point : Sight::strewn(count, about, 20.0, seed)) cones.push_back(point);
    return cones;
}

/// The error of a registration: distance of the car from its true place in the course, and rotation.
std::pair<double, double> error_of(const Registration& registration, const Pose& pose, const Pose& course) {
    const Pose car = in_map(course, pose);
    return {(registration.to_course(car.position) - pose.position).norm(),
            std::abs(std::remainder(car.yaw_rad - registration.course.yaw_rad - pose.yaw_rad,
                                    2.0 * std::numbers::pi))};
}

TEST(KnownRegistration, FindsTheSkidpadFromAnyPoseNearTheStart) {
    const KnownRegistration known(known_course(Mission::skidpad));
    std::mt19937 random(5);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    for (unsigned i = 0; i < 30; ++i) {
        const double x_m = -15.75 + 3.0 * unit(random);
        const double y_m = unit(random);
        const Pose pose{{x_m, y_m}, 0.35 * unit(random)};
        const double yaw_rad = 3.1 * unit(random);
        const Pose course{{80.0 * unit(random), -40.0}, yaw_rad};
        const Seen seen =
            seen_from(with_false(known_event::skidpad_cones(), 25, {-5.0, 0.0}, i), pose, course, 0.1, i);
        const auto found = search(known, seen, in_map(course, pose), {{known.course().start_x_m, 0.0}, 0.0});
        ASSERT_TRUE(found) << i;
        const auto [off_m, turned_rad] = error_of(found->registration, pose, course);
        EXPECT_LT(off_m, 0.3) << i;
        EXPECT_LT(turned_rad, 0.03) << i;
    }
}

TEST(KnownRegistration, FindsTheLaneOfAnAccelerationOfAnyWidth) {
    const KnownRegistration known(known_course(Mission::acceleration));
    std::mt19937 random(6);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    for (unsigned i = 0; i < 30; ++i) {
        const double half_m = 2.0 + 0.5 * unit(random);
        const double x_m = -1.5 + 3.0 * unit(random);
        const Pose pose{{x_m, unit(random)}, 0.35 * unit(random)};
        const Pose course{{10.0, 20.0}, 3.1 * unit(random)};
        const Seen seen = seen_from(with_false(known_event::acceleration_cones(half_m), 12, {10.0, 0.0}, i),
                                    pose, course, 0.1, i);
        const auto found = search(known, seen, in_map(course, pose), {{known.course().start_x_m, 0.0}, 0.0});
        ASSERT_TRUE(found) << i;
        const Registration& registration = found->registration;
        EXPECT_NEAR(registration.widening_m, half_m - 1.5, 0.15) << i;
        EXPECT_NEAR(registration.to_course(in_map(course, pose).position).y(), pose.position.y(), 0.3) << i;
        EXPECT_LT(error_of(registration, pose, course).second, 0.03) << i;
        // Along the lane, the place is the expected one.
        EXPECT_NEAR(registration.to_course(in_map(course, pose).position).x(), known.course().start_x_m, 0.6);
    }
}

/// The distance of a place from the boundaries of a skidpad, directly from the rules.
double distance_to_skidpad_m(const Point& place) {
    double nearest_m = std::numeric_limits<double>::infinity();
    for (const double side : {-1.0, 1.0}) {
        const double from_centre_m = (place - Point(0.0, side * 9.125)).norm();
        if (side * place.y() >= 0.0) nearest_m = std::min(nearest_m, std::abs(from_centre_m - 7.625));
        if (side * place.y() >= 1.3) nearest_m = std::min(nearest_m, std::abs(from_centre_m - 10.625));
        if (std::abs(place.x()) > 7.4 && place.x() > -20.0 && place.x() < 27.0) {
            nearest_m = std::min(nearest_m, std::abs(place.y() - side * 1.5));
        }
    }
    return nearest_m;
}

TEST(KnownRegistration, NoPoseOfAFineGridExplainsFewConesMuchBetter) {
    const KnownRegistration known(known_course(Mission::skidpad));
    const Pose expected{{known.course().start_x_m, 0.0}, 0.0};
    const auto explained = [](const std::vector<Point>& in_car, const Pose& car) {
        double sum = 0.0;
        for (const Point& cone : in_car) {
            const double off = distance_to_skidpad_m(in_map(car, {cone, 0.0}).position) / 0.45;
            sum += std::max(0.0, 1.0 - off * off);
        }
        return sum;
    };
    for (unsigned seed = 0; seed < 6; ++seed) {
        // A third of the cones are missing, and as many are false.
        std::vector<Point> cones = known_event::skidpad_cones();
        std::mt19937 random(seed);
        std::ranges::shuffle(cones, random);
        cones.resize(cones.size() * 2 / 3);
        cones = with_false(std::move(cones), 20, {-5.0, 0.0}, seed);
        const Pose pose{{-14.0 - 0.5 * seed, 0.3 * seed - 0.8}, 0.1 * seed - 0.25};
        const Seen seen = seen_from(cones, pose, {}, 0.1, seed);
        const auto found = search(known, seen, pose, expected);
        ASSERT_TRUE(found) << seed;
        std::vector<Point> in_car;
        for (const SeenCone& cone : seen.cones) {
            in_car.emplace_back(pose.ahead_m(cone.position), pose.left_m(cone.position));
        }
        double best = 0.0;
        for (double yaw_rad = -0.48; yaw_rad < 0.49; yaw_rad += 0.04) {
            for (double x_m = -4.4; x_m < 4.5; x_m += 0.2) {
                for (double y_m = -4.0; y_m < 4.1; y_m += 0.2) {
                    best = std::max(best, explained(in_car, {expected.position + Point(x_m, y_m), yaw_rad}));
                }
            }
        }
        const Registration& registration = found->registration;
        const Pose car{registration.to_course(pose.position), pose.yaw_rad - registration.course.yaw_rad};
        EXPECT_GT(explained(in_car, car), 0.95 * best) << seed;
    }
}

TEST(KnownRegistration, NothingStandsOutAmongConesOfNoCourse) {
    for (const Mission mission : {Mission::acceleration, Mission::skidpad}) {
        const KnownRegistration known(known_course(mission));
        int found = 0;
        constexpr int kFields = 100;
        for (unsigned i = 0; i < kFields; ++i) {
            const int count = 6 + static_cast<int>(i) % 30;
            const Seen seen = seen_from(Sight::strewn(count, {0.0, 0.0}, 20.0, i), {}, {}, 0.0, i);
            if (search(known, seen, {}, {{known.course().start_x_m, 0.0}, 0.0})) ++found;
        }
        EXPECT_LE(found, 3) << to_string(mission);
    }
}

TEST(KnownRegistration, APassedDeadlineFindsNothing) {
    const KnownRegistration known(known_course(Mission::skidpad));
    const Pose pose{{known.course().start_x_m, 0.0}, 0.0};
    const Seen seen = seen_from(known_event::skidpad_cones(), pose, {}, 0.05, 1);
    EXPECT_TRUE(search(known, seen, pose, pose));
    EXPECT_FALSE(search(known, seen, pose, pose, Deadline(0.0)));
}

TEST(KnownRegistration, RefiningComesBackFromHalfAMeterAndAFewDegrees) {
    const KnownRegistration known(known_course(Mission::skidpad));
    const Pose pose{{-9.0, 0.0}, 0.0};
    const Seen seen =
        seen_from(with_false(known_event::skidpad_cones(), 20, {1.0, 0.0}, 2), pose, {}, 0.1, 3);
    for (const Pose& wrong : {Pose{{0.5, 0.0}, 0.0}, Pose{{-0.3, 0.4}, 0.04}, Pose{{0.0, -0.5}, -0.04}}) {
        const Registration refined = known.refine({wrong, 0.1}, seen.cones, pose.position);
        const auto [off_m, turned_rad] = error_of(refined, pose, {});
        EXPECT_LT(off_m, 0.12);
        EXPECT_LT(turned_rad, 0.02);
        EXPECT_NEAR(refined.widening_m, 0.0, 0.08);
    }
}

/// An acceleration, seen by a car that drives along the lane; the registration has the start line `off_m` too
/// far back.
GateEvidence driven(const std::vector<Point>& cones, double off_m, double from_x_m, double to_x_m,
                    unsigned seed, ConeColor gate_color = ConeColor::unknown) {
    GateEvidence gates(75.0);
    const Registration registration{{{-off_m, 0.0}, 0.0}, 0.4};
    Sight sight(cones, 0.1, 0.05, seed);
    for (double x_m = from_x_m; x_m < to_x_m; x_m += 0.6) {
        Frame frame = sight.look({{x_m, 0.0}, 0.0}, {}, x_m);
        for (Cone& cone : frame.cones) {
            const double to_gate_m =
                std::min(std::abs(cone.position.x()), std::abs(cone.position.x() - 75.0));
            if (gate_color != ConeColor::unknown) {
                cone.color = to_gate_m < 1.0           ? gate_color
                             : cone.position.y() > 0.0 ? ConeColor::blue
                                                       : ConeColor::yellow;
            }
        }
        gates.observe(registration, frame, view_of(frame));
    }
    return gates;
}

TEST(GateEvidence, BothGatesTellWhereTheLinesAre) {
    const std::vector<Point> cones = known_event::acceleration_cones(1.9);
    for (const double off_m : {-3.0, -1.3, 0.0, 0.4, 2.2, 3.0}) {
        const GateEvidence at_start = driven(cones, off_m, -2.0, -1.4, 1);
        EXPECT_FALSE(at_start.has_seen_finish());
        const GateEvidence at_finish = driven(cones, off_m, -2.0, 74.0, 2);
        EXPECT_NEAR(at_finish.start_line_m(), off_m, 0.3);
        EXPECT_TRUE(at_finish.has_seen_finish());
        // Started behind the gate.
        EXPECT_NEAR(driven(cones, off_m, 1.5, 74.0, 3).start_line_m(), off_m, 0.3);
    }
    EXPECT_NEAR(driven(cones, 2.2, -6.0, 2.0, 4).start_line_m(), 2.2, 0.3);
}

TEST(GateEvidence, FalsePositivesBesidePairsAreNoGate) {
    // At each pair beside the finish one more cone stands at one side.
    std::vector<Point> cones = known_event::acceleration_cones(1.9);
    for (const double x_m : {65.4, 70.5, 79.6}) cones.emplace_back(x_m, 1.9);
    for (const double off_m : {-2.0, 0.0, 2.0}) {
        EXPECT_NEAR(driven(cones, off_m, 3.0, 74.0, 5).start_line_m(), off_m, 0.3);
    }
}

TEST(GateEvidence, OrangeConesTellAGateOfTwo) {
    std::vector<Point> cones;
    for (int i = 0; i <= 15; ++i) {
        cones.emplace_back(5.0 * i, 1.9);
        cones.emplace_back(5.0 * i, -1.9);
    }
    EXPECT_NEAR(driven(cones, 2.0, 1.0, 74.0, 6, ConeColor::orange).start_line_m(), 2.0, 0.3);
}

TEST(GateEvidence, WithoutAGateTheLineIsExpectedWhereTheStartSaysIt) {
    std::vector<Point> cones;
    for (int i = 0; i <= 15; ++i) {
        cones.emplace_back(5.0 * i, 1.9);
        cones.emplace_back(5.0 * i, -1.9);
    }
    const GateEvidence gates = driven(cones, 0.3, 1.0, 74.0, 7);
    EXPECT_FALSE(gates.has_seen_finish());
    EXPECT_LT(std::abs(gates.start_line_m()), 2.5);
}

}  // namespace
}  // namespace conelane
