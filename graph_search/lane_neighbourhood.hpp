#pragma once

#include "graph_search/lane_constraints.hpp"
#include "graph_search/lane_features.hpp"
#include "graph_search/path_pair_enumeration.hpp"
#include "graph_search/search_graph.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace conelane {

/// Detours leave a boundary within this distance of its first vertex, along it [m].
inline constexpr double kDetourRange_m = 24.0;
/// A detour leaves out at most so many vertices in a row.
inline constexpr std::size_t kMostLeftOut = 2;

/// Local search: the lanes that differ from a given one by one change of one boundary near the car.
///
/// Algorithm 2 goes back depth first, so a limited search varies the far ends of few lanes. Where one of
/// these has taken a false positive near the car, the same lane without it is often never met, however well
/// it would rank. This tries, in the order in which the lane grows,
///   - detours: from a vertex in kDetourRange_m over at most one vertex that is not on the lane to a vertex
///     farther on, or to the end of the boundary, at most kMostLeftOut being left out;
///   - starts: another first vertex, joined to one of the first 1 + kMostLeftOut of the boundary, or none.
class LaneNeighbourhood {
  public:
    /// Adds to `pairs` the feasible ones, closed too where they can be, each as the left-right decider would
    /// let it grow; some may be there already. `starts`: by side, vertices that a boundary may start at, in
    /// the order to be tried. Draws on `budget`, in which an iteration is a vertex added to a lane; its
    /// deadline is not looked at. Keeps memory from call to call. Precondition: `lane` is a path pair in
    /// `graph` with at least two vertices a side; `heading` is a unit vector.
    void run(const SearchGraph& graph, const PathPairVertices& lane, const PathPairVertices& starts,
             const Point& heading, const EnumerationRules& rules, SearchBudget& budget, PathPairs& pairs);

  private:
    /// A lane while it grows: the tips of its boundaries and what the features need.
    struct Tips {
        std::array<Vertex, 2> last;
        std::array<Point, 2> direction;  ///< of the last segments; the heading where there is none
        std::array<double, 2> length_m;
        LaneGrowth growth;
    };
    struct Pushed {
        Side side;
        Vertex vertex;
    };
    /// By side, the vertices to come.
    using Rest = std::array<std::span<const Vertex>, 2>;

    [[nodiscard]] Tips start(Vertex left, Vertex right);
    /// Returns whether the lane may become feasible.
    bool push(Tips& tips, Side side, Vertex vertex);
    [[nodiscard]] Side next_side(const Tips& tips, const Rest& rest) const;
    /// Grows the lane by all of `rest`, adds it where it is feasible, and takes `rest` away again.
    void complete(Tips tips, Rest rest, PathPairs& pairs);
    /// From the vertex in place `at` of a side, which is that side's tip.
    void try_detours(const Tips& tips, Side side, std::size_t at, Rest rest, PathPairs& pairs);
    void try_starts(Side side, std::span<const Vertex> starts, PathPairs& pairs);
    [[nodiscard]] bool turns_too_far(const Point& before, const Point& after) const;
    [[nodiscard]] Point segment(Vertex from, Vertex to) const;
    [[nodiscard]] bool is_on_lane(Vertex vertex) const;

    const SearchGraph* graph_ = nullptr;
    const PathPairVertices* lane_ = nullptr;
    SearchBudget* budget_ = nullptr;
    EnumerationRules rules_;
    double phi_max_ = 0.0;  ///< as turning_measure
    Point heading_{0.0, 0.0};
    LaneConstraints constraints_;
    std::vector<Pushed> pushed_;    ///< the lane, in the order in which it grew
    std::vector<Vertex> vias_;      ///< the vertices that a detour may lead over
    std::vector<Vertex> detoured_;  ///< the rest of a boundary with a detour
};

}  // namespace conelane
