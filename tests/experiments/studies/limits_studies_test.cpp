// The studies of overruns and of memory: their counts, and that the detectors stay within their limits.

#include "conelane/invalid_input.hpp"
#include "evaluation/formats/scene_set.hpp"
#include "experiments/studies/deadlines.hpp"
#include "experiments/studies/memory.hpp"
#include "model/deadline.hpp"
#include "tests/support/straight_scene.hpp"
#include "tests/support/testing.hpp"

#include <chrono>
#include <thread>

namespace conelane::experiments {
namespace {

using testing::HasSubstr;

void work_until(const Deadline& deadline) {
    while (!deadline.passed()) {
    }
}

TEST(Deadlines, CountFromTheLimitToTheAnswer) {
    const std::vector<AnnotatedScene> scenes{straight_scene()};
    const std::vector<TimedCall> calls{
        {"early", [](const Scene&, double) {}},
        {"late", [](const Scene&, double limit_ms) { work_until(Deadline(limit_ms + 30.0)); }},
        {"asleep",
         [](const Scene&, double limit_ms) {
             std::this_thread::sleep_for(std::chrono::duration<double, std::milli>(limit_ms + 30.0));
         }},
    };
    DeadlineOptions options;
    options.limits_ms = {20.0};
    options.repeats = 3;
    const std::vector<DeadlineRow> rows = deadline_rows(scenes, calls, options);
    ASSERT_EQ(rows.size(), 3U);
    EXPECT_EQ(rows[0].calls, 3U);
    EXPECT_EQ(rows[0].struck, 0U);
    EXPECT_EQ(rows[1].struck, 3U);
    EXPECT_GE(rows[1].wall.median_ms, 29.0);
    EXPECT_LE(rows[1].cpu.max_ms, rows[1].wall.max_ms + 1.0);
    EXPECT_GT(rows[1].cpu.max_ms, 1.0);
    EXPECT_EQ(rows[1].slowest_cones, 20U);
    EXPECT_EQ(rows[2].struck, 3U);
    EXPECT_GE(rows[2].wall.median_ms, 29.0);
    EXPECT_LT(rows[2].cpu.max_ms, 10.0) << "who sleeps does not work";
    EXPECT_THAT(deadline_table(rows), HasSubstr("asleep"));
}

TEST(Deadlines, HaveQuantilesByNearestRank) {
    std::vector<double> overruns;
    for (int i = 1; i <= 2000; ++i) overruns.push_back(0.001 * i);
    const OverrunStatistics statistics = overrun_statistics(overruns);
    EXPECT_DOUBLE_EQ(statistics.median_ms, 1.0005);
    EXPECT_DOUBLE_EQ(statistics.p99_ms, 1.98);
    EXPECT_DOUBLE_EQ(statistics.p999_ms, 1.998);
    EXPECT_DOUBLE_EQ(statistics.max_ms, 2.0);
    EXPECT_EQ(overrun_statistics({}).max_ms, 0.0);
}

TEST(Deadlines, RefuseWhatIsNotThere) {
    EXPECT_THROW((void)deadline_rows({}, {}, {}), InvalidInput);
    EXPECT_THROW((void)timed_calls(std::vector<std::string>{"magic"}), InvalidInput);
    EXPECT_EQ(timed_calls(std::vector<std::string>{"front", "path-pair"}).size(), 2U);
}

/// A call of the memory study that leaks memory.
TEST(Memory, ThatGrowsIsSeen) {
    const std::vector<AnnotatedScene> scenes{straight_scene()};
    std::vector<std::vector<char>> kept;
    const std::vector<TimedCall> calls{
        {"leaking", [&](const Scene&, double) { kept.emplace_back(1000, 'x'); }}};
    MemoryOptions options;
    options.calls = 2000;
    const std::vector<MemoryRow> rows = memory_rows(scenes, calls, options);
    ASSERT_EQ(rows.size(), 1U);
    EXPECT_EQ(rows[0].warm.calls, 200U);
    EXPECT_EQ(rows[0].middle.calls, 1100U);
    EXPECT_EQ(rows[0].end.calls, 2000U);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
    EXPECT_GT(rows[0].bytes_per_call, 900.0);
    EXPECT_GT(rows[0].end.resident_bytes, rows[0].warm.resident_bytes + 1'000'000U);
#endif
    EXPECT_THAT(memory_table(rows), HasSubstr("leaking"));
    options.calls = 1;
    EXPECT_THROW((void)memory_rows(scenes, calls, options), InvalidInput);
    EXPECT_THROW((void)memory_rows({}, calls, {}), InvalidInput);
}

/// 100 000 calls: `conelane study memory`.
TEST(Memory, DoesNotGrowWithTheCallsOfADetector) {
    SceneOptions scene_options;
    scene_options.false_positive_rates = {0.2};
    scene_options.ranges_m = {20.0};
    scene_options.every_m = 60.0;
    const SceneSet set = make_scene_set({"generated:kidney"}, scene_options);
    MemoryOptions options;
    options.calls = 2000;
    const auto calls = timed_calls(std::vector<std::string>{"front", "clc", "path-pair"});
    for (const MemoryRow& row : memory_rows(set.scenes, calls, options)) {
        SCOPED_TRACE(row.detector);
        // Even the smallest leak in every fourth call would exceed the blocks that the allocator holds back,
        // which vary.
        EXPECT_LT(row.end.heap_bytes, row.middle.heap_bytes + 8 * (row.end.calls - row.middle.calls));
    }
}

}  // namespace
}  // namespace conelane::experiments
