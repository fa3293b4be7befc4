// Covariances of the positions of cones: which are valid, and what they say along a direction.

#include "tests/support/refusal.hpp"

namespace conelane {
namespace {

std::string error_of(const PositionCovariance& covariance) {
    Scene scene;
    scene.cones = {{0, {1.0, 0.0}}, {1, {2.0, 0.0}}};
    scene.cones[1].position_covariance = covariance;
    return refusal([&] { validate(scene); });
}

TEST(PositionCovariance, IsFiniteAndPositiveSemidefinite) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
    for (const PositionCovariance& valid :
         {PositionCovariance{}, PositionCovariance{1.0, 1.0, 1.0}, PositionCovariance{0.3, -0.3, 0.3},
          PositionCovariance{4.0, 0.0, 0.0}, PositionCovariance{0.01, 0.0200000001, 0.04},
          PositionCovariance{1e300, 1e300, 1e300}}) {
        EXPECT_TRUE(valid.is_valid()) << valid.xy_m2;
        EXPECT_EQ(error_of(valid), "accepted");
    }
    const std::string key = "cones[1].position_covariance: ";
    for (const PositionCovariance& indefinite :
         {PositionCovariance{-1e-9, 0.0, 1.0}, PositionCovariance{1.0, 0.0, -1.0},
          PositionCovariance{1.0, 1.1, 1.0}, PositionCovariance{0.0, 1e-6, 1.0},
          PositionCovariance{1e300, 1.1e300, 1e300}}) {
        EXPECT_FALSE(indefinite.is_valid()) << indefinite.xy_m2;
        EXPECT_EQ(error_of(indefinite), key + "must be positive semidefinite");
    }
    for (const PositionCovariance& infinite :
         {PositionCovariance{kInfinity, 0.0, 1.0}, PositionCovariance{1.0, kNaN, 1.0},
          PositionCovariance{1.0, 0.0, kNaN}}) {
        EXPECT_EQ(error_of(infinite), key + "must be a finite number");
    }
}

TEST(PositionCovariance, SaysTheVarianceAlongADirection) {
    const PositionCovariance ellipse{0.04, 0.0, 0.01};
    EXPECT_DOUBLE_EQ(ellipse.along_m2({1.0, 0.0}), 0.04);
    EXPECT_DOUBLE_EQ(ellipse.along_m2({0.0, -1.0}), 0.01);
    const double root = std::sqrt(0.5);
    EXPECT_NEAR(ellipse.along_m2({root, root}), 0.025, 1e-12);
    const PositionCovariance line{1.0, 1.0, 1.0};
    EXPECT_NEAR(line.along_m2({root, root}), 2.0, 1e-12);
    EXPECT_NEAR(line.along_m2({root, -root}), 0.0, 1e-12);
    EXPECT_GE(line.along_m2({root, -root}), 0.0);
}

}  // namespace
}  // namespace conelane
