#pragma once

#include "conelane/stop_reason.hpp"
#include "model/deadline.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>

namespace conelane {

/// The limits of a search and what it has used; its parts use one budget, one after the other.
struct SearchBudget {
    std::int64_t iteration_limit = 2500;  ///< it_max of Algorithm 2
    Deadline deadline;                    ///< none by default
    std::size_t memory_limit_bytes = std::size_t{1}
                                     << 29U;  ///< approximate limit of memory that grows with the search

    std::int64_t iterations = 0;
    std::optional<StopReason> stopped_by;  ///< time or memory

    /// Adds work, in units of about 10 ns, and reads the clock once in a while. Returns whether to stop.
    bool spend(std::size_t work) {
        work_since_reading_ += work;
        if (work_since_reading_ >= kWorkPerReading) read_clock();
        return stopped_by.has_value();
    }
    /// Reads the clock now.
    bool read_clock() {
        work_since_reading_ = 0;
        if (!stopped_by && deadline.passed()) stopped_by = StopReason::time;
        return stopped_by.has_value();
    }
    /// `bytes`: all that the part holds. Returns whether to stop.
    bool occupy(std::size_t bytes) {
        if (!stopped_by && bytes > memory_limit_bytes) stopped_by = StopReason::memory;
        return stopped_by.has_value();
    }
    [[nodiscard]] bool spent() const { return iterations >= iteration_limit || stopped_by; }

  private:
    static constexpr std::size_t kWorkPerReading = 2000;
    std::size_t work_since_reading_ = 0;
};

}  // namespace conelane
