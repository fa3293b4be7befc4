#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace conelane {

// These numbers of path-pair's search decide how long it takes, never what is proven: every claimed optimum
// is an optimum with any of them. "Row ..." names the row of the table "What was tried" in exact-search.md
// that has the measurement. Numbers without a row, except limits of memory, are those of its row "other
// steps, patience, ...": others took within 3 % either way, or were better by one objective and worse by the
// other.

/// It says when a node's ascent shortens its steps, and when the ascent ends.
struct AscentPatience {
    int steps;         ///< After so many steps without progress, the step is halved.
    double min_scale;  ///< Once the steps are shorter than this, the ascent ends.
};

/// The ascent of a node's multipliers.
struct AscentTuning {
    /// min_scale: row "frontiers tried again at 0.6", together with retry_gap.
    AscentPatience root{8, 0.2};
    AscentPatience node{4, 0.1};
    double min_gain = 0.005;  ///< share of the gap by which a step's bound has to rise to be progress
    /// The root's steps aim at no more than so many gaps: row "the ascent's steps aimed at the incumbent of
    /// windows".
    double max_overshoot = 2.0;
    double use_memory = 0.9;  ///< A step keeps this share of the averaged use of an edge or an end.
    int steps_per_separation = 4;
    int cliques_per_separation = 12;
    int max_cliques = 600;                       ///< No more cliques have multipliers.
    std::int64_t completion_tries = 60;          ///< So many arcs are tried to complete a walk.
    std::int64_t first_completion_tries = 1000;  ///< So many are tried while there is no incumbent.

    /// Smoothed ascent: row "smoothed ascent in place of the fourth step". It comes at this step of the root,
    /// when most scenes have ended.
    int smoothed_step = 4;
    double first_temperature = 1.0;
    double cooling = 0.7;  ///< the next temperature is this times the one before
    double last_temperature = 0.01;
    int sweeps = 10;                                       ///< at each temperature
    std::array<double, 2> clique_temperatures{0.6, 0.03};  ///< Between them it adds cliques.
    int cliques_per_stage = 20;
    double scale_after = 0.25;  ///< of the steps that follow it
};

/// The search on the frontiers.
struct FrontierTuning {
    // Before the ascent's end, a try may take so many frontiers.
    std::int64_t first_frontiers = 1000;  ///< row "1000 frontiers at first in place of 2000"
    std::int64_t first_frontiers_of_small_graph = 2000;
    int small_graph_arcs = 200;              ///< A graph with fewer arcs is small: the same row.
    std::int64_t updates_per_frontier = 30;  ///< So many label updates allow one more frontier.
    int steps_per_try = 4;
    double retry_gap =
        0.6;  ///< share of the gap that had too many frontiers: row "frontiers tried again at 0.6"

    // These limits bound the memory of a try at the ascent's end: see docs/path-pair.md.
    std::size_t max_frontiers = 300'000;
    std::size_t max_table_bytes = 200'000'000;  ///< of the onward tables together
    std::size_t max_labels = 1'000'000;
    std::size_t max_label_words = 40'000'000;  ///< of 8 bytes, of the labels' sets of edges together

    /// To make a frontier takes so many steps of the clock: half a microsecond.
    std::size_t work_per_frontier = 500;
    int wide_frontiers = 4000;      ///< From here on a narrow search comes first, and tables have detours.
    std::size_t narrow_labels = 2;  ///< A narrow search expands so many labels at a frontier.

    // Beams look for incumbents. The width of a beam is the number of labels that it expands at an arc.
    std::size_t first_beam_width = 2;  ///< at the root: row "a beam before the first frontiers"
    int first_beam_min_arcs = 70;      ///< A smaller graph has no first beam.
    int first_beam_end_arcs = 1000;    ///< A graph of so many arcs has none either: its windows come first.

    // Targets of the last try: row "targets below the incumbent".
    std::array<double, 3> targets{0.3, 0.6, 1.0};  ///< shares of the gap
    /// They are shares of the gap of a target that was too wide: row "lower targets where one was too wide".
    std::array<double, 2> lower_targets{0.3, 0.1};
    double min_target_gap = 1.0;  ///< Targets differ by at least this cost.
};

