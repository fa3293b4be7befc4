#pragma once

#include "solvers/path_pair/bound/pair_relaxation.hpp"
#include "solvers/path_pair/primal/incumbent.hpp"

namespace conelane::path_pair {

/// Incumbents without a relaxation: a beam search over beginnings of both legs, one arc at a time. Of the
/// beginnings with equally many arcs the cheapest go on. No leg gets far ahead of the other, and only a few
/// beginnings may end at the same cone: otherwise dead ends would crowd out the rest.
class PairBeam {
  public:
    struct Limits {
        std::size_t width;  ///< number of beginnings that go on
        int max_at_cone;    ///< among these, number of legs that end at the same cone
    };
    PairBeam(const ArcGraph& graph, const LegSystem& system, SearchClock& clock)
        : graph_(graph), system_(system), clock_(clock) {}

    /// Lists the pairs of first arcs, which all beams of a search begin with. Precondition: the legs of the
    /// system are alike.
    void find_first_steps();
    /// Offers the incumbent the best pair that is met.
    void run(const Limits& limits, Incumbent& incumbent);

  private:
    struct Label {
        int before;                 ///< the label that it continues, -1 for the first of a chain
        std::array<int, 2> last;    ///< arcs
        std::array<int, 2> length;  ///< arcs of each leg
        int along_heading;          ///< edges, at most 2
        double cost;
    };
    struct Step {
        int label;  ///< the label that is continued, -1 for a pair of first arcs
        int leg;
        std::array<int, 2> last;
        double cost;
    };

    [[nodiscard]] bool starts(int arc) const {
        return system_.kinds[0].start[to_index(graph_.tail(arc))] != 0;
    }
    [[nodiscard]] std::uint64_t* lost(std::size_t number) { return lost_.data() + number * words_; }
    /// Adds the ways on from a label to steps_, and returns how many there are. Of those to the same pair of
    /// last arcs the cheapest is kept.
    std::size_t add_steps(int label, const std::uint64_t* lost);
    void add_step(const Step& step);
    void grow_places();
    /// The place of the step to these last arcs, or the free one where it belongs.
    [[nodiscard]] std::size_t place_of(const std::array<int, 2>& last) const;
    void take_cheapest_first_steps();
    void take_cheapest_steps();
    [[nodiscard]] bool is_full() const { return labels_.size() - next_ >= limits_.width; }
    void take(const Step& step);
    void add_label(const Step& step);
    [[nodiscard]] bool is_lane(const Label& label) const;
    [[nodiscard]] bool allows(const std::uint64_t* lost, int arc) const;
    void take_edge(int arc, std::uint64_t* lost) const;
    void take_cone(int cone, std::uint64_t* lost) const;
    void offer(int label, Incumbent& incumbent);

    const ArcGraph& graph_;
    const LegSystem& system_;
    SearchClock& clock_;
    Limits limits_{};
    std::size_t edge_words_ = 0;
    std::size_t words_ = 0;
    std::vector<Label> labels_;
    std::size_t level_ = 0;  ///< first label of those that go on
    std::size_t next_ = 0;   ///< first label with one arc more
    std::vector<Step> steps_;
    std::vector<Step> first_steps_;       ///< a heap, and behind it what was taken off it, the last one first
    std::size_t first_steps_heaped_ = 0;  ///< size of the heap
    std::vector<int> at_cone_;            ///< legs of the new labels that end there
    /// Where steps_ has the step to a pair of last arcs: a table with open addressing, of a power of two.
    struct Place {
        std::size_t level;  ///< of the step; the place is free if it is not the present one
        std::size_t step;
    };
    std::vector<Place> places_;
    std::size_t place_level_ = 0;  ///< counts levels over all beams
    /// By label from level_ on: edges that are excluded, cones that are taken.
    std::vector<std::uint64_t> lost_;
    std::vector<std::uint64_t> lost_next_;  ///< by label from next_ on
    std::array<std::vector<int>, 2> legs_;
};

}  // namespace conelane::path_pair
