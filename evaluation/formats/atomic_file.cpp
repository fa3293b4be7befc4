#include "evaluation/formats/atomic_file.hpp"

#include "evaluation/input_error.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <ranges>
#include <string_view>
#include <system_error>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <pthread.h>
#include <sys/file.h>
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
    for (const auto& clear : registry().to_clear | std::views::reverse) clear();
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

namespace fs = std::filesystem;

/// Prefix of temporary names; the number of the process and of the attempt follow.
const std::string kTemporary = ".tmp";

/// Open descriptors of the process: renaming over a file to which a shell has redirected them would take the
/// file away from the other writers.
bool is_open_descriptor(const fs::path& target) {
    const std::string path = target.lexically_normal().string();
    constexpr std::array<std::string_view, 2> kNames{"/dev/stdout", "/dev/stderr"};
    constexpr std::array<std::string_view, 2> kFolders{"/dev/fd/", "/proc/self/fd/"};
    return std::ranges::find(kNames, path) != kNames.end() ||
           std::ranges::any_of(kFolders, [&](std::string_view folder) { return path.starts_with(folder); });
}

[[noreturn]] void fail(const fs::path& target, int error) {
    std::string message = "cannot be written: " + std::generic_category().message(error);
    if (error == ENOENT && target.has_parent_path())
        message += "; make the folder '" + target.parent_path().string() + "' first";
    throw InputError(target, 0, "", message);
}

/// A name beside `place` that no other process uses.
fs::path temporary_name(const fs::path& place, int attempt) {
    fs::path name = place;
    name += kTemporary + std::to_string(::getpid()) + "_" + std::to_string(attempt);
    return name;
}

/// Creates an empty file beside `place` under a name that no other file has.
fs::path create_temporary(const fs::path& place, const fs::path& target) {
    for (int attempt = 0;; ++attempt) {
        fs::path name = temporary_name(place, attempt);
        const int descriptor = ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (descriptor >= 0) {
            ::close(descriptor);
            return name;
        }
        if (errno != EEXIST) fail(target, errno);
    }
}

/// Keeps the file at `place` under a second name; no name if there is no file, or if the file system has no
/// hard links.
fs::path kept_aside(const fs::path& place) {
    for (int attempt = 0;; ++attempt) {
        fs::path name = temporary_name(place, attempt);
        if (::link(place.c_str(), name.c_str()) == 0) return name;
        if (errno != EEXIST) return {};
    }
}

/// A file that already has its name, and what it replaced.
struct Renamed {
    fs::path place;
    fs::path aside;
    bool is_new;
};

void undo(const Renamed& renamed) {
    std::error_code ignored;
    if (!renamed.aside.empty()) {
        fs::rename(renamed.aside, renamed.place, ignored);
    } else if (renamed.is_new) {
        fs::remove(renamed.place, ignored);
    }
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

void remove_abandoned_files(const fs::path& folder) {
    std::vector<fs::path> abandoned;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
        const std::string name = entry.path().filename().string();
        const std::size_t end = name.rfind(kTemporary);
        if (end == std::string::npos || !entry.is_regular_file()) continue;
        const std::string_view numbers = std::string_view(name).substr(end + kTemporary.size());
        if (numbers.find('_') != std::string_view::npos &&
            numbers.find_first_not_of("0123456789_") == std::string_view::npos) {
            abandoned.push_back(entry.path());
        }
    }
    for (const fs::path& file : abandoned) fs::remove(file);
}

AtomicFile::AtomicFile(const fs::path& target) : target_(target), place_(target) {
    std::error_code error;
    const fs::file_status status = fs::status(target, error);
    if (fs::is_directory(status)) throw InputError(target, 0, "", "is a folder, not a file");
    if (is_open_descriptor(target) || (fs::exists(status) && !fs::is_regular_file(status))) {
        errno = 0;
        stream_.open(target, std::ios::binary | std::ios::app);
        if (!stream_) fail(target, errno);
        return;
    }
    if (target.filename().empty()) fail(target, EISDIR);
    if (fs::exists(status)) place_ = fs::canonical(target);
    {
        // Opened before it may be cleared: opening a file that is gone would create it again.
        const auto held = hold_interruption();
        temporary_ = create_temporary(place_, target);
        clearing_.emplace([name = temporary_] { ::unlink(name.c_str()); });
        if (fs::exists(status)) fs::permissions(temporary_, status.permissions(), error);
        stream_.open(temporary_, std::ios::binary | std::ios::trunc);
    }
    if (!stream_) {
        const int reason = errno;
        fs::remove(temporary_, error);
        fail(target, reason);
    }
}

