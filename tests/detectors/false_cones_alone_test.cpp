// How often front claims a lane where there is no course: false cones, uniform in the half disc ahead of the
// car. The figures of docs/limits.md: `detectors_tests --gtest_filter='*FalseConesAlone*'` prints them.

#include "conelane/detectors.hpp"
#include "evaluation/world/course.hpp"
#include "tests/support/testing.hpp"

namespace conelane {
namespace {

Scene false_cones(std::size_t cones, double range_m, std::size_t index) {
    Scene scene;
    scene.id = "noise/" + std::to_string(cones) + "/range_" + std::to_string(static_cast<int>(range_m)) +
               "/" + std::string(4 - std::to_string(index).size(), '0') + std::to_string(index);
    SceneGenerator random = generator_for(scene.id + "/1");
    boost::random::uniform_real_distribution<double> ahead_m(0.0, range_m);
    boost::random::uniform_real_distribution<double> left_m(-range_m, range_m);
    const HalfDisc view{scene.pose.position, scene.pose.heading(), range_m};
    while (scene.cones.size() < cones) {
        const double ahead = ahead_m(random);
        const Point position = rounded(Point(ahead, left_m(random)));
        if (view.contains(position))
            scene.cones.push_back({.id = static_cast<ConeId>(scene.cones.size()), .position = position});
    }
    return scene;
}

struct Field {
    std::size_t cones;
    double range_m;
    int most_claimed;  ///< of 1000 scenes: lanes of a confidence above 0.3
    int most_trusted;  ///< lanes or boundaries that are trusted for 10 m
};

class FalseConesAlone : public testing::TestWithParam<Field> {};
INSTANTIATE_TEST_SUITE_P(Front, FalseConesAlone,
                         testing::Values(Field{16, 20.0, 50, 15}, Field{16, 30.0, 5, 5},
                                         Field{16, 50.0, 2, 2}, Field{40, 20.0, 75, 400}));

TEST_P(FalseConesAlone, AreSeldomALane) {
    const auto detector = make_detector("front");
    int claimed = 0;
    int trusted = 0;
    for (std::size_t index = 0; index < 1000; ++index) {
        const LaneAnswer answer =
            detector->detect(false_cones(GetParam().cones, GetParam().range_m, index), {1e3});
        ASSERT_NE(answer.status, LaneStatus::error) << answer.message;
        if (answer.status != LaneStatus::found) continue;
        if (answer.confidence.value_or(0.0) > 0.3) ++claimed;
        if (answer.trusted_m.value_or(0.0) >= 10.0) ++trusted;
    }
    std::cout << claimed << " of 1000 claimed, " << trusted << " trusted for 10 m\n";
    EXPECT_LE(claimed, GetParam().most_claimed);
    EXPECT_LE(trusted, GetParam().most_trusted);
}

}  // namespace
}  // namespace conelane
