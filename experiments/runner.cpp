#include "experiments/runner.hpp"

#include "experiments/progress.hpp"

#include <chrono>
#include <cstddef>
#include <exception>
#include <memory>
#include <new>
#include <string>
#include <utility>

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

namespace conelane::experiments {
namespace {

LaneAnswer detect(LaneDetector& detector, const Scene& scene, const DetectionLimits& limits) {
    try {
        return detector.detect(scene, limits);
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& failure) {
        LaneAnswer answer;
        answer.status = LaneStatus::error;
        answer.message = failure.what();
        return answer;
    }
}

bool same_lap(const AnnotatedScene& a, const AnnotatedScene& b) {
    return a.track == b.track && a.false_positive_rate == b.false_positive_rate && a.range_m == b.range_m;
}

/// First scene of each lap, and the end of all.
std::vector<std::size_t> lap_starts(std::span<const AnnotatedScene> scenes) {
    std::vector<std::size_t> starts;
    for (std::size_t i = 0; i < scenes.size(); ++i) {
        if (i == 0 || !same_lap(scenes[i - 1], scenes[i])) starts.push_back(i);
    }
    starts.push_back(scenes.size());
    return starts;
}

}  // namespace

std::vector<LaneRecord> run(const MethodEntry& method, std::span<const AnnotatedScene> scenes,
                            const RunOptions& options) {
    std::vector<LaneRecord> records(scenes.size());
    if (scenes.empty()) return records;
    Progress progress(std::string(method.name), options.show_progress ? scenes.size() : 0);
    const std::optional<std::size_t> nearest = cone_set_size(method, options.method);
    const std::vector<std::size_t> starts = lap_starts(scenes);

    const auto drive_lap = [&](std::size_t lap) {
        const std::unique_ptr<LaneDetector> detector = method.make(options.method);
        (void)detect(*detector, scenes[starts[lap]].scene, options.limits);
        detector->reset();
        for (std::size_t i = starts[lap]; i < starts[lap + 1]; ++i) {
            const auto start = std::chrono::steady_clock::now();
            LaneAnswer answer = detect(*detector, scenes[i].scene, options.limits);
            const std::chrono::duration<double, std::milli> latency =
                std::chrono::steady_clock::now() - start;
            records[i] = {scenes[i].scene.id, std::string(method.name), std::move(answer), latency.count(),
                          nearest};
            progress.advance();
        }
    };
    if (options.threads <= 1) {
        for (std::size_t lap = 0; lap + 1 < starts.size(); ++lap) drive_lap(lap);
    } else {
        tbb::task_arena arena(static_cast<int>(options.threads));
        arena.execute([&] { tbb::parallel_for(std::size_t{0}, starts.size() - 1, drive_lap); });
    }
    return records;
}

}  // namespace conelane::experiments
