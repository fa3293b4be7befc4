#include "evaluation/scoring/statistics.hpp"

#include "conelane/invalid_input.hpp"
#include "evaluation/seeded_random.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

namespace conelane {
namespace {

void require_values(std::span<const double> sample) {
    if (sample.empty()) throw InvalidInput("sample", "has no values");
}

std::vector<double> sorted(std::span<const double> sample) {
    std::vector<double> values(sample.begin(), sample.end());
    std::ranges::sort(values);
    return values;
}

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

std::optional<double> share(std::size_t part, std::size_t whole) {
    if (whole == 0) return std::nullopt;
    return static_cast<double>(part) / static_cast<double>(whole);
}

double median(std::span<const double> sample) {
    require_values(sample);
    const std::vector<double> values = sorted(sample);
    const std::size_t middle = values.size() / 2;
    return values.size() % 2 == 1 ? values[middle] : std::midpoint(values[middle - 1], values[middle]);
}

double quantile(std::span<const double> sample, double share) {
    require_values(sample);
    const std::vector<double> values = sorted(sample);
    // A rank that is whole in exact arithmetic, such as 0.95 * 20, must not be rounded up to the next one.
    constexpr double kRankTolerance = 1e-9;
    const double rank = std::ceil(share * static_cast<double>(values.size()) - kRankTolerance);
    const auto index = static_cast<std::size_t>(std::max(1.0, rank)) - 1;
    return values[std::min(index, values.size() - 1)];
}

double mean(std::span<const double> sample) {
    require_values(sample);
    return std::accumulate(sample.begin(), sample.end(), 0.0) / static_cast<double>(sample.size());
}

double standard_deviation(std::span<const double> sample) {
    const double centre = mean(sample);
    if (sample.size() == 1) return 0.0;
    double squares = 0.0;
    for (const double value : sample) squares += (value - centre) * (value - centre);
    return std::sqrt(squares / static_cast<double>(sample.size() - 1));
}

double shifted_geometric_mean(std::span<const double> sample, double shift) {
    require_values(sample);
    double logarithms = 0.0;
    for (const double value : sample) logarithms += std::log(value + shift);
    return std::exp(logarithms / static_cast<double>(sample.size())) - shift;
}

CourseMean course_mean(std::span<const double> values, std::span<const std::string> courses,
                       std::uint64_t seed) {
    constexpr int kResamples = 2000;
    constexpr double kTail = 0.025;
    if (values.size() != courses.size()) throw InvalidInput("courses", "are not as many as the values");
    CourseMean result{mean(values), {}, {}};
    std::map<std::string, std::pair<double, double>> by_course;  // sum and number of values
    for (std::size_t k = 0; k < values.size(); ++k) {
        by_course[courses[k]].first += values[k];
        by_course[courses[k]].second += 1.0;
    }
    std::vector<std::pair<double, double>> sums;
    for (const auto& [course, sum] : by_course) {
        sums.push_back(sum);
        result.of_course.push_back(sum.first / sum.second);
    }
    if (sums.size() < 2) return result;
    boost::random::mt19937_64 random = generator_of("courses", seed);
    boost::random::uniform_int_distribution<std::size_t> drawn(0, sums.size() - 1);
    std::vector<double> means;
    for (int resample = 0; resample < kResamples; ++resample) {
        std::pair<double, double> sum;
        for (std::size_t k = 0; k < sums.size(); ++k) {
            const auto& [of_values, number] = sums[drawn(random)];
            sum.first += of_values;
            sum.second += number;
        }
        means.push_back(sum.first / sum.second);
    }
    result.interval.emplace(quantile(means, kTail), quantile(means, 1.0 - kTail));
    return result;
}

std::optional<double> Sample::mean() const {
    return values_.empty() ? std::nullopt : std::optional(conelane::mean(values_));
}

std::optional<double> Sample::median() const {
    return values_.empty() ? std::nullopt : std::optional(conelane::median(values_));
}

std::optional<double> Sample::quantile(double share) const {
    return values_.empty() ? std::nullopt : std::optional(conelane::quantile(values_, share));
}

LatencyStatistics latency_statistics(std::span<const double> latencies_ms) {
    LatencyStatistics result;
    result.median_ms = median(latencies_ms);
    result.mean_ms = mean(latencies_ms);
    result.standard_deviation_ms = standard_deviation(latencies_ms);
    result.p95_ms = quantile(latencies_ms, 0.95);
    result.p99_ms = quantile(latencies_ms, 0.99);
    result.max_ms = std::ranges::max(latencies_ms);
    result.shifted_geometric_mean_ms = shifted_geometric_mean(latencies_ms, kGeometricMeanShift_ms);
    const auto within =
        std::ranges::count_if(latencies_ms, [](double latency) { return latency <= kRealTimeBudget_ms; });
    result.share_within_budget = static_cast<double>(within) / static_cast<double>(latencies_ms.size());
    return result;
}

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
