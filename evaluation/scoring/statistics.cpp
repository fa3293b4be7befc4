#include "evaluation/scoring/statistics.hpp"

#include "conelane/invalid_input.hpp"
#include "evaluation/seeded_random.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <numeric>
#include <vector>

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

}  // namespace

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

}  // namespace conelane
