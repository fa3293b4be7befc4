#pragma once

#include "solvers/path_pair/frontier/onward_tables.hpp"
#include "solvers/path_pair/primal/incumbent.hpp"

namespace conelane::path_pair {

/// Pairs of legs by labels on the frontiers. A label is the beginnings of both legs up to a frontier, with
/// the edges that they have lost. Frontier by frontier, cheapest first; a label is dropped where
///   - its reduced cost and the cheapest walk on reach the cutoff, also if the walk must do without the
///     edges that one of its arcs has lost, or
///   - another label of the frontier dominates it: that one costs no more (true costs, without
///     multipliers), has as many edges along the heading, and has lost no edge that this one still has and
///     that a walk on below the cutoff uses.
/// Edges far behind soon make no difference, so beginnings merge and pairs are searched almost like walks.
class FrontierSearch {
  public:
    enum class Outcome {
        exhausted,  ///< nothing below the cutoff is left
        narrow,     ///< some frontiers had more than `width` labels
        stopped     ///< by `max_labels` or the clock
    };
    static constexpr std::size_t kAnyWidth = std::numeric_limits<std::size_t>::max();

    FrontierSearch(const ArcGraph& graph, PairRelaxation& relaxation, Incumbent& incumbent,
                   const FrontierGraph& frontiers, const EdgeSets& edges, const OnwardTables& tables,
                   SearchClock& clock)
        : graph_(graph),
          relaxation_(relaxation),
          incumbent_(incumbent),
          frontiers_(frontiers),
          edges_(edges),
          tables_(tables),
          clock_(clock) {}

    struct Limits {
        std::size_t width;  ///< of each frontier only so many of the cheapest labels are expanded
        std::size_t max_labels;
    };
    /// Offers the incumbent what is below its limit. Precondition: the frontiers' onward costs are found, and
    /// the tables are theirs.
    Outcome run(const Limits& limits);

  private:
    struct Label {
        int before;  ///< the label that it continues, -1 for the first of a chain
        int arc;     ///< by which; -1 if a leg ended
        int frontier;
        int along_heading;  ///< edges, at most 2
        int next;           ///< of the labels that wait at the frontier
        double cost;        ///< without multipliers
        double reduced;
    };

    void begin();
    void take(int arc, Label& label, std::uint64_t* lost) const;
    void wait(Label label);
    /// Call it before this many sets of edges are looked at.
    [[nodiscard]] bool out_of_time(std::size_t sets);
    void settle(int f);
    [[nodiscard]] bool detour_reaches_limit(int label, int most) const;
    [[nodiscard]] bool dominated(const Label& label, const std::uint64_t* lost, int most);
    void expand(int label);
    void offer(int label);
    /// With offset.
    [[nodiscard]] double limit() const { return incumbent_.limit() + relaxation_.offset(); }
    [[nodiscard]] std::uint64_t* lost(int label) { return lost_.row(to_index(label)); }
    [[nodiscard]] const Label& label_at(int number) const { return *labels_.row(to_index(number)); }

    const ArcGraph& graph_;
    PairRelaxation& relaxation_;
    Incumbent& incumbent_;
    const FrontierGraph& frontiers_;
    const EdgeSets& edges_;
    const OnwardTables& tables_;
    SearchClock& clock_;
    Limits limits_{};
    bool is_narrow_ = false;  ///< the width left a label out

    std::size_t words_ = 0;
    BlockRows<Label> labels_;
    BlockRows<std::uint64_t> lost_;    ///< by label
    std::vector<int> waiting_;         ///< by frontier, the label that came last
    std::vector<std::uint64_t> open_;  ///< frontiers with labels that wait
    bool again_ = false;               ///< there is one before the frontier that is settled

    // Of the frontier that is settled.
    std::vector<int> here_;
    std::vector<int> kept_along_heading_;
    std::vector<std::uint64_t> kept_lost_;
    std::vector<std::uint64_t> any_lost_;  ///< by one that is kept
    std::vector<std::uint64_t> wanted_;

    std::vector<int> chain_;
    std::array<std::vector<int>, 2> legs_;
};

}  // namespace conelane::path_pair
