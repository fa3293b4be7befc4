// The checker's rules one by one, on a lane that can be followed by hand.

#include "conelane/check.hpp"

#include "tests/support/six_cone_lane.hpp"
#include "tests/support/testing.hpp"

namespace conelane {
namespace {

using testing::Contains;
using testing::Each;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using tests::six_cone_lane;

constexpr double kRounding = 1e-9;

void add_cone(Scene& scene, const Point& position) {
    scene.cones.push_back({static_cast<ConeId>(scene.cones.size()), position});
}

const LaneGraph kLane{{{0, 1}, {1, 2}, {3, 4}, {4, 5}}};

std::vector<std::string> violations(const Scene& scene, const RldParameters& parameters,
                                    const LaneGraph& graph = kLane) {
    return check(scene, parameters, graph).violations;
}

double objective(const Scene& scene, const RldParameters& parameters, const LaneGraph& graph = kLane) {
    return check(scene, parameters, graph).objective.value();
}

/// All four edges have the expected length and angles, and are along the heading.
TEST(Check, AcceptsTheStraightLane) {
    const CheckReport report = check(six_cone_lane(), {}, kLane);
    EXPECT_THAT(report.violations, IsEmpty());
    EXPECT_FALSE(report.is_final);
    EXPECT_EQ(report.along_heading, 4U);
    EXPECT_NEAR(report.objective.value(), -4.0, kRounding);
}

TEST(Check, NoConeHasThreeEdges) {
    Scene scene = six_cone_lane();
    add_cone(scene, {4.2, 4.95});
    const CheckReport report = check(scene, {}, {{{0, 1}, {1, 2}, {1, 6}, {3, 4}, {4, 5}}});
    EXPECT_THAT(report.violations, Contains(HasSubstr("(2) cone 1 has degree 3")));
    EXPECT_TRUE(report.is_final);
}

TEST(Check, FourEndpointsOfWhichTwoAreNear) {
    Scene scene = six_cone_lane();
    add_cone(scene, {20.0, 1.75});
    add_cone(scene, {23.2, 1.75});
    EXPECT_THAT(violations(scene, {}, {{{0, 1}, {1, 2}, {3, 4}, {4, 5}, {6, 7}}}),
                Contains(HasSubstr("(3) 6 endpoints")));
    EXPECT_THAT(violations(scene, {}, {{{0, 1}, {1, 2}}}), Contains(HasSubstr("(3) 2 endpoints")));

    RldParameters parameters;
    parameters.d_near = 1.0;
    EXPECT_THAT(violations(six_cone_lane(), parameters), Contains(HasSubstr("(11) 0 near")));
    parameters.d_near = 8.0;
    EXPECT_THAT(violations(six_cone_lane(), parameters), Contains(HasSubstr("(11) 4 near")));
    parameters.d_side = 1.0;  // all cones are 1.75 m from the car's axis
    EXPECT_THAT(violations(six_cone_lane(), parameters), Contains(HasSubstr("(11) 0 near")));
}

TEST(Check, FarEndsMayBeExactlyDMaxApart) {
    RldParameters parameters;
    parameters.d_max = 3.5;
    EXPECT_THAT(violations(six_cone_lane(), parameters), IsEmpty());
    parameters.d_max = 3.4;
    EXPECT_THAT(violations(six_cone_lane(), parameters), Contains(HasSubstr("(17)")));
}

TEST(Check, NoPathGoesRound) {
    const CheckReport report = check(six_cone_lane(), {}, {{{0, 1}, {0, 3}, {1, 4}, {3, 4}}});
    EXPECT_THAT(report.violations, Contains(HasSubstr("(5) a cycle through cone 0")));
    EXPECT_TRUE(report.is_final);
}

/// One path joins the near cones 0 and 3, the other one the far cones 2 and 5.
TEST(Check, ThePairingSaysWhichEndsAPathMayHave) {
    const LaneGraph across{{{0, 3}, {2, 5}}};
    EXPECT_THAT(violations(six_cone_lane(), {}, across), Contains(HasSubstr("joins both near endpoints")));
    RldParameters parameters;
    parameters.pairing = Pairing::paper;
    EXPECT_THAT(violations(six_cone_lane(), parameters, across), Each(Not(HasSubstr("joins both"))));
}

/// At 1.6 m ahead, the cones of one boundary are beside the middles of the other boundary's edges.
TEST(Check, BoundariesKeepTheirDistanceExceptBetweenFacingCones) {
    RldParameters parameters;
    parameters.d_min = 3.5;
    EXPECT_THAT(violations(six_cone_lane(1.6), parameters), IsEmpty());
    parameters.d_min = 3.6;
    EXPECT_THAT(violations(six_cone_lane(1.6), parameters), Contains(HasSubstr("(6)")));
    EXPECT_THAT(violations(six_cone_lane(), parameters), IsEmpty());
}

/// {1, 5} and {2, 4} cross in (5.8, 0); their ends are more than 2 m from each other.
/// Two facing edges whose ends are 1.6e-12 m farther apart than their nearest points: within a tie. So far
/// from the origin, coordinates are 1e-4 m apart.
TEST(Check, FacingConesAreSeenFarFromTheOrigin) {
    Scene scene;
    scene.pose = {{1e12, 0.3}, 0.75};
    for (const Point& position : {Point{1000000000001.8542, 2.710760714506913},
                                  {1000000000004.0493, 4.755676994576915},
                                  {1000000000002.5359, 1.979071845633092},
                                  {1000000000004.731, 4.023988125703094}})
        add_cone(scene, position);
    EXPECT_THAT(violations(scene, {}, {{{0, 1}, {2, 3}}}), IsEmpty());
}

TEST(Check, EdgesThatCrossAreAtNoDistance) {
    const LaneGraph crossing{{{1, 5}, {2, 4}}};
    RldParameters parameters;
    parameters.d_min = 1.0;
    EXPECT_THAT(violations(six_cone_lane(), parameters, crossing), Contains(HasSubstr("(6)")));
    parameters.d_min = 0.0;
    EXPECT_THAT(violations(six_cone_lane(), parameters, crossing), Each(Not(HasSubstr("cross"))));
    parameters.forbid_crossing = true;
    EXPECT_THAT(violations(six_cone_lane(), parameters, crossing), Contains(HasSubstr("crossing:")));
}

/// Edges {0, 1} and {2, 3}, the latter's end past the former by less than a tie of 1e-9 m, then by more.
TEST(Check, EdgesThatTouchWithinATieDoNotCross) {
    Scene scene;
    for (const Point& place : {Point{0, 0}, Point{4, 0}, Point{2, -5e-10}, Point{2, 3}})
        add_cone(scene, place);
    RldParameters parameters;
    parameters.d_min = 0.0;
    parameters.forbid_crossing = true;
    const LaneGraph touching{{{0, 1}, {2, 3}}};
    EXPECT_THAT(violations(scene, parameters, touching), Each(Not(HasSubstr("cross"))));
    scene.cones[2].position.y() = -2e-9;
    EXPECT_THAT(violations(scene, parameters, touching), Contains(HasSubstr("crossing:")));
}

TEST(Check, LimitsOfSpacingAndAngle) {
    RldParameters parameters;
    parameters.d_e = 5.2;  // the cost of each edge is (2 / 1.7)^4 = 1.9
    EXPECT_THAT(violations(six_cone_lane(), parameters), IsEmpty());
    parameters.s_crit = 1.0;
    EXPECT_THAT(violations(six_cone_lane(), parameters), Contains(HasSubstr("(27) edge {0, 1}")));

    Scene scene = six_cone_lane();
    add_cone(scene, {4.2, 4.95});  // a square corner costs (pi / 2 / 0.9)^4 = 9.3
    EXPECT_THAT(violations(scene, {}, {{{0, 1}, {1, 6}}}), Contains(HasSubstr("(28) the angle at cone 1")));

    add_cone(scene, scene.cones[0].position);
    EXPECT_THAT(violations(scene, {}, {{{0, 7}}}), Contains(HasSubstr("has no length")));
}

/// An edge counts in (9) if it is near the car and along its heading.
TEST(Check, TwoEdgesAlongTheHeading) {
    Scene scene = six_cone_lane();
    add_cone(scene, {20.0, 1.75});
    add_cone(scene, {23.2, 1.75});
    EXPECT_EQ(check(scene, {}, {{{6, 7}}}).along_heading, 0U) << "far from the car";
    EXPECT_EQ(check(scene, {}, {{{0, 3}}}).along_heading, 0U) << "across its way";
    EXPECT_EQ(check(scene, {}, {{{0, 1}}}).along_heading, 1U);

    RldParameters parameters;
    parameters.d_h = 2.1;  // 0 and 3 are 2.02 m away
    EXPECT_THAT(violations(six_cone_lane(), parameters), IsEmpty());
    scene = six_cone_lane();
    scene.pose.position = {0.0, 1.0};
    EXPECT_THAT(violations(scene, parameters), Contains(HasSubstr("(9) 1 edges")));
}

TEST(Check, AnEdgeOverTheCarCostsAsIfItWereHalfAMetreAway) {
    Scene scene = six_cone_lane();
    scene.pose = {{2.6, 1.75}, std::numbers::pi / 2.0};
    EXPECT_NEAR(objective(scene, {}, {{{0, 1}}}), 1.2 * std::pow(3.2 / 0.5, 4) - 1.0, 1e-6);
}

TEST(Check, ConfidencesOfBothConesScaleTheBenefit) {
    Scene scene = six_cone_lane();
    scene.cones[0].confidence = 0.5;
    scene.cones[1].confidence = 0.4;
    RldParameters parameters;
    EXPECT_NEAR(objective(scene, parameters), -4.0, kRounding);
    parameters.use_confidence = true;
    EXPECT_NEAR(objective(scene, parameters), -(0.5 * 0.4 + 0.4 + 1.0 + 1.0), kRounding);
}

/// The near ends are 1.75 m beside the axis, half of the usual width is 1.8 m.
TEST(Check, NearEndsBesideTheCarEarnABenefit) {
    RldParameters parameters;
    parameters.near_end_weight = 0.5;
    EXPECT_NEAR(objective(six_cone_lane(), parameters), -4.0 - 2.0 * 0.5 * (1.0 - std::pow(0.05 / 1.7, 2)),
                kRounding);
    parameters.lane_width_m = 10.0;  // far off: no benefit, and no cost
    EXPECT_NEAR(objective(six_cone_lane(), parameters), -4.0, kRounding);
}

TEST(Check, UnevenSpacingCosts) {
    Scene scene = six_cone_lane();
    scene.cones[2].position.x() += 1.0;
    const double spacing = 0.4 * std::pow(1.0 / 1.7, 4);
    RldParameters parameters;
    EXPECT_NEAR(objective(scene, parameters), -4.0 + spacing, kRounding);
    parameters.unevenness_weight = 2.0;
    EXPECT_NEAR(objective(scene, parameters), -4.0 + spacing + 2.0 * std::pow(1.0 / 1.7, 2), kRounding);
}

TEST(CheckClaim, IsComparedWithTheRecomputedValues) {
    const auto claimed = [](const Claim& claim) {
        return check(six_cone_lane(), {}, kLane, claim).violations;
    };
    EXPECT_THAT(claimed({true, -4.0, -4.0}), IsEmpty());
    EXPECT_THAT(claimed({false, -4.0, {}}), IsEmpty());
    EXPECT_THAT(claimed({false, -4.1, {}}), Contains(HasSubstr("is claimed")));
    EXPECT_THAT(claimed({false, -3.9, {}}), Contains(HasSubstr("is claimed")));
    EXPECT_THAT(claimed({false, -4.0, -3.9}), Contains(HasSubstr("the bound is above")));
    EXPECT_THAT(claimed({true, -4.0, {}}), Contains(HasSubstr("without a bound")));
    EXPECT_THAT(claimed({true, -4.0, -4.1}), Contains(HasSubstr("within the gap")));
    EXPECT_THAT(claimed({true, -4.0, -4.1, 0.2}), IsEmpty());
}

}  // namespace
}  // namespace conelane
