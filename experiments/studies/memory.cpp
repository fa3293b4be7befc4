#include "experiments/studies/memory.hpp"

#include "conelane/invalid_input.hpp"
#include "evaluation/formats/scene_file.hpp"
#include "experiments/options/whole_number.hpp"
#include "experiments/progress/progress.hpp"
#include "experiments/studies/study.hpp"
#include "experiments/studies/text_table.hpp"

#include <algorithm>
#include <fstream>

#include <CLI/CLI.hpp>
#include <unistd.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace conelane::experiments {
namespace {

std::size_t resident_bytes() {
    std::ifstream pages("/proc/self/statm");
    std::size_t total = 0;
    std::size_t resident = 0;
    if (!(pages >> total >> resident)) throw InvalidInput("/proc/self/statm", "cannot be read");
    return resident * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

std::size_t heap_bytes() {
#ifdef __GLIBC__
    const struct mallinfo2 heap = mallinfo2();
    return heap.uordblks + heap.hblkhd;
#else
    return 0;
#endif
}

MemoryRow measure(std::span<const AnnotatedScene> scenes, const TimedCall& call, const MemoryOptions& options,
                  Progress& progress) {
    MemoryRow row{call.name, {}, {}, {}, 0.0};
    const std::size_t warm = std::max(scenes.size(), options.calls / 10);
    const std::size_t middle = warm + (options.calls - warm) / 2;
    for (std::size_t k = 0; k < options.calls; ++k) {
        call.run(scenes[k % scenes.size()].scene, options.time_limit_ms);
        progress.advance();
        MemoryReading* const reading = k + 1 == warm            ? &row.warm
                                       : k + 1 == middle        ? &row.middle
                                       : k + 1 == options.calls ? &row.end
                                                                : nullptr;
        if (reading == nullptr) continue;
        *reading = memory_now();
        reading->calls = k + 1;
    }
    row.bytes_per_call =
        (static_cast<double>(row.end.heap_bytes) - static_cast<double>(row.warm.heap_bytes)) /
        static_cast<double>(row.end.calls - row.warm.calls);
    return row;
}

nlohmann::ordered_json to_json(const MemoryReading& reading) {
    return {{"calls", reading.calls},
            {"resident_bytes", reading.resident_bytes},
            {"heap_bytes", reading.heap_bytes}};
}

nlohmann::ordered_json row_to_json(const MemoryRow& row) {
    return {{"method", row.detector},
            {"warm", to_json(row.warm)},
            {"middle", to_json(row.middle)},
            {"end", to_json(row.end)},
            {"bytes_per_call", row.bytes_per_call}};
}

class MemoryStudy : public Study {
  public:
    MemoryStudy()
        : Study(
              {"memory", "does memory grow with the calls of a method?",
               "The scenes in turn, over and over, one instance a method in this one process. Resident "
               "memory as the operating system counts it, and what the C library has allocated and not got "
               "back: after the first tenth of the calls, which fills workspaces, halfway and at the end."}) {
    }

    void add_options(CLI::App& command) override {
        command.add_option("--scenes", scenes_, "*.scenes.jsonl")->required();
        command.add_option("--methods", detectors_, "methods, and solvers of the registry")
            ->delimiter(',')
            ->capture_default_str();
        command.add_option("--calls", options_.calls, "number of calls of each method")
            ->check(whole_number(2, 100'000'000))
            ->capture_default_str();
        command
            .add_option("--time-limit", options_.time_limit_ms,
                        "time limit of each call [ms]; without it none")
            ->check(CLI::Range(0.1, 1e6));
    }

    StudyResult run() override {
        const std::vector<AnnotatedScene> scenes = read_scenes(scenes_);
        const std::vector<MemoryRow> rows = memory_rows(scenes, timed_calls(detectors_), options_);
        return study_result(memory_table(rows), rows, [](const MemoryRow& row) { return row_to_json(row); });
    }

  private:
    std::string scenes_;
    std::vector<std::string> detectors_{"front", "clc", "path-pair"};
    MemoryOptions options_;
};

}  // namespace

MemoryReading memory_now() {
    return {0, resident_bytes(), heap_bytes()};
}

std::vector<MemoryRow> memory_rows(std::span<const AnnotatedScene> scenes, std::span<const TimedCall> calls,
                                   const MemoryOptions& options) {
    if (scenes.empty()) throw InvalidInput("--scenes", "hold no scene");
    if (options.calls < 2 * scenes.size() || options.calls < 4)
        throw InvalidInput("--calls", "must be at least 4, and at least 2 for each scene");
    Progress progress("memory", calls.size() * options.calls);
    std::vector<MemoryRow> rows;
    for (const TimedCall& call : calls) rows.push_back(measure(scenes, call, options, progress));
    return rows;
}

std::string memory_table(std::span<const MemoryRow> rows) {
    TextTable table({{"method", true},
                     {"calls"},
                     {"resident KiB warm"},
                     {"middle"},
                     {"end"},
                     {"heap KiB warm"},
                     {"middle"},
                     {"end"},
                     {"bytes a call"}});
    const auto kib = [](std::size_t bytes) { return fixed(static_cast<double>(bytes) / 1024.0, 1); };
    for (const MemoryRow& row : rows) {
        table.add({row.detector, std::to_string(row.end.calls), kib(row.warm.resident_bytes),
                   kib(row.middle.resident_bytes), kib(row.end.resident_bytes), kib(row.warm.heap_bytes),
                   kib(row.middle.heap_bytes), kib(row.end.heap_bytes), fixed(row.bytes_per_call, 3)});
    }
    return table.text();
}

std::unique_ptr<Study> make_memory_study() {
    return std::make_unique<MemoryStudy>();
}

}  // namespace conelane::experiments
