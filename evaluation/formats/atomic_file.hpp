#pragma once

#include <filesystem>
#include <fstream>
#include <functional>
#include <list>
#include <mutex>
#include <optional>
#include <ostream>
#include <span>
#include <utility>

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

/// Like std::ofstream, but keeps the reason of a failed write.
class OutputStream : public std::ostream {
  public:
    OutputStream() : std::ostream(nullptr) { rdbuf(&buffer_); }

    /// Fails like std::ofstream::open, with errno set.
    void open(const std::filesystem::path& file, std::ios::openmode mode);
    [[nodiscard]] bool is_open() const { return buffer_.is_open(); }
    void close();
    /// Throws InputError naming `file` if a write, a flush or the closing failed, with the system's reason.
    void require_written(const std::filesystem::path& file) const;

  private:
    class Buffer : public std::filebuf {
      public:
        [[nodiscard]] int reason() const { return reason_; }
        /// Runs a write, and keeps errno if it is the first failure.
        template <typename Write, typename Succeeded>
        auto watched(const Write& write, const Succeeded& succeeded);

      protected:
        int_type overflow(int_type character) override;
        std::streamsize xsputn(const char* text, std::streamsize count) override;
        int sync() override;

      private:
        int reason_ = 0;  ///< errno of the first failure; 0 without a failure
    };
    Buffer buffer_;
};

/// A file that appears under its name complete or not at all: it is written under a temporary name in the
/// same folder and renamed by `commit`. If it is destroyed without `commit`, or a signal ends the program,
/// the target stays unchanged. A target that is not a regular file, such as a pipe or /dev/stdout, is written
/// directly.
class AtomicFile {
  public:
    /// Throws InputError naming the target if it cannot be written.
    explicit AtomicFile(const std::filesystem::path& target);
    ~AtomicFile();
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    [[nodiscard]] std::ostream& stream() { return stream_; }

    /// Closes the file, which is then complete under its temporary name. Throws InputError naming the target
    /// if it could not be written completely, for example on a full disk.
    void finish();
    /// Finishes the file and gives it its name. Throws InputError naming the target if that fails.
    void commit();
    /// Finishes all files, and then gives them their names, in their order. Signals are held back meanwhile.
    /// If one rename fails, the earlier targets get their old content back.
    friend void commit_together(std::span<AtomicFile* const> files);

  private:
    std::filesystem::path target_;     ///< as the caller spelled it, for messages
    std::filesystem::path place_;      ///< where the file goes: the target with symbolic links followed
    std::filesystem::path temporary_;  ///< empty if the target is written directly or is complete
    std::optional<ClearOnInterruption> clearing_;  ///< of the temporary file
    bool is_open_ = true;
    OutputStream stream_;
};

void commit_together(std::span<AtomicFile* const> files);

/// Removes temporary files that a killed program left in a folder. Precondition: no other program writes
/// there.
void remove_abandoned_files(const std::filesystem::path& folder);

/// Throws InputError as writing the target would, without changing it. Pipes and devices are not opened:
/// opening one may end its reader.
void require_writable(const std::filesystem::path& target);

/// Exclusive right to write into a folder, until destroyed or until the process ends in any way. The empty
/// file `.lock` carries the lock and stays there: removing it would let two processes hold a lock of that
/// name.
class FolderLock {
  public:
    /// Throws InputError naming the folder if another process, or another lock of this process, has it.
    explicit FolderLock(const std::filesystem::path& folder);
    ~FolderLock();
    FolderLock(FolderLock&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
    FolderLock(const FolderLock&) = delete;
    FolderLock& operator=(const FolderLock&) = delete;
    FolderLock& operator=(FolderLock&&) = delete;

  private:
    int descriptor_;
};

}  // namespace conelane
