#include "experiments/comparison/runner.hpp"

#include "evaluation/progress/progress.hpp"

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
#include <sched.h>

namespace conelane::experiments {
namespace {

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

void run(const Method& method, std::span<const AnnotatedScene> scenes, const RunOptions& options,
         const LapSink& sink) {
    const DetectorMaker make = method.maker(options);
    Progress progress(method.name, options.show_progress ? scenes.size() : 0);
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

std::vector<LaneRecord> run(const Method& method, std::span<const AnnotatedScene> scenes,
                            const RunOptions& options) {
    std::vector<LaneRecord> records;
    run(method, scenes, options,
        [&](std::span<const LaneRecord> lap) { std::ranges::copy(lap, std::back_inserter(records)); });
    return records;
}

struct PinnedThread::Mask {
    cpu_set_t processors;
};

PinnedThread::PinnedThread() : before_(std::make_unique<Mask>()) {
    const int processor = sched_getcpu();
    cpu_set_t one;
    CPU_ZERO(&one);
    if (processor >= 0) CPU_SET(static_cast<unsigned>(processor), &one);
    if (processor < 0 || sched_getaffinity(0, sizeof(cpu_set_t), &before_->processors) != 0 ||
        sched_setaffinity(0, sizeof(cpu_set_t), &one) != 0) {
        before_.reset();
    }
}

PinnedThread::~PinnedThread() {
    if (before_) sched_setaffinity(0, sizeof(cpu_set_t), &before_->processors);
}

}  // namespace conelane::experiments
