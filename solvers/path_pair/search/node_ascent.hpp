#pragma once

#include "solvers/path_pair/bound/smoothed_ascent.hpp"
#include "solvers/path_pair/primal/pair_completion.hpp"
#include "solvers/path_pair/search/frontier_solve.hpp"

namespace conelane::path_pair {

/// The multipliers of an ascent that a certificate repeats: multiples of a unit, and only those that dropped
/// something, in order.
class MultiplierStages {
  public:
    explicit MultiplierStages(double unit) : unit_(unit) {}

    /// Rounds the multipliers that are evaluated next. No arc gets cheaper, so no cycle gains.
    void round(Multipliers& multipliers);
    /// The multipliers rounded last dropped something.
    void keep() { stages_.push_back(evaluated_); }
    void add(const Multipliers& multipliers) { stages_.push_back(multipliers); }
    [[nodiscard]] std::vector<Multipliers> take() { return std::exchange(stages_, {}); }

  private:
    double unit_;
    Multipliers evaluated_;
    std::vector<Multipliers> stages_;
};

/// Raises the bound of a node step by step. On the way it completes the bound's walks to incumbents, drops
/// what reaches the incumbent, adds cliques, and searches the frontiers where they are few enough.
class NodeAscent {
  public:
    /// What its parts work with, from their making on.
    struct Context {
        const ArcGraph& graph;
        const LegSystem& system;
        Incumbent& incumbent;
        const PathPairOptions& options;
        CliquePool& cliques;
        const Decisions& decisions;  ///< of the node at hand
        SecondLegBound& second_leg;
        SearchClock& clock;
    };
    /// The rules of an ascent: kinds of nodes differ in them.
    struct Rules {
        AscentPatience patience;
        FrontierSolve::TargetLimits last_search;  ///< of frontiers, at the ascent's end
        bool separates_cliques = true;
        bool smooths = false;  ///< at one step, multipliers come from a smoothed ascent
        int first_try = 1;     ///< the step that searches frontiers first; 0: after a beam
    };
    /// The steps aim at the cost of the incumbent. If windows have found it, they aim at `outside_cost`, that
    /// of the best one found otherwise.
    struct Aim {
        double known_cost = kUnreachable;  ///< of the incumbent when windows were last searched
        double outside_cost = kUnreachable;
    };

    explicit NodeAscent(const Context& context);
    /// Forgets the nodes of earlier searches. `stages`: those that a certificate wants.
    void restart(MultiplierStages* stages = nullptr);

    void begin(const Node& node, const Rules& rules);
    /// Precondition: not done.
    Verdict step(Node& node, const Aim& aim);
    /// To the end.
    Verdict run(Node& node, const Rules& rules);
    [[nodiscard]] bool is_done() const { return state_.is_last; }
    [[nodiscard]] int steps() const { return state_.step; }

    [[nodiscard]] const PairRelaxation& relaxation() const { return relaxation_; }
    [[nodiscard]] const WalkUsage& usage() const { return usage_; }
    [[nodiscard]] FrontierSolve& frontiers() { return frontiers_; }

  private:
    struct State {
        int step = 0;
        bool is_last = false;          ///< the ascent ends with this step
        double value = -kUnreachable;  ///< the bound at this step's multipliers
        double best = -kUnreachable;
        double scale = 1.0;                ///< of the steps
        int since_best = 0;                ///< steps without progress
        int next_completion = 0;           ///< the step that completes walks next
        std::int64_t updates = 0;          ///< of labels since the frontiers were last tried, about
        double failed_gap = kUnreachable;  ///< the gap at which the frontiers were too many
    };

    /// Minus infinity if the time has ended.
    double evaluate(const ResidualGraph& graph);
    /// Goes on from the multipliers of a smoothed ascent. Only the next evaluation tells what they are worth.
    void smooth(const ResidualGraph& graph);
    /// The node's best multipliers so far, with 0 for cliques that came later.
    void take_best_multipliers(const Node& node);
    /// Keeps the multipliers where they are the best so far, and counts steps without progress.
    void note_value(Node& node);
    void complete_walks(const ResidualGraph& graph);
    /// Searches the frontiers at some steps, if they are not too many for the work done so far, and at the
    /// last.
    Verdict try_frontiers(const ResidualGraph& graph);
    void move_multipliers(const Node& node, const Aim& aim);
    [[nodiscard]] double step_gap(const Aim& aim) const;
    /// Whether anything was dropped.
    bool fix(ResidualGraph& graph);
    void separate(const ResidualGraph& graph);
    [[nodiscard]] const AscentTuning& tuning() const { return options_.tuning.ascent; }

    const ArcGraph& graph_;
    Incumbent& incumbent_;
    const PathPairOptions& options_;
    CliquePool& cliques_;
    const Decisions& decisions_;
    SearchClock& clock_;
    MultiplierStages* stages_ = nullptr;
    PairRelaxation relaxation_;
    PairCompletion completion_;
    FrontierSolve frontiers_;
    ArcFixing fixing_;
    CliqueSeparation separation_;
    SmoothedAscent smoothed_;
    Ascent ascent_;
    WalkUsage usage_;
    Multipliers multipliers_;  ///< of the current step
    Rules rules_{};
    State state_;
    std::vector<char> edge_alive_;
};

}  // namespace conelane::path_pair
