#include "experiments/studies/deadlines.hpp"

#include "conelane/detectors.hpp"
#include "conelane/invalid_input.hpp"
#include "evaluation/formats/scene_file.hpp"
#include "evaluation/scoring/statistics.hpp"
#include "experiments/options/whole_number.hpp"
#include "experiments/progress/progress.hpp"
#include "experiments/studies/study.hpp"
#include "experiments/studies/text_table.hpp"
#include "model/deadline.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <ctime>
#include <system_error>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace conelane::experiments {
namespace {

double thread_cpu_ms() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

// Written by the signal handler, which runs in the thread that reads them.
volatile double cpu_at_limit_ms = 0.0;
volatile std::sig_atomic_t limit_struck = 0;

void note_processor_time(int /*signal*/) {
    cpu_at_limit_ms = thread_cpu_ms();
    limit_struck = 1;
}

/// Interrupts the thread that made it when a limit expires, to read the thread's processor time then. Time
/// that the thread spends after it is an overrun of its code; wall clock also passes while other threads run.
class LimitProbe {
  public:
    LimitProbe() {
        struct sigaction action {};
        action.sa_handler = note_processor_time;
        action.sa_flags = SA_RESTART;
        require(sigaction(SIGRTMIN, &action, &before_) == 0);
        sigevent event{};
        event.sigev_notify = SIGEV_THREAD_ID;
        event.sigev_signo = SIGRTMIN;
        event._sigev_un._tid = static_cast<pid_t>(syscall(SYS_gettid));  // glibc has no other name for it
        require(timer_create(CLOCK_MONOTONIC, &event, &timer_) == 0);
    }
    ~LimitProbe() {
        timer_delete(timer_);
        sigaction(SIGRTMIN, &before_, nullptr);
    }
    LimitProbe(const LimitProbe&) = delete;
    LimitProbe& operator=(const LimitProbe&) = delete;

    void start(double limit_ms) {
        limit_struck = 0;
        set(limit_ms);
    }
    /// The processor time spent since the limit expired; nothing if it has not.
    std::optional<double> stop() {
        const double now_ms = thread_cpu_ms();
        set(0.0);
        if (limit_struck == 0) return std::nullopt;
        return std::max(0.0, now_ms - cpu_at_limit_ms);
    }

  private:
    static void require(bool done) {
        if (!done) throw std::system_error(errno, std::generic_category(), "timer");
    }
    void set(double after_ms) const {  // 0 disarms it
        constexpr double kNanoseconds = 1e6;
        const auto nanoseconds = static_cast<std::int64_t>(after_ms * kNanoseconds);
        itimerspec time{};
        time.it_value.tv_sec = nanoseconds / 1'000'000'000;
        time.it_value.tv_nsec = nanoseconds % 1'000'000'000;
        require(timer_settime(timer_, 0, &time, nullptr) == 0);
    }

    timer_t timer_{};
    struct sigaction before_ {};
};

DeadlineRow measure(std::span<const AnnotatedScene> scenes, const TimedCall& call, double limit_ms,
                    const DeadlineOptions& options, Progress& progress) {
    DeadlineRow row{call.name, limit_ms, 0, 0, {}, {}, {}, 0};
    const std::size_t count = std::min(options.limit.value_or(scenes.size()), scenes.size());
    std::vector<double> wall_ms;
    std::vector<double> cpu_ms;
    double max_cpu_ms = -1.0;
    LimitProbe probe;
    call.run(scenes.front().scene, limit_ms);  // code and memory are loaded before times are taken
    for (std::size_t k = 0; k < count * options.repeats; ++k) {
        const Scene& scene = scenes[(k % count) * scenes.size() / count].scene;
        const Stopwatch watch;
        probe.start(limit_ms);
        call.run(scene, limit_ms);
        const std::optional<double> late_cpu_ms = probe.stop();
        const double late_ms = watch.elapsed_ms() - limit_ms;
        ++row.calls;
        progress.advance();
        if (!late_cpu_ms) continue;
        ++row.struck;
        wall_ms.push_back(std::max(0.0, late_ms));
        cpu_ms.push_back(*late_cpu_ms);
        if (*late_cpu_ms <= max_cpu_ms) continue;
        max_cpu_ms = *late_cpu_ms;
        row.slowest_scene = scene.id;
        row.slowest_cones = scene.cones.size();
    }
    row.wall = overrun_statistics(wall_ms);
    row.cpu = overrun_statistics(cpu_ms);
    return row;
}

nlohmann::ordered_json to_json(const OverrunStatistics& overrun) {
    return {{"median_ms", overrun.median_ms},
            {"p99_ms", overrun.p99_ms},
            {"p999_ms", overrun.p999_ms},
            {"max_ms", overrun.max_ms}};
}

nlohmann::ordered_json row_to_json(const DeadlineRow& row) {
    nlohmann::ordered_json json{
        {"method", row.detector}, {"limit_ms", row.limit_ms}, {"calls", row.calls}, {"struck", row.struck}};
    if (row.struck == 0) return json;
    json["wall"] = to_json(row.wall);
    json["cpu"] = to_json(row.cpu);
    json["slowest_scene"] = row.slowest_scene;
    json["slowest_cones"] = row.slowest_cones;
    return json;
}

class DeadlinesStudy : public Study {
  public:
    DeadlinesStudy()
        : Study({"deadlines", "by how much do methods overrun their time limits?",
                 "Every scene under every limit, one thread, methods by name and solvers on all cones. "
                 "Overruns are those of the calls that were still running when the limit expired: wall clock "
                 "from the limit to the answer, and the thread's processor time between the two, which other "
                 "programs do not lengthen. Quantiles by nearest rank: p99.9 of fewer than 1000 calls is the "
                 "largest."}) {
        for (const DetectorInfo& detector : detectors()) detectors_.emplace_back(detector.name);
        detectors_.emplace_back("path-pair");
    }

