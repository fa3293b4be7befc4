#include "model/strip_costs.hpp"

namespace conelane {
namespace {

constexpr std::array<LearnedFeature, kStripEdgeFeatures> kEdge{{
    {"one", "1", "1 for each edge"},
    {"length", "5 m", "metres of boundary"},
    {"gap", "3 m", "longer than 5 m: a cone may be missing"},
    {"stretch", "1", "its length differs from 4 m: squared, in 2 m"},
    {"short", "m", "shorter than 2 m"},
    {"beside", "1", "cones close beside it, which it would skip"},
    {"crowd", "2", "cones within 3.5 m of its midpoint"},
    {"gap_beside", "3 m", "gap times the cones within 2.5 m beside it"},
    {"gap_crowd", "3 m", "gap times crowd"},
    {"length_crowd", "5 m", "length times crowd"},
    {"in_lane", "1", "cones at 0.6 to 2.6 m on both sides: on neither is an empty lane"},
    {"distance", "30 m", "its midpoint is far from the car"},
}};
constexpr std::array<LearnedFeature, kStripTriangleFeatures> kTriangle{{
    {"one", "1", "1 for each triangle"},
    {"inside", "1", "cones in the triangle: a lane is empty"},
    {"wide", "m", "the new rung is longer than 4.5 m"},
    {"narrow", "m", "the new rung is shorter than 3.2 m"},
    {"off", "m", "its length differs from 3.7 m"},
    {"squared_off", "m^2", "the same, squared"},
    {"lead_before", "4 m", "the other boundary was ahead, along the edge"},
    {"squared_lead_before", "1", "the same, squared"},
    {"lead_after", "4 m", "the other boundary is ahead after the step"},
    {"squared_lead_after", "1", "the same, squared"},
    {"width_change", "m", "the rungs differ in length"},
    {"squared_width_change", "m^2", "the same, squared"},
    {"area", "10 m^2", "of the triangle"},
    {"rotation", "rad", "angle between the rungs"},
    {"squared_rotation", "rad^2", "the same, squared"},
    {"ahead", "1", "the boundary was ahead, and moves on"},
}};
constexpr std::array<LearnedFeature, kStripStartFeatures> kStart{{
    {"one", "1", "1 for each start"},
    {"aside", "m", "the middle of the rung is beside the car's axis"},
    {"squared_aside", "m^2", "the same, squared"},
    {"ahead", "6 m", "the rung is ahead of the car; negative behind it"},
    {"behind_car", "2 m", "the rung is behind the car"},
    {"squared_ahead", "1", "ahead, squared"},
    {"skew", "4 m", "one cone is ahead of the other"},
    {"squared_skew", "1", "the same, squared"},
    {"off", "m", "the rung's length differs from 3.7 m"},
    {"squared_off", "m^2", "the same, squared"},
    {"between", "1", "cones between the car and the rung"},
    {"behind", "1", "cones from which the boundaries may have come"},
    {"crowd", "2", "cones within 3.5 m of its middle"},
}};
constexpr std::array<LearnedFeature, kStripTurnFeatures> kTurn{{
    {"one", "1", "1 for each turn"},
    {"angle", "rad", "from straight on"},
    {"squared_angle", "rad^2", "the same, squared"},
    {"sharp", "rad", "beyond 0.8 rad"},
    {"curvature", "0.2/m", "of the circle through its three cones"},
    {"inside", "1", "cones in the triangle that it cuts off"},
    {"unevenness", "1", "its edges differ in length: squared, in 2 m"},
    {"length", "8 m", "both edges together"},
    {"inner", "rad", "angle, if the lane lies on the inner side"},
    {"bent_gap", "rad", "angle times gaps: a cone may be missing in a bend"},
    {"crowd", "2", "cones within 3.5 m of its middle cone"},
}};
constexpr std::array<LearnedFeature, kStripEndFeatures> kEnd{{
    {"one", "1", "1 for each end"},
    {"in_view", "10 m", "far inside the edge of view"},
    {"on", "1", "a cone goes straight on"},
    {"next_in_view", "5 m", "the place of a next cone is inside the view"},
    {"on_in_view", "1", "on times next_in_view"},
    {"distance", "30 m", "far from the car"},
    {"aside", "1", "beside the car's axis, as a sine"},
    {"crowd", "2", "cones within 3.5 m"},
}};

}  // namespace

std::string_view to_string(StripPart part) {
    constexpr std::array<std::string_view, kStripParts.size()> kNames{"edge", "triangle", "start", "turn",
                                                                      "end"};
    return kNames[static_cast<std::size_t>(part)];
}

std::span<const LearnedFeature> learned_features(StripPart part) {
    constexpr std::array<std::span<const LearnedFeature>, kStripParts.size()> kFeatures{kEdge, kTriangle,
                                                                                        kStart, kTurn, kEnd};
    return kFeatures[static_cast<std::size_t>(part)];
}

StripCosts hand_set_strip_costs() {
    // In the order of the features above.
    StripCosts costs = StripCosts::zero();
    costs.of(StripPart::edge).linear = {0.0, -1.0, 0.5, 0.1, 0.5, 0.5, 0.0, 0.5, 0.0, 0.0, 0.0, 0.0};
    costs.of(StripPart::triangle).linear = {0.0, 1.0, 0.3, 0.5,  0.0, 0.05, 0.0, 0.1,
                                            0.0, 0.1, 0.0, 0.05, 0.0, 0.05, 0.1, 0.0};
    costs.of(StripPart::start).linear = {0.0, 0.3, 0.0, 0.3, 0.0, 0.0, 0.0, 0.5, 0.0, 0.1, 1.0, 0.3, 0.0};
    costs.of(StripPart::turn).linear = {0.0, 0.0, 0.8, 0.5, 0.0, 0.5, 0.1, 0.0, 0.0, 0.0, 0.0};
    costs.of(StripPart::end).linear = {0.0, 0.2, 0.0, 0.0, 0.5, 0.0, 0.0, 0.0};
    return costs;
}

}  // namespace conelane
