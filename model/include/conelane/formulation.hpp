#pragma once

#include <string_view>

namespace conelane {

/// Two programs whose integer points give the same sets of edges.
enum class Formulation {
    paper,  ///< the rows as printed (after the errata), every variable binary
    tight,  ///< stronger relaxation, fewer rows; only edges and path ends are integer
};
[[nodiscard]] std::string_view to_string(Formulation formulation);

}  // namespace conelane
