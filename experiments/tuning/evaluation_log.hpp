#pragma once

#include "evaluation/formats/atomic_file.hpp"
#include "experiments/tuning/evaluation.hpp"
#include "experiments/tuning/tuner.hpp"

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace conelane::experiments {

/// Stores every evaluation in a file at once, a line each, after a first line with everything that the
/// figures depend on. Stored points are not evaluated again: a tuning that was stopped resumes, and one with
/// more evaluations starts where the last one ended.
class EvaluationLog {
  public:
    /// `header`: a JSON object. With an empty path, evaluations are kept in memory only. An unfinished last
    /// line is dropped. Throws InputError if the file has another header or format.
    EvaluationLog(std::filesystem::path file, const std::string& header, Evaluate evaluate);

    /// From memory, or evaluated and stored. Throws InputError if the disk is full.
    [[nodiscard]] std::vector<LapFigure> operator()(const RldParameters& parameters);

    [[nodiscard]] std::size_t evaluations() const { return figures_.size(); }

  private:
    using Key = std::vector<double>;  ///< the numeric parameters in the order of the file format

    void read();

    std::filesystem::path file_;
    Evaluate evaluate_;
    std::map<Key, std::vector<LapFigure>> figures_;
    OutputStream stream_;
};

}  // namespace conelane::experiments