AtomicFile::~AtomicFile() {
    if (temporary_.empty()) return;
    stream_.close();
    std::error_code ignored;
    fs::remove(temporary_, ignored);
}

void AtomicFile::finish() {
    if (is_open_) stream_.close();
    is_open_ = false;
    stream_.require_written(target_);
}

void AtomicFile::commit() {
    AtomicFile* const only = this;
    commit_together({&only, 1});
}

void commit_together(std::span<AtomicFile* const> files) {
    for (AtomicFile* file : files) file->finish();
    const auto held = hold_interruption();
    std::vector<Renamed> done;
    std::error_code ignored;
    for (AtomicFile* file : files) {
        if (file->temporary_.empty()) continue;
        const bool is_new = !fs::exists(fs::symlink_status(file->place_, ignored));
        done.push_back(
            {file->place_, is_new || files.size() == 1 ? fs::path{} : kept_aside(file->place_), is_new});
        std::error_code error;
        fs::rename(file->temporary_, file->place_, error);
        if (!error) continue;
        if (!done.back().aside.empty()) fs::remove(done.back().aside, ignored);
        done.pop_back();
        for (const Renamed& renamed : done | std::views::reverse) undo(renamed);
        fail(file->target_, error.value());
    }
    for (const Renamed& renamed : done) {
        if (!renamed.aside.empty()) fs::remove(renamed.aside, ignored);
    }
    for (AtomicFile* file : files) {
        file->temporary_.clear();
        file->clearing_.reset();
    }
}

void require_writable(const fs::path& target) {
    std::error_code ignored;
    const fs::file_status status = fs::status(target, ignored);
    if (fs::is_other(status)) return;
    const AtomicFile probe(target);
}

template <typename Write, typename Succeeded>
auto OutputStream::Buffer::watched(const Write& write, const Succeeded& succeeded) {
    errno = 0;
    const auto result = write();
    if (!succeeded(result) && reason_ == 0) reason_ = errno;
    return result;
}

std::filebuf::int_type OutputStream::Buffer::overflow(int_type character) {
    return watched([&] { return std::filebuf::overflow(character); },
                   [](int_type written) { return written != traits_type::eof(); });
}

std::streamsize OutputStream::Buffer::xsputn(const char* text, std::streamsize count) {
    return watched([&] { return std::filebuf::xsputn(text, count); },
                   [&](std::streamsize written) { return written == count; });
}

int OutputStream::Buffer::sync() {
    return watched([&] { return std::filebuf::sync(); }, [](int result) { return result == 0; });
}

void OutputStream::open(const std::filesystem::path& file, std::ios::openmode mode) {
    errno = 0;
    if (buffer_.open(file, mode | std::ios::out) == nullptr) {
        setstate(std::ios::failbit);
    } else {
        clear();
    }
}

void OutputStream::close() {
    const bool is_closed =
        buffer_.watched([&] { return buffer_.close() != nullptr; }, [](bool closed) { return closed; });
    if (!is_closed) setstate(std::ios::failbit);
}

void OutputStream::require_written(const std::filesystem::path& file) const {
    // `stream << other.rdbuf()` does not report a failed write of its target.
    if (good() && buffer_.reason() == 0) return;
    std::string message = "cannot be written to its end";
    if (buffer_.reason() != 0) message += ": " + std::generic_category().message(buffer_.reason());
    throw InputError(file, 0, "", message);
}

FolderLock::FolderLock(const std::filesystem::path& folder)
    : descriptor_(::open((folder / ".lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666)) {
    if (descriptor_ < 0) {
        throw InputError(folder, 0, "", "cannot be written: " + std::generic_category().message(errno));
    }
    while (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
        if (errno == EINTR) continue;
        const int reason = errno;
        ::close(descriptor_);
        throw InputError(folder, 0, "",
                         reason == EWOULDBLOCK
                             ? "another conelane is writing there"
                             : "cannot be locked: " + std::generic_category().message(reason));
    }
}

FolderLock::~FolderLock() {
    if (descriptor_ >= 0) ::close(descriptor_);
}

}  // namespace conelane
