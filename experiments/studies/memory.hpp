#pragma once

#include "evaluation/world/annotated_scene.hpp"
#include "experiments/studies/timed_call.hpp"

#include <cstddef>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace conelane::experiments {

class Study;

/// Whether the memory of the process grows with the calls of a detector.
[[nodiscard]] std::unique_ptr<Study> make_memory_study();

struct MemoryOptions {
    std::size_t calls = 100'000;
    double time_limit_ms = std::numeric_limits<double>::infinity();
};

/// Memory of the process at one time.
struct MemoryReading {
    std::size_t calls = 0;           ///< made so far
    std::size_t resident_bytes = 0;  ///< by the operating system
    std::size_t heap_bytes = 0;      ///< allocated and not freed; 0 if the C library does not report it
};
[[nodiscard]] MemoryReading memory_now();

/// One detector. The first tenth of the calls, and every scene once at least, fills workspaces.
struct MemoryRow {
    std::string detector;
    MemoryReading warm;
    MemoryReading middle;  ///< halfway from there to the end
    MemoryReading end;
    double bytes_per_call = 0.0;  ///< of the heap, from `warm` to `end`
};

/// All scenes in turn, repeatedly. Throws InvalidInput if there is no scene, if there are fewer than two
/// calls a scene, or if an answer is an error.
[[nodiscard]] std::vector<MemoryRow> memory_rows(std::span<const AnnotatedScene> scenes,
                                                 std::span<const TimedCall> calls,
                                                 const MemoryOptions& options);

[[nodiscard]] std::string memory_table(std::span<const MemoryRow> rows);

}  // namespace conelane::experiments
