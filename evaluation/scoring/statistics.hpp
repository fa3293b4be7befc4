#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

// Measures of solvers on the same runs, as benchmarks of optimisation print them. Definitions with their
// sources: docs/measures.md.
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

/// Whether a detector's statements about its own lanes are true. Shares are in [0, 1], and absent if no lane
/// counts.
class Calibration {
  public:
    static constexpr std::size_t kBins = 10;
    static constexpr double kSure = 0.99;

    struct Bin {
        std::size_t lanes = 0;
        double confidence = 0.0;  ///< sum
        std::size_t usable = 0;
    };

    /// Counts a lane with this probability of being usable. Precondition: it is in [0, 1].
    void add(double confidence, bool is_usable);
    /// Counts a lane of that length, which is said to be right up to `trusted_m`, and which leaves the true
    /// boundaries at `divergence_m`, if at all.
    void add_trust(double trusted_m, double lane_length_m, std::optional<double> divergence_m);

    /// By confidence, from [0, 0.1) to [0.9, 1].
    [[nodiscard]] const std::array<Bin, kBins>& bins() const { return bins_; }
    /// Expected calibration error: mean over the lanes of |confidence - share usable| of their bin.
    [[nodiscard]] std::optional<double> error() const;
    /// Share of usable lanes among those with a confidence of at least kSure.
    [[nodiscard]] std::optional<double> usable_where_sure() const;
    /// Share of lanes with a confidence of at least kSure.
    [[nodiscard]] std::optional<double> sure() const;
    /// Share of the lanes that are right up to their trusted length.
    [[nodiscard]] std::optional<double> right_where_trusted() const;
    /// Sum of the trusted lengths over the sum of the lengths.
    [[nodiscard]] std::optional<double> trusted_share() const;

  private:
    std::array<Bin, kBins> bins_{};
    std::size_t lanes_ = 0;
    std::size_t sure_ = 0;
    std::size_t usable_where_sure_ = 0;
    std::size_t with_trust_ = 0;
    std::size_t right_where_trusted_ = 0;
    double trusted_m_ = 0.0;
    double length_m_ = 0.0;
};

/// One run of a solver: an instance, in one order of its rows and columns.
struct SolverRun {
    double time_ms = 0.0;  ///< wall clock
    bool solved = false;   ///< an optimum, or that there is none, was proven within the limit, and checked
};

/// The times, with `factor` times the limit for unsolved runs. Precondition: limit_ms > 0, factor >= 1.
[[nodiscard]] std::vector<double> penalised_times_ms(std::span<const SolverRun> runs, double limit_ms,
                                                     double factor = 1.0);

/// PAR k: the mean of the penalised times. Throws InvalidInput if there is no run.
[[nodiscard]] double penalised_average_ms(std::span<const SolverRun> runs, double limit_ms, double factor);

/// Dolan and Moré's performance profile of each solver: at each of the ratios, ascending and >= 1, the share
/// of the runs that it solves within this multiple of the fastest time. `by_solver` are runs of the same
/// instances in one order. A run that no solver solves counts for none. Throws InvalidInput if the numbers of
/// runs differ or there are none.
[[nodiscard]] std::vector<std::vector<double>> performance_profiles(
    std::span<const std::vector<SolverRun>> by_solver, std::span<const double> ratios);

/// The best single solver compared with the best solver of each run.
struct BestSolvers {
    std::size_t single_best = 0;  ///< the solver of the least PAR 10, the first of several
    double single_par10_ms = 0.0;
    double virtual_par10_ms =
        0.0;  ///< of the fastest that solves each run; a run that none solves is penalised
    std::vector<std::size_t> won;  ///< by solver: runs that it solves first, a tie goes to the first
};
/// Throws InvalidInput if the numbers of runs differ, or there is no solver or no run.
[[nodiscard]] BestSolvers best_solvers(std::span<const std::vector<SolverRun>> by_solver, double limit_ms);

/// Objective and bound known at some time of a run.
struct Knowledge {
    double time_ms = 0.0;
    std::optional<double> objective;  ///< of the incumbent
    std::optional<double> bound;      ///< proven lower bound
};

/// |a - b| / max(|a|, |b|), in [0, 1]; 0 if both are 0, 1 if one is absent or they differ in sign.
[[nodiscard]] double relative_distance(std::optional<double> a, std::optional<double> b);

/// Integral over [0, limit] of the gap between `known_best` and the incumbent, or the bound, as a step
/// function of time: 1 until the first of them. In milliseconds, between 0 and the limit. `steps` ascend in
/// time; those after the limit are ignored.
struct GapIntegrals {
    double primal_ms = 0.0;
    double dual_ms = 0.0;
};
[[nodiscard]] GapIntegrals gap_integrals(std::span<const Knowledge> steps, double known_best,
                                         double limit_ms);

/// Variation of the times of one instance over its permutations.
struct Variability {
    double coefficient = 0.0;  ///< standard deviation (divisor k - 1) / mean
    double ratio = 1.0;        ///< largest / smallest
};
/// Throws InvalidInput for fewer than two times. Precondition: every time is positive.
[[nodiscard]] Variability variability_of(std::span<const double> times_ms);

}  // namespace conelane
