#pragma once

#include "graph_search/clc/lane_constraints.hpp"
#include "graph_search/clc/lane_features.hpp"
#include "graph_search/clc/next_vertex.hpp"
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
    /// Without it the search goes on where no extension can become feasible: slower, and finds the same.
    bool backtracking = true;
    double next_vertex_distance_weight = 0.0;  ///< of NVD; 0: equation (3)
    /// Limited-discrepancy search: lanes with more are left out. A vertex that NVD puts in place k + 1 counts
    /// k, and a lane's are added up.
    std::uint32_t max_discrepancies = std::numeric_limits<std::uint32_t>::max();
    bool with_features = false;  ///< whether PathPairs::features is filled
};

/// A feasible path pair, as the last of the steps that built it.
struct PathPair {
    std::uint32_t last_step;
    bool closed;
    std::int64_t iteration;  ///< of the search in which it was met first, from 1
    double length_m;         ///< mean of the lengths of both boundaries
};

/// What two path pairs have in common where the same vertices were added to the same sides in the same order,
/// and else only by a chance of 1 in 2^64.
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

/// A set of numbers that keeps its memory when it is emptied. As an open hash table; nothing depends on the
/// order in it.
class FingerprintSet {
  public:
    void clear();
    /// Returns whether it was not there yet.
    bool insert(const PathPairFingerprint& fingerprint);

  private:
    void grow();

    std::vector<std::uint64_t> slots_;  ///< a power of two of them, at most half in use; 0 is an empty one
    std::size_t used_ = 0;
};

/// The vertices of both boundaries, from the car outward.
using PathPairVertices = std::array<std::vector<Vertex>, 2>;

/// All path pairs found, as a tree of steps: what many have in common is stored once.
class PathPairs {
  public:
    void clear();
    [[nodiscard]] const std::vector<PathPair>& found() const { return found_; }
    /// One entry for each pair found, where they were asked for.
    [[nodiscard]] std::span<const LaneFeatures> features() const { return features_; }
    [[nodiscard]] PathPairVertices vertices(const PathPair& pair) const;
    /// Those of one side, in the place of what `vertices` holds.
    void vertices(const PathPair& pair, Side side, std::vector<Vertex>& vertices) const;

    static constexpr std::uint32_t kNone = ~std::uint32_t{0};
    /// Returns the number of the new step. The first two of a pair are its start, left and right.
    std::uint32_t add_step(std::uint32_t before, Side side, Vertex vertex);
    /// About what is kept.
    [[nodiscard]] std::size_t bytes() const;
    /// Adds a feasible lane, unless a side has a single vertex or it is there already by the same steps;
    /// where it can be closed (section IV-E) it is followed by itself, closed. `fingerprint`, `boundaries`
    /// and `growth` are those of `pair`, which is open; `growth` is read only where rules.with_features.
    /// Returns the work done, as SearchBudget counts it.
    std::size_t add_lane(const PathPair& pair, const PathPairFingerprint& fingerprint,
                         const LaneConstraints& boundaries, const LaneGrowth& growth,
                         const EnumerationRules& rules);
    /// To fill in what belongs to the scene.
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
/// How V is read: the recursive call gets the visited sets by value, so what a call marks holds for itself
/// and the calls below it, and is forgotten when it returns. While V[s][c] is in use, side s ends in c by the
/// same path, so the order in which NVD offers the neighbours of c is fixed and the visited ones are always
/// the first of that order: a position in it stands for the whole set. A call first takes all pairs in which
/// side s goes on from c to n, then those in which it does not, so each path pair is met exactly once.
///
/// One thing is added to line 11: a call also returns where the lane can become feasible only by extending a
/// side all of whose neighbours are visited; line 22 would give up each of its further extensions one by one.
class PathPairEnumeration {
  public:
    /// Adds to `pairs` all feasible path pairs from `start` with at least two vertices a side and at most
    /// rules.max_discrepancies that are not there yet by the same steps, in the order met; each one that can
    /// be closed (section IV-E) is followed by itself, closed. Draws on `budget`, in which an iteration is
    /// one run of the loop in line 3; where it is spent the search stops, and what was found stays. Returns
    /// whether the enumeration is complete. Keeps memory from call to call. Precondition: `heading` is a unit
    /// vector, start.left != start.right.
    ///
    /// `guide`: a lane to follow first (warm start, section IV-F), its start included; empty for none. The
    /// search goes along it as far as it can, LRD deciding between the sides, and then on as ever: the same
    /// set of pairs in another order.
    bool run(const SearchGraph& graph, StartPair start, const Point& heading, const EnumerationRules& rules,
             SearchBudget& budget, PathPairs& pairs, const PathPairVertices& guide = {});

  private:
    /// One call of EPP: the path pair it extends, by its last step, and the visited sets, by position.
    struct Call {
        std::array<NextVertexDecider::Range, 2> unvisited;
        std::array<std::uint32_t, 2> tried;   ///< vertices that NVD puts before the next one
        std::uint32_t discrepancies;          ///< of the lane
        std::array<Vertex, 2> visited_early;  ///< the guide's vertex, out of the order of `unvisited`
        std::array<Vertex, 2> last;
        std::array<Point, 2> direction;  ///< of the last segments
        std::array<double, 2> length_m;
        PathPairFingerprint fingerprint;
        LaneGrowth growth;  ///< only where features are asked for
        std::uint32_t step;
        Side pushed;  ///< the side that was extended to get here
    };

    /// By side, an index of NextVertexDecider::option.
    using NextOptions = std::array<std::uint32_t, 2>;

    /// Where a call goes on.
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
    /// Extends the lane of the last call; unless BTD gives the longer lane up, that becomes a call, and where
    /// it is feasible it is added to `pairs`.
    void extend(const Choice& choice, const std::array<bool, 2>& extensible, SearchBudget& budget,
                PathPairs& pairs);
    /// Drops visited vertices from the front of what a side has left; returns whether any is left.
    bool drop_visited(Call& call, Side side) const;
    /// Where the guide goes on, for the sides where it does; both sides' options keep kNoOption otherwise.
    [[nodiscard]] NextOptions guided_options(const Call& call);
    [[nodiscard]] Side choose_side(const Call& call, const NextOptions& options) const;

    const SearchGraph* graph_ = nullptr;
    EnumerationRules rules_;
    NextVertexDecider next_vertex_;
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
