#pragma once

#include <filesystem>
#include <utility>

namespace conelane {

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
