#pragma once

#include <functional>
#include <list>
#include <mutex>

namespace conelane {

/// Cleans up if a signal ends the program, from its construction to its destruction. `clear` runs in another
/// thread, never while `hold_interruption` is held.
class ClearOnInterruption {
  public:
    explicit ClearOnInterruption(std::function<void()> clear);
    ~ClearOnInterruption();
    ClearOnInterruption(const ClearOnInterruption&) = delete;
    ClearOnInterruption& operator=(const ClearOnInterruption&) = delete;

  private:
    std::list<std::function<void()>>::iterator entry_;
};

/// While it is held, no signal ends the program: for making and registering a temporary file in one step.
[[nodiscard]] std::unique_lock<std::recursive_mutex> hold_interruption();

/// From here on SIGINT, SIGTERM and SIGHUP run the registered cleanup, print one line on stderr and end the
/// program by that signal; signals that the program was started to ignore stay ignored. Call it once, before
/// any other thread starts: the signals are blocked in all threads and one thread waits for them, so no
/// handler of a library sees them. Programs started later inherit the blocked signals.
void end_cleanly_on_signals();

}  // namespace conelane
