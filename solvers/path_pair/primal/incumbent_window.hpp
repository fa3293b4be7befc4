#pragma once

#include "solvers/path_pair/bound/pair_relaxation.hpp"

namespace conelane::path_pair {

/// Small graphs around a lane graph, to be searched for a better one. A window has the arcs among the cones
/// that are the fewest arcs away from a centre; elsewhere the legs are fixed. Centres go along the legs from
/// their ends back, so legs that end too early grow first.
class IncumbentWindow {
  public:
    /// Windows are cut from the whole graph.
    IncumbentWindow(const ArcGraph& graph, const LegSystem& system, const ResidualGraph& whole)
        : graph_(graph), whole_system_(system), whole_(whole) {}

    /// `usable` by arc of the arc graph: arcs that a better lane graph may have. Precondition: the legs of
    /// the system are alike.
    void assign(std::span<const char> usable);
    /// Starts windows of about this many arcs, with all cones as centres.
    void restart(std::size_t max_arcs);

    /// The next window: `arcs` are those of the whole graph, in ascending order. Returns false if no centre
    /// is left. Legs: arcs of the arc graph, from start to end.
    bool next(const std::array<std::vector<int>, 2>& legs, std::vector<int>& arcs);
    /// For the last window: kind k is leg k, with a fixed start or end if that is outside the window.
    [[nodiscard]] const LegSystem& system() const { return system_; }
    /// Whether the last window held a better lane graph. If not, the cones around its centre are settled.
    void report(bool improved);

  private:
    enum class Place : char { outside, reached, inside };

    [[nodiscard]] int next_centre(const std::array<std::vector<int>, 2>& legs) const;
    void spread(int centre);
    void fix_outside(std::span<const int> leg, LegSystem::Kind& kind);
    [[nodiscard]] bool is_inside(int arc) const {
        return place_[to_index(graph_.tail(arc))] == Place::inside &&
               place_[to_index(graph_.head(arc))] == Place::inside;
    }

    const ArcGraph& graph_;
    const LegSystem& whole_system_;
    const ResidualGraph& whole_;
    std::vector<char> usable_;
    std::vector<int> next_start_;  ///< by cone
    std::vector<int> next_;        ///< cones that usable arcs lead to from a cone
    std::size_t max_arcs_ = 0;
    bool holds_all_ = false;     ///< all that can be reached from the centre
    std::vector<char> settled_;  ///< by cone: no window around it improves the legs
    std::vector<Place> place_;   ///< by cone
    std::vector<int> cones_;     ///< of the window, nearest first
    LegSystem system_;
    std::vector<char> of_legs_;           ///< by arc of the arc graph
    std::vector<std::uint64_t> blocked_;  ///< edges that the fixed ones exclude
    std::vector<int> fixed_cones_;
};

}  // namespace conelane::path_pair
