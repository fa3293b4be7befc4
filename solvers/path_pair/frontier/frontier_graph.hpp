#pragma once

#include "solvers/path_pair/frontier/dominated_edges.hpp"
#include "solvers/path_pair/frontier/partner_bounds.hpp"
#include "solvers/path_pair/graph/block_rows.hpp"

namespace conelane::path_pair {

/// Both legs abreast as one walk. A frontier is the pair of their last arcs. Of the two, the one that stands
/// earlier in the residual graph moves: its leg goes on or ends, and once it has ended the other one moves.
/// So every pair of legs is exactly one walk from frontier to frontier, and with reduced costs
///     forward(f)  = cheapest walk from a first frontier to f,
///     onward(f)   = cheapest walk on from f to a last one, whose ends are partners,
/// forward(f) + onward(f) - offset bounds every pair that passes f. Frontiers and steps that reach a limit
/// are dropped, and so are steps by a dominated edge: one that every walk up to the frontier has lost, or
/// that every walk on excludes.
class FrontierGraph {
  public:
    struct Frontier {
        int moving;   ///< last arc of the leg that moves, in the residual graph, ...
        int waiting;  ///< ... and of the other one, which waits or has ended
        std::uint8_t moving_kind;
        bool ended;
        bool operator==(const Frontier&) const = default;
    };
    struct Step {
        int to;       ///< the next frontier
        int arc;      ///< by which; -1 if the moving leg ends
        double turn;  ///< cost of the turn into it
    };

    /// If the clock's time ends, every function below returns early and its result must not be used. If that
    /// happens while the frontiers are renumbered, no frontier is left.
    FrontierGraph(PairRelaxation& relaxation, SearchClock& clock) : relaxation_(relaxation), clock_(clock) {}

    /// All frontiers that a pair below `limit` may pass, by forward costs and cheapest single legs on, with
    /// forward(f). With `edges`, steps by edges that every walk up to their frontier has lost are left out.
    /// Returns false if there are more than `max_frontiers`, or if no time is left. Precondition: the
    /// relaxation was evaluated on the residual graph. `limit`: with offset, here and below.
    bool build(const ResidualGraph& residual, const DominatedEdges& dominated, double limit,
               std::size_t max_frontiers, const EdgeSets* edges = nullptr);

    /// onward(f) where it matters below the limit, and the bound, with offset, that it gives.
    double find_onward(double limit);
    /// forward(f) again, after steps were dropped.
    void find_forward();
    /// Precondition: forward and onward costs are found. They stay.
    void drop(double limit);
    /// Drops the steps by dominated edges of frontiers, which the same intersections give as for arcs. The
    /// forward and onward costs then no longer hold.
    void drop_dominated_edges(const EdgeSets& edges);

    [[nodiscard]] int size() const { return static_cast<int>(now_.frontiers.size()); }
    [[nodiscard]] const ResidualGraph& residual() const { return *residual_; }
    [[nodiscard]] const Frontier& frontier(int f) const { return now_.frontiers[to_index(f)]; }
    [[nodiscard]] std::span<const int> starts() const { return starts_; }
    [[nodiscard]] bool is_last(int f) const { return now_.last[to_index(f)] != 0; }
    [[nodiscard]] std::span<const Step> steps(int f) const {
        return {now_.steps.data() + now_.begin[to_index(f)], now_.steps.data() + now_.end[to_index(f)]};
    }
    [[nodiscard]] double onward(int f) const { return now_.onward[to_index(f)]; }
    /// Reduced cost of the two arcs of a first frontier.
    [[nodiscard]] double start_cost(int f) const;
    [[nodiscard]] double cost(const Step& step) const {
        return step.turn + (step.arc < 0 ? 0.0 : relaxation_.reduced()[to_index(step.arc)]);
    }

