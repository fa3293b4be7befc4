#include "graph_search/lane_beam.hpp"

#include "graph_search/next_vertex.hpp"
#include "graph_search/start_vertices.hpp"
#include "model/geometry.hpp"
#include "model/invalid_input.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <tuple>

namespace conelane {
namespace {

constexpr double kNotThere = std::numeric_limits<double>::quiet_NaN();

constexpr double kDegree = std::numbers::pi / 180.0;

constexpr std::array<StepMeasure, kStepMeasureCount> kMeasures{{
    {"start_width_m", 2.5, 0.5, 9},
    {"start_asymmetry_m", 0.0, 0.5, 13},
    {"start_distance_m", 0.0, 1.0, 9},
    {"start_lead", 0.0, 0.125, 9},
    {"steps", 0.0, 1.0, 1},
    {"segment_m", 0.5, 0.5, 11},
    {"segment_change_m", 0.0, 0.5, 10},
    {"first_turn_rad", 0.0, 10.0 * kDegree, 11},
    {"turn_rad", 0.0, 7.5 * kDegree, 13},
    {"turn_times_segment_rad_m", 0.0, 0.5, 13},
    {"turn_change_rad", 0.0, 7.5 * kDegree, 15},
    {"skew_rad", 0.0, 7.5 * kDegree, 15},
    {"width_m", 2.5, 0.5, 13},
    {"width_change_m", 0.0, 0.3, 12},
    {"advance_m", -3.0, 0.5, 19},
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

/// The two scores that a value stands between, of which `share` belongs to the second.
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

/// A first segment may turn farther from the heading than two segments from each other: the car need not
/// stand along the lane.
constexpr double kLargestFirstTurn_rad = 110.0 * kDegree;

constexpr double kBeside_m = 1.2;
constexpr double kClose_m = 0.6;

bool is_inside(const Point& point, const Point& a, const Point& b, const Point& c) {
    const double at_ab = cross(b - a, point - a);
    const double at_bc = cross(c - b, point - b);
    const double at_ca = cross(a - c, point - c);
    return (at_ab > 0.0 && at_bc > 0.0 && at_ca > 0.0) || (at_ab < 0.0 && at_bc < 0.0 && at_ca < 0.0);
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
                     const StepScores& scores, const LaneBounds& bounds, std::size_t width) {
    graph_ = &graph;
    scene_ = &scene;
    scores_ = &scores;
    bounds_ = bounds;
    turn_limit_ = turning_measure(bounds.phi_max_rad);
    first_turn_limit_ = turning_measure(kLargestFirstTurn_rad);
    heading_ = scene.pose.heading();
    width_ = width;
    states_.clear();
    next_.clear();
    for (const StartPair& start : starts) next_.push_back(add_start(start));
    keep_best();
}

bool LaneBeam::advance() {
    next_.clear();
    for (const std::size_t number : level_) {
        const Vertex tip = states_[number].last[next_side(states_[number])];
        for (const Vertex vertex : graph_->neighbours(tip)) {
            const std::size_t extended = extend(number, vertex);
            if (extended != kNone) next_.push_back(extended);
        }
    }
    keep_best();
    return !level_.empty();
}

std::size_t LaneBeam::run() {
    while (advance()) {
    }
    std::size_t best = kNone;
    for (std::size_t i = 0; i < states_.size(); ++i) {
        const State& state = states_[i];
        if (state.vertices[kLeft] < 2 || state.vertices[kRight] < 2) continue;
        if (best == kNone || state.score > states_[best].score) best = i;
    }
    return best;
}

PathPairVertices LaneBeam::vertices(std::size_t number) const {
    PathPairVertices vertices;
    for (; states_[number].parent != kNone; number = states_[number].parent) {
        const State& state = states_[number];
        vertices[state.pushed].push_back(state.last[state.pushed]);
    }
    for (const Side side : {kLeft, kRight}) {
        vertices[side].push_back(states_[number].last[side]);
        std::ranges::reverse(vertices[side]);
    }
    return vertices;
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
    const auto [asymmetry_m, distance_m] = start_pair_measures(*scene_, start);
    const Point across = graph_->position(start.left) - graph_->position(start.right);
    State state{};
    state.last = {start.left, start.right};
    state.before = state.last;
    state.direction = {heading_, heading_};
    state.vertices = {1, 1};
    state.width_m = across.norm();
    state.parent = kNone;
    state.step.fill(kNotThere);
    state.step[kStartWidthMeasure] = state.width_m;
    state.step[kStartAsymmetryMeasure] = asymmetry_m;
    state.step[kStartDistanceMeasure] = distance_m;
    state.step[kStartLeadMeasure] = std::abs(across.dot(heading_)) / state.width_m;
    state.score = scores_->score(state.step);
    states_.push_back(state);
    return states_.size() - 1;
}

std::size_t LaneBeam::extend(std::size_t number, Vertex vertex) {
    const State& from = states_[number];
    const Side side = next_side(from);
    const Side facing = opposite(side);
    const Point& point = graph_->position(vertex);
    const Point& tip = graph_->position(from.last[side]);
    const Point& facing_tip = graph_->position(from.last[facing]);
    const Point segment = point - tip;
    const bool is_first = from.vertices[side] == 1;
    if (turning_measure(from.direction[side], segment) >= (is_first ? first_turn_limit_ : turn_limit_)) {
        return kNone;
    }
    const double width_m = foot_point(point, {graph_->position(from.before[facing]), facing_tip}).distance_m;
    if (width_m <= bounds_.w_min_m || is_on_lane(number, vertex)) return kNone;

    State state = from;
    const double turn_rad = turning_angle(from.direction[side], segment);
    const double segment_m = segment.norm();
    state.before[side] = from.last[side];
    state.last[side] = vertex;
    state.direction[side] = segment / segment_m;
    state.segment_m[side] = segment_m;
    state.turn_rad[side] = turn_rad;
    ++state.vertices[side];
    state.width_m = width_m;
    state.length_m += segment_m;
    state.parent = number;
    state.pushed = side;

    StepMeasures& step = state.step;
    step.fill(kNotThere);
    step[kStepsMeasure] = 0.0;
    step[kSegmentMeasure] = segment_m;
    if (is_first) {
        step[kFirstTurnMeasure] = std::abs(turn_rad);
    } else {
        step[kTurnMeasure] = std::abs(turn_rad);
        step[kTurnTimesSegmentMeasure] = std::abs(turn_rad) * segment_m;
        step[kSegmentChangeMeasure] = std::abs(segment_m - from.segment_m[side]);
        if (from.vertices[side] > 2) step[kTurnChangeMeasure] = std::abs(turn_rad - from.turn_rad[side]);
    }
    if (from.vertices[facing] > 1) {
        step[kSkewMeasure] = std::abs(turning_angle(from.direction[facing], segment));
    }
    step[kWidthMeasure] = width_m;
    step[kWidthChangeMeasure] = std::abs(width_m - from.width_m);
    const Point along = state.direction[side] + state.direction[facing];
    const double along_length = along.norm();
    step[kAdvanceMeasure] = along_length == 0.0 ? 0.0 : (point - facing_tip).dot(along) / along_length;
    measure_surroundings(from, side, vertex, step);
    state.score += scores_->score(step);
    states_.push_back(state);
    return states_.size() - 1;
}

void LaneBeam::measure_surroundings(const State& state, Side side, Vertex vertex, StepMeasures& step) const {
    const Point& point = graph_->position(vertex);
    const Point& tip = graph_->position(state.last[side]);
    const Vertex facing = state.last[opposite(side)];
    const Point segment = point - tip;
    const double segment_m = segment.norm();
    const Point direction = segment / segment_m;
    step[kBesideMeasure] = step[kCloseMeasure] = step[kInsideMeasure] = 0.0;
    for (const Vertex other : graph_->neighbours(state.last[side])) {
        if (other == vertex || other == facing) continue;
        const Point& position = graph_->position(other);
        if (is_inside(position, tip, graph_->position(facing), point)) step[kInsideMeasure] += 1.0;
        const Point offset = position - tip;
        const double along_m = offset.dot(direction);
        if (along_m <= 0.0 || along_m >= segment_m) continue;
        const double across_m = std::abs(cross(direction, offset));
        if (across_m < kBeside_m) step[kBesideMeasure] += 1.0;
        if (across_m < kClose_m) step[kCloseMeasure] += 1.0;
    }
}

bool LaneBeam::is_on_lane(std::size_t number, Vertex vertex) const {
    for (; number != kNone; number = states_[number].parent) {
        const std::array<Vertex, 2>& last = states_[number].last;
        if (last[kLeft] == vertex || last[kRight] == vertex) return true;
    }
    return false;
}

void LaneBeam::keep_best() {
    // Of equal scores by what does not change where the scene is mirrored.
    std::ranges::sort(next_, {}, [&](std::size_t number) {
        const State& state = states_[number];
        const auto [low, high] = std::minmax(state.last[kLeft], state.last[kRight]);
        return std::tuple(-state.score, state.length_m, low, high);
    });
    level_.clear();
    for (const std::size_t number : next_) {
        if (level_.size() == width_) break;
        const State& state = states_[number];
        // With a segment on each side, whatever goes on from there goes on alike.
        const bool is_known = std::ranges::any_of(level_, [&](std::size_t better) {
            const State& other = states_[better];
            return other.last == state.last && other.before == state.before;
        });
        if (!is_known) level_.push_back(number);
    }
}

}  // namespace conelane
