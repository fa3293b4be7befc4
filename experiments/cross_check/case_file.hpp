#pragma once

#include "experiments/cross_check/drawn_case.hpp"

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace conelane::experiments {

/// A stored case, to be judged again.
struct StoredCase {
    CrossCheckCase drawn;
    std::vector<std::string> solvers;
    double time_limit_ms = 0.0;  ///< the generous limit
};

/// Writes NAME.scenes.jsonl, NAME.params.json and, if the scene has an edge, NAME.mps, the program in the
/// case's formulation; finally NAME.case.json, which names them and holds the rest and the findings. NAME is
/// the scene's id. Returns its path. Each file appears complete or not at all. Throws InputError.
std::filesystem::path write_case(const std::filesystem::path& directory, const StoredCase& stored,
                                 std::span<const std::string> findings);

/// Reads a NAME.case.json and the files beside it. Throws InputError naming file, line and key.
[[nodiscard]] StoredCase read_case(const std::filesystem::path& file);

}  // namespace conelane::experiments
