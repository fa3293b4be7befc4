#pragma once

#include <string_view>

namespace conelane {

/// Two programs with the same integer points.
enum class Formulation {
    paper,  ///< the rows as printed (after the errata), every variable binary
    tight,  ///< stronger relaxation, fewer rows; only edges are integer
};
[[nodiscard]] std::string_view to_string(Formulation formulation);

}  // namespace conelane
