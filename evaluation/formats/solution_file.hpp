#pragma once

#include "conelane/scene.hpp"
#include "conelane/stop_reason.hpp"
#include "evaluation/formats/parameter_tag.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace conelane {

/// A line of a `*.solutions.jsonl` file: a solver's claim about a scene. The checker decides whether the
/// edges are a lane graph.
struct SolutionRecord {
    std::string scene;
    std::string solver;
    std::string formulation;
    std::string status;   ///< optimal, feasible, infeasible, stopped or error
    std::string message;  ///< why it has this status; always there with error
    std::vector<std::pair<ConeId, ConeId>> edges;
    std::optional<double> objective;
    std::optional<double> bound;
    std::optional<std::int64_t> nodes;
    double build_ms = 0.0;
    double solve_ms = 0.0;
    std::optional<StopReason> stopped_by;  ///< the limit that ended the search, if one did
    std::optional<std::size_t> nearest;    ///< size of the cone set that was solved; absent: all cones
    ParameterTag parameters = {};          ///< parameters of the objective
    std::size_t line = 0;                  ///< line in the file that was read; 0 without a file
};

/// Records in the order of the file, which may be empty. Throws InputError naming file, line and key for
/// invalid JSON, for edges with a status other than optimal and feasible, and for a second answer of a solver
/// to a scene with the same formulation.
[[nodiscard]] std::vector<SolutionRecord> read_solutions(const std::filesystem::path& file);

/// A bound of minus infinity (nothing proven) is left out. Throws InvalidInput if another number is not
/// finite, InputError if the file cannot be written; an old file then stays unchanged.
void write_solutions(const std::filesystem::path& file, std::span<const SolutionRecord> records);

}  // namespace conelane
