#include "graph_search/clc/lane_beam.hpp"

#include "conelane/invalid_input.hpp"
#include "graph_search/clc/neighbourhood.hpp"
#include "graph_search/clc/next_vertex.hpp"
#include "graph_search/clc/start_vertices.hpp"
#include "model/geometry.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <numeric>
#include <tuple>

namespace conelane {
namespace {

constexpr double kNotBetter = -std::numeric_limits<double>::infinity();
constexpr double kNotThere = std::numeric_limits<double>::quiet_NaN();

constexpr double kDegree = std::numbers::pi / 180.0;

constexpr std::array<StepMeasure, kStepMeasureCount> kMeasures{{
    {"start_width_m", 2.5, 0.5, 9},
    {"start_asymmetry_m", 0.0, 0.5, 13},
    {"start_distance_m", 0.0, 1.0, 9},
    {"start_lead", 0.0, 0.125, 9},
    {"steps", 0.0, 1.0, 1},
    {"segment_m", 0.5, 0.5, 20},
    {"segment_change_m", 0.0, 0.5, 16},
    {"first_turn_rad", 0.0, 10.0 * kDegree, 11},
    {"turn_rad", 0.0, 7.5 * kDegree, 13},
    {"turn_times_segment_rad_m", 0.0, 0.5, 13},
    {"turn_change_rad", 0.0, 7.5 * kDegree, 15},
    {"skew_rad", 0.0, 7.5 * kDegree, 15},
    {"width_m", 2.5, 0.5, 13},
    {"width_change_m", 0.0, 0.3, 12},
    {"advance_m", -3.0, 0.5, 27},
    {"beside", 0.0, 1.0, 4},
    {"close", 0.0, 1.0, 4},
    {"inside", 0.0, 1.0, 4},
}};

constexpr std::array<std::size_t, kStepMeasureCount + 1> offsets() {
    std::array<std::size_t, kStepMeasureCount + 1> result{};
    for (std::size_t i = 0; i < kStepMeasureCount; ++i) result[i + 1] = result[i] + kMeasures[i].scores;
    return result;
}
constexpr std::array<std::size_t, kStepMeasureCount + 1> kOffsets = offsets();

/// The two scores around a value; `share` is the weight of the second.
struct Place {
    std::size_t first;
    std::size_t second;
    double share;
};
Place place(std::size_t measure, double value) {
    const StepMeasure& table = kMeasures[measure];
    const auto last = static_cast<double>(table.scores - 1);
    const double at = std::clamp((value - table.first) / table.spacing, 0.0, last);
    const auto below = static_cast<std::size_t>(at);
    return {kOffsets[measure] + below, kOffsets[measure] + std::min(below + 1, table.scores - 1),
            at - static_cast<double>(below)};
}

/// A first segment may turn farther from the heading than later segments from each other, because the car
/// need not be parallel to the lane.
constexpr double kMaxFirstTurn_rad = 110.0 * kDegree;

constexpr Vertex kNoVertex = ~Vertex{0};

/// Bits of a state; beyond so many vertices some share a bit.
constexpr std::size_t kBits = 64 * std::tuple_size_v<decltype(LaneBeam::State::bits)>;

std::size_t word_of(Vertex vertex) {
    return vertex % kBits / 64;
}
std::uint64_t bit_of(Vertex vertex) {
    return std::uint64_t{1} << (vertex % 64);
}

}  // namespace

const std::array<StepMeasure, kStepMeasureCount>& step_measures() {
    return kMeasures;
}

std::size_t step_score_count(std::size_t measure) {
    return kOffsets[measure];
}

double StepScores::score(const StepMeasures& step) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < kStepMeasureCount; ++i) {
        if (std::isnan(step[i])) continue;
        const Place at = place(i, step[i]);
        sum += (1.0 - at.share) * values[at.first] + at.share * values[at.second];
    }
    return sum;
}

