#pragma once

#include "graph_search/clc/deciders.hpp"
#include "graph_search/clc/lane_constraints.hpp"
#include "graph_search/clc/lane_features.hpp"
#include "graph_search/shared/search_budget.hpp"
#include "graph_search/shared/search_graph.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace conelane {

/// The two first vertices of a lane.
struct StartPair {
    Vertex left;
    Vertex right;

    bool operator==(const StartPair&) const = default;
};

struct EnumerationRules {
    LaneBounds bounds;
    double d_max_m = 5.5;  ///< for closing; must be that of the search graph
    WidthBacktracking width_backtracking = WidthBacktracking::left_behind;
    double next_vertex_distance_weight = 0.0;  ///< of NVD; 0: equation (3)
    /// Limited-discrepancy search: lanes with more discrepancies are left out. A vertex in place k + 1 of
    /// NVD's order counts k; a lane's are added up.
    std::uint32_t max_discrepancies = std::numeric_limits<std::uint32_t>::max();
    bool with_features = false;  ///< whether PathPairs::features is filled
    /// Of this graph, weight and reach; keeps from run to run what it has found. Null: each run has a new
    /// one.
    NextVertexDecider* next_vertex = nullptr;
    StepReach* reach = nullptr;  ///< of the search graph: longer steps are left out; null: none is
};

/// A feasible path pair, given by the last of its steps.
struct PathPair {
    std::uint32_t last_step;
    bool closed;
    std::int64_t iteration;  ///< of the search in which it was met first, from 1
    double length_m;         ///< mean of the lengths of both boundaries
};

/// Equal for path pairs with the same vertices added to the same sides in the same order; otherwise equal
/// with a chance of 1 in 2^64.
class PathPairFingerprint {
  public:
    explicit PathPairFingerprint(StartPair start) {
        add(kLeft, start.left);
        add(kRight, start.right);
    }
    void add(Side side, Vertex vertex);
    [[nodiscard]] std::uint64_t value() const { return value_; }

  private:
    std::uint64_t value_ = 0;
};

/// A set of numbers that keeps its memory when it is cleared, as an open hash table; its order is not used.
class FingerprintSet {
  public:
    void clear();
    /// Returns whether it is new.
    bool insert(const PathPairFingerprint& fingerprint);

  private:
    void grow();

    std::vector<std::uint64_t> slots_;  ///< size a power of two, at most half in use; 0 is an empty slot
    std::size_t used_ = 0;
};

/// The vertices of both boundaries, from the car outward.
using PathPairVertices = std::array<std::vector<Vertex>, 2>;

/// All path pairs found, as a tree of steps: common beginnings are stored once.
class PathPairs {
  public:
    void clear();
    [[nodiscard]] const std::vector<PathPair>& found() const { return found_; }
    /// One entry for each pair found, if features were requested.
    [[nodiscard]] std::span<const LaneFeatures> features() const { return features_; }
    /// `vertices` gives its memory.
    [[nodiscard]] PathPairVertices vertices(const PathPair& pair, PathPairVertices vertices = {}) const;

    static constexpr std::uint32_t kNone = ~std::uint32_t{0};
    /// Returns the number of the new step. The first two of a pair are its start, left and right.
    std::uint32_t add_step(std::uint32_t before, Side side, Vertex vertex);
    /// Approximate size.
    [[nodiscard]] std::size_t bytes() const;
    /// Adds a feasible lane, unless a side has a single vertex or the lane is there already by the same
    /// steps. If it can be closed (section IV-E), its closed form follows. `fingerprint`, `boundaries` and
    /// `growth` are those of `pair`, which is open; `growth` is read only if rules.with_features. Returns the
    /// work done, as SearchBudget counts it.
    std::size_t add_lane(const PathPair& pair, const PathPairFingerprint& fingerprint,
                         const LaneConstraints& boundaries, const LaneGrowth& growth,
                         const EnumerationRules& rules);
    /// For setting the features that depend on the scene.
    [[nodiscard]] std::span<LaneFeatures> features() { return features_; }

  private:
    /// Adds `pair` closed, if its ends are near and the constraints hold. Returns the work.
    std::size_t add_closed(const PathPair& pair, const LaneConstraints& boundaries,
                           const EnumerationRules& rules);

    struct Step {
        std::uint32_t before;
        Vertex vertex;
        std::uint8_t side;
    };
    std::vector<Step> steps_;
    std::vector<PathPair> found_;
    std::vector<LaneFeatures> features_;
    FingerprintSet known_;
    std::array<std::vector<Point>, 2> closing_points_;
};

