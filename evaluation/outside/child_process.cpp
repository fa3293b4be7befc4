#include "evaluation/outside/child_process.hpp"

#include "model/deadline.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <ctime>
#include <system_error>
#include <thread>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace conelane {
namespace {

constexpr std::size_t kKeptErrors = 4096;
constexpr std::size_t kMaxWords = 200;

[[noreturn]] void fail(int error, const char* what) {
    throw std::system_error(error, std::generic_category(), what);
}

void close_if_open(int& descriptor) {
    if (descriptor >= 0) ::close(descriptor);
    descriptor = -1;
}

/// Programs that are started do not inherit the two ends.
struct Pipe {
    Pipe() {
        if (::pipe2(ends.data(), O_CLOEXEC) != 0) fail(errno, "no pipe");
    }
    ~Pipe() {
        close_if_open(ends[0]);
        close_if_open(ends[1]);
    }
    Pipe(const Pipe&) = delete;
    Pipe& operator=(const Pipe&) = delete;

    /// This program's end never blocks; the other end still does.
    int keep(std::size_t end) {
        const int kept = ends[end];
        ends[end] = -1;
        ::fcntl(kept, F_SETFL, ::fcntl(kept, F_GETFL) | O_NONBLOCK);
        return kept;
    }

    std::array<int, 2> ends{-1, -1};  ///< to read, to write
};

/// During its lifetime, writing to a pipe without a reader only fails with EPIPE. Signals of other threads
/// and the signal handling of the process stay unchanged.
class WithoutBrokenPipeSignal {
  public:
    WithoutBrokenPipeSignal() {
        sigemptyset(&broken_pipe_);
        sigaddset(&broken_pipe_, SIGPIPE);
        pthread_sigmask(SIG_BLOCK, &broken_pipe_, &before_);
    }
    ~WithoutBrokenPipeSignal() {
        if (sigismember(&before_, SIGPIPE) == 1) return;
        const timespec now{0, 0};
        while (sigtimedwait(&broken_pipe_, nullptr, &now) < 0 && errno == EINTR) {
        }
        pthread_sigmask(SIG_SETMASK, &before_, nullptr);
    }
    WithoutBrokenPipeSignal(const WithoutBrokenPipeSignal&) = delete;
    WithoutBrokenPipeSignal& operator=(const WithoutBrokenPipeSignal&) = delete;

  private:
    sigset_t broken_pipe_{};
    sigset_t before_{};
};

/// Starts the shell with these standard streams, in its own process group, with no signal blocked.
pid_t start_shell(const std::string& command, int input, int output, int errors) {
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, input, STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, output, STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, errors, STDERR_FILENO);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    sigset_t none;
    sigemptyset(&none);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setpgroup(&attributes, 0);
    posix_spawnattr_setflags(&attributes, static_cast<short>(POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETPGROUP));
    std::array<std::string, 3> words{"sh", "-c", command};
    const std::array<char*, 4> arguments{words[0].data(), words[1].data(), words[2].data(), nullptr};
    pid_t child = -1;
    const int failure = posix_spawn(&child, "/bin/sh", &actions, &attributes, arguments.data(), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    if (failure != 0) fail(failure, "no shell");
    return child;
}

/// Appends the available bytes; closes the descriptor at its end.
void read_available(int& descriptor, std::string& text, std::size_t at_most) {
    std::array<char, 1U << 16U> block;
    while (descriptor >= 0 && text.size() <= at_most) {
        const ssize_t count = ::read(descriptor, block.data(), block.size());
        if (count > 0) {
            text.append(block.data(), static_cast<std::size_t>(count));
        } else if (count < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) {
            return;
        } else if (count == 0 || errno != EINTR) {
            close_if_open(descriptor);
        }
    }
}

}  // namespace

ChildProcess::ChildProcess(const std::string& command) {
    Pipe to_child;
    Pipe from_child;
    Pipe errors_of_child;
    {
        const auto held = hold_interruption();
        pid_ = start_shell(command, to_child.ends[0], from_child.ends[1], errors_of_child.ends[1]);
        clearing_.emplace([group = pid_] { ::kill(-group, SIGKILL); });
    }
    input_ = to_child.keep(1);
    output_ = from_child.keep(0);
    errors_ = errors_of_child.keep(0);
}

ChildProcess::~ChildProcess() {
    end(0.0);
}

void ChildProcess::tell(std::string_view text) {
    pending_ += text;
    write_pending();
}

void ChildProcess::write_pending() {
    const WithoutBrokenPipeSignal guarded;
    while (input_ >= 0 && !pending_.empty()) {
        const ssize_t written = ::write(input_, pending_.data(), pending_.size());
        if (written >= 0) {
            pending_.erase(0, static_cast<std::size_t>(written));
        } else if (errno == EAGAIN || errno == EWOULDBLOCK) {
            return;
        } else if (errno != EINTR) {
            close_if_open(input_);
        }
    }
}