void add_score_derivatives(const StepMeasures& step, double factor, std::span<double> derivatives) {
    for (std::size_t i = 0; i < kStepMeasureCount; ++i) {
        if (std::isnan(step[i])) continue;
        const Place at = place(i, step[i]);
        derivatives[at.first] += factor * (1.0 - at.share);
        derivatives[at.second] += factor * at.share;
    }
}

void validate(const StepScores& scores) {
    if (scores.values.size() != step_score_count()) {
        throw InvalidInput("scores", "must have " + std::to_string(step_score_count()) + " entries");
    }
    for (std::size_t i = 0; i < scores.values.size(); ++i) {
        if (!std::isfinite(scores.values[i])) {
            throw InvalidInput("scores[" + std::to_string(i) + "]", "must be finite");
        }
    }
}

void LaneBeam::start(const SearchGraph& graph, const Scene& scene, std::span<const StartPair> starts,
                     const StepScores& scores, const LaneBounds& bounds, std::size_t width,
                     StepReach* reach) {
    graph_ = &graph;
    reach_ = reach;
    scene_ = &scene;
    scores_ = &scores;
    bounds_ = bounds;
    turn_limit_ = turning_measure(bounds.phi_max_rad);
    first_turn_limit_ = turning_measure(kMaxFirstTurn_rad);
    heading_ = scene.pose.heading();
    width_ = width;
    constexpr double kRounding = 1e-9;
    most_about_ = kRounding;
    for (const std::size_t measure : {kBesideMeasure, kCloseMeasure, kInsideMeasure}) {
        const auto first = scores.values.begin() + static_cast<std::ptrdiff_t>(kOffsets[measure]);
        most_about_ +=
            *std::max_element(first, first + static_cast<std::ptrdiff_t>(kMeasures[measure].scores));
    }
    states_.clear();
    best_ = {kNotBetter, 0.0, kNone, kNoVertex, kNoVertex, kNoVertex};
    next_.clear();
    for (const StartPair& start : starts) {
        const std::size_t number = add_start(start);
        const auto [low, high] = std::minmax(start.left, start.right);
        next_.push_back({states_[number].score, 0.0, number, kNoVertex, low, high});
    }
    keep_best();
}

bool LaneBeam::advance(SearchBudget& budget) {
    next_.clear();
    Step step;
    for (const std::size_t number : level_) {
        const State& from = states_[number];
        const Side side = next_side(from);
        const Vertex facing = from.last[opposite(side)];
        const bool is_lane = from.vertices[opposite(side)] > 1;
        const std::span<const Vertex> neighbours = graph_->neighbours(from.last[side]);
        const Point& tip = graph_->position(from.last[side]);
        const double reach_m2 =
            reach_ != nullptr ? reach_->squared_m2(from.last[side]) : std::numeric_limits<double>::infinity();
        // A test of membership walks back along the lane; looking around a segment visits all neighbours.
        const std::size_t work =
            10 + (from.vertices[kLeft] + from.vertices[kRight]) / 8 + neighbours.size() / 8;
        for (const Vertex vertex : neighbours) {
            if ((graph_->position(vertex) - tip).squaredNorm() > reach_m2) continue;
            if (budget.spend(work)) return false;
            if (!measure(number, side, vertex, step)) continue;
            const auto [low, high] = std::minmax(vertex, facing);
            Extension extension{score_after(number, step) + most_about_,
                                from.length_m + step.segment_m,
                                number,
                                vertex,
                                low,
                                high,
                                false};
            if (is_lane && extension.score > best_.score) {
                look_about(number, side, vertex, step);
                extension.score = score_after(number, step);
                extension.exact = true;
                if (extension.score > best_.score) best_ = extension;
            }
            next_.push_back(extension);
        }
    }
    keep_best();
    return !level_.empty() &&
           !budget.occupy(states_.size() * sizeof(State) + next_.size() * sizeof(Extension));
}

std::size_t LaneBeam::run(SearchBudget& budget) {
    while (advance(budget)) {
    }
    return best_.parent == kNone ? kNone : extend(best_.parent, best_.vertex);
}

PathPairVertices LaneBeam::vertices(std::size_t number) const {
    PathPairVertices both;
    vertices(number, both);
    return both;
}

