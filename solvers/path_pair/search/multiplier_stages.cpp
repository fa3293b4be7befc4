#include "solvers/path_pair/search/multiplier_stages.hpp"

#include <cmath>

namespace conelane::path_pair {

void MultiplierStages::round(Multipliers& multipliers) {
    for (double& multiplier : multipliers.cone) multiplier = unit_ * std::ceil(multiplier / unit_);
    for (double& multiplier : multipliers.clique) multiplier = unit_ * std::ceil(multiplier / unit_);
    multipliers.heading = unit_ * std::floor(multipliers.heading / unit_);
    evaluated_ = multipliers;
}

}  // namespace conelane::path_pair
