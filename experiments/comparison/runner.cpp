#include "experiments/comparison/runner.hpp"

#include "detectors/drivable/drivable_answers.hpp"
#include "evaluation/outside/outside_program.hpp"
#include "evaluation/outside/outside_solver.hpp"
#include "experiments/comparison/answer_check.hpp"
#include "experiments/comparison/pinning.hpp"
#include "experiments/progress/progress.hpp"
#include "model/deadline.hpp"
#include "model/doubled_cones.hpp"

#include <algorithm>
#include <iterator>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

namespace conelane::experiments {
namespace {

/// The problem that an RLD detector's lanes are checked against.
struct CheckedRld {
    ConeSet cones;
    RldParameters parameters;
};

/// A detector of this program.
class TimedLaneDetector : public TimedDetector {
  public:
    TimedLaneDetector(std::string name, std::unique_ptr<LaneDetector> detector, const RunOptions& options,
                      std::optional<std::size_t> nearest, std::optional<CheckedRld> check = {})
        : name_(std::move(name)),
          limits_(options.limits),
          detector_(std::move(detector)),
          nearest_(nearest),
          check_(std::move(check)),
          doubled_(detector_->doubled_cone_m()) {}

    LaneRecord answer(const Scene& scene) override {
        const Stopwatch watch;
        LaneAnswer answer = detector_->detect(scene, limits_);
        const double latency_ms = watch.elapsed_ms();
        LaneRecord record{scene.id, name_, std::move(answer), latency_ms, nearest_};
        if (check_) check_answer(record, check_->cones.seen(doubled_.merge(scene)), check_->parameters);
        return record;
    }
    void warm_up(const Scene& scene) override {
        (void)detector_->detect(scene, limits_);
        detector_->reset();
    }
    void reset() override { detector_->reset(); }

  private:
    std::string name_;
    DetectionLimits limits_;
    std::unique_ptr<LaneDetector> detector_;
    std::optional<std::size_t> nearest_;
    std::optional<CheckedRld> check_;
    DoubledCones doubled_;  ///< a detector answers for the scene without doubled cones
};

/// A program from outside, taken from a pool of running programs and given back.
class TimedProgram : public TimedDetector {
  public:
    TimedProgram(std::shared_ptr<OutsideProgramPool> pool, std::optional<std::size_t> nearest)
        : pool_(std::move(pool)), program_(pool_->take()), nearest_(nearest) {}
    ~TimedProgram() override { pool_->give_back(std::move(program_)); }
    TimedProgram(const TimedProgram&) = delete;
    TimedProgram& operator=(const TimedProgram&) = delete;

    LaneRecord answer(const Scene& scene) override {
        if (!nearest_) return program_->answer(scene);
        const Stopwatch watch;
        const Scene seen = nearest_ahead(scene, *nearest_);
        const double cut_ms = watch.elapsed_ms();
        LaneRecord record = program_->answer(seen);
        record.latency_ms += cut_ms;
        record.nearest = nearest_;
        return record;
    }
    void warm_up(const Scene& /*scene*/) override {}  // warmed up once, at its start
    void reset() override { program_->reset(); }

  private:
    std::shared_ptr<OutsideProgramPool> pool_;
    std::unique_ptr<OutsideProgram> program_;
    std::optional<std::size_t> nearest_;
};

std::vector<LaneRecord> drive_lap(const DetectorMaker& make, std::span<const AnnotatedScene> lap,
                                  Progress& progress) {
    const std::unique_ptr<TimedDetector> timed = make(lap.front().track);
    timed->warm_up(lap.front().scene);
    std::vector<LaneRecord> records;
    records.reserve(lap.size());
    for (const AnnotatedScene& scene : lap) {
        records.push_back(timed->answer(scene.scene));
        progress.advance();
    }
    return records;
}

/// Passes laps on in their order, in whatever order they finish.
class InOrder {
  public:
    InOrder(std::size_t laps, const LapSink& sink) : waiting_(laps), sink_(sink) {}

    void put(std::size_t lap, std::vector<LaneRecord> records) {
        const std::scoped_lock lock(mutex_);
        waiting_[lap] = std::move(records);
        for (; next_ < waiting_.size() && waiting_[next_]; ++next_) {
            sink_(*waiting_[next_]);
            waiting_[next_]->clear();
        }
    }