void LaneBeam::vertices(std::size_t number, PathPairVertices& vertices) const {
    for (std::vector<Vertex>& side : vertices) side.clear();
    for (; states_[number].parent != kNone; number = states_[number].parent) {
        const State& state = states_[number];
        vertices[state.pushed].push_back(state.last[state.pushed]);
    }
    for (const Side side : {kLeft, kRight}) {
        vertices[side].push_back(states_[number].last[side]);
        std::ranges::reverse(vertices[side]);
    }
}

Side LaneBeam::next_side(const State& state) const {
    const Point along = state.direction[kLeft] + state.direction[kRight];
    const double left_before_right_m =
        (graph_->position(state.last[kLeft]) - graph_->position(state.last[kRight])).dot(along);
    if (left_before_right_m != 0.0) return left_before_right_m < 0.0 ? kLeft : kRight;
    if (state.vertices[kLeft] != state.vertices[kRight]) {
        return state.vertices[kLeft] < state.vertices[kRight] ? kLeft : kRight;
    }
    return state.last[kLeft] < state.last[kRight] ? kLeft : kRight;
}

std::size_t LaneBeam::add_start(StartPair start) {
    const StartPairMeasures measures = start_pair_measures(*scene_, start);
    const Point across = graph_->position(start.left) - graph_->position(start.right);
    State state{};
    state.last = {start.left, start.right};
    for (const Vertex vertex : {start.left, start.right}) state.bits[word_of(vertex)] |= bit_of(vertex);
    state.before = state.last;
    state.direction = {heading_, heading_};
    state.vertices = {1, 1};
    state.width_m = across.norm();
    state.parent = kNone;
    state.step.fill(kNotThere);
    state.step[kStartWidthMeasure] = state.width_m;
    state.step[kStartAsymmetryMeasure] = measures.asymmetry_m;
    state.step[kStartDistanceMeasure] = measures.distance_m;
    state.step[kStartLeadMeasure] = std::abs(across.dot(heading_)) / state.width_m;
    state.score = scores_->score(state.step);
    states_.push_back(state);
    return states_.size() - 1;
}

bool LaneBeam::measure(std::size_t number, Side side, Vertex vertex, Step& step) const {
    const State& from = states_[number];
    const Side facing = opposite(side);
    const Point& point = graph_->position(vertex);
    const Point& tip = graph_->position(from.last[side]);
    const Point& facing_tip = graph_->position(from.last[facing]);
    const Point segment = point - tip;
    const bool is_first = from.vertices[side] == 1;
    if (turning_measure(from.direction[side], segment) >= (is_first ? first_turn_limit_ : turn_limit_)) {
        return false;
    }
    step.width_m = foot_point(point, {graph_->position(from.before[facing]), facing_tip}).distance_m;
    if (step.width_m <= bounds_.w_min_m || is_on_lane(number, vertex)) return false;

    step.turn_rad = turning_angle(from.direction[side], segment);
    step.segment_m = segment.norm();
    step.direction = segment / step.segment_m;
    StepMeasures& measures = step.measures;
    measures.fill(kNotThere);
    measures[kStepsMeasure] = 0.0;
    measures[kSegmentMeasure] = step.segment_m;
    if (is_first) {
        measures[kFirstTurnMeasure] = std::abs(step.turn_rad);
    } else {
        measures[kTurnMeasure] = std::abs(step.turn_rad);
        measures[kTurnTimesSegmentMeasure] = std::abs(step.turn_rad) * step.segment_m;
        measures[kSegmentChangeMeasure] = std::abs(step.segment_m - from.segment_m[side]);
        if (from.vertices[side] > 2) {
            measures[kTurnChangeMeasure] = std::abs(step.turn_rad - from.turn_rad[side]);
        }
    }
    if (from.vertices[facing] > 1) {
        measures[kSkewMeasure] = std::abs(turning_angle(from.direction[facing], segment));
    }
    measures[kWidthMeasure] = step.width_m;
    measures[kWidthChangeMeasure] = std::abs(step.width_m - from.width_m);
    const Point along = step.direction + from.direction[facing];
    const double along_length = along.norm();
    measures[kAdvanceMeasure] = along_length == 0.0 ? 0.0 : (point - facing_tip).dot(along) / along_length;
    return true;
}

