#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace conelane {

/// Real-time budget of a detection: the period of a 20 Hz LiDAR [ms].
inline constexpr double kRealTimeBudget_ms = 50.0;
/// Shift of the shifted geometric mean of times [ms].
inline constexpr double kGeometricMeanShift_ms = 1.0;

/// part / whole; nothing if the whole is 0.
[[nodiscard]] std::optional<double> share(std::size_t part, std::size_t whole);

/// Every function throws InvalidInput if the sample is empty. Values need not be sorted.

/// The middle value; for an even count, the mean of the two middle values.
[[nodiscard]] double median(std::span<const double> sample);

/// Nearest-rank quantile: the smallest value that at least `share` of the sample does not exceed, so always
/// one of the values; the smallest one for share 0. Precondition: `share` in [0, 1].
[[nodiscard]] double quantile(std::span<const double> sample, double share);

[[nodiscard]] double mean(std::span<const double> sample);

/// Of the sample (divisor n - 1); 0 for a single value.
[[nodiscard]] double standard_deviation(std::span<const double> sample);

/// exp(mean of log(x + shift)) - shift. Precondition: every value is above -shift.
[[nodiscard]] double shifted_geometric_mean(std::span<const double> sample, double shift);

/// A mean over runs on several courses. Runs on one course are alike, so whole courses are drawn again for
/// the interval, with replacement.
struct CourseMean {
    double mean = 0.0;                                    ///< over all values
    std::optional<std::pair<double, double>> interval{};  ///< 95 %; absent for a single course
    std::vector<double> of_course;                        ///< means, by name of the course
};
/// `courses` names the course of each value. The same seed gives the same interval on any machine. Throws
/// InvalidInput also if the sizes differ.
[[nodiscard]] CourseMean course_mean(std::span<const double> values, std::span<const std::string> courses,
                                     std::uint64_t seed = 1);

/// Values of which there may be none: each statistic is absent then.
class Sample {
  public:
    void add(std::optional<double> value) {
        if (value) values_.push_back(*value);
    }
    [[nodiscard]] const std::vector<double>& values() const { return values_; }
    [[nodiscard]] std::optional<double> mean() const;
    [[nodiscard]] std::optional<double> median() const;
    [[nodiscard]] std::optional<double> quantile(double share) const;

  private:
    std::vector<double> values_;
};

/// The statistics that tables show of times [ms].
struct LatencyStatistics {
    double median_ms = 0.0;
    double mean_ms = 0.0;
    double standard_deviation_ms = 0.0;
    double p95_ms = 0.0;
    double p99_ms = 0.0;
    double max_ms = 0.0;
    double shifted_geometric_mean_ms = 0.0;  ///< shift kGeometricMeanShift_ms
    double share_within_budget = 0.0;        ///< at most kRealTimeBudget_ms, in [0, 1]
};
[[nodiscard]] LatencyStatistics latency_statistics(std::span<const double> latencies_ms);

/// Wilcoxon's signed-rank test of paired samples, two-sided.
struct SignedRankTest {
    std::size_t pairs = 0;  ///< pairs that differ; equal pairs are left out
    double rank_sum = 0.0;  ///< of the smaller sign, ties with their mean rank
    double p_value = 1.0;   ///< 1 if no pair differs
    bool is_exact = false;  ///< by the distribution of the rank sum; else by the normal approximation
};
/// Exact for at most 50 pairs that all differ, no two by the same amount; otherwise the normal approximation
/// with the correction for ties and without a continuity correction, as scipy.stats.wilcoxon does by default.
/// Throws InvalidInput if the samples differ in size or a value is not finite.
[[nodiscard]] SignedRankTest signed_rank_test(std::span<const double> first, std::span<const double> second);

/// Holm's step-down correction for this many tests, in the order of `p_values`.
[[nodiscard]] std::vector<double> holm_corrected(std::span<const double> p_values);

}  // namespace conelane
