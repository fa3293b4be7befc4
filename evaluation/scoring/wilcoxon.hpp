#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace conelane {

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
