#include "experiments/comparison/summary.hpp"

#include "tests/support/testing.hpp"

#include <deque>

namespace conelane::experiments {
namespace {

struct Place {
    std::string condition = "paper";
    std::optional<double> rate = 0.0;
    std::optional<double> range_m = 30.0;
};

/// Scored records, and the scenes and answers that they refer to.
class Summaries : public testing::Test {
  protected:
    void add(const std::string& method, const Place& place, std::optional<LaneFailure> failure,
             double latency_ms = 1.0, std::optional<std::size_t> nearest = {}, bool is_trained = false) {
        AnnotatedScene& scene = scenes_.emplace_back();
        scene.condition = place.condition;
        scene.false_positive_rate = place.rate;
        scene.range_m = place.range_m;
        LaneRecord& record = records_.emplace_back();
        record.detector = method;
        record.nearest = nearest;
        SceneScore score{.category = failure ? Category::none : Category::near_ground_truth,
                         .lane_length_m = 25.0,
                         .ground_truth_length_m = 25.0,
                         .divergence_known = true,
                         .latency_ms = latency_ms,
                         .trained_on = is_trained};
        auto scored = std::ranges::find_if(methods_, [&](const ScoredMethod& known) {
            return known.method.name == method && known.method.nearest == nearest;
        });
        if (scored == methods_.end()) {
            scored = methods_.insert(scored, ScoredMethod{});
            scored->method.name = method;
            scored->method.nearest = nearest;
        }
        scored->scores.push_back({&scene, &record, score, failure});
    }
    void add_unknown(const std::string& method) {
        add(method, {}, {});
        methods_.back().scores.back().score.divergence_known = false;
    }
    [[nodiscard]] std::string text(const std::vector<std::string>& notes = {}) const {
        return summary(methods_, notes);
    }
    [[nodiscard]] static std::vector<std::string> lines(const std::string& text) {
        std::vector<std::string> all;
        std::istringstream stream(text);
        for (std::string line; std::getline(stream, line);) all.push_back(line);
        return all;
    }
    static void expect_to_fit(const std::string& text) {
        const std::vector<std::string> all = lines(text);
        EXPECT_LE(all.size() + kLinesBelowSummary, kSummaryLines) << text;
        for (const std::string& line : all) EXPECT_LE(line.size(), kSummaryColumns) << line;
    }