  private:
    static constexpr std::size_t kStepsPerFrontier = 4;  ///< for which room is made at once
    struct Arrays {
        std::vector<Frontier> frontiers;
        std::vector<char> last;
        std::vector<std::size_t> begin;  ///< of a frontier's steps
        std::vector<std::size_t> end;
        std::vector<Step> steps;
        std::vector<double> forward;
        std::vector<double> onward;

        template <typename Visit>
        void for_each(const Visit& visit) {
            visit(frontiers, 1);
            visit(last, 1);
            visit(begin, 1);
            visit(end, 1);
            visit(steps, kStepsPerFrontier);
            visit(forward, 1);
            visit(onward, 1);
        }
        void clear() {
            for_each([](auto& values, std::size_t) { values.clear(); });
        }
        /// Precondition: cleared.
        void reserve(std::size_t count) {
            for_each([&](auto& values, std::size_t each) { values.reserve(each * count); });
        }
    };
    static std::uint64_t key(const Frontier& frontier);
    /// Call it before this many frontiers are looked at.
    bool out_of_time(std::size_t frontiers = 1);
    /// For graph/timed_growth.hpp.
    template <typename T>
    bool fill(std::vector<T>& values, std::size_t count, T value) {
        return path_pair::fill(values, count, value, clock_);
    }
    template <typename T>
    bool make_room(std::vector<T>& values, std::size_t more) {
        return path_pair::make_room(values, more, clock_);
    }
    /// Whether walks up to a frontier or on from it are meant: sets of lost edges pass along the steps, sets
    /// of excluded edges against them.
    enum class Walks { up_to, on_from };
    /// The dominated edges of every frontier by its walks up to it or on from it, and steps by one no longer
    /// kept. False if the time is up.
    template <Walks kWalks>
    bool drop_steps_by_dominated(const EdgeSets& edges);
    /// The same rows of the set of all edges.
    bool fill_dominated(std::size_t words);
    void forget_frontiers();

    void begin(double limit);
    void open(int f);
    bool narrow_dominated(int from, int to, int arc);
    bool extend(int f, double limit, std::size_t max_frontiers);
    /// Whether a walk on from the frontier to partners may stay below the limit.
    [[nodiscard]] bool may_pass(const Frontier& frontier, double forward, double limit) const;
    void add_steps(int f, double limit);
    /// `other`: the kind of the leg that waits.
    [[nodiscard]] static Frontier after(const Frontier& frontier, int arc, std::uint8_t other);
    int number(const Frontier& wanted);
    bool grow_table();  ///< false, and no table, where the time is up
    void order();
    bool order_frontiers();
    void keep(std::span<const int> order);

    PairRelaxation& relaxation_;
    SearchClock& clock_;
    const ResidualGraph* residual_ = nullptr;
    const DominatedEdges* dominated_of_arcs_ = nullptr;
    const EdgeSets* edges_ = nullptr;                ///< of the build, if it looks for dominated edges
    std::array<std::vector<double>, 2> leg_onward_;  ///< by kind and arc
    PartnerBounds partners_;
    bool has_partners_ = false;
    Arrays now_;
    std::vector<int> starts_;

    // Scratch.
    Arrays old_;
    std::vector<int> table_;      ///< frontier by slot, linear probing
    std::vector<int> open_at_;    ///< by moving arc, the first of its open frontiers
    std::vector<int> next_open_;  ///< by frontier
    std::vector<std::uint64_t> open_arcs_;
    std::size_t max_first_ = 0;  ///< first frontiers, more are too many
    int moving_ = 0;             ///< the arc whose frontiers are extended
    bool again_ = false;         ///< an arc before it has open frontiers
    std::vector<int> index_;
    std::vector<int> order_;
    std::vector<int> stack_;
    std::vector<std::size_t> next_step_;
    std::vector<char> keep_step_;         ///< of old_.steps
    std::vector<int> changed_;            ///< by frontier, the sweep that changed it last
    BlockRows<std::uint64_t> dominated_;  ///< by frontier
    std::vector<std::uint64_t> nothing_;  ///< the empty set
};

}  // namespace conelane::path_pair