void ChildProcess::read_output() {
    read_available(output_, received_, kMaxLine);
}

void ChildProcess::read_errors() {
    // One block at a time, because a program may write without end.
    read_available(errors_, error_tail_, 2 * kKeptErrors);
    if (error_tail_.size() > kKeptErrors) error_tail_.erase(0, error_tail_.size() - kKeptErrors);
}

ChildProcess::Reply ChildProcess::ask(std::string_view text, double limit_ms) {
    const Deadline deadline(limit_ms);
    tell(text);
    std::size_t searched = 0;
    while (true) {
        const std::size_t newline = received_.find('\n', searched);
        if (newline != std::string::npos) {
            Reply reply{Outcome::line, received_.substr(0, newline)};
            received_.erase(0, newline + 1);
            return reply;
        }
        searched = received_.size();
        if (searched > kMaxLine) return {Outcome::too_long, {}};
        if (output_ < 0) return {Outcome::closed_output, {}};
        if (input_ < 0 && !pending_.empty()) return {Outcome::closed_input, {}};
        const double left_ms = deadline.remaining_ms();
        if (left_ms <= 0.0) return {Outcome::late, {}};
        // A negative descriptor is skipped.
        std::array<pollfd, 3> watched{pollfd{output_, POLLIN, 0}, pollfd{errors_, POLLIN, 0},
                                      pollfd{pending_.empty() ? -1 : input_, POLLOUT, 0}};
        if (::poll(watched.data(), watched.size(), static_cast<int>(std::ceil(std::min(left_ms, 1e6)))) < 0) {
            if (errno != EINTR) fail(errno, "poll");
            continue;
        }
        if (watched[1].revents != 0) read_errors();
        if (watched[2].revents != 0) write_pending();
        if (watched[0].revents != 0) read_output();
    }
}

bool ChildProcess::has_exited() const {
    siginfo_t ended{};
    return ::waitid(P_PID, static_cast<id_t>(pid_), &ended, WEXITED | WNOHANG | WNOWAIT) == 0 &&
           ended.si_pid == pid_;
}

std::string ChildProcess::reap() {
    // The system reuses the group's number only after the shell is reaped.
    const auto held = hold_interruption();
    const bool by_itself = has_exited();
    ::kill(-pid_, SIGKILL);
    int status = 0;
    rusage usage{};  // of the shell and of the processes that it has waited for
    while (::wait4(pid_, &status, 0, &usage) < 0 && errno == EINTR) {
    }
    constexpr std::size_t kKiB = 1024;
    peak_bytes_ = static_cast<std::size_t>(usage.ru_maxrss) * kKiB;
    pid_ = -1;
    clearing_.reset();
    if (!by_itself) return "";
    if (WIFSIGNALED(status)) return "signal " + std::to_string(WTERMSIG(status));
    return "exit code " + std::to_string(WEXITSTATUS(status));
}

std::string ChildProcess::end(double patience_ms) {
    if (pid_ < 0) return "";
    close_if_open(input_);
    const Deadline deadline(patience_ms);
    while (!has_exited() && !deadline.passed()) {
        read_errors();
        std::string last_output;  // read so that the program is not blocked
        read_available(output_, last_output, kMaxLine);
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    std::string how = reap();
    read_errors();
    close_if_open(output_);
    close_if_open(errors_);
    return how;
}

void ChildProcess::end_failed(Outcome outcome, std::string& fault) {
    constexpr double kPatience_ms = 100.0;
    const bool is_ending = outcome == Outcome::closed_output || outcome == Outcome::closed_input;
    const std::string how = end(is_ending ? kPatience_ms : 0.0);
    if (is_ending && !how.empty()) fault += ", " + how;
    if (const std::string words = last_words(); !words.empty()) fault += "; it said: " + words;
}

std::string ChildProcess::last_words() const {
    std::string words;
    std::size_t end = error_tail_.size();
    for (int lines = 0; lines < 2 && end > 0;) {
        const std::size_t begin = error_tail_.find_last_of('\n', end - 1) + 1;  // npos + 1 is 0
        const std::string line = error_tail_.substr(begin, std::min(end - begin, kMaxWords));
        end = begin > 0 ? begin - 1 : 0;
        if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
        if (!words.empty()) words.insert(0, " | ");
        words.insert(0, line);
        ++lines;
    }
    return words;
}

std::string fault_of(ChildProcess::Outcome outcome, double limit_ms) {
    using Outcome = ChildProcess::Outcome;
    if (outcome == Outcome::late) return fmt::format("no answer within {:.0f} ms", limit_ms);
    if (outcome == Outcome::too_long)
        return fmt::format("more than {} bytes without a newline", ChildProcess::kMaxLine);
    if (outcome == Outcome::closed_input) return "the program does not read its input";
    return outcome == Outcome::closed_output ? "the program ended" : "";
}

}  // namespace conelane
