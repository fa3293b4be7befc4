#include "solvers/milp/detail/own_process.hpp"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <exception>
#include <new>
#include <system_error>

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace conelane::detail {
namespace {

constexpr std::uint64_t kWhole = 0x636f6e656c616e65;

/// The end of an answer; before it point and message, before these what the library printed.
struct Trailer {
    SolveStatus status = SolveStatus::error;
    std::optional<StopReason> stopped_by;
    std::optional<double> bound;
    std::int64_t nodes = 0;
    std::size_t point_bytes = 0;
    std::size_t message_bytes = 0;
    bool out_of_memory = false;
    std::uint64_t mark = kWhole;
};

void write_all(int file, std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
        const ssize_t written = ::write(file, bytes.data(), bytes.size());
        if (written < 0 && errno != EINTR) return;
        if (written > 0) bytes = bytes.subspan(static_cast<std::size_t>(written));
    }
}

/// Allocates nothing, memory may be what is missing.
void answer(int file, const MilpReport& report, bool out_of_memory) {
    const auto point = std::as_bytes(std::span(report.point));
    const auto message = std::as_bytes(std::span(report.message));
    const Trailer trailer{.status = report.status,
                          .stopped_by = report.stopped_by,
                          .bound = report.bound,
                          .nodes = report.nodes,
                          .point_bytes = point.size(),
                          .message_bytes = message.size(),
                          .out_of_memory = out_of_memory};
    write_all(file, point);
    write_all(file, message);
    write_all(file, std::as_bytes(std::span(&trailer, 1)));
}

[[noreturn]] void run_copy(int file, const std::function<MilpReport()>& work) {
    // What a terminal sends to both is for the caller alone; with the caller, the copy ends.
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, SIG_IGN);
    for (const int signal : {SIGABRT, SIGSEGV}) std::signal(signal, SIG_DFL);
    ::dup2(file, STDERR_FILENO);
    MilpReport report;
    try {
        report = work();
        answer(file, report, false);
    } catch (const std::bad_alloc&) {
        answer(file, {}, true);
    } catch (const std::exception& failure) {
        report.message = failure.what();
        answer(file, report, false);
    }
    ::_exit(0);
}

std::string read_all(int file) {
    std::string text;
    std::array<char, 4096> part{};
    while (true) {
        const ssize_t count = ::read(file, part.data(), part.size());
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) return text;
        text.append(part.data(), static_cast<std::size_t>(count));
    }
}

MilpReport report_in(std::string text, int status) {
    MilpReport report;
    Trailer trailer;
    const std::size_t end = text.size() - std::min(text.size(), sizeof trailer);
    if (text.size() >= sizeof trailer) std::memcpy(&trailer, text.data() + end, sizeof trailer);
    if (text.size() < sizeof trailer || trailer.mark != kWhole) {
        while (text.ends_with('\n')) text.pop_back();
        const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
        report.message = "the library ended its process by signal " + std::to_string(signal) +
                         (text.empty() ? "" : ": " + text.substr(text.rfind('\n') + 1));
        return report;
    }
    if (trailer.out_of_memory) throw std::bad_alloc();
    report.status = trailer.status;
    report.stopped_by = trailer.stopped_by;
    report.bound = trailer.bound;
    report.nodes = trailer.nodes;
    report.message = text.substr(end - trailer.message_bytes, trailer.message_bytes);
    report.point.resize(trailer.point_bytes / sizeof(double));
    if (!report.point.empty()) {
        std::memcpy(report.point.data(), text.data() + end - trailer.message_bytes - trailer.point_bytes,
                    trailer.point_bytes);
    }
    return report;
}

}  // namespace

MilpReport in_own_process(const std::function<MilpReport()>& work) {
    std::array<int, 2> pipe{};
    if (::pipe2(pipe.data(), O_CLOEXEC) != 0) throw std::system_error(errno, std::generic_category(), "pipe");
    const pid_t copy = ::fork();
    if (copy == 0) run_copy(pipe[1], work);
    const int error = errno;
    ::close(pipe[1]);
    const std::string text = copy < 0 ? std::string() : read_all(pipe[0]);
    ::close(pipe[0]);
    if (copy < 0) throw std::system_error(error, std::generic_category(), "fork");
    int status = 0;
    while (::waitpid(copy, &status, 0) < 0 && errno == EINTR) {
    }
    return report_in(text, status);
}

}  // namespace conelane::detail
