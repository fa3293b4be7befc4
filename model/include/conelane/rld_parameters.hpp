#pragma once

#include <memory>
#include <numbers>
#include <span>
#include <string_view>

namespace conelane {

struct LearnedCosts;

/// Which pairs of paths are a lane graph.
enum class Pairing {
    near_far,  ///< each path joins a near endpoint with a far one
    paper,  ///< as printed: one path between the near endpoints and one between the far ones is allowed too
};
[[nodiscard]] std::string_view to_string(Pairing pairing);

/// The symbols of the RLD paper. The paper prints no values; the defaults were found by hand on recorded
/// tracks. The default of d_max is the widest lane. If d_max is larger, one boundary may go on alone.
struct RldParameters {
    double d_e = 3.2;                   ///< expected spacing of a boundary's cones [m]
    double d_t = 1.7;                   ///< the spacing cost (18) is 1 this far from d_e [m]
    double theta_e = std::numbers::pi;  ///< expected interior angle; pi is straight on [rad]
    double theta_t = 0.9;               ///< the angle cost (20) is 1 this far from theta_e [rad]
    double w_s = 0.4;                   ///< weight of the spacing cost (18)
    double w_t = 0.5;                   ///< weight of the angle cost (20)
    double w_p = 1.2;                   ///< weight of the heading cost (25)
    double w_b = 1.0;                   ///< benefit of an edge (29)
    double d_min = 2.5;                 ///< smallest distance of two edges, except end to end (6)-(8) [m]
    double d_h = 6.0;                   ///< (9) counts edges at most this far from the car [m]
    double theta_heading = 1.2;         ///< (9): largest acute angle of a counted edge to the heading [rad]
    double d_near = 6.0;                ///< near endpoints (11) are at most this far from the car [m]
    double d_max = 6.5;                 ///< largest distance between the far endpoints (17) [m]
    double s_crit = 2.5;                ///< largest spacing cost of an edge (27); see d_gap
    double t_crit = 4.0;                ///< largest angle cost of two adjacent edges (28)
    Pairing pairing = Pairing::near_far;

    // Extras that the paper's conclusion names; off by default.
    double w_color = 0.0;          ///< weight of the color cost, see ProblemEdge::color_cost
    bool use_confidence = false;   ///< an edge's benefit is w_b times the confidences of its two cones
    bool forbid_crossing = false;  ///< no two edges cross; (7) forbids most crossings already

    // Extras of this project, off by default: costs of a lane's shape, see shape_costs.hpp. The symbols are
    // those of model/formulation.md and the keys of files.
    double unevenness_weight = 0.0;  ///< w_u, of uneven spacing
    double facing_weight = 0.0;      ///< w_v, of the facing cost
    double near_end_weight = 0.0;    ///< w_n, benefit of a near endpoint half a lane beside the car's axis
    double lane_width_m = 3.6;       ///< d_w, expected width of the lane
    double facing_distance_m = 2.7;  ///< d_v, v_ij is 1 at this offset of the facing edge
    double facing_angle_rad = 0.4;   ///< theta_v, v_ij is 1 where the sine of the angle is this
    double facing_length_m = 3.0;    ///< d_l, v_ij is 1 at this difference of lengths

    // Edges over gaps, where a cone of a boundary is missing; off by default.
    double d_gap = 0.0;      ///< longest edge allowed though s_crit forbids it [m]; off at 0
    double theta_gap = 0.4;  ///< largest angle from straight on of a turn with such an edge [rad]
    double d_clear = 0.0;    ///< such an edge has no cone this near, except this near its ends [m]

    double d_side = 0.0;  ///< a near endpoint is at most this far from the car's axis [m]; off at 0

    // An edge joins two cones, one of which is among the nearest cones of the other; off at 0.
    double nearest_of_edge = 0.0;  ///< k_edge: one end is among this many nearest cones of the other
    double nearest_of_gap = 0.0;   ///< k_gap: the same for an edge over a gap

    /// Costs from learned_costs.hpp, added to those above; none by default. Not changed after it is set.
    std::shared_ptr<const LearnedCosts> learned_costs = {};
};

/// One numeric parameter: how files spell it, where it is, and what it may be.
struct RldParameterField {
    std::string_view key;
    double RldParameters::*value;
    std::string_view unit;  ///< "m", "rad" or "1"
    double lowest;          ///< smallest valid value
    double highest;         ///< largest valid value
    std::string_view description;
};
/// All numeric parameters of the paper in the order of the file format.
[[nodiscard]] std::span<const RldParameterField> rld_parameter_fields();
/// The numeric parameters of the extras. Their defaults switch the extras off.
[[nodiscard]] std::span<const RldParameterField> rld_extra_fields();

/// The parameters with the costs of a lane's shape: hand-set weights w_u, w_v and w_n, and hand-set w_s, w_t,
/// d_e, d_min, theta_heading and s_crit, which suit them. Parameters with shape costs are returned unchanged.
[[nodiscard]] RldParameters with_shape_costs(RldParameters parameters);
/// Whether any shape cost has a positive weight.
[[nodiscard]] bool has_shape_costs(const RldParameters& parameters);

/// Throws InvalidInput naming the first parameter, or list of learned costs, that is out of range or NaN.
void validate(const RldParameters& parameters);

}  // namespace conelane