    std::deque<AnnotatedScene> scenes_;
    std::deque<LaneRecord> records_;
    std::vector<ScoredMethod> methods_;
};

/// Numbers of methods, conditions, rates, ranges and cone-set sizes.
std::vector<std::array<std::size_t, 5>> combinations() {
    std::vector<std::array<std::size_t, 5>> all;
    for (const std::size_t methods : {1U, 8U, 40U}) {
        for (const std::size_t conditions : {1U, 2U, 4U}) {
            for (const std::size_t rates : {1U, 4U, 30U}) {
                for (const auto& [ranges, sizes] : {std::pair{1U, 1U}, {3U, 1U}, {1U, 12U}, {3U, 12U}})
                    all.push_back({methods, conditions, rates, ranges, sizes});
            }
        }
    }
    return all;
}

TEST_F(Summaries, OfNothingAreEmpty) {
    EXPECT_EQ(text(), "");
}

TEST_F(Summaries, SayUsableLanesByConditionAndRateLatencyAndWhatWentWrong) {
    for (const char* condition : {"paper", "car"}) {
        for (const double rate : {0.0, 0.166}) {
            const bool is_hard = rate > 0.0 && std::string(condition) == "car";
            for (int i = 0; i < 4; ++i) {
                add("worse", {condition, rate},
                    is_hard ? std::optional(LaneFailure::wrong_leg) : std::nullopt, 5.0 + i);
                add("better", {condition, rate},
                    is_hard && i == 0 ? std::optional(LaneFailure::false_cone) : std::nullopt);
            }
        }
    }
    ScoredRecord& first = methods_.front().scores.front();  // of `paper`, without false positives
    first.failure = LaneFailure::nothing_found;
    first.score.category = Category::none;
    EXPECT_THAT(
        lines(text()),
        ElementsAre("Usable lanes in %, by share of false positives in %; 16 scenes a method; range 30 m",
                    "               paper           car     latency in ms",
                    "method       0  16.6       0  16.6   median      p99",
                    "better   100.0 100.0   100.0  75.0     1.00     1.00",
                    "worse     75.0 100.0   100.0   0.0     6.50     8.00", "",
                    "Not usable, in % of the scenes, and why", "better    6.2  false cone 6.2",
                    "worse    31.2  wrong leg 25.0, nothing found 6.2", ""));
}

TEST_F(Summaries, UnknownMeasuresHaveNoShareAndAreLast) {
    add_unknown("unknown");
    add("bad", {}, LaneFailure::error);
    const std::vector<std::string> all = lines(text());
    EXPECT_THAT(all[3], HasSubstr("bad"));
    EXPECT_THAT(all[4], testing::StartsWith("unknown       -"));
    EXPECT_THAT(text(), HasSubstr("bad      100.0  error 100.0\n"));
}

TEST_F(Summaries, AMethodThatHasLearnedFromACourseIsMarked) {
    for (const bool is_trained : {true, false}) add("clc", {}, {}, 1.0, {}, is_trained);
    add("front", {}, {});
    EXPECT_THAT(text(), HasSubstr("clc* "));
    EXPECT_THAT(text(), Not(HasSubstr("front*")));
    EXPECT_THAT(text(), HasSubstr("* with courses that the method has learned from"));
}

TEST_F(Summaries, ConeSetSizesAreColumnsAndAllConesTheLast) {
    for (const std::optional<std::size_t> size : {std::optional<std::size_t>(), {12U}, {6U}}) {
        add("rld", {"", 0.3}, {}, size == 12U ? 2.0 : 0.5, size);
        SceneScore& score = methods_.back().scores.back().score;
        score.accuracy = Accuracy{true, true, true, size == 6U};
        score.solved_to_optimality = size == 12U;
        add("clc", {"", 0.3}, {}, 4.0, size);
    }
    EXPECT_THAT(
        lines(text()),
        ElementsAre("Each method among the n nearest cones, 30 % false; 3 scenes a method; range 30 m",
                    "accurate %     n=6  n=12   all", "rld          100.0   0.0   0.0",
                    "clc              -     -     -", "", "proven %       n=6  n=12   all",
                    "rld            0.0 100.0   0.0", "clc              -     -     -", "",
                    "median ms      n=6  n=12   all   growth", "rld           0.50  2.00  0.50    n^2.0",
                    "clc           4.00  4.00  4.00    n^0.0", "", "p95 ms         n=6  n=12   all",
                    "rld           0.50  2.00  0.50", "clc           4.00  4.00  4.00", ""))
        << text();
    expect_to_fit(text());
}

TEST_F(Summaries, FitWhateverIsCompared) {
    for (const auto& [methods, conditions, rates, ranges, sizes] : combinations()) {
        SCOPED_TRACE(testing::Message()
                     << methods << ' ' << conditions << ' ' << rates << ' ' << ranges << ' ' << sizes);
        methods_.clear();
        scenes_.clear();
        records_.clear();
        for (std::size_t i = 0; i < methods * conditions * rates * ranges; ++i) {
            const std::size_t m = i / (conditions * rates * ranges);
            const std::size_t c = i / (rates * ranges) % conditions;
            const std::size_t r = i / ranges % rates;
            const std::size_t g = i % ranges;
            add("a-method-of-a-long-name-" + std::to_string(m),
                {"condition" + std::to_string(c), 0.01 * static_cast<double>(r),
                 20.0 + 10.0 * static_cast<double>(g)},
                static_cast<LaneFailure>((m + r) % kLaneFailureCount), 12345.678,
                sizes > 1 ? std::optional((m + c + r + g) % sizes) : std::nullopt, m == 0);
        }
        const std::string all = text({"a note", std::string(300, 'x')});
        expect_to_fit(all);
        EXPECT_TRUE(methods == 8U || (all.find(" more method") != std::string::npos) == (methods == 40U));
    }
}

TEST_F(Summaries, EntriesWithoutRoomAreCounted) {
    for (int method = 0; method < 20; ++method) {
        for (int rate = 0; rate < 40; ++rate) add("m" + std::to_string(method), {"", 0.01 * rate}, {});
    }
    EXPECT_THAT(text(), HasSubstr("15 more methods and 13 more columns: see the wide table\n"));
}

TEST_F(Summaries, RangesAreTakenTogether) {
    for (const double range_m : {30.0, 50.0}) add("clc", {"paper", 0.0, range_m}, {});
    EXPECT_THAT(lines(text())[0], HasSubstr("; 2 scenes a method; range 30, 50 m together"));
    EXPECT_THAT(text(), HasSubstr("\nclc      100.0     1.00"));
}

TEST_F(Summaries, ManyCausesEndWithTheirRest) {
    for (std::size_t i = 0; i < kLaneFailureCount; ++i) {
        for (std::size_t times = 0; times <= i; ++times) add("clc", {}, static_cast<LaneFailure>(i));
    }
    const std::string line = lines(text())[6];
    EXPECT_THAT(line, testing::StartsWith(
                          "clc     100.0  leaves path 18.2, stopped early 16.4, gap not bridged 14.5, "));
    EXPECT_THAT(line, HasSubstr(", other "));
    EXPECT_LE(line.size(), kSummaryColumns);
}

}  // namespace
}  // namespace conelane::experiments
