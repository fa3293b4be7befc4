#pragma once

#include "conelane/rld_parameters.hpp"
#include "model/search_certificate.hpp"

namespace conelane {

struct SearchVerdict {
    enum class Kind {
        verified,
        refused,     ///< something claimed is wrong or not proven by the multipliers
        unverified,  ///< would take more steps than allowed: neither proven nor refuted
    };
    Kind kind = Kind::refused;
    std::string reason;       ///< a sentence, unless verified
    std::int64_t steps = 0;   ///< taken
    bool is_optimum = false;  ///< if verified: the lane graph costs no more than 1e-8 above the bound
};

/// Repeats the proof of a whole search in rational arithmetic, from the scene alone: that no lane graph that
/// `check` accepts costs less than the certificate's bound, and that its own lane graph is one and costs what
/// is claimed. Shares no code with any solver nor with the builder of their problem.
///
/// `check` decides on edges, excluded pairs and the colors' part of a cost. The other costs are computed to
/// 50 digits and rounded down to multiples of 2^-60; from there on every sum and comparison is exact.
/// `max_steps` limits the labels and frontiers of the enumeration, all parts together.
[[nodiscard]] SearchVerdict verify_search(const Scene& scene, const RldParameters& parameters,
                                          const SearchCertificate& certificate, std::int64_t max_steps);

}  // namespace conelane
