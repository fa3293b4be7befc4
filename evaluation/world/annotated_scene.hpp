#pragma once

#include "conelane/lane.hpp"
#include "conelane/scene.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace conelane {

/// A scene with data that only the scoring may see.
struct AnnotatedScene {
    Scene scene;
    std::optional<Lane> ground_truth;
    std::string track;  ///< empty if the scene comes from no track
    std::optional<double> false_positive_rate;
    std::optional<double> range_m;
    std::optional<std::uint64_t> seed;  ///< the base seed
    std::string condition;              ///< empty without a named condition
    /// Map points in view that the car does not see, in the map's order. Recorded for named conditions, for
    /// persistent false positives, and for runs, whose map may lack them.
    std::vector<Cone> missed;
    std::optional<double> travelled_m;  ///< along the path of a run
};

}  // namespace conelane