  private:
    std::mutex mutex_;
    std::vector<std::optional<std::vector<LaneRecord>>> waiting_;
    std::size_t next_ = 0;
    const LapSink& sink_;
};

}  // namespace

DetectorMaker maker_of(const KnownDetector& detector, const RunOptions& options) {
    return [&detector, options](const std::string& /*track*/) {
        const ConeSet cones = cone_set(detector, options.detector);
        std::optional<CheckedRld> check;
        if (detector.is_rld()) check = CheckedRld{cones, rld_parameters(detector, options.detector)};
        return std::make_unique<TimedLaneDetector>(std::string(detector.name),
                                                   make_detector(detector, options.detector), options,
                                                   cones.nearest, check);
    };
}

DetectorMaker maker_of(const std::string& name, std::function<std::unique_ptr<LaneDetector>()> make_detector,
                       const RunOptions& options) {
    return [name, make_detector = std::move(make_detector), options](const std::string& /*track*/) {
        return std::make_unique<TimedLaneDetector>(name, make_detector(), options, std::nullopt);
    };
}

DetectorMaker maker_of_program(const std::string& name, const std::string& command,
                               const RunOptions& options) {
    return [pool = std::make_shared<OutsideProgramPool>(name, command), nearest = options.detector.nearest](
               const std::string& /*track*/) { return std::make_unique<TimedProgram>(pool, nearest); };
}

RldParameters solver_parameters(const DetectorOptions& options) {
    RldParameters parameters = options.rld_parameters.value_or(RldParameters{});
    if (options.pairing) parameters.pairing = *options.pairing;
    return parameters;
}

DetectorMaker maker_of_solver(const OutsideDetector& solver, const RunOptions& options) {
    const RldDetectorOptions made{.parameters = solver_parameters(options.detector),
                                  .cones = {options.detector.nearest, {}}};
    validate(made.parameters);
    const OutsideSolverOptions how{solver.formulation.value_or(Formulation::tight)};
    (void)OutsideSolver(solver, how);  // throws at once if the command is invalid
    return [solver, options, made, how](const std::string& /*track*/) {
        auto detector =
            answer_drivable_lanes(make_rld_detector(std::make_unique<OutsideSolver>(solver, how), made));
        return std::make_unique<TimedLaneDetector>(solver.name, std::move(detector), options,
                                                   made.cones.nearest,
                                                   CheckedRld{made.cones, made.parameters});
    };
}

bool same_lap(const AnnotatedScene& a, const AnnotatedScene& b) {
    return a.track == b.track && a.condition == b.condition &&
           a.false_positive_rate == b.false_positive_rate && a.range_m == b.range_m;
}

std::vector<std::size_t> lap_starts(std::span<const AnnotatedScene> scenes) {
    std::vector<std::size_t> starts;
    for (std::size_t i = 0; i < scenes.size(); ++i) {
        if (i == 0 || !same_lap(scenes[i - 1], scenes[i])) starts.push_back(i);
    }
    starts.push_back(scenes.size());
    return starts;
}

void run(const std::string& name, const DetectorMaker& make, std::span<const AnnotatedScene> scenes,
         const RunOptions& options, const LapSink& sink) {
    Progress progress(name, options.show_progress ? scenes.size() : 0);
    const std::vector<std::size_t> starts = lap_starts(scenes);
    const std::size_t laps = starts.size() - 1;
    const auto lap_scenes = [&](std::size_t lap) {
        return scenes.subspan(starts[lap], starts[lap + 1] - starts[lap]);
    };
    if (options.threads <= 1) {
        const PinnedThread pinned;
        for (std::size_t lap = 0; lap < laps; ++lap) sink(drive_lap(make, lap_scenes(lap), progress));
        return;
    }
    InOrder in_order(laps, sink);
    // oneTBB warns if there are more arenas than processors.
    const int threads = std::min(static_cast<int>(options.threads), oneapi::tbb::info::default_concurrency());
    oneapi::tbb::task_arena arena(threads);
    arena.execute([&] {
        oneapi::tbb::parallel_for(std::size_t{0}, laps, [&](std::size_t lap) {
            in_order.put(lap, drive_lap(make, lap_scenes(lap), progress));
        });
    });
}

std::vector<LaneRecord> run(const std::string& name, const DetectorMaker& make,
                            std::span<const AnnotatedScene> scenes, const RunOptions& options) {
    std::vector<LaneRecord> records;
    run(name, make, scenes, options,
        [&](std::span<const LaneRecord> lap) { std::ranges::copy(lap, std::back_inserter(records)); });
    return records;
}

}  // namespace conelane::experiments
