#pragma once

#include <memory>

namespace conelane::experiments {

/// Keeps the calling thread on the processor that it is on, until destroyed. Where the system does not allow
/// that, the thread stays free.
class PinnedThread {
  public:
    PinnedThread();
    ~PinnedThread();
    PinnedThread(const PinnedThread&) = delete;
    PinnedThread& operator=(const PinnedThread&) = delete;

  private:
    struct Mask;
    std::unique_ptr<Mask> before_;  ///< absent where the thread stayed free
};

}  // namespace conelane::experiments
