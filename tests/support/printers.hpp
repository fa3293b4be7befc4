#pragma once

#include "conelane/lane_detector.hpp"
#include "conelane/lane_graph.hpp"

#include <ostream>
#include <type_traits>

/// How GoogleTest prints values of the library, which would be bytes; in the precompiled header of the tests.
namespace conelane {

template <typename Named>
requires(std::is_enum_v<Named>&& requires(Named value) {
    to_string(value);
}) void PrintTo(const Named& value, std::ostream* out) {
    *out << to_string(value);
}

inline void PrintTo(const Point& point, std::ostream* out) {
    *out << '(' << point.x() << ", " << point.y() << ')';
}

inline void PrintTo(const Edge& edge, std::ostream* out) {
    *out << edge.i << '-' << edge.j;
}

inline void PrintTo(const LaneGraph& graph, std::ostream* out) {
    *out << "edges";
    for (const Edge& edge : graph.edges) PrintTo(edge, &(*out << ' '));
}

inline void PrintTo(const Lane& lane, std::ostream* out) {
    *out << (lane.closed ? "closed, left" : "left");
    for (const ConeId id : lane.left) *out << ' ' << id;
    *out << ", right";
    for (const ConeId id : lane.right) *out << ' ' << id;
}

inline void PrintTo(const MergedCone& merged, std::ostream* out) {
    *out << merged.cone << " into " << merged.into;
}

inline void PrintTo(const ColorProbabilities& p, std::ostream* out) {
    *out << "unknown " << p.unknown << ", blue " << p.blue << ", yellow " << p.yellow << ", orange "
         << p.orange << ", big orange " << p.big_orange;
}

inline void PrintTo(const PositionCovariance& covariance, std::ostream* out) {
    *out << covariance.xx_m2 << ' ' << covariance.xy_m2 << ' ' << covariance.yy_m2;
}

}  // namespace conelane
