#pragma once

#include "evaluation/formats/atomic_file.hpp"
#include "evaluation/formats/lane_file.hpp"

#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

namespace conelane::experiments {

/// A lanes file that grows while a detector runs. Until it is complete its name is FILE.part; a stopped run
/// finds its answers there.
class LaneLog {
  public:
    /// Opens FILE.part, and drops an unfinished last line. Throws InputError.
    explicit LaneLog(const std::filesystem::path& file);

    /// Whole lines of an earlier run.
    [[nodiscard]] std::size_t stored() const { return stored_; }
    /// Keeps the first `count` of them. Precondition: count <= stored(), nothing appended yet.
    void keep(std::size_t count);

    /// The line is on the disk when this returns. Throws InputError if the disk is full.
    void append(std::span<const LaneRecord> records);

    /// Gives the file its name. Throws InputError.
    void finish();

  private:
    std::filesystem::path file_;
    std::filesystem::path part_;
    std::size_t stored_ = 0;
    OutputStream stream_;
};

}  // namespace conelane::experiments
