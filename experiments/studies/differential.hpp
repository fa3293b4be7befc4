#pragma once

#include "conelane/rld_parameters.hpp"
#include "conelane/solve_report.hpp"
#include "evaluation/scenes/annotated_scene.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace conelane::experiments {

class Study;

/// Whether path-pair and another exact solver contradict each other on drawn cases.
[[nodiscard]] std::unique_ptr<Study> make_differential_study();

/// A scene's nearest cones under a pairing and a set of costs.
struct DifferentialCase {
    std::size_t number = 0;
    const AnnotatedScene* scene = nullptr;
    std::size_t cones = 0;
    Pairing pairing = Pairing::near_far;
    bool shape_costs = false;
};

/// Case `number` of a seed: the scene, 12 to 40 cones, pairing and costs, each drawn uniformly. It depends
/// only on these two and the scenes, so a run may be cut into parts. A scene with fewer cones gives all of
/// only on these two and the scenes, so a run may be split into parts. A scene with fewer cones gives all of
[[nodiscard]] DifferentialCase draw_case(std::span<const AnnotatedScene> scenes, std::uint64_t seed,
                                         std::size_t number);

enum class Agreement {
    same_optimum,  ///< both proven, and equal
    both_infeasible,
    undecided,  ///< one of them reached its limit, without a contradiction
    refused,    ///< the independent checker refuses an answer, or a solver answers with an error
    differ,     ///< a proven bound of one is above the objective found by the other
};
[[nodiscard]] std::string_view to_string(Agreement agreement);

/// For two reports on the same case; differences up to 1e-6 are ignored.
[[nodiscard]] Agreement compare_reports(const RldReport& first, const RldReport& second);

struct DifferentialOptions {
    std::uint64_t seed = 1;
    std::size_t first = 0;
    std::size_t cases = 1000;
    std::string reference = "cbc";
    double time_limit_ms = 10'000.0;  ///< a solve
};

struct DifferentialRow {
    DifferentialCase drawn;
    Agreement agreement = Agreement::undecided;
    std::string message;  ///< of the checker or a solver, where it is refused
    RldReport path_pair;
    RldReport reference;
};

[[nodiscard]] std::vector<DifferentialRow> differential_rows(std::span<const AnnotatedScene> scenes,
                                                             const DifferentialOptions& options);

/// One line.
[[nodiscard]] std::string differential_outcome(std::span<const DifferentialRow> rows,
                                               const DifferentialOptions& options);

}  // namespace conelane::experiments