/// It says which node is next, and on what the node branches.
struct BranchingTuning {
    std::size_t max_open_nodes = 2000;  ///< With more, the search goes depth-first, which bounds the memory.
    double min_end_doubt = 0.1;         ///< An end whose use is above 1 less this is certain.
    double min_use_in_first = 0.4;      ///< If an edge is used more, its branch "in" is searched first.
    int steps_without_end = 2;          ///< The branch without an end has so many steps of the ascent.
};

/// A phase takes a pair of legs and improves it in windows. The pair is the best of a beam; with a beam of
/// width 0, it is the incumbent.
struct WindowPhase {
    std::size_t beam_width;   ///< So many beginnings go on.
    int beam_max_at_cone;     ///< No more of their legs end at the same cone.
    std::size_t window_arcs;  ///< A window has about so many arcs.
};

/// The search for better incumbents in windows. Work and its shares in steps of the clock, about a nanosecond
/// each. Measured on the 89 scenes of row "windows (89 scenes open after 50 ms, in 50 ms)".
struct WindowTuning {
    /// Rows "windows of 100, then 200 and 300 arcs" and "few beginnings at the same cone".
    std::array<WindowPhase, 12> phases{{{64, 3, 100},
                                        {0, 0, 200},
                                        {64, 8, 100},
                                        {64, 16, 100},
                                        {0, 0, 300},
                                        {128, 8, 150},
                                        {128, 16, 150},
                                        {0, 0, 450},
                                        {256, 16, 150},
                                        {256, 32, 150},
                                        {0, 0, 700},
                                        {512, 32, 200}}};
    std::size_t new_pair_arcs = 100;   ///< of windows around an incumbent that the ascent found
    int max_steps = 15;                ///< of a window's ascent
    std::size_t max_frontiers = 3000;  ///< of a window
    std::size_t beam_width = 8;        ///< labels at an arc, where those were not enough

    // When windows are searched.
    int first_step = 2;               ///< of the root's ascent: row "windows from the third step on"
    int huge_graph_arcs = 1000;       ///< arcs of a graph whose windows come before the first step
    double work_per_huge_arc = 50e3;  ///< at once, for each arc above that number: there the bound comes late
    /// Beams in succession that bring no new pair: after them, nothing more is done at once. Row "windows of
    /// huge graphs end after two beams without a new pair".
    int max_idle_beams = 2;

    // Their share of the work: row "windows from the third step on, with a third of the work".
    double little_work = 10e6;  ///< work on bounds, up to which the first share holds
    double share_of_little_work = 0.1;
    double share_of_more_work = 1.0;      ///< where the gap is wide: no proof will come soon
    double min_share_of_more_work = 0.1;  ///< where it is narrow
    double narrow_gap = 0.1;              ///< shares of the incumbent's cost
    double wide_gap = 0.5;
    double min_work = 0.3e6;  ///< with less it is not worth beginning
};

/// All of them.
struct SearchTuning {
    AscentTuning ascent = {};
    FrontierTuning frontiers = {};
    BranchingTuning branching = {};
    WindowTuning windows = {};
};

/// Stages of `path-pair`, and its numbers. The answer is the same with each stage off; it takes longer.
struct PathPairOptions {
    bool fix_arcs = true;            ///< drop arcs whose reduced-cost bound reaches the incumbent
    bool clique_multipliers = true;  ///< multipliers on cliques of incompatible edges, not on cones alone
    bool complete_walks = true;      ///< complete the relaxation's walks to incumbents
    bool search_windows = true;      ///< improve incumbents in small parts of a large graph
    bool search_frontiers =
        true;  ///< end nodes by the search on frontiers, not by branching to the last edge
    bool drop_dominated_edges = true;  ///< there, drop what every way up to a frontier, or on, excludes
    int root_steps = 150;              ///< most ascent steps at the root
    int node_steps = 30;               ///< and at each other node
    SearchTuning tuning = {};
    /// The search ends after so many counted steps of about a nanosecond, as if time had run out: a limit
    /// that is the same on every machine.
    std::int64_t max_work = std::numeric_limits<std::int64_t>::max();
};

}  // namespace conelane
