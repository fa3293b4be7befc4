// What `front` makes of covariances: nothing where they are 0, wider rules and shorter trust elsewhere.

#include "graph_search/front/front_detector.hpp"
#include "tests/support/cones_at.hpp"
#include "tests/support/front_fixture.hpp"
#include "tests/support/no_time_limit.hpp"

namespace conelane {
namespace {

using tests::kNoTimeLimit;
using tests::straight_front_scene;

Scene with_covariance(Scene scene, const PositionCovariance& covariance) {
    for (Cone& cone : scene.cones) cone.position_covariance = covariance;
    return scene;
}

TEST(FrontCovariance, ShortensTheTrustOfTheSameLane) {
    const auto front = make_front_detector(shipped_front_options());
    const Scene scene = straight_front_scene(8);
    const LaneAnswer sure = front->detect(scene, kNoTimeLimit);
    ASSERT_EQ(sure.status, LaneStatus::found);
    ASSERT_GT(sure.trusted_m.value_or(0.0), 15.0);
    double last_m = *sure.trusted_m;
    bool shortened = false;
    for (const double sigma_m : {0.1, 0.5, 1.0, 3.0, 10.0}) {
        const double variance_m2 = sigma_m * sigma_m;
        const LaneAnswer answer =
            front->detect(with_covariance(scene, {variance_m2, 0.0, variance_m2}), kNoTimeLimit);
        ASSERT_EQ(answer.lane, sure.lane) << sigma_m;
        // Wider rules let other lanes beside it.
        EXPECT_NEAR(answer.confidence.value(), sure.confidence.value(), 1e-3);
        EXPECT_LE(answer.trusted_m.value(), last_m) << sigma_m;
        shortened = shortened || *answer.trusted_m < last_m;
        last_m = *answer.trusted_m;
    }
    EXPECT_TRUE(shortened);
    EXPECT_EQ(last_m, 0.0);
}

/// Covariances turn with the map.
TEST(FrontCovariance, IsSeenFromTheCar) {
    Scene scene = tests::cones_at({{2.0, 1.8}, {2.0, -1.8}});
    scene.cones[0].position_covariance = {0.04, 0.01, 0.09};
    const double angle_rad = 0.7;
    Scene turned = scene;
    turned.pose.yaw_rad = angle_rad;
    const Point ahead = turned.pose.heading();
    const Point left(-ahead.y(), ahead.x());
    for (Cone& cone : turned.cones) cone.position = cone.position.x() * ahead + cone.position.y() * left;
    // R C R^T
    const double c = ahead.x();
    const double s = ahead.y();
    turned.cones[0].position_covariance = {c * c * 0.04 - 2.0 * c * s * 0.01 + s * s * 0.09,
                                           c * s * 0.04 + (c * c - s * s) * 0.01 - c * s * 0.09,
                                           s * s * 0.04 + 2.0 * c * s * 0.01 + c * c * 0.09};
    FrontMap map;
    FrontMap turned_map;
    map.build(scene);
    turned_map.build(turned);
    ASSERT_TRUE(map.has_spread());
    for (Vertex cone = 0; cone < 2; ++cone) {
        for (const Point& direction : {Point(1.0, 0.0), Point(0.0, 1.0), Point(0.6, 0.8), Point(0.6, -0.8)}) {
            const bool same = map.scene_index(cone) == turned_map.scene_index(cone);
            const Vertex other = same ? cone : 1 - cone;
            EXPECT_NEAR(map.variance_m2(cone, direction), turned_map.variance_m2(other, direction), 1e-12);
        }
    }
    EXPECT_NEAR(map.spread_between_m(0, 1), 0.3, 1e-12);
    EXPECT_NEAR(map.variance_m2(map.scene_index(0) == 0 ? 0 : 1), 0.065, 1e-12);
}

TEST(FrontCovariance, LetsCertainRulesGiveWay) {
    const FrontRules rules;
    const auto narrowest_m = [&](double sigma_m) {
        const Scene scene =
            with_covariance(tests::cones_at({{2.0, 0.9}, {2.0, -0.9}}), {0.0, 0.0, sigma_m * sigma_m});
        FrontMap map;
        map.build(scene);
        FrontStarts starts;
        starts.list(map, rules);
        EXPECT_EQ(starts.pairs.empty(), narrowest_between_m(map, 0, 1, rules) > 1.8);
        return narrowest_between_m(map, 0, 1, rules);
    };
    EXPECT_EQ(narrowest_m(0.0), rules.narrowest_m);
    EXPECT_NEAR(narrowest_m(0.2), rules.narrowest_m - rules.narrowest_spreads * 0.2 * std::sqrt(2.0), 1e-12);
    EXPECT_LT(narrowest_m(0.4), 1.8);
    EXPECT_EQ(narrowest_m(100.0), 0.5);

    // The cone 2 takes a turn of 120 degrees at the left cone 0.
    const auto turns = [&](double sigma_m) {
        const Scene scene =
            with_covariance(tests::cones_at({{4.0, 3.0}, {4.0, -3.0}, {2.0, 3.0 + 2.0 * std::sqrt(3.0)}}),
                            {sigma_m * sigma_m, 0.0, sigma_m * sigma_m});
        FrontMap map;
        map.build(scene);
        Vertex start_left = 0;
        Vertex start_right = 0;
        for (Vertex cone = 0; cone < 3; ++cone) {
            if (map.scene_index(cone) == 0) start_left = cone;
            if (map.scene_index(cone) == 1) start_right = cone;
        }
        const FrontState state = start_state(map, start_left, start_right);
        FrontMoves moves;
        moves.list(map, state, kLeft, rules);
        return moves.extensions.size();
    };
    EXPECT_EQ(turns(0.0), 0U);
    EXPECT_EQ(turns(0.05), 0U);
    EXPECT_EQ(turns(0.5), 1U);
}

}  // namespace
}  // namespace conelane
