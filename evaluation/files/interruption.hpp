#pragma once

#include <functional>
#include <list>
#include <mutex>

namespace conelane {

/// Something to clear away should a signal end the program, from its making to its destruction. `clear` runs
/// in another thread while `hold_interruption` is held there.
class ClearOnInterruption {
  public:
    explicit ClearOnInterruption(std::function<void()> clear);
    ~ClearOnInterruption();
    ClearOnInterruption(const ClearOnInterruption&) = delete;
    ClearOnInterruption& operator=(const ClearOnInterruption&) = delete;

  private:
    std::list<std::function<void()>>::iterator entry_;
};

/// While it is held, no signal ends the program: for making a temporary file and saying so in one step.
[[nodiscard]] std::unique_lock<std::recursive_mutex> hold_interruption();

/// From here on SIGINT, SIGTERM and SIGHUP clear away what was registered, print one line on stderr and end
/// the program by that signal; those that the program was started to ignore are left ignored. Call it once,
/// before any other thread starts: the signals are blocked in all threads and waited for in one of its own,
/// so that no handler of a library sees them. Programs that are started meanwhile are started with them
/// blocked.
void end_cleanly_on_signals();

}  // namespace conelane
