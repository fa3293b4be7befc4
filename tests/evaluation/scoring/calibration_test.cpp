// Statements of a detector about its own lanes, compared with the truth.

#include "evaluation/scoring/statistics.hpp"

#include <gtest/gtest.h>

namespace conelane {
namespace {

TEST(Calibration, KnowsNothingWithoutLanes) {
    const Calibration calibration;
    EXPECT_FALSE(calibration.error());
    EXPECT_FALSE(calibration.sure());
    EXPECT_FALSE(calibration.usable_where_sure());
    EXPECT_FALSE(calibration.right_where_trusted());
    EXPECT_FALSE(calibration.trusted_share());
}

TEST(Calibration, ErrorIsWeighedOverTheBins) {
    Calibration calibration;
    // With a confidence of 0.95, three of four lanes are usable; with 0.25, one of two.
    for (const bool usable : {true, true, true, false}) calibration.add(0.95, usable);
    for (const bool usable : {true, false}) calibration.add(0.25, usable);
    EXPECT_EQ(calibration.bins()[9].lanes, 4U);
    EXPECT_EQ(calibration.bins()[2].lanes, 2U);
    EXPECT_NEAR(*calibration.error(), (4.0 * 0.20 + 2.0 * 0.25) / 6.0, 1e-12);
}

TEST(Calibration, OverAndUnderWithinABinCancel) {
    Calibration calibration;
    calibration.add(0.51, false);
    calibration.add(0.59, true);
    EXPECT_NEAR(*calibration.error(), (1.10 - 1.0) / 2.0, 1e-12);
}

TEST(Calibration, TheLastBinHoldsCertainty) {
    Calibration calibration;
    calibration.add(1.0, true);
    calibration.add(0.0, false);
    EXPECT_EQ(calibration.bins()[9].lanes, 1U);
    EXPECT_EQ(calibration.bins()[0].lanes, 1U);
    EXPECT_DOUBLE_EQ(*calibration.error(), 0.0);
}

TEST(Calibration, SureIsFrom99PercentOn) {
    Calibration calibration;
    calibration.add(0.98, false);
    calibration.add(0.99, true);
    calibration.add(0.995, false);
    calibration.add(1.0, true);
    EXPECT_DOUBLE_EQ(*calibration.sure(), 0.75);
    EXPECT_DOUBLE_EQ(*calibration.usable_where_sure(), 2.0 / 3.0);
}

TEST(Calibration, TrustHoldsUpToTheDivergence) {
    Calibration calibration;
    calibration.add_trust(18.0, 20.0, std::nullopt);  // never off the boundaries
    calibration.add_trust(18.0, 20.0, 18.0);          // off after the trusted length
    calibration.add_trust(18.0, 20.0, 18.1);
    calibration.add_trust(18.0, 20.0, 17.9);  // off within the trusted length
    EXPECT_DOUBLE_EQ(*calibration.right_where_trusted(), 0.75);
    EXPECT_DOUBLE_EQ(*calibration.trusted_share(), 0.9);
    // Only the trusted length of the lane counts.
    calibration.add_trust(100.0, 20.0, std::nullopt);
    EXPECT_DOUBLE_EQ(*calibration.trusted_share(), (4 * 18.0 + 20.0) / 100.0);
}

}  // namespace
}  // namespace conelane
