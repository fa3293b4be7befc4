#pragma once

#include <filesystem>
#include <utility>

namespace conelane {

/// The only one that writes into a folder, until destroyed or until the process ends, however it ends. The
/// empty file `.lock` that carries the lock stays there: removing it would let two hold a lock of that name.
class FolderLock {
  public:
    /// Throws InputError naming the folder where another process, or another lock of this one, has it.
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