void LaneBeam::look_about(std::size_t number, Side side, Vertex vertex, Step& step) const {
    const State& from = states_[number];
    const Point& point = graph_->position(vertex);
    const Point& facing_tip = graph_->position(from.last[opposite(side)]);
    const Neighbourhood cones = neighbourhood(*graph_, from.last[side], graph_->position(from.last[side]),
                                              facing_tip, point, point, facing_tip);
    step.measures[kBesideMeasure] = cones.beside;
    step.measures[kCloseMeasure] = cones.close;
    step.measures[kInsideMeasure] = cones.inside;
}

std::size_t LaneBeam::extend(std::size_t number, Vertex vertex) {
    Step step;
    const Side side = next_side(states_[number]);
    if (!measure(number, side, vertex, step)) return kNone;
    look_about(number, side, vertex, step);
    State state = states_[number];
    state.before[side] = state.last[side];
    state.last[side] = vertex;
    state.bits[word_of(vertex)] |= bit_of(vertex);
    state.direction[side] = step.direction;
    state.segment_m[side] = step.segment_m;
    state.turn_rad[side] = step.turn_rad;
    ++state.vertices[side];
    state.width_m = step.width_m;
    state.length_m += step.segment_m;
    state.parent = number;
    state.pushed = side;
    state.step = step.measures;
    state.score += scores_->score(step.measures);
    states_.push_back(state);
    return states_.size() - 1;
}

bool LaneBeam::is_on_lane(std::size_t number, Vertex vertex) const {
    if ((states_[number].bits[word_of(vertex)] & bit_of(vertex)) == 0) return false;
    if (graph_->vertex_count() <= kBits) return true;
    for (; number != kNone; number = states_[number].parent) {
        const std::array<Vertex, 2>& last = states_[number].last;
        if (last[kLeft] == vertex || last[kRight] == vertex) return true;
    }
    return false;
}

void LaneBeam::keep_best() {
    // A heap, because only the first few are taken. Ties are decided by values that do not change when the
    // scene is mirrored. The first one's bound is replaced by its score, so scores are taken in their order.
    const auto is_worse = [](const Extension& a, const Extension& b) {
        return std::tuple(-a.score, a.exact, a.length_m, a.low, a.high) >
               std::tuple(-b.score, b.exact, b.length_m, b.low, b.high);
    };
    Step step;
    std::make_heap(next_.begin(), next_.end(), is_worse);
    level_.clear();
    while (!next_.empty() && level_.size() < width_) {
        std::pop_heap(next_.begin(), next_.end(), is_worse);
        Extension extension = next_.back();
        next_.pop_back();
        if (is_known(extension)) continue;
        if (extension.exact) {
            level_.push_back(extension.vertex == kNoVertex ? extension.parent
                                                           : extend(extension.parent, extension.vertex));
            continue;
        }
        const Side side = next_side(states_[extension.parent]);
        (void)measure(extension.parent, side, extension.vertex, step);
        look_about(extension.parent, side, extension.vertex, step);
        extension.score = score_after(extension.parent, step);
        extension.exact = true;
        next_.push_back(extension);
        std::push_heap(next_.begin(), next_.end(), is_worse);
    }
}

bool LaneBeam::is_known(const Extension& extension) const {
    const State& from = states_[extension.parent];
    std::array<Vertex, 2> last = from.last;
    std::array<Vertex, 2> before = from.before;
    if (extension.vertex != kNoVertex) {
        const Side side = next_side(from);
        before[side] = last[side];
        last[side] = extension.vertex;
    }
    // States with a segment on each side and the same last vertices have the same continuations.
    return std::ranges::any_of(level_, [&](std::size_t better) {
        return states_[better].last == last && states_[better].before == before;
    });
}

}  // namespace conelane
