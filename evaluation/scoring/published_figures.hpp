#pragma once

#include <array>

namespace conelane {

/// Figures that the papers print, in per cent and milliseconds, to show beside this project's figures. They
/// were measured on other machines and, for RLD, on other data: for comparison, not for exact reproduction.

/// CLC paper, Table I (VIII-D; both ranges, 30 m and 50 m, together) and Table II (VIII-E). The text of
/// VIII-D says 2.6 % critical failures at a rate of 50 %; the table says 5.0 %, which is the value here.
struct PublishedClcRow {
    double false_positive_rate;  ///< false positives / all points
    double ground_truth;
    double near_ground_truth;
    double too_short;
    double diverging_from_20;
    double diverging_below_20;
    double success;
    double mean_iou;
    double complete;  ///< Table II
};
inline constexpr std::array<PublishedClcRow, 4> kPublishedClc{{
    {0.0, 34.5, 61.9, 0.7, 2.2, 0.6, 99.4, 96.9, 46.4},
    {0.1, 24.9, 70.9, 0.5, 2.9, 0.8, 99.2, 96.0, 34.4},
    {0.3, 9.3, 85.1, 0.8, 4.1, 0.7, 99.3, 93.2, 13.4},
    {0.5, 2.1, 70.9, 2.6, 19.3, 5.0, 95.0, 79.5, 2.3},
}};
/// CLC paper, VIII-G: "a median runtime of under 5ms and a maximum runtime of 12ms".
inline constexpr double kPublishedClcMedianBelow_ms = 5.0;
inline constexpr double kPublishedClcMax_ms = 12.0;

/// RLD paper, IV-B and Fig. 7: inaccurate solves over straight, circle and curvy track together.
struct PublishedRldRow {
    double false_positive_rate;  ///< false positives / all points; the paper gives false positives : cones
    const char* printed_ratio;
    double inaccurate;
    bool upper_bound;  ///< the paper says "less than"
};
inline constexpr std::array<PublishedRldRow, 2> kPublishedRld{{
    {1.0 / 6.0, "1:5", 3.62, false},
    {1.0 / 2.0, "1:1", 10.0, true},
}};
/// RLD paper, IV-A and Fig. 6, cone sets of n = 12: share of successful solves, mean of theirs, and the time
/// within which 95 % of all are solved, with its standard deviation.
inline constexpr int kPublishedRldConeSet = 12;
inline constexpr double kPublishedRldSolved = 97.19;
inline constexpr double kPublishedRldMean_ms = 71.79;
inline constexpr double kPublishedRldP95_ms = 155.88;
inline constexpr double kPublishedRldStandardDeviation_ms = 51.96;

}  // namespace conelane
