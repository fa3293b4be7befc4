#pragma once

#include "experiments/files/output_stream.hpp"
#include "experiments/tuning/evaluation.hpp"
#include "experiments/tuning/tuner.hpp"

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace conelane::experiments {

/// Every evaluation on file as soon as it is made, a line each behind a first line with all that the figures
/// depend on. What the file holds is not evaluated again: a tuning that was stopped goes on, and one that
/// asks for more evaluations starts where the last ended.
class EvaluationLog {
  public:
    /// `header`: a JSON object. An empty path keeps the memory but no file. An unfinished last line is
    /// dropped. Throws InputError where the file holds another header or is none of this kind.
    EvaluationLog(std::filesystem::path file, const std::string& header, Evaluate evaluate);

    /// From memory, or evaluated and written through. Throws InputError where the disk is full.
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
