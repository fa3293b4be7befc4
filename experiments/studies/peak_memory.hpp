#pragma once

#include <cstddef>
#include <optional>

namespace conelane::experiments {

/// Growth of this process's resident memory since construction, by the operating system (VmHWM, after
/// clear_refs). Freed memory that was not returned would hide growth, so it is returned first if the C
/// library can do so.
class PeakMemory {
  public:
    PeakMemory();
    /// In bytes; absent if the system does not report it.
    [[nodiscard]] std::optional<std::size_t> rise_bytes() const;

  private:
    std::optional<std::size_t> before_bytes_;
};

}  // namespace conelane::experiments