    void add_options(CLI::App& command) override {
        command.add_option("--scenes", scenes_, "*.scenes.jsonl")->required();
        command.add_option("--methods", detectors_, "methods, and solvers of the registry")
            ->delimiter(',')
            ->capture_default_str();
        command.add_option("--limits", options_.limits_ms, "milliseconds")
            ->delimiter(',')
            ->check(CLI::Range(0.1, 1e6))
            ->capture_default_str();
        command.add_option("--repeats", options_.repeats, "number of calls for each scene and limit")
            ->check(whole_number(1, 1'000'000))
            ->capture_default_str();
        command
            .add_option_function<std::size_t>(
                "--limit", [this](std::size_t count) { options_.limit = count; },
                "scenes at most, evenly spread")
            ->check(whole_number(1, 1'000'000));
    }

    StudyResult run() override {
        const std::vector<AnnotatedScene> scenes = read_scenes(scenes_);
        const std::vector<DeadlineRow> rows = deadline_rows(scenes, timed_calls(detectors_), options_);
        return study_result(deadline_table(rows), rows,
                            [](const DeadlineRow& row) { return row_to_json(row); });
    }

  private:
    std::string scenes_;
    std::vector<std::string> detectors_;
    DeadlineOptions options_;
};

}  // namespace

OverrunStatistics overrun_statistics(std::span<const double> overruns_ms) {
    if (overruns_ms.empty()) return {};
    return {median(overruns_ms), quantile(overruns_ms, 0.99), quantile(overruns_ms, 0.999),
            quantile(overruns_ms, 1.0)};
}

std::vector<DeadlineRow> deadline_rows(std::span<const AnnotatedScene> scenes,
                                       std::span<const TimedCall> calls, const DeadlineOptions& options) {
    if (scenes.empty()) throw InvalidInput("--scenes", "hold no scene");
    const std::size_t count = std::min(options.limit.value_or(scenes.size()), scenes.size());
    Progress progress("deadlines", calls.size() * options.limits_ms.size() * count * options.repeats);
    std::vector<DeadlineRow> rows;
    for (const TimedCall& call : calls) {
        for (const double limit_ms : options.limits_ms)
            rows.push_back(measure(scenes, call, limit_ms, options, progress));
    }
    return rows;
}

std::string deadline_table(std::span<const DeadlineRow> rows) {
    TextTable table({{"method", true},
                     {"limit ms"},
                     {"calls"},
                     {"struck"},
                     {"late ms"},
                     {"p99"},
                     {"p99.9"},
                     {"max"},
                     {"cpu ms"},
                     {"p99"},
                     {"p99.9"},
                     {"max"},
                     {"cones"}});
    for (const DeadlineRow& row : rows) {
        const auto cell = [&](double value) {
            return fixed(row.struck == 0 ? std::nullopt : std::optional(value), 3);
        };
        table.add({row.detector, fmt::format("{:g}", row.limit_ms), std::to_string(row.calls),
                   std::to_string(row.struck), cell(row.wall.median_ms), cell(row.wall.p99_ms),
                   cell(row.wall.p999_ms), cell(row.wall.max_ms), cell(row.cpu.median_ms),
                   cell(row.cpu.p99_ms), cell(row.cpu.p999_ms), cell(row.cpu.max_ms),
                   row.struck == 0 ? "-" : std::to_string(row.slowest_cones)});
    }
    return table.text();
}

std::unique_ptr<Study> make_deadlines_study() {
    return std::make_unique<DeadlinesStudy>();
}

}  // namespace conelane::experiments
