#pragma once

#include "conelane/lane_graph_problem.hpp"
#include "model/geometry.hpp"

#include <limits>

namespace conelane {

/// A segment with data for its distances from many others.
struct MeasuredSegment {
    MeasuredSegment(const Point& from_m, const Point& to_m)
        : from(from_m),
          to(to_m),
          along(to_m - from_m),
          inverse_squared_length(1.0 / std::max(std::numeric_limits<double>::min(), along.squaredNorm())) {}

    Point from;
    Point to;
    Point along;
    double inverse_squared_length;
};

/// Whether two segments come closer than the limit, at a point where not both are ends: with
/// segment_distance, distance_m < limit_m and not between_ends. A problem needs thousands of these tests, so
/// the code avoids branches that depend on the segments: a mispredicted branch costs more than the
/// arithmetic.
[[nodiscard]] bool come_closer(const MeasuredSegment& a, const MeasuredSegment& b, double limit_m);

/// Which of a problem's edges may come close to each other. If both ends of an edge are out of reach on the
/// same side of another edge (left, right, behind or ahead), so is the whole edge. The codes of Cohen and
/// Sutherland's line clipping, one for each cone around an edge, exclude most pairs of edges.
class NearEdges {
  public:
    /// Edges as a problem lists them: by their first cones. The scene and the edges must outlive this object.
    NearEdges(const Scene& scene, std::span<const ProblemEdge> edges, double reach_m);

    /// The later edges that come within reach of this edge or cross it, ascending, without those that share a
    /// cone with it. Some others may be included. Call in ascending order; valid until the next call.
    [[nodiscard]] std::span<const std::size_t> after(std::size_t edge);

  private:
    static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
    static constexpr unsigned kLeft = 1;
    static constexpr unsigned kRight = 2;
    static constexpr unsigned kBehind = 4;
    static constexpr unsigned kAhead = 8;
    static constexpr unsigned kOwn = 16;  ///< a cone of the edge itself

    void gather(std::size_t cone);

    const Scene& scene_;
    std::span<const ProblemEdge> edges_;
    double reach_m_;
    double max_length_m_ = 0.0;
    std::vector<std::size_t> first_edge_;    ///< by cone, the first edge that begins at it or at a later one
    std::vector<unsigned> codes_;            ///< by cone
    std::size_t around_ = kNone;             ///< the cone for which the following lists are gathered
    std::span<const std::size_t> cones_;     ///< cones with larger indices
    std::span<const std::size_t> gathered_;  ///< edges between these cones

    // Capacity of the lists: one more than their largest length.
    std::vector<unsigned char> is_gathered_;  ///< by later cone
    std::vector<std::size_t> cone_list_;
    std::vector<std::size_t> gathered_list_;
    std::vector<std::size_t> near_list_;
};

}  // namespace conelane
