#pragma once

#include "graph_search/front/front_features.hpp"
#include "graph_search/front/front_map.hpp"
#include "graph_search/front/front_state.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace conelane {

// Divisors that bring values to about 1, and limits at which values are clamped.
inline constexpr double kLengthScale_m = 4.0;
inline constexpr double kViewScale_m = 10.0;
inline constexpr double kFarBeyond = 2.0;
inline constexpr double kPartnerReach_m = 3.0;
inline constexpr double kDefaultWidth = 0.9;
inline constexpr float kMaxCounted = 3.0F;

inline float scaled(double value, double unit, double most = 4.0) {
    return static_cast<float>(std::clamp(value / unit, -most, most));
}

/// What the color of a cone says, seen from a side; all 0 if no cone of the scene has one.
struct ConeColors {
    float own = 0.0F;      ///< probability of the color of that side
    float against = 0.0F;  ///< of the other side's
    float orange = 0.0F;
    float none = 0.0F;         ///< that it is unknown, times the share of the cones that have a color
    float consistency = 0.0F;  ///< see FrontMap
};
struct ExtendColors {
    ConeColors cone;       ///< the new one
    float beside = 0.0F;   ///< nearness of the nearest cone of the own color beside the segment
    float partner = 0.0F;  ///< color evidence of the cone at the place across, times how near that cone is
};

/// Inputs of the features of a move that extends. Angles are positive inward.
struct ExtendSeen {
    const StateMeasures& measures;
    const EdgeNeighbourhood& about;
    const FrontEdge& edge;
    const FrontEnd& other;
    Side side;
    const Point& at;      ///< the new cone
    const Point& facing;  ///< the other side's last one
    double length_m;
    double turn_rad;
    double change_rad;      ///< of the turn, from the last one
    double turn_other_rad;  ///< minus the turn of the other boundary
    double skew_rad;        ///< to the other side's last segment
    double width_m;
    double mean_width_m;
    double view_m;
    double partner_m2;  ///< squared distance from the place across to the nearest cone there
    float log_own;      ///< logarithm of the length divided by the own last segment's
    float log_other;    ///< divided by the other boundary's last segment's
    float inside;       ///< cones in the triangle that the move adds
    ExtendColors colors;
};

inline constexpr std::array<FrontFeatureOf<ExtendSeen>, kExtendFeatures> kExtendSchema{{
    {"length", "m", "of the new segment: the rules ask for a cone every 5 m",
     [](auto& s) { return scaled(s.length_m, kLengthScale_m); }},
    {"log_ratio_own", "1", "its length over the last one's", [](auto& s) { return s.log_own; }},
    {"log_ratio_own_size", "1", "absolute value", [](auto& s) { return std::abs(s.log_own); }},
    {"log_ratio_other", "1", "its length over the other side's last one",
     [](auto& s) { return s.log_other; }},
    {"log_ratio_mean", "1", "its length over the mean so far",
     [](auto& s) { return s.edge.log_length - s.measures.log_mean_segment; }},
    {"turn", "rad", "from the last segment, positive inward",
     [](auto& s) { return static_cast<float>(s.turn_rad); }},
    {"turn_size", "rad", "absolute value: boundaries bend little",
     [](auto& s) { return static_cast<float>(std::abs(s.turn_rad)); }},
    {"turn_change", "rad", "from the last turn: bends are arcs",
     [](auto& s) { return static_cast<float>(s.change_rad); }},
    {"turn_change_size", "rad", "absolute value",
     [](auto& s) { return static_cast<float>(std::abs(s.change_rad)); }},
    {"turn_other", "rad", "less that of the other boundary: both bend alike",
     [](auto& s) { return static_cast<float>(s.turn_other_rad); }},
    {"turn_other_size", "rad", "absolute value",
     [](auto& s) { return static_cast<float>(std::abs(s.turn_other_rad)); }},
    {"skew", "rad", "angle from the new segment to the other side's last one",
     [](auto& s) { return static_cast<float>(s.skew_rad); }},
    {"skew_size", "rad", "absolute value: they are parallel",
     [](auto& s) { return static_cast<float>(std::abs(s.skew_rad)); }},
    {"width", "m", "from the new cone to the other boundary",
     [](auto& s) { return scaled(s.width_m, kLengthScale_m) - static_cast<float>(kDefaultWidth); }},
    {"width_deviation", "m", "absolute difference to the mean so far",
     [](auto& s) { return scaled(std::abs(s.width_m - s.mean_width_m), 1.0); }},
    {"width_change", "m", "from that of the cone before",
     [](auto& s) { return scaled(s.width_m - s.measures.width_m, kLengthScale_m); }},
    {"diagonal", "m", "from the new cone to the other's last one",
     [](auto& s) { return scaled((s.facing - s.at).norm(), kLengthScale_m); }},
    {"lead", "m", "how far the new cone is before the other's last one",
     [](auto& s) { return scaled((s.at - s.facing).dot(s.other.direction), kLengthScale_m, kFarBeyond); }},
    {"inside", "1", "cones in the triangle just swept, up to 3: a lane is empty",
     [](auto& s) { return s.inside; }},
    {"beside_inward", "1", "nearness of the nearest cone beside the segment, inside: one was skipped",
     [](auto& s) { return s.about.nearest_beside[s.side == kRight ? kLeft : kRight]; }},
    {"beside_outward", "1", "the same outside", [](auto& s) { return s.about.nearest_beside[s.side]; }},
    {"beside", "1", "nearness summed over all cones beside it",
     [](auto& s) { return std::min(s.about.beside, kMaxCounted); }},
    {"within_disc", "1", "cones in the disc about the segment, up to 4: neighbours have none between them",
     [](auto& s) { return std::min(s.about.within_disc, 4.0F) / 2.0F; }},
    {"continuation", "1", "how badly the best next segment goes on: the boundary does not end here",
     [](auto& s) { return s.about.continuation; }},
    {"partner", "m", "from the place across, a lane width off, to the nearest cone there",
     [](auto& s) { return scaled(std::sqrt(s.partner_m2), kPartnerReach_m, 1.0); }},
    {"bridges", "1", "1 for a segment of more than 5.8 m: a cone was missed",
     [](auto& s) { return s.length_m > kShortSegment_m ? 1.0F : 0.0F; }},
    {"view_left", "m", "from the new cone to the edge of view",
     [](auto& s) { return scaled(s.view_m - s.at.norm(), kViewScale_m, kFarBeyond); }},
    {"crowding", "1", "nearness of the nearest cone to the new one: boundary cones stand alone",
     [](auto& s) { return s.about.crowding; }},
    {"color_own", "1", "probability that the new cone has the color of its side",
     [](auto& s) { return s.colors.cone.own; }},
    {"color_against", "1", "that it has the other side's", [](auto& s) { return s.colors.cone.against; }},
    {"color_orange", "1", "that it is orange: a gate, on either side",
     [](auto& s) { return s.colors.cone.orange; }},
    {"color_none", "1", "that its color is unknown, times the share of the cones in view that have one",
     [](auto& s) { return s.colors.cone.none; }},
    {"color_beside", "1", "nearness of the nearest cone of the own color beside the segment: one was skipped",
     [](auto& s) { return s.colors.beside; }},
    {"color_partner", "1", "color of the cone at the place across, times how near it is: 1 the other side's",
     [](auto& s) { return s.colors.partner; }},
}};

}  // namespace conelane
