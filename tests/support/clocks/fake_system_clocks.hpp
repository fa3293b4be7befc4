#pragma once

#include <cstdint>
#include <ctime>
#include <vector>

#include <sys/syscall.h>
#include <sys/time.h>
#include <unistd.h>

// Fakes the clocks of the whole program, of the C library and of every library that it links: a test program
// includes this once. The monotonic clock is real, but can be ahead by a requested time, as if the processor
// had been away, or advance by the same step at each reading; the time of day jumps by an hour, forth and
// back, at each reading.

namespace conelane::tests {

struct ClockLooks {
    std::int64_t monotonic = 0;
    std::int64_t time_of_day = 0;
    /// Gets the processor time of this thread between each two readings of the monotonic clock.
    std::vector<double>* gaps_ms = nullptr;
    double last_look_ms = 0.0;
    std::int64_t away_at = 0;  ///< the reading of the monotonic clock from which it is ahead; 0: none
    std::int64_t away_s = 0;   ///< by how much
    std::int64_t step_ns = 0;  ///< of the monotonic clock at each reading; 0: it is real
};
inline thread_local ClockLooks clock_looks;

inline timespec true_time(clockid_t clock) {
    timespec time{};
    syscall(SYS_clock_gettime, clock, &time);
    return time;
}
inline double thread_cpu_ms() {
    const timespec time = true_time(CLOCK_THREAD_CPUTIME_ID);
    return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}
/// A reading of the clock, and the end of a call.
inline void note_look() {
    const double now_ms = thread_cpu_ms();
    if (clock_looks.gaps_ms != nullptr) clock_looks.gaps_ms->push_back(now_ms - clock_looks.last_look_ms);
    clock_looks.last_look_ms = thread_cpu_ms();
}
inline void forget_looks() {
    clock_looks = {};
    clock_looks.last_look_ms = thread_cpu_ms();
}

}  // namespace conelane::tests

extern "C" int clock_gettime(clockid_t clock, timespec* time) noexcept {
    using conelane::tests::clock_looks;
    *time = conelane::tests::true_time(clock);
    if (clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE) {
        ++clock_looks.time_of_day;
        time->tv_sec += clock_looks.time_of_day % 2 == 0 ? 3600 : -3600;
    } else if (clock == CLOCK_MONOTONIC) {
        ++clock_looks.monotonic;
        if (clock_looks.away_at > 0 && clock_looks.monotonic >= clock_looks.away_at)
            time->tv_sec += clock_looks.away_s;
        if (const std::int64_t now_ns = clock_looks.monotonic * clock_looks.step_ns; now_ns > 0)
            *time = {now_ns / 1'000'000'000, now_ns % 1'000'000'000};
        conelane::tests::note_look();
    }
    return 0;
}

extern "C" int gettimeofday(timeval* time, void* /*zone*/) noexcept {
    timespec now{};
    clock_gettime(CLOCK_REALTIME, &now);
    *time = {now.tv_sec, now.tv_nsec / 1000};
    return 0;
}

extern "C" time_t time(time_t* seconds) noexcept {
    timespec now{};
    clock_gettime(CLOCK_REALTIME, &now);
    if (seconds != nullptr) *seconds = now.tv_sec;
    return now.tv_sec;
}
