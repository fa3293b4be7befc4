#pragma once

#include "solvers/path_pair/bound/pair_relaxation.hpp"
#include "solvers/path_pair/path_pair_options.hpp"

namespace conelane::path_pair {

/// Multipliers near the best ones, without walks. In the dual of the linear program over arcs and turns, each
/// cone chooses one state (unused, a turn, a leg's first or last arc), each clique at most one edge, the
/// source two starts and the sink two partners. What two of them share (an arc, an edge, a start, an end) has
/// a price in both, and the prices add up to its cost. With the minimum of each one's choices softened to
///     -T log(sum of exp(-cost / T)),
/// the best prices of one shared thing, all others fixed, are those at which both use it with the same
/// probability, in closed form (block-coordinate ascent, as in Sinkhorn's scaling). T falls stage by stage.
/// The multiplier of a cone is what its cheapest state gains, so no walk gains from a cycle.
class SmoothedAscent {
  public:
    SmoothedAscent(const ArcGraph& graph, const LegSystem& system, const AscentTuning& tuning,
                   SearchClock& clock)
        : graph_(graph), system_(system), tuning_(tuning), clock_(clock) {}

    /// Sets the multipliers of cones and cliques, and adds violated cliques to the pool. Returns false and
    /// leaves the multipliers as they are if the time ended or a price left the range of numbers.
    /// Precondition: both legs are alike.
    bool find(const ResidualGraph& residual, CliquePool& cliques, Multipliers& multipliers);

  private:
    /// A leg that starts, or ends, at a cone: shared by the cone and the source, or the sink.
    struct Choice {
        double price;  ///< in the cone; in the other one it is minus that
        double scale;  ///< of this stage, in the cone
        double sum;    ///< weights of the cone's states that choose it, without scale
        double weight;
    };
    /// An edge of a clique: shared by the clique and, sweep by sweep, one of the edge's cones.
    struct Member {
        int edge;
        double price;
        double weight;
    };

    void begin(const ResidualGraph& residual, double heading);
    void add_members(const CliquePool& cliques);
    bool set_weights(double temperature);
    void set_costs();
    void set_choices(double temperature);
    bool sweep();
    void sum_states();
    void balance_arc(int a);
    void balance_start(int cone);
    void balance_end(int cone);
    double balance_choice(int cone, Choice& choice, double chosen, double total);
    void balance_members(std::size_t clique);
    void absorb(double temperature);
    void separate(CliquePool& cliques);
    [[nodiscard]] double in_sum(int a) const;
    [[nodiscard]] double out_sum(int a) const;
    bool read(const CliquePool& cliques, Multipliers& multipliers);

    const ArcGraph& graph_;
    const LegSystem& system_;
    const AscentTuning& tuning_;
    SearchClock& clock_;
    CliqueSeparation separation_;
    const ResidualGraph* residual_ = nullptr;
    int sweeps_ = 0;

    // By arc, which comes in at its head and goes out at its tail. Weights are those of a start and an end.
    std::vector<double> cost_, in_price_, out_price_, in_scale_, out_scale_, start_weight_, end_weight_;
    std::vector<double> out_weight_, in_weight_;  ///< of turns, by position in out_arc and in_arc
    std::vector<double> unused_, total_;          ///< by cone: weight of the state, and of all states
    std::vector<Choice> start_, end_;             ///< by cone
    std::vector<int> starts_, ends_;
    double pairs_of_ends_ = 0.0;  ///< weight of all pairs of partners
    std::vector<Member> members_;
    std::vector<std::size_t> member_start_;         ///< by clique
    std::vector<double> empty_;                     ///< by clique: weight of choosing no edge
    std::vector<std::array<int, 2>> arcs_of_edge_;  ///< -1 without the arc
    std::vector<double> edge_use_;
    std::vector<char> edge_alive_;
};

}  // namespace conelane::path_pair
