#pragma once

#include "conelane/lane_graph.hpp"

#include <utility>

namespace conelane {

/// What a simpler program needs to repeat the proof of a search that no lane graph costs less than `bound`.
/// It holds Lagrange multipliers as in BoundCertificate, as multiples of 2^-24, in stages: with the
/// multipliers of a stage, arcs and turns whose cheapest walks reach the bound are dropped, and the next
/// stage starts from the rest. What remains after the last stage is enumerated, with the last stage's
/// multipliers as a bound.
struct SearchCertificate {
    static constexpr int kFractionBits = 24;
    using Units = std::int64_t;  ///< multiples of 2^-24
    /// Larger multipliers are not allowed; without such a multiplier, the enumeration has more to do.
    static constexpr Units kMaxUnits = Units{1} << 62;
    /// A bound or an objective beyond this has no certificate, because verifiers add up sums in 128 bits.
    static constexpr double kMaxBound = 1e12;

    struct Stage {
        std::vector<Units> cone;                            ///< by cone of the scene
        std::vector<std::pair<std::size_t, Units>> clique;  ///< by place in the part's cliques; others are 0
        Units heading = 0;
    };
    /// All pairs of legs of one kind.
    struct Part {
        /// If absent, both legs go from near to far cones. Otherwise, for the pairing `paper`: one leg joins
        /// two near cones, and the other goes from this far cone to a far cone of higher index.
        std::optional<std::size_t> far_start;
        std::vector<std::vector<Edge>> cliques;  ///< of edges pairwise excluded
        std::vector<Stage> stages;               ///< at least one
    };
    std::vector<Part> parts;
    std::optional<LaneGraph> lane_graph;  ///< the best one found
    std::optional<double> objective;      ///< of it
    /// No lane graph costs less; infinite if none exists.
    double bound = 0.0;
};

}  // namespace conelane
