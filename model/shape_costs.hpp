#pragma once

#include "conelane/lane_graph_problem.hpp"

#include <functional>

namespace conelane {

// The shape of a lane as costs of single edges and turns: extras that the RLD paper does not have, section
// "Shape costs" of formulation.md. All are without weight.

/// u_ijk = ((D_ij - D_jk) / d_t)^2: neighbouring edges of a boundary have about the same length.
[[nodiscard]] double unevenness(double before_m, double after_m, const RldParameters& parameters);

/// v_ij in [0, 1], an entry for each edge: the cost of the edge that faces it best. Over all `facers`, the
/// edges within s_crit, that share no cone with {i, j}, it is the least (l^2 + (b - d_w)^2) / d_v^2 +
/// (sin(angle) / theta_v)^2 + ((D - D_ij) / d_l)^2, at most 1. l and b are the components, along {i, j} and
/// across it, of the vector between the two midpoints; the angle is between the edges, and D is the length of
/// the other edge. An edge of zero length has 1. `stop` gets the number of pairs of edges before they are
/// examined; the costs are invalid once it returns true.
[[nodiscard]] std::vector<double> facing_costs(const Scene& scene, std::span<const ProblemEdge> edges,
                                               std::span<const Edge> facers, const RldParameters& parameters,
                                               const std::function<bool(std::size_t)>& stop = {});

/// The same where the lane's width is unknown: the least (l / 4 m)^2 + (w / 1 m)^2 + (sin(angle) / 0.6)^2,
/// at most 1, where w is the distance of |b| from the interval [2.5 m, 5.5 m]. A feature of learned costs.
[[nodiscard]] std::vector<double> facing_at_any_width(const Scene& scene, std::span<const ProblemEdge> edges,
                                                      std::span<const Edge> facers,
                                                      const std::function<bool(std::size_t)>& stop = {});

/// z_i in [0, 1]: 1 - ((|y_i| - d_w / 2) / d_t)^2, at least 0, with the distance y_i of a cone from the car's
/// axis. It is 1 half a lane beside the axis, where a boundary begins.
[[nodiscard]] double near_end_fit(const Scene& scene, const Point& cone, const RldParameters& parameters);

}  // namespace conelane
