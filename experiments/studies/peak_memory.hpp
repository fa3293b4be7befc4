#pragma once

#include <cstddef>
#include <optional>

namespace conelane::experiments {

/// How far the resident memory of this process rises above what it is at the making, by the operating system
/// (VmHWM, after clear_refs). What was freed before and not given back does not show, so it is given back
/// first where the C library can.
class PeakMemory {
  public:
    PeakMemory();
    /// In bytes; absent where the system does not tell.
    [[nodiscard]] std::optional<std::size_t> rise_bytes() const;

  private:
    std::optional<std::size_t> before_bytes_;
};

}  // namespace conelane::experiments
