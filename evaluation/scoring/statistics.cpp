#include "evaluation/scoring/statistics.hpp"

#include "conelane/invalid_input.hpp"
#include "evaluation/seeded_random.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
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

constexpr double kPar10 = 10.0;

/// The number of runs, which is the same for every solver.
std::size_t common_size(std::span<const std::vector<SolverRun>> by_solver) {
    const std::size_t runs = by_solver.empty() ? 0 : by_solver.front().size();
    for (const std::vector<SolverRun>& one : by_solver) {
        if (one.size() != runs) throw InvalidInput("runs", "solvers have different numbers of them");
    }
    return runs;
}

/// The solver that solves the run first.
std::optional<std::size_t> fastest(std::span<const std::vector<SolverRun>> by_solver, std::size_t run) {
    std::optional<std::size_t> best;
    for (std::size_t s = 0; s < by_solver.size(); ++s) {
        if (!by_solver[s][run].solved) continue;
        if (!best || by_solver[s][run].time_ms < by_solver[*best][run].time_ms) best = s;
    }
    return best;
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

void Calibration::add(double confidence, bool is_usable) {
    const auto place = static_cast<std::size_t>(confidence * static_cast<double>(kBins));
    Bin& bin = bins_[std::min(place, kBins - 1)];
    ++bin.lanes;
    bin.confidence += confidence;
    ++lanes_;
    if (is_usable) ++bin.usable;
    if (confidence < kSure) return;
    ++sure_;
    if (is_usable) ++usable_where_sure_;
}

void Calibration::add_trust(double trusted_m, double lane_length_m, std::optional<double> divergence_m) {
    ++with_trust_;
    if (!divergence_m || *divergence_m >= trusted_m) ++right_where_trusted_;
    trusted_m_ += std::min(trusted_m, lane_length_m);
    length_m_ += lane_length_m;
}

std::optional<double> Calibration::error() const {
    if (lanes_ == 0) return std::nullopt;
    double sum = 0.0;
    for (const Bin& bin : bins_) sum += std::abs(bin.confidence - static_cast<double>(bin.usable));
    return sum / static_cast<double>(lanes_);
}

std::optional<double> Calibration::usable_where_sure() const {
    return share(usable_where_sure_, sure_);
}

std::optional<double> Calibration::sure() const {
    return share(sure_, lanes_);
}

std::optional<double> Calibration::right_where_trusted() const {
    return share(right_where_trusted_, with_trust_);
}

std::optional<double> Calibration::trusted_share() const {
    if (length_m_ <= 0.0) return std::nullopt;
    return trusted_m_ / length_m_;
}

std::vector<double> penalised_times_ms(std::span<const SolverRun> runs, double limit_ms, double factor) {
    std::vector<double> times;
    times.reserve(runs.size());
    for (const SolverRun& run : runs) times.push_back(run.solved ? run.time_ms : factor * limit_ms);
    return times;
}

double penalised_average_ms(std::span<const SolverRun> runs, double limit_ms, double factor) {
    return mean(penalised_times_ms(runs, limit_ms, factor));
}

std::vector<std::vector<double>> performance_profiles(std::span<const std::vector<SolverRun>> by_solver,
                                                      std::span<const double> ratios) {
    const std::size_t runs = common_size(by_solver);
    if (runs == 0) throw InvalidInput("runs", "there is none");
    std::vector<std::vector<double>> shares(by_solver.size(), std::vector<double>(ratios.size(), 0.0));
    for (std::size_t run = 0; run < runs; ++run) {
        const auto best = fastest(by_solver, run);
        if (!best) continue;
        const double best_ms = by_solver[*best][run].time_ms;
        for (std::size_t s = 0; s < by_solver.size(); ++s) {
            if (!by_solver[s][run].solved) continue;
            for (std::size_t r = 0; r < ratios.size(); ++r) {
                if (by_solver[s][run].time_ms <= ratios[r] * best_ms) shares[s][r] += 1.0;
            }
        }
    }
    for (std::vector<double>& of_solver : shares) {
        for (double& share : of_solver) share /= static_cast<double>(runs);
    }
    return shares;
}

BestSolvers best_solvers(std::span<const std::vector<SolverRun>> by_solver, double limit_ms) {
    const std::size_t runs = common_size(by_solver);
    if (runs == 0) throw InvalidInput("runs", "there is none");
    BestSolvers best;
    best.single_par10_ms = std::numeric_limits<double>::infinity();
    for (std::size_t s = 0; s < by_solver.size(); ++s) {
        const double par10_ms = penalised_average_ms(by_solver[s], limit_ms, kPar10);
        if (par10_ms >= best.single_par10_ms) continue;
        best.single_best = s;
        best.single_par10_ms = par10_ms;
    }
    best.won.assign(by_solver.size(), 0);
    std::vector<SolverRun> chosen(runs);
    for (std::size_t run = 0; run < runs; ++run) {
        const auto winner = fastest(by_solver, run);
        if (!winner) continue;
        ++best.won[*winner];
        chosen[run] = by_solver[*winner][run];
    }
    best.virtual_par10_ms = penalised_average_ms(chosen, limit_ms, kPar10);
    return best;
}

double relative_distance(std::optional<double> a, std::optional<double> b) {
    if (!a || !b) return 1.0;
    const double largest = std::max(std::abs(*a), std::abs(*b));
    if (largest == 0.0) return 0.0;
    if (*a * *b < 0.0) return 1.0;
    return std::abs(*a - *b) / largest;
}

GapIntegrals gap_integrals(std::span<const Knowledge> steps, double known_best, double limit_ms) {
    GapIntegrals integrals;
    double primal = 1.0;
    double dual = 1.0;
    double since_ms = 0.0;
    const auto add_until = [&](double until_ms) {
        integrals.primal_ms += primal * (until_ms - since_ms);
        integrals.dual_ms += dual * (until_ms - since_ms);
        since_ms = until_ms;
    };
    for (const Knowledge& step : steps) {
        if (step.time_ms >= limit_ms) break;
        add_until(std::max(step.time_ms, since_ms));
        if (step.objective) primal = relative_distance(step.objective, known_best);
        if (step.bound) dual = relative_distance(step.bound, known_best);
    }
    add_until(limit_ms);
    return integrals;
}

Variability variability_of(std::span<const double> times_ms) {
    if (times_ms.size() < 2) throw InvalidInput("times", "must be at least two");
    const auto [least, most] = std::ranges::minmax(times_ms);
    return {standard_deviation(times_ms) / mean(times_ms), most / least};
}

}  // namespace conelane
