#include "model/formulation_parts.hpp"

#include "model/constraints/families.hpp"

namespace conelane {
namespace {

constexpr std::array kPaperFixed{constraints::inlier_degree, constraints::four_endpoints,
                                 constraints::two_paths, constraints::turn_products};
constexpr std::array kPaper{constraints::width_pairs, constraints::heading,      constraints::near_endpoints,
                            constraints::far_marks,   constraints::far_distance, constraints::edge_limits,
                            constraints::turn_limits};
constexpr std::array kTight{constraints::turn_flow, constraints::four_endpoints, constraints::width_cliques,
                            constraints::heading,   constraints::near_endpoints, constraints::far_partners};

constexpr FormulationParts kPaperParts{.extent = EdgeExtent::all_pairs,
                                       .high_cost_turns = true,
                                       .inliers = true,
                                       .far_marks = true,
                                       .all_integer = true,
                                       .fixed_families = kPaperFixed,
                                       .families = kPaper};
constexpr FormulationParts kTightParts{
    .extent = EdgeExtent::candidates, .path_ends = true, .families = kTight};

}  // namespace

std::string_view to_string(Formulation formulation) {
    return formulation == Formulation::paper ? "paper" : "tight";
}

const FormulationParts& parts(Formulation formulation) {
    return formulation == Formulation::paper ? kPaperParts : kTightParts;
}

}  // namespace conelane
