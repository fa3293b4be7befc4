#pragma once

#include "experiments/files/interruption.hpp"
#include "experiments/files/output_stream.hpp"

#include <filesystem>
#include <optional>
#include <ostream>
#include <span>

namespace conelane::experiments {

/// A file that appears under its name whole or not at all: it is written under a temporary name in the same
/// folder and renamed by `commit`. Destroyed without `commit`, or where a signal ends the program, it leaves
/// the target as it was. A target that is no regular file, such as a pipe or /dev/stdout, is written
/// directly.
class AtomicFile {
  public:
    /// Throws InputError naming the target where it cannot be written.
    explicit AtomicFile(const std::filesystem::path& target);
    ~AtomicFile();
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    [[nodiscard]] std::ostream& stream() { return stream_; }

    /// Closes the file, which is then whole under its temporary name. Throws InputError naming the target
    /// where it could not be written to its end, be it that the disk is full.
    void finish();
    /// Finishes the file and gives it its name. Throws InputError naming the target where that fails.
    void commit();
    /// Finishes all files, and only then gives them their names, in their order. No signal comes in between.
    /// Where one cannot have its name, those before it get back what was there.
    friend void commit_together(std::span<AtomicFile* const> files);

  private:
    std::filesystem::path target_;     ///< as the caller spelled it, for messages
    std::filesystem::path place_;      ///< where the file goes: the target with symbolic links followed
    std::filesystem::path temporary_;  ///< empty where the target is written directly or is in place
    std::optional<ClearOnInterruption> clearing_;  ///< of the temporary file
    bool is_open_ = true;
    OutputStream stream_;
};

void commit_together(std::span<AtomicFile* const> files);

/// Removes what a program that was killed left in a folder under temporary names. Precondition: no other
/// program writes there.
void remove_abandoned_files(const std::filesystem::path& folder);

/// Throws InputError as writing the target would, and leaves it as it was. Pipes and devices are left alone:
/// opening one may end what reads it.
void require_writable(const std::filesystem::path& target);

}  // namespace conelane::experiments
