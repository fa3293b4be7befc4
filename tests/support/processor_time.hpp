#pragma once

#include "tests/support/slowness.hpp"

#include <algorithm>
#include <ctime>
#include <limits>

namespace conelane::tests {

/// Processor time of this program, which does not include other programs.
inline double processor_time_ms() {
    timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

/// By how much a call exceeds its time limit: the smallest value of up to ten tries (the first call pays for
/// memory that later ones find; a pause of the host may count as time of the processor), divided by
/// kSlowness. `ample_ms` is far above the work of any call between two checks of its clock: a try below it is
/// the last.
template <typename Call>
double overrun_ms(double limit_ms, double ample_ms, const Call& call) {
    double min_ms = std::numeric_limits<double>::infinity();
    for (int attempt = 0; attempt < 10 && min_ms > ample_ms; ++attempt) {
        const double before_ms = processor_time_ms();
        call();
        min_ms = std::min(min_ms, (processor_time_ms() - before_ms - limit_ms) / kSlowness);
    }
    return min_ms;
}

}  // namespace conelane::tests
