#pragma once

#include <memory>

namespace conelane::experiments {

/// Keeps the calling thread on its current processor until destroyed. If the system does not allow this, the
/// thread is not pinned.
class PinnedThread {
  public:
    PinnedThread();
    ~PinnedThread();
    PinnedThread(const PinnedThread&) = delete;
    PinnedThread& operator=(const PinnedThread&) = delete;

  private:
    struct Mask;
    std::unique_ptr<Mask> before_;  ///< absent if the thread is not pinned
};

}  // namespace conelane::experiments
