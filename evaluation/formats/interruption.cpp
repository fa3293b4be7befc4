#include "evaluation/formats/interruption.hpp"

#include <array>
#include <csignal>
#include <string>
#include <thread>
#include <utility>

#include <pthread.h>
#include <unistd.h>

namespace conelane {
namespace {

struct Registry {
    std::recursive_mutex mutex;
    std::list<std::function<void()>> to_clear;
};

/// Never destroyed: the waiting thread may still use it at the end of the program.
Registry& registry() {
    static Registry& the_one = *new Registry;
    return the_one;
}

[[noreturn]] void end_by(int signal) {
    // Held to the end, so that nothing that was cleaned up can be created again.
    registry().mutex.lock();
    // Last one first, like destructors: a program that was started ends before its folder is removed.
    for (auto clear = registry().to_clear.rbegin(); clear != registry().to_clear.rend(); ++clear) (*clear)();
    // A progress bar may be in the line.
    const std::string line =
        std::string(isatty(STDERR_FILENO) == 1 ? "\r\033[K" : "") + "conelane: interrupted\n";
    [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, line.data(), line.size());
    std::signal(signal, SIG_DFL);
    ::kill(::getpid(), signal);
    sigset_t only;
    sigemptyset(&only);
    sigaddset(&only, signal);
    pthread_sigmask(SIG_UNBLOCK, &only, nullptr);
    ::_exit(128 + signal);  // not reached: the signal is delivered before
}

}  // namespace

ClearOnInterruption::ClearOnInterruption(std::function<void()> clear) {
    const auto held = hold_interruption();
    entry_ = registry().to_clear.insert(registry().to_clear.end(), std::move(clear));
}

ClearOnInterruption::~ClearOnInterruption() {
    const auto held = hold_interruption();
    registry().to_clear.erase(entry_);
}

std::unique_lock<std::recursive_mutex> hold_interruption() {
    return std::unique_lock(registry().mutex);
}

void end_cleanly_on_signals() {
    sigset_t signals;
    sigemptyset(&signals);
    bool any = false;
    for (const int signal : std::array{SIGINT, SIGTERM, SIGHUP}) {
        struct sigaction before {};
        if (sigaction(signal, nullptr, &before) == 0 && before.sa_handler == SIG_IGN) continue;
        sigaddset(&signals, signal);
        any = true;
    }
    if (!any) return;
    (void)registry();
    pthread_sigmask(SIG_BLOCK, &signals, nullptr);
    std::thread([signals] {
        int signal = 0;
        while (sigwait(&signals, &signal) != 0) {
        }
        end_by(signal);
    }).detach();
}

}  // namespace conelane
