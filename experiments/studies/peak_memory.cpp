#include "experiments/studies/peak_memory.hpp"

#include <fstream>
#include <string>
#include <string_view>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace conelane::experiments {
namespace {

std::optional<std::size_t> status_bytes(std::string_view key) {
    constexpr std::size_t kKiB = 1024;
    std::ifstream status("/proc/self/status");
    for (std::string word; status >> word;) {
        std::size_t kib = 0;
        if (word == key && status >> kib) return kib * kKiB;
    }
    return std::nullopt;
}

}  // namespace

PeakMemory::PeakMemory() {
#ifdef __GLIBC__
    malloc_trim(0);
#endif
    std::ofstream peak("/proc/self/clear_refs");
    peak << "5";  // resets the peak to the current value
    peak.close();
    if (peak) before_bytes_ = status_bytes("VmRSS:");
}

std::optional<std::size_t> PeakMemory::rise_bytes() const {
    const auto peak = status_bytes("VmHWM:");
    if (!before_bytes_ || !peak) return std::nullopt;
    return *peak > *before_bytes_ ? *peak - *before_bytes_ : 0;
}

}  // namespace conelane::experiments
