#pragma once

#include "conelane/lane_graph.hpp"
#include "conelane/rld_parameters.hpp"
#include "conelane/scene.hpp"
#include "model/learned_reference.hpp"

#include <cstddef>
#include <optional>
#include <vector>

namespace conelane {

/// The rules and costs of model/formulation.md in extended precision, found cone by cone from the scene. The
/// checkers of lane graphs and of bounds use it. It shares no code with the builder of LaneGraphProblem, so
/// an error of the builder is not repeated here. Cone indices must be those of the scene.
class LaneGraphReference {
  public:
    using Real = long double;

    /// Both must outlive it.
    LaneGraphReference(const Scene& scene, const RldParameters& parameters);

    [[nodiscard]] bool is_near(std::size_t cone) const;  ///< (11)
    /// (17): more than d_max from each other.
    [[nodiscard]] bool are_apart(std::size_t a, std::size_t b) const;
    /// Shorter edges may lose their squares in double, and so their direction.
    [[nodiscard]] bool has_length(const Edge& edge) const;
    [[nodiscard]] bool exceeds_s_crit(const Edge& edge) const;  ///< (27): then only a gap allows the edge
    [[nodiscard]] bool is_over_gap(const Edge& edge) const;
    /// Whether the edge joins a cone with one of its nearest, by the limit of edges of its kind.
    [[nodiscard]] bool joins_nearest(const Edge& edge) const;
    [[nodiscard]] bool is_along_heading(const Edge& edge) const;  ///< (9)
    /// (28): whether the way from one cone over another to a third one turns too sharply.
    [[nodiscard]] bool exceeds_t_crit(std::size_t from, std::size_t middle, std::size_t to) const;
    /// Whether that way is as straight as an edge over a gap needs it.
    [[nodiscard]] bool is_straight(std::size_t from, std::size_t middle, std::size_t to) const;
    [[nodiscard]] bool are_too_close(const Edge& a, const Edge& b) const;  ///< (6)-(8)
    /// Whether the ends of each edge lie on different sides of the other's line, each farther than a tie.
    [[nodiscard]] bool cross(const Edge& a, const Edge& b) const;

    [[nodiscard]] Real edge_cost(const Edge& edge) const;  ///< without the costs of ends
    [[nodiscard]] Real turn_cost(std::size_t from, std::size_t middle, std::size_t to) const;
    [[nodiscard]] Real end_cost(std::size_t cone) const;  ///< of a path that ends there

  private:
    struct Vector {
        Real x;
        Real y;
        Vector operator-(const Vector& b) const { return {x - b.x, y - b.y}; }
    };
    /// An edge that may be part of a boundary, so it may face another edge.
    struct FacingEdge {
        std::size_t k;
        std::size_t l;
        Real length;
        Vector middle;
        Vector direction;  ///< unit length
    };
    /// The nearest points of two segments.
    struct Nearest {
        Real distance;
        Real s;  ///< position on the first segment, in [0, 1]
        Real t;  ///< position on the second segment, in [0, 1]
    };

    static Vector along(const Vector& a, const Vector& b, Real t);
    static Real dot(const Vector& a, const Vector& b) { return a.x * b.x + a.y * b.y; }
    static Real wedge(const Vector& a, const Vector& b) { return a.x * b.y - a.y * b.x; }
    static Real length(const Vector& a);
    static Real fourth(Real value) { return value * value * value * value; }
    static Nearest nearest_points(const Vector& a, const Vector& b, const Vector& c, const Vector& d);

    [[nodiscard]] Vector position(std::size_t cone) const;
    [[nodiscard]] Vector vector_of(const Edge& edge) const { return position(edge.j) - position(edge.i); }
    [[nodiscard]] Real length_of(const Edge& edge) const { return length(vector_of(edge)); }
    [[nodiscard]] Real spacing_cost(const Edge& edge) const;
    [[nodiscard]] Real angle_cost(std::size_t from, std::size_t middle, std::size_t to) const;
    [[nodiscard]] Real interior_angle(std::size_t from, std::size_t middle, std::size_t to) const;
    [[nodiscard]] bool is_clear(const Edge& edge) const;
    void find_facing_edges();
    [[nodiscard]] Real facing_cost(const Edge& edge) const;
    [[nodiscard]] Real color_faults(const Edge& edge) const;

    const Scene& scene_;
    const RldParameters& p_;
    Vector car_;
    Vector heading_;
    std::vector<FacingEdge> facing_edges_;  ///< all edges that (27) allows; only if facing has a cost
    std::optional<LearnedReference<Real>> learned_;
};

}  // namespace conelane
