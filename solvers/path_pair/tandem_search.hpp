#pragma once

#include "solvers/path_pair/arc_graph.hpp"
#include "solvers/path_pair/incumbent.hpp"
#include "solvers/path_pair/pair_relaxation.hpp"
#include "solvers/path_pair/residual_graph.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace conelane::path_pair {

/// Pairs of legs by labels, both legs abreast.
///
/// A label is the beginnings of both legs. Of their last arcs the one that stands earlier in the residual
/// graph moves: its leg goes on or ends; once it has ended, the other one moves. So every pair of legs is
/// exactly one chain of labels. Depth-first, cheapest bound first; a label is dropped where
///   - its reduced cost and the cheapest ways on of both legs reach the cutoff, or
///   - a label with the same last arcs dominates it: costs no more, has as many edges along the heading, and
///     has lost no edge that this one still has.
/// An edge is lost once a chosen edge is incompatible with it or it is at a cone that a leg has left. Only
/// edges that some way on below the cutoff uses need comparing (`find_detours`), and those are few, so that
/// beginnings which differ far behind the last arcs merge: the pairs are searched almost as if they were
/// walks.
class TandemSearch {
  public:
    void bind(const ArcGraph& graph, PairRelaxation& relaxation, Incumbent& incumbent);

    /// Offers the incumbent what costs less by more than `tolerance`, until nothing does. False where
    /// `budget` labels were not enough or `stopped` says so.
    /// Precondition: forward labels of the residual graph at prices without paying cycles.
    bool exhaust(const ResidualGraph& residual, double tolerance, std::int64_t budget,
                 const std::function<bool()>& stopped);

  private:
    /// Last arcs: of the leg that moves, and of the other, which has ended or waits.
    struct Front {
        int moving;
        int waiting;
        int moving_kind;
        bool ended;
    };
    struct Label {
        std::uint64_t key;  ///< of the front
        Front front;
        int before;         ///< the label that it continues, -1 for the first of a chain
        int arc;            ///< by which; -1 where a leg ended
        int along_heading;  ///< edges, at most 2
        int older;          ///< the label before in the same slot of `newest_`
        double cost;        ///< without prices
    };
    /// A label to be made.
    struct Step {
        Front front;
        int before;
        int arc;
        double turn_cost;
        double reduced;  ///< cost with prices
        double bound;
    };

    void number_edges();
    bool find_detours(const std::function<bool()>& stopped);
    void begin(double tolerance);
    void take(const Step& step);
    void take_arc(int arc);
    [[nodiscard]] bool dominated(double slack);
    void expand(const Step& step, int label, double tolerance);
    [[nodiscard]] bool abreast(int a, int b) const;
    [[nodiscard]] std::uint64_t key(const Front& front) const;
    [[nodiscard]] int& newest(std::uint64_t key);
    void use_slots(std::size_t count);
    [[nodiscard]] double limit(double tolerance) const;
    void offer(int label);
    void sort_from(std::size_t first);

    const ArcGraph* graph_ = nullptr;
    PairRelaxation* relaxation_ = nullptr;
    Incumbent* incumbent_ = nullptr;
    const ResidualGraph* residual_ = nullptr;
    std::array<std::vector<double>, 2> onward_;  ///< by kind and arc

    // Sets of the residual graph's edges, numbered without gaps, as rows of `words_` words.
    std::size_t words_ = 0;
    std::vector<int> number_;              ///< by edge
    std::vector<int> edges_;               ///< by number
    std::vector<std::uint64_t> excluded_;  ///< by number: the incompatible ones
    std::vector<std::uint64_t> at_cone_;   ///< by cone
    std::vector<std::uint64_t> within_;    ///< by arc and level: on a way on with less than so much slack
    bool has_detours_ = false;
    double gap_ = 0.0;
    std::vector<double> detour_;
    std::vector<int> queue_;

    std::vector<Label> labels_;
    std::vector<std::uint64_t> lost_;  ///< by label
    std::vector<int> newest_;          ///< label by slot
    std::vector<Step> open_;
    Label label_{};  ///< the one being made
    std::vector<std::uint64_t> label_lost_;
    std::vector<int> chain_;
    std::array<std::vector<int>, 2> legs_;
};

}  // namespace conelane::path_pair
