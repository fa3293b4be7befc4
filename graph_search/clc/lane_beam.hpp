#pragma once

#include "conelane/scene.hpp"
#include "graph_search/clc/lane_constraints.hpp"
#include "graph_search/clc/path_pair_enumeration.hpp"
#include "graph_search/shared/search_budget.hpp"
#include "graph_search/shared/search_graph.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

namespace conelane {

/// A measure of one step of a lane, by which LaneBeam judges it. Scores stand at `first`, `first + spacing`,
/// ...; between two of them they are interpolated, beyond the last ones they stay.
struct StepMeasure {
    std::string_view name;  ///< the unit in it
    double first;
    double spacing;
    std::size_t scores;
};

/// The first step of a lane is its starting pair, each other one a vertex added to a side.
enum StepMeasureIndex : std::size_t {
    // Of the starting pair; `lead` is how much farther one is ahead, over their distance.
    kStartWidthMeasure,
    kStartAsymmetryMeasure,
    kStartDistanceMeasure,
    kStartLeadMeasure,
    // Of the others. `steps` has one score, of making the step at all.
    kStepsMeasure,
    kSegmentMeasure,
    kSegmentChangeMeasure,
    kFirstTurnMeasure,  ///< from the car's heading
    kTurnMeasure,
    kTurnTimesSegmentMeasure,
    kTurnChangeMeasure,
    kSkewMeasure,         ///< angle with the other side's last segment
    kWidthMeasure,        ///< from the new vertex to the other side's last segment
    kWidthChangeMeasure,  ///< from that of the step before
    kAdvanceMeasure,      ///< of the new vertex before the other side's last one, along the lane
    // Vertices within 1.2 m and 0.6 m of the segment, and in the triangle that the lane grows by.
    kBesideMeasure,
    kCloseMeasure,
    kInsideMeasure,
    kStepMeasureCount
};
[[nodiscard]] const std::array<StepMeasure, kStepMeasureCount>& step_measures();

/// All that there are of a step; NaN for what it does not have.
using StepMeasures = std::array<double, kStepMeasureCount>;

/// What LaneBeam goes by: the scores of all measures, one behind the other.
struct StepScores {
    std::vector<double> values;

    [[nodiscard]] double score(const StepMeasures& step) const;
};
/// Of StepScores::values, all measures together and those of the ones before `measure`.
[[nodiscard]] std::size_t step_score_count(std::size_t measure = kStepMeasureCount);

/// Adds the derivatives of StepScores::score by the values, times `factor`.
void add_score_derivatives(const StepMeasures& step, double factor, std::span<double> derivatives);

/// Throws InvalidInput where there are not step_score_count() values or one is not finite.
void validate(const StepScores& scores);

/// Beam search for a lane, which Algorithm 2 then follows first. Beyond the paper.
///
/// Algorithm 2 goes back depth first: where one of its first vertices is false, all of its iterations may go
/// to what lies behind it. Here the lanes that grow vertex by vertex compete: of those with equally many
/// vertices the best `width` are kept, whatever pair they start from. A lane's score is the sum of learned
/// scores of its steps, each of which looks at the last vertices only; of lanes that end in the same last two
/// vertices a side only the best goes on. The side whose last vertex is behind the other's grows next. Of the
/// constraints only C_seg is looked at, and that a new vertex is more than w_min off the other side's last
/// segment: what comes out is a guide, not yet a lane.
class LaneBeam {
  public:
    struct State {
        std::array<Vertex, 2> last;
        std::array<Vertex, 2> before;  ///< the vertices before; `last` itself where there is none
        std::array<Point, 2>
            direction;  ///< unit vectors of the last segments; the heading where there is none
        std::array<double, 2> segment_m;  ///< lengths of the last segments; 0 where there is none
        std::array<double, 2> turn_rad;   ///< with sign, at `before`
        std::array<std::size_t, 2> vertices;
        double width_m;
        double length_m;  ///< of both sides
        double score;
        std::size_t parent;  ///< kNone: a starting pair
        Side pushed;         ///< the side that was extended to get here
        std::uint64_t bits;  ///< of the lane's vertices, see is_on_lane
        StepMeasures step;
    };
    static constexpr std::size_t kNone = ~std::size_t{0};

    /// The first level: the best `width` of the starting pairs. Keeps the references until the next call, and
    /// memory from call to call. Precondition: width > 0.
    void start(const SearchGraph& graph, const Scene& scene, std::span<const StartPair> starts,
               const StepScores& scores, const LaneBounds& bounds, std::size_t width);
    /// The next level; returns whether it has a state. Returns false and leaves the level where the budget is
    /// spent before.
    bool advance(SearchBudget& budget);
    /// All the levels to the last one, or as many as the budget's time and memory allow. Returns the state
    /// with the highest score among those with two vertices a side, kNone where there is none.
    std::size_t run(SearchBudget& budget);

    /// Best first.
    [[nodiscard]] std::span<const std::size_t> level() const { return level_; }
    [[nodiscard]] const State& state(std::size_t number) const { return states_[number]; }
    [[nodiscard]] PathPairVertices vertices(std::size_t number) const;
    /// The same in the place of what `vertices` holds.
    void vertices(std::size_t number, PathPairVertices& vertices) const;
    /// The side that the state grows by.
    [[nodiscard]] Side next_side(const State& state) const;

    /// For training, which keeps the right lane in the beam. Both return the number of the state, which is
    /// not on any level; `extend` kNone where the vertex cannot follow.
    std::size_t add_start(StartPair start);
    std::size_t extend(std::size_t number, Vertex vertex);
    /// Puts the state in the place of the whole level.
    void restart(std::size_t number) { level_.assign(1, number); }

  private:
    /// A step and what the state after it needs to know.
    struct Step {
        StepMeasures measures;
        Point direction;
        double segment_m;
        double turn_rad;
        double width_m;
    };
    /// A state that may follow; only those that go on are kept.
    struct Extension {
        double score;
        double length_m;
        std::size_t parent;
        Vertex vertex;  ///< none: the parent itself, a starting pair
        Vertex low;     ///< the last vertices of both sides
        Vertex high;
    };

    [[nodiscard]] bool is_on_lane(std::size_t number, Vertex vertex) const;
    /// Whether the vertex can follow on the side, and the step if so.
    [[nodiscard]] bool measure(std::size_t number, Side side, Vertex vertex, Step& step) const;
    /// Makes a level of those in `next_` that go on.
    void keep_best();
    /// Whether the level has a state that ends alike.
    [[nodiscard]] bool is_known(const Extension& extension) const;

    const SearchGraph* graph_ = nullptr;
    const Scene* scene_ = nullptr;
    const StepScores* scores_ = nullptr;
    LaneBounds bounds_;
    double turn_limit_ = 0.0;  ///< as turning_measure
    double first_turn_limit_ = 0.0;
    Point heading_{0.0, 0.0};
    std::size_t width_ = 0;
    std::vector<State> states_;
    std::vector<std::size_t> level_;
    std::vector<Extension> next_;
    Extension best_;  ///< of those with two vertices a side
};

}  // namespace conelane
