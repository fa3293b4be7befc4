#pragma once

#include "model/lane_graph_problem.hpp"
#include "model/rld_parameters.hpp"
#include "model/scene.hpp"

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace conelane {

// What a lane looks like as a whole, as costs of single edges and turns: extras that the RLD paper does not
// have, section "Shape costs" of formulation.md. All are without weight.

/// u_ijk = ((D_ij - D_jk) / d_t)^2: a boundary's cones stand about as far apart as their neighbours do.
[[nodiscard]] double unevenness(double before_m, double after_m, const RldParameters& parameters);

/// v_ij in [0, 1], an entry for each edge: how badly the edge that faces it best does. Of all edges that (27)
/// allows and that share no cone with {i, j}, the least (l^2 + (b - d_w)^2) / d_v^2 + (sin(angle) /
/// theta_v)^2 + ((D - D_ij) / d_l)^2, at most 1; l and b are the components, along {i, j} and across, of the
/// way between both midpoints, the angle is that between the edges, and D the other's length. An edge of zero
/// length has 1. `stop` is asked before so many pairs of edges are looked at; the costs are of no use once it
/// says so.
[[nodiscard]] std::vector<double> facing_costs(const Scene& scene, std::span<const ProblemEdge> edges,
                                               const RldParameters& parameters,
                                               const std::function<bool(std::size_t)>& stop = {});

/// z_i in [0, 1]: 1 - ((|y_i| - d_w / 2) / d_t)^2, at least 0, with the distance y_i of a cone to the car's
/// axis: 1 half a lane beside it, where a boundary begins.
[[nodiscard]] double near_end_fit(const Scene& scene, const Point& cone, const RldParameters& parameters);

}  // namespace conelane
