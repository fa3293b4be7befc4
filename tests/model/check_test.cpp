// The rules and costs of the model one by one, on a lane that can be followed by hand: the checker, the
// verification of answers and the problem agree on each.

#include "conelane/check.hpp"

#include "model/answer_verification.hpp"
#include "tests/support/six_cone_lane.hpp"
#include "tests/support/testing.hpp"

namespace conelane {
namespace {

using tests::six_cone_lane;
using P = RldParameters;

const LaneGraph kLane{{{0, 1}, {1, 2}, {3, 4}, {4, 5}}};
/// One path joins the near cones 0 and 3, the other one the far cones 2 and 5.
const LaneGraph kAcross{{{0, 3}, {2, 5}}};

Scene with_cones(Scene scene, const std::vector<Point>& places) {
    for (const Point& place : places) scene.cones.push_back({static_cast<ConeId>(scene.cones.size()), place});
    return scene;
}
Scene seen_from(Scene scene, const Pose& pose) {
    scene.pose = pose;
    return scene;
}

/// A lane graph and what is wrong with it; nothing for a lane.
struct Case {
    std::string violation;  ///< part of a sentence of the checker
    std::string fault;      ///< part of the sentence of the verification of answers
    Scene scene = six_cone_lane();
    std::vector<std::pair<double P::*, double>> set{};  ///< parameters that are not the default
    LaneGraph graph = kLane;
    bool is_final = false;
    Pairing pairing = Pairing::near_far;
};

std::vector<Case> cases() {
    const Scene lane = six_cone_lane();
    // At 1.6 m ahead, the cones of one boundary are beside the middles of the other boundary's edges.
    const Scene shifted = six_cone_lane(1.6);
    const Scene corner = with_cones(lane, {{4.2, 4.95}});  // costs (pi / 2 / 0.9)^4 = 9.3
    const Scene longer = with_cones(lane, {{20.0, 1.75}, {23.2, 1.75}});
    const Scene doubled = with_cones(lane, {lane.cones[0].position});
    const std::vector<std::pair<double P::*, double>> any_heading{{&P::theta_heading, std::numbers::pi / 2},
                                                                  {&P::d_h, 10.0}};
    // Facing edges whose ends are 1.6e-12 m farther apart than their nearest points: within a tie. So far
    // from the origin, coordinates are 1e-4 m apart.
    const Scene far_off = with_cones({.id = "far", .pose = {{1e12, 0.3}, 0.75}, .cones = {}},
                                     {{1000000000001.8542, 2.710760714506913},
                                      {1000000000004.0493, 4.755676994576915},
                                      {1000000000002.5359, 1.979071845633092},
                                      {1000000000004.731, 4.023988125703094}});
    return {
        {"", ""},
        {"(2) cone 1 has degree 3",
         "more than two edges",
         corner,
         {},
         {{{0, 1}, {1, 2}, {1, 6}, {3, 4}, {4, 5}}},
         true},
        {"(3) 6 endpoints", "more than two paths", longer, {}, {{{0, 1}, {1, 2}, {3, 4}, {4, 5}, {6, 7}}}},
        {"(3) 2 endpoints", "not two paths but 1", lane, {}, {{{0, 1}, {1, 2}}}},
        {"(3) 0 endpoints", "not two paths but 0", lane, {}, {}},
        {"(11) 4 near", "4 near and 0 far ends", lane, {}, {{{0, 1}, {3, 4}}}},
        {"(11) 0 near", "0 near and 4 far ends", lane, {{&P::d_near, 1.0}}},
        {"(11) 4 near", "4 near and 0 far ends", lane, {{&P::d_near, 8.0}}},
        {"(11) 0 near", "0 near and 4 far ends", lane, {{&P::d_side, 1.0}}},  // all are 1.75 m aside
        {"", "", lane, {{&P::d_max, 3.5}}},
        {"(17)", "(17)", lane, {{&P::d_max, 3.4}}},
        {"(5) a cycle through cone 0", "(28)", lane, {}, {{{0, 1}, {0, 3}, {1, 4}, {3, 4}}}, true},
        {"joins both near endpoints", "from a near cone to a far one", lane, any_heading, kAcross},
        {"", "", lane, any_heading, kAcross, false, Pairing::paper},
        {"", "", shifted, {{&P::d_min, 3.5}}},
        {"(6)", "(7)", shifted, {{&P::d_min, 3.6}}, kLane, true},
        {"", "", lane, {{&P::d_min, 3.6}}},
        {"(6)", "(7)", lane, {{&P::d_min, 1.0}}, {{{1, 5}, {2, 4}}}, true},
        {"", "", far_off, {}, {{{0, 1}, {2, 3}}}},
        {"", "", lane, {{&P::d_e, 5.2}}},  // the cost of each edge is (2 / 1.7)^4 = 1.9
        {"(27) edge {0, 1}", "(27)", lane, {{&P::d_e, 5.2}, {&P::s_crit, 1.0}}, kLane, true},
        {"(28) the angle at cone 1", "(28)", corner, {}, {{{0, 1}, {1, 6}}}, true},
        {"has no length", "(27)", doubled, {}, {{{0, 6}}}, true},
        {"", "", lane, {{&P::d_h, 2.1}}},  // 0 and 3 are 2.02 m away
        {"(9) 1 edges", "(9)", seen_from(lane, {{0.0, 1.0}, 0.0}), {{&P::d_h, 2.1}}},
    };
}

RldParameters parameters_of(const Case& tried) {
    RldParameters parameters{.pairing = tried.pairing};
    for (const auto& [parameter, value] : tried.set) parameters.*parameter = value;
    return parameters;
}

TEST(Check, NamesTheBrokenRuleAndAgreesWithTheProblem) {
    for (const Case& tried : cases()) {
        SCOPED_TRACE(tried.violation);
        const RldParameters parameters = parameters_of(tried);
        const CheckReport report = check(tried.scene, parameters, tried.graph);
        const LaneGraphProblem problem = make_problem(tried.scene, parameters, EdgeExtent::all_pairs);
        const std::string fault = verify_answer(problem, tried.graph).violation;
        EXPECT_EQ(report.is_final, tried.is_final);
        if (tried.violation.empty()) {
            EXPECT_THAT(report.violations, IsEmpty());
            EXPECT_EQ(fault, "");
            EXPECT_TRUE(is_feasible(problem, tried.graph));
        } else {
            EXPECT_THAT(report.violations, Contains(HasSubstr(tried.violation)));
            EXPECT_THAT(fault, HasSubstr(tried.fault));
            EXPECT_FALSE(is_feasible(problem, tried.graph));
        }
    }
}

/// Edges {0, 1} and {2, 3}, the latter's end past the former by less than a tie of 1e-9 m, then by more.
TEST(Check, EdgesCrossOnlyBeyondATieAndWhereTheyMayNot) {
    Scene scene = with_cones({}, {{0, 0}, {4, 0}, {2, -5e-10}, {2, 3}});
    RldParameters parameters{.d_min = 0.0, .forbid_crossing = true};
    const LaneGraph touching{{{0, 1}, {2, 3}}};
    const auto violations = [&] { return check(scene, parameters, touching).violations; };
    EXPECT_THAT(violations(), Each(Not(HasSubstr("cross"))));
    scene.cones[2].position.y() = -2e-9;
    EXPECT_THAT(violations(), Contains(HasSubstr("crossing:")));
    parameters.forbid_crossing = false;
    EXPECT_THAT(violations(), Each(Not(HasSubstr("cross"))));
}

/// An edge counts in (9) if it is near the car and along its heading.
TEST(Check, CountsTheEdgesAlongTheHeading) {
    const Scene scene = with_cones(six_cone_lane(), {{20.0, 1.75}, {23.2, 1.75}});
    EXPECT_EQ(check(scene, {}, kLane).along_heading, 4U);
    EXPECT_EQ(check(scene, {}, {{{6, 7}}}).along_heading, 0U) << "far from the car";
    EXPECT_EQ(check(scene, {}, {{{0, 3}}}).along_heading, 0U) << "across its way";
    EXPECT_EQ(check(scene, {}, {{{0, 1}}}).along_heading, 1U);
}

/// The objective of the checker, which has to be the problem's.
double cost(const Scene& scene, const RldParameters& parameters, const LaneGraph& graph = kLane) {
    const double checked = check(scene, parameters, graph).objective.value();
    EXPECT_NEAR(objective(make_problem(scene, parameters, EdgeExtent::all_pairs), graph), checked, 1e-9);
    return checked;
}

TEST(Check, CostsByHand) {
    EXPECT_NEAR(cost(six_cone_lane(), {}), -4.0, 1e-9) << "expected lengths and angles, along the heading";
    EXPECT_NEAR(cost(seen_from(six_cone_lane(), {{2.6, 1.75}, std::numbers::pi / 2}), {}, {{{0, 1}}}),
                1.2 * std::pow(3.2 / 0.5, 4) - 1.0, 1e-6)
        << "an edge over the car costs as if it were half a metre away";
    Scene scene = six_cone_lane();
    scene.cones[0].confidence = 0.5;
    scene.cones[1].confidence = 0.4;
    RldParameters parameters;
    EXPECT_NEAR(cost(scene, parameters), -4.0, 1e-9);
    parameters.use_confidence = true;
    EXPECT_NEAR(cost(scene, parameters), -(0.5 * 0.4 + 0.4 + 1.0 + 1.0), 1e-9);
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
