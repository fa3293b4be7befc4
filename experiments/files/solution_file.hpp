#pragma once

#include "conelane/scene.hpp"
#include "conelane/stop_reason.hpp"
#include "experiments/files/parameter_tag.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace conelane::experiments {

/// A line of a `*.solutions.jsonl` file: the lane graph that an RLD solver answered on a scene. It is what
/// was claimed; whether the edges are a lane graph is for the checker to say.
struct SolutionRecord {
    std::string scene;
    std::string solver;
    std::string formulation;
    std::string status;   ///< optimal, feasible, infeasible, stopped or error
    std::string message;  ///< where status is error
    std::vector<std::pair<ConeId, ConeId>> edges;
    std::optional<double> objective;
    std::optional<double> bound;
    std::optional<std::int64_t> nodes;
    double build_ms = 0.0;
    double solve_ms = 0.0;
    std::optional<StopReason> stopped_by;  ///< the limit that ended the search, where one did
    std::optional<std::size_t> nearest;    ///< size of the cone set that was solved; absent: all cones
    ParameterTag parameters = {};          ///< that were minimised by
    std::size_t line = 0;                  ///< in the file that was read; 0: none was
};

/// Records in the order of the file, which may hold none. Throws InputError naming file, line and key: beside
/// what is no such JSON, where a status other than optimal and feasible comes with edges or a solver answers
/// a scene twice with the same formulation.
[[nodiscard]] std::vector<SolutionRecord> read_solutions(const std::filesystem::path& file);

/// A bound of minus infinity (nothing proven) is left out. Throws InvalidInput where another number is not
/// finite, InputError where the file cannot be written; then an old file stays as it was.
void write_solutions(const std::filesystem::path& file, std::span<const SolutionRecord> records);

}  // namespace conelane::experiments
