#pragma once

#include "conelane/scene.hpp"
#include "graph_search/clc/deciders.hpp"
#include "graph_search/clc/lane_constraints.hpp"
#include "graph_search/clc/neighbourhood.hpp"
#include "graph_search/clc/path_pair_enumeration.hpp"
#include "graph_search/shared/search_budget.hpp"
#include "graph_search/shared/search_graph.hpp"

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace conelane {

/// A measure of one step of a lane, by which LaneBeam judges it. Scores are given at `first`, `first +
/// spacing`, ...; between them they are interpolated, beyond the ends they are constant.
struct StepMeasure {
    std::string_view name;  ///< the unit in it
    double first;
    double spacing;
    std::size_t scores;
};

/// The first step of a lane is its starting pair; each other step adds a vertex to a side.
enum StepMeasureIndex : std::size_t {
    // Measures of the starting pair; `lead` is how much farther ahead one cone is, over their distance.
    kStartWidthMeasure,
    kStartAsymmetryMeasure,
    kStartDistanceMeasure,
    kStartLeadMeasure,
    // Measures of the other steps. `steps` has one score, for making the step.
    kStepsMeasure,
    kSegmentMeasure,
    kSegmentChangeMeasure,
    kFirstTurnMeasure,  ///< from the car's heading
    kTurnMeasure,
    kTurnTimesSegmentMeasure,
    kTurnChangeMeasure,
    kSkewMeasure,         ///< angle with the other side's last segment
    kWidthMeasure,        ///< from the new vertex to the last segment of the other side
    kWidthChangeMeasure,  ///< change from the width of the step before
    kAdvanceMeasure,      ///< of the new vertex ahead of the last one of the other side, along the lane
    // Vertices within 1.2 m and 0.6 m of the segment, and in the triangle that the lane grows by.
    kBesideMeasure,
    kCloseMeasure,
    kInsideMeasure,
    kStepMeasureCount
};
[[nodiscard]] const std::array<StepMeasure, kStepMeasureCount>& step_measures();

/// All measures of a step; NaN for those that it does not have.
using StepMeasures = std::array<double, kStepMeasureCount>;

/// The scores of all measures, one after the other.
struct StepScores {
    std::vector<double> values;

    [[nodiscard]] double score(const StepMeasures& step) const;
};
/// Number of StepScores::values: of all measures, and of the measures before `measure`.
[[nodiscard]] std::size_t step_score_count(std::size_t measure = kStepMeasureCount);

/// Adds the derivatives of StepScores::score with respect to the values, times `factor`.
void add_score_derivatives(const StepMeasures& step, double factor, std::span<double> derivatives);

/// Throws InvalidInput unless there are step_score_count() finite values.
void validate(const StepScores& scores);

/// Beam search for a lane, which Algorithm 2 then follows first. Beyond the paper.
///
/// Algorithm 2 backtracks depth first: if one of its first vertices is false, all of its iterations may go to
/// the vertices behind it. Here lanes that grow vertex by vertex compete: of lanes with equally many
/// vertices, the best `width` are kept, from all starting pairs. A lane's score is the sum of learned scores
/// of its steps, each of which depends only on the last vertices; of lanes that end in the same last two
/// vertices a side, only the best goes on. The side whose last vertex is behind the other's grows next. The
/// only constraints are C_seg and that a new vertex is more than w_min off the other side's last segment: the
/// result is a guide, not a lane.
class LaneBeam {
  public:
    struct State {
        std::array<Vertex, 2> last;
        std::array<Vertex, 2> before;     ///< the vertices before; `last` itself if there is none
        std::array<Point, 2> direction;   ///< unit vectors of the last segments; the heading if there is none
        std::array<double, 2> segment_m;  ///< lengths of the last segments; 0 if there is none
        std::array<double, 2> turn_rad;   ///< with sign, at `before`
        std::array<std::size_t, 2> vertices;
        double width_m;
        double length_m;  ///< of both sides
        double score;
        std::size_t parent;     ///< kNone: a starting pair
        Side pushed;            ///< the side that was extended to get here
        std::bitset<512> bits;  ///< of the lane's vertices, see is_on_lane
        StepMeasures step;
    };
    static constexpr std::size_t kNone = ~std::size_t{0};

    /// The first level: the best `width` starting pairs. Keeps the references until the next call, and memory
    /// from call to call. `reach`: `advance` leaves out longer steps; null: none. Precondition: width > 0.
    void start(const SearchGraph& graph, const Scene& scene, std::span<const StartPair> starts,
               const StepScores& scores, const LaneBounds& bounds, std::size_t width,
               StepReach* reach = nullptr);
    /// The next level; returns whether it has a state. If the budget is spent before, returns false and keeps
    /// the level.
    bool advance(SearchBudget& budget);
    /// All levels to the last one, or as many as the budget's time and memory allow. Returns the state with
    /// the highest score among those with two vertices a side; kNone if there is none.
    std::size_t run(SearchBudget& budget);

    /// Best first.
    [[nodiscard]] std::span<const std::size_t> level() const { return level_; }
    [[nodiscard]] const State& state(std::size_t number) const { return states_[number]; }
    /// `vertices` gives its memory.
    [[nodiscard]] PathPairVertices vertices(std::size_t number, PathPairVertices vertices = {}) const;
    /// The side that the state grows by.
    [[nodiscard]] Side next_side(const State& state) const;

    /// For training, which keeps the right lane in the beam. Both return the number of the state, which is
    /// not on any level; `extend` returns kNone if the vertex cannot follow.
    std::size_t add_start(StartPair start);
    std::size_t extend(std::size_t number, Vertex vertex);
    /// Replaces the whole level by the state.
    void restart(std::size_t number) { level_.assign(1, number); }

  private:
    /// A vertex that may come next on a side. All of it depends on the side's last two vertices only, so it
    /// is found once for each directed edge that the search meets.
    struct Continuation {
        Vertex vertex;
        Point segment;
        Point direction;
        double segment_m;
        double nearly_turn_rad;  ///< see nearly_angle_rad; with sign
        double turn_rad;         ///< the same exactly; NaN until a step is measured
        double bound;  ///< on its scores and on those that are not known before the step is measured
    };
    /// A range of `continuations_`.
    struct Range {
        std::uint32_t begin;
        std::uint32_t end;
    };
    static constexpr std::uint32_t kUnknown = ~std::uint32_t{0};
    /// A neighbourhood that is known. Most are asked for several times, for lanes that differ farther back.
    struct KnownNeighbourhood {
        std::array<Vertex, 3> vertices;
        Neighbourhood cones;
    };
    /// A step and what the state after it needs to know.
    struct Step {
        StepMeasures measures;
        Vertex vertex;
        Point direction;
        double segment_m;
        double turn_rad;
        double width_m;
    };
    /// A state that may follow; only those that go on are stored.
    struct Extension {
        double score = 0.0;  ///< an upper bound until the step was measured
        double length_m = 0.0;
        double width_m = 0.0;
        std::size_t parent;
        Vertex vertex;  ///< none: the parent itself, a starting pair
        Vertex low;     ///< the last vertices of both sides
        Vertex high;
        std::uint32_t step = 0;  ///< in `steps_` if it was measured, else in `continuations_`
        bool exact = true;
        bool is_lane = false;  ///< two vertices a side
        Side side = kLeft;     ///< of the vertex
    };

    /// An extension by its number in `next_`.
    struct Ranked {
        double score;
        std::uint32_t number;
    };

    [[nodiscard]] bool is_on_lane(std::size_t number, Vertex vertex) const;
    /// Whether the vertex turns the side by less than the limit; sets `next` if so.
    [[nodiscard]] bool turns_to(const State& from, Side side, Vertex vertex, Continuation& next) const;
    /// All vertices within reach that the side may turn to.
    [[nodiscard]] Range continuations(const State& from, Side side);
    /// Whether the vertex is far enough from the other side, and not on the lane; sets the width.
    [[nodiscard]] bool has_room(std::size_t number, Side side, Vertex vertex, double& width_m) const;
    /// At least the score of the state after that step, and above it only by what the neighbourhood may take
    /// off and by rounded angles. Takes a fraction of the time of `measure`.
    [[nodiscard]] double bound_after(const State& from, Side side, const Continuation& next,
                                     double width_m) const;
    /// How far the vertex is ahead of the last one of the facing side, along the lane.
    [[nodiscard]] double advance_m(const State& from, Side facing, const Continuation& next) const;
    void measure(const State& from, Side side, Continuation& next, double width_m, Step& step);
    /// The cones around the step from `tip` to `vertex`, but for the last vertex of the other side.
    [[nodiscard]] const Neighbourhood& cones_around(Vertex tip, Vertex vertex, Vertex facing);
    /// Adds the state after that step, which has that score.
    std::size_t add_state(std::size_t number, Side side, const Step& step, double score);
    /// Makes a level of the best ones in `next_`, and replaces `best_` if there is a better one. Measures
    /// only where a bound could be among them.
    void keep_best();
    /// Whether the level has a state with the same last vertices.
    [[nodiscard]] bool is_known(const Extension& extension) const;

    const SearchGraph* graph_ = nullptr;
    StepReach* reach_ = nullptr;
    const Scene* scene_ = nullptr;
    const StepScores* scores_ = nullptr;
    LaneBounds bounds_;
    double turn_limit_ = 0.0;  ///< as turning_measure
    double first_turn_limit_ = 0.0;
    Point heading_{0.0, 0.0};
    std::size_t width_ = 0;
    /// The part of a bound that all steps have in common: the score of making a step, the highest scores of
    /// its neighbourhood, and how much rounding and approximate angles may lower the other scores.
    double slack_ = 0.0;
    double slack_per_m_ = 0.0;  ///< how much approximate angles may lower them for each metre of the segment
    StepReach all_;             ///< used if no reach is given
    std::vector<Continuation> continuations_;
    std::vector<Range> after_first_;                  ///< by vertex
    std::vector<Range> after_edge_;                   ///< by directed edge
    std::vector<KnownNeighbourhood> neighbourhoods_;  ///< by a hash of the vertices, the last one with each
    std::vector<State> states_;
    std::vector<std::size_t> level_;
    std::vector<Extension> next_;
    std::vector<Ranked> heap_;
    std::vector<Step> steps_;  ///< those of `next_` that were measured
    Extension best_;           ///< of those with two vertices a side
};

}  // namespace conelane
