#include "evaluation/scoring/wilcoxon.hpp"

#include "conelane/invalid_input.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace conelane {
namespace {

constexpr std::size_t kMaxExactPairs = 50;

/// Share of the 2^n sign patterns of ranks 1 ... n whose rank sum is at most `rank_sum`.
double share_at_most(std::size_t n, std::size_t rank_sum) {
    std::vector<double> count(n * (n + 1) / 2 + 1, 0.0);
    count[0] = 1.0;
    for (std::size_t rank = 1; rank <= n; ++rank) {
        for (std::size_t sum = count.size(); sum-- > rank;) count[sum] += count[sum - rank];
    }
    double share = 0.0;
    for (std::size_t sum = 0; sum <= rank_sum; ++sum) share += count[sum];
    return share * std::exp2(-static_cast<double>(n));
}

}  // namespace

SignedRankTest signed_rank_test(std::span<const double> first, std::span<const double> second) {
    if (first.size() != second.size()) throw InvalidInput("samples", "must be of one size");
    std::vector<double> differences;
    for (std::size_t k = 0; k < first.size(); ++k) {
        const double difference = first[k] - second[k];
        if (!std::isfinite(difference)) throw InvalidInput("samples", "must be finite");
        if (difference != 0.0) differences.push_back(difference);
    }
    SignedRankTest test;
    test.pairs = differences.size();
    if (differences.empty()) return test;
    std::ranges::sort(differences, {}, [](double difference) { return std::abs(difference); });
    const auto n = static_cast<double>(differences.size());
    double positive = 0.0;
    double tie_sum = 0.0;  // of t^3 - t for each group of t ties
    bool has_ties = false;
    for (std::size_t begin = 0; begin < differences.size();) {
        std::size_t end = begin + 1;
        while (end < differences.size() && std::abs(differences[end]) == std::abs(differences[begin])) ++end;
        const double rank = static_cast<double>(begin + end + 1) / 2.0;
        const auto tied = static_cast<double>(end - begin);
        if (end - begin > 1) has_ties = true;
        tie_sum += tied * tied * tied - tied;
        for (std::size_t k = begin; k < end; ++k) positive += differences[k] > 0.0 ? rank : 0.0;
        begin = end;
    }
    const double whole = n * (n + 1.0) / 2.0;
    test.rank_sum = std::min(positive, whole - positive);
    test.is_exact = differences.size() <= kMaxExactPairs && differences.size() == first.size() && !has_ties;
    if (test.is_exact) {
        test.p_value = std::min(
            1.0,
            2.0 * share_at_most(differences.size(), static_cast<std::size_t>(std::lround(test.rank_sum))));
        return test;
    }
    const double variance = n * (n + 1.0) * (2.0 * n + 1.0) / 24.0 - tie_sum / 48.0;
    const double z = (test.rank_sum - whole / 2.0) / std::sqrt(variance);
    test.p_value = std::erfc(std::abs(z) / std::numbers::sqrt2);
    return test;
}

std::vector<double> holm_corrected(std::span<const double> p_values) {
    std::vector<std::size_t> order(p_values.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::sort(order, {}, [&](std::size_t k) { return p_values[k]; });
    std::vector<double> corrected(p_values.size());
    double largest = 0.0;
    for (std::size_t place = 0; place < order.size(); ++place) {
        const double scaled = p_values[order[place]] * static_cast<double>(order.size() - place);
        largest = std::max(largest, std::min(1.0, scaled));
        corrected[order[place]] = largest;
    }
    return corrected;
}

}  // namespace conelane