/// Algorithm 2 of the CLC paper: depth-first search over pairs of simple paths, both growing at once.
///
/// How V is read: the recursive call gets the visited sets by value, so marks of a call hold for itself and
/// the calls below it, and are forgotten when it returns. While V[s][c] is in use, side s ends in c by the
/// same path, so NVD's order of the neighbours of c is fixed and the visited ones are always the first of
/// that order: a position in it represents the whole set. A call first takes all pairs in which side s goes
/// on from c to n, then those in which it does not, so each path pair is met exactly once.
///
/// One addition to line 11: a call also returns if the lane can become feasible only by extending a side all
/// of whose neighbours are visited; line 22 would give up each of its further extensions one by one.
class PathPairEnumeration {
  public:
    /// Adds to `pairs` all feasible path pairs from `start` with at least two vertices a side and at most
    /// rules.max_discrepancies that are not there yet by the same steps, in the order met. If a pair can be
    /// closed (section IV-E), its closed form follows. Draws on `budget`, in which an iteration is one run of
    /// the loop in line 3; when it is spent, the search stops, and the pairs found stay. Returns whether the
    /// enumeration is complete. Keeps memory from call to call. Precondition: `heading` is a unit vector,
    /// start.left != start.right.
    ///
    /// `guide`: a lane to follow first (warm start, section IV-F), with its start; empty for none. The search
    /// follows it as far as it can, LRD deciding between the sides, and then continues as usual: the same set
    /// of pairs in another order.
    bool run(const SearchGraph& graph, StartPair start, const Point& heading, const EnumerationRules& rules,
             SearchBudget& budget, PathPairs& pairs, const PathPairVertices& guide = {});

  private:
    /// One call of EPP: the path pair it extends, by its last step, and the visited sets, by position.
    struct Call {
        std::array<NextVertexDecider::Range, 2> unvisited;
        std::array<std::uint32_t, 2> tried;   ///< number of vertices before the next one in NVD's order
        std::uint32_t discrepancies;          ///< of the lane
        std::array<Vertex, 2> visited_early;  ///< the guide's vertex, out of the order of `unvisited`
        std::array<Vertex, 2> last;
        std::array<Point, 2> direction;  ///< of the last segments
        std::array<double, 2> length_m;
        PathPairFingerprint fingerprint;
        LaneGrowth growth;  ///< only if features are requested
        std::uint32_t step;
        Side pushed;  ///< the side that was extended to get here
    };

    /// By side, an index of NextVertexDecider::option.
    using NextOptions = std::array<std::uint32_t, 2>;

    /// State of a call.
    struct Choice {
        Side side;
        NextVertex next;
        bool guided;
    };

    /// Starts with the call that has the start alone.
    void begin(const SearchGraph& graph, StartPair start, const Point& heading, const EnumerationRules& rules,
               PathPairs& pairs, const PathPairVertices& guide);
    /// Returns from the last call.
    void end_call();
    /// Chooses the next vertex of the last call and marks it visited. Precondition: a side is extensible.
    Choice choose(Call& call, const std::array<bool, 2>& extensible);
    /// Extends the lane of the last call. Unless BTD gives the longer lane up, it becomes a call, and if it
    /// is feasible it is added to `pairs`.
    void extend(const Choice& choice, const std::array<bool, 2>& extensible, SearchBudget& budget,
                PathPairs& pairs);
    /// Drops visited vertices from the front of the rest of a side's order; returns whether any are left.
    bool drop_visited(Call& call, Side side) const;
    /// Next vertices of the guide, for the sides on which it goes on; both sides' options keep kNoOption
    /// otherwise.
    [[nodiscard]] NextOptions guided_options(const Call& call);
    [[nodiscard]] Side choose_side(const Call& call, const NextOptions& options) const;

    const SearchGraph* graph_ = nullptr;
    EnumerationRules rules_;
    NextVertexDecider own_next_vertex_;
    NextVertexDecider* next_vertex_ = nullptr;
    LaneConstraints constraints_;
    std::array<std::vector<std::uint8_t>, 2> on_path_;
    std::vector<Call> calls_;
    StartPair start_{};
    double phi_max_ = 0.0;  ///< as turning_measure
    PathPairVertices guide_;
    std::array<std::size_t, 2> guide_position_{0, 0};  ///< next vertex of each side of the guide
    bool follows_guide_ = false;
};

}  // namespace conelane
