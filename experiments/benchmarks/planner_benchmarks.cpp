// Time of a planner for a frame, and of its detector for the same frame alone: median and 99th percentile of
// the processor time. The frames are a lap of each generated circuit, driven by the planner: condition `car`,
// 30 % false positives, 20 m range.

#include "evaluation/scoring/statistics.hpp"
#include "evaluation/world/generated_tracks.hpp"
#include "experiments/race/race.hpp"

#include <ctime>

#include <benchmark/benchmark.h>

namespace conelane::experiments {
namespace {

constexpr double kSight_m = 20.0;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::vector<Frame> lap_of(const RaceCourse& course) {
    SceneOptions scenes;
    scenes.conditions = {"car"};
    RaceOptions options;
    options.sight.condition = conditions_of(scenes).front();
    options.sight.false_positive_rate = 0.3;
    options.sight.seed = 1;
    options.sight.range_m = kSight_m;
    const auto planner = make_planner({.laps = 1});
    std::vector<Frame> frames;
    (void)race(course, options, [&](const Frame& frame) {
        frames.push_back(frame);
        Drive drive;
        for (const DrivablePoint& point : planner->update(frame, {.time_limit_ms = kInfinity}).lane.points) {
            drive.path.push_back(point.position);
        }
        return drive;
    });
    return frames;
}

const std::vector<std::vector<Frame>>& laps() {
    static const std::vector<std::vector<Frame>> all = [] {
        std::vector<std::vector<Frame>> laps;
        for (const std::string& name : generated_track_names()) {
            const Track track = generate_track(name, 0);
            if (track.closed) laps.push_back(lap_of(circuit(track)));
        }
        return laps;
    }();
    return all;
}

/// Processor time of a call [ms].
template <typename Call>
double time_ms(Call&& call) {
    const std::clock_t begin = std::clock();
    call();
    return 1e3 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
}

/// One iteration is all frames once. `with_planner`, `with_detector`: whose time counts; with both, the
/// planner's time minus the detector's.
void frames(benchmark::State& state, bool with_planner, bool with_detector) {
    std::vector<double> times_ms;
    (void)laps();
    for ([[maybe_unused]] auto iteration : state) {
        for (const std::vector<Frame>& lap : laps()) {
            const auto planner = make_planner({.laps = 1});
            const auto detector = make_detector("front-warm");
            for (const Frame& frame : lap) {
                const Scene scene{"frame", frame.pose, frame.cones};
                double taken_ms = 0.0;
                if (with_planner) {
                    taken_ms += time_ms([&] {
                        Plan plan = planner->update(frame, {.time_limit_ms = kInfinity});
                        benchmark::DoNotOptimize(plan);
                    });
                }
                if (with_detector) {
                    const double detector_ms = time_ms([&] {
                        LaneAnswer answer = detector->detect(scene, {.time_limit_ms = kInfinity});
                        benchmark::DoNotOptimize(answer);
                    });
                    taken_ms += with_planner ? -detector_ms : detector_ms;
                }
                times_ms.push_back(taken_ms);
            }
        }
    }
    state.counters["frames"] = static_cast<double>(times_ms.size());
    state.counters["median_ms"] = median(times_ms);
    state.counters["p99_ms"] = quantile(times_ms, 0.99);
}
BENCHMARK_CAPTURE(frames, planner, true, false)->Iterations(1)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(frames, detector_alone, false, true)->Iterations(1)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(frames, planner_less_detector, true, true)->Iterations(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace conelane::experiments

BENCHMARK_MAIN();
