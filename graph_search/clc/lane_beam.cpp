#include "graph_search/clc/lane_beam.hpp"

#include "conelane/invalid_input.hpp"
#include "graph_search/clc/start_vertices.hpp"

#include <tuple>
#include <utility>

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

/// The scores of a measure.
std::span<const double> scores_of(const StepScores& scores, std::size_t measure) {
    return std::span(scores.values).subspan(kOffsets[measure], kMeasures[measure].scores);
}
double most(const StepScores& scores, std::size_t measure) {
    return std::ranges::max(scores_of(scores, measure));
}
/// The largest change of a score by a change of its measure by 1.
double steepest(const StepScores& scores, std::size_t measure) {
    const std::span<const double> values = scores_of(scores, measure);
    double change = 0.0;
    for (std::size_t i = 1; i < values.size(); ++i)
        change = std::max(change, std::abs(values[i] - values[i - 1]));
    return change / kMeasures[measure].spacing;
}

/// The score of one measure up to rounding, without a division.
template <std::size_t measure>
double nearly_score(const double* values, double value) {
    constexpr StepMeasure kTable = kMeasures[measure];
    constexpr double kPerSpacing = 1.0 / kTable.spacing;
    constexpr auto kLast = static_cast<double>(kTable.scores - 1);
    const double at = std::min(std::max((value - kTable.first) * kPerSpacing, 0.0), kLast);
    const auto below = static_cast<std::int32_t>(std::min(at, kLast - 1.0));
    const double* const score = values + kOffsets[measure] + below;
    return score[0] + (at - below) * (score[1] - score[0]);
}

/// A first segment may turn farther from the heading than later segments from each other, because the car
/// need not be parallel to the lane.
constexpr double kMaxFirstTurn_rad = 110.0 * kDegree;

constexpr Vertex kNoVertex = ~Vertex{0};

/// A hash of 32 bits is shifted by this to a place in LaneBeam::neighbourhoods_.
constexpr unsigned kNeighbourhoodShift = 22;

/// Bits of a state; beyond so many vertices some share a bit.
constexpr std::size_t kBits = decltype(LaneBeam::State::bits){}.size();

}  // namespace

const std::array<StepMeasure, kStepMeasureCount>& step_measures() {
    return kMeasures;
}

std::size_t step_score_count(std::size_t measure) {
    return kOffsets[measure];
}

double StepScores::score(const StepMeasures& step) const {
    double sum = 0.0;
    const auto add = [&](std::size_t measure) {
        if (std::isnan(step[measure])) return;
        const Place at = place(measure, step[measure]);
        sum += (1.0 - at.share) * values[at.first] + at.share * values[at.second];
    };
    // Unrolled, so that the tables are constants.
    [&]<std::size_t... measure>(std::index_sequence<measure...>) {
        (add(measure), ...);
    }
    (std::make_index_sequence<kStepMeasureCount>());
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
    double largest = 1.0;
    for (const double value : scores.values) largest = std::max(largest, std::abs(value));
    slack_ = kRounding * largest + scores_of(scores, kStepsMeasure)[0];
    for (const std::size_t measure : {kBesideMeasure, kCloseMeasure, kInsideMeasure})
        slack_ += most(scores, measure);
    for (const std::size_t measure : {kFirstTurnMeasure, kTurnMeasure, kTurnChangeMeasure, kSkewMeasure})
        slack_ += kNearlyAngle_rad * steepest(scores, measure);
    slack_per_m_ = kNearlyAngle_rad * steepest(scores, kTurnTimesSegmentMeasure);
    if (reach_ == nullptr) all_.reset(graph, 0);
    neighbourhoods_.assign(std::size_t{1} << (32U - kNeighbourhoodShift),
                           {{kNoVertex, kNoVertex, kNoVertex}, {}});
    continuations_.clear();
    after_first_.assign(graph.vertex_count(), {kUnknown, kUnknown});
    after_edge_.assign(graph.directed_edge_count(), {kUnknown, kUnknown});
    states_.clear();
    const Extension none{.parent = kNone, .vertex = kNoVertex, .low = kNoVertex, .high = kNoVertex};
    best_ = none;
    best_.score = kNotBetter;
    next_.clear();
    for (const StartPair& start : starts) {
        const std::size_t number = add_start(start);
        const auto [low, high] = std::minmax(start.left, start.right);
        next_.push_back({.score = states_[number].score,
                         .parent = number,
                         .vertex = kNoVertex,
                         .low = low,
                         .high = high});
    }
    keep_best();
}

bool LaneBeam::advance(SearchBudget& budget) {
    next_.clear();
    for (const std::size_t number : level_) {
        const State& from = states_[number];
        const Side side = next_side(from);
        const Vertex facing = from.last[opposite(side)];
        const bool is_lane = from.vertices[opposite(side)] > 1;
        const std::size_t neighbours = graph_->neighbours(from.last[side]).size();
        if (budget.spend(neighbours)) return false;
        // A test of membership walks back along the lane; looking around a segment visits all neighbours.
        const std::size_t work = 10 + (from.vertices[kLeft] + from.vertices[kRight]) / 8 + neighbours / 8;
        const auto [begin, end] = continuations(from, side);
        for (std::uint32_t i = begin; i != end; ++i) {
            if (budget.spend(work)) return false;
            const Continuation& step = continuations_[i];
            double width_m = 0.0;
            if (!has_room(number, side, step.vertex, width_m)) continue;
            const auto [low, high] = std::minmax(step.vertex, facing);
            next_.push_back({.score = bound_after(from, side, step, width_m),
                             .length_m = from.length_m + step.segment_m,
                             .width_m = width_m,
                             .parent = number,
                             .vertex = step.vertex,
                             .low = low,
                             .high = high,
                             .step = i,
                             .exact = false,
                             .is_lane = is_lane,
                             .side = side});
        }
    }
    keep_best();
    return !level_.empty() &&
           !budget.occupy(states_.size() * sizeof(State) + next_.size() * sizeof(Extension) +
                          continuations_.size() * sizeof(Continuation) + after_edge_.size() * sizeof(Range));
}

std::size_t LaneBeam::run(SearchBudget& budget) {
    while (advance(budget)) {
    }
    return best_.parent == kNone ? kNone : extend(best_.parent, best_.vertex);
}

PathPairVertices LaneBeam::vertices(std::size_t number, PathPairVertices vertices) const {
    for (std::vector<Vertex>& side : vertices) side.clear();
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
    const StartPairMeasures measures = start_pair_measures(*scene_, start);
    const Point across = graph_->position(start.left) - graph_->position(start.right);
    State state{};
    state.last = {start.left, start.right};
    for (const Vertex vertex : {start.left, start.right}) state.bits.set(vertex % kBits);
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

bool LaneBeam::turns_to(const State& from, Side side, Vertex vertex, Continuation& next) const {
    const double* const values = scores_->values.data();
    const bool is_first = from.vertices[side] == 1;
    next.vertex = vertex;
    next.segment = graph_->position(vertex) - graph_->position(from.last[side]);
    const double turning = turning_measure(from.direction[side], next.segment);
    if (turning >= (is_first ? first_turn_limit_ : turn_limit_)) return false;
    next.segment_m = next.segment.norm();
    next.direction = next.segment / next.segment_m;
    const double turn_rad = nearly_angle_rad(turning);
    next.turn_rad = kNotThere;
    next.nearly_turn_rad = std::copysign(turn_rad, cross(from.direction[side], next.segment));
    next.bound = slack_ + slack_per_m_ * next.segment_m +
                 nearly_score<kSegmentMeasure>(values, next.segment_m) +
                 (is_first ? nearly_score<kFirstTurnMeasure>(values, turn_rad)
                           : nearly_score<kTurnMeasure>(values, turn_rad) +
                                 nearly_score<kTurnTimesSegmentMeasure>(values, turn_rad * next.segment_m) +
                                 nearly_score<kSegmentChangeMeasure>(
                                     values, std::abs(next.segment_m - from.segment_m[side])));
    return true;
}

LaneBeam::Range LaneBeam::continuations(const State& from, Side side) {
    const Vertex tip = from.last[side];
    Range unknown{kUnknown, kUnknown};
    Range* range = &unknown;
    if (from.vertices[side] == 1) {
        range = &after_first_[tip];
    } else {
        const std::span<const Vertex> neighbours = graph_->neighbours(from.before[side]);
        const auto place = std::ranges::lower_bound(neighbours, tip);
        // Training may go on to a vertex that is no neighbour.
        if (place != neighbours.end() && *place == tip) {
            range = &after_edge_[graph_->first_edge(from.before[side]) +
                                 static_cast<std::size_t>(place - neighbours.begin())];
        }
    }
    if (range->begin == kUnknown) {
        range->begin = static_cast<std::uint32_t>(continuations_.size());
        const std::span<const Vertex> neighbours = graph_->neighbours(tip);
        Continuation next;
        for (const std::uint32_t place : (reach_ != nullptr ? *reach_ : all_).steps(tip)) {
            if (turns_to(from, side, neighbours[place], next)) continuations_.push_back(next);
        }
        range->end = static_cast<std::uint32_t>(continuations_.size());
    }
    return *range;
}

bool LaneBeam::has_room(std::size_t number, Side side, Vertex vertex, double& width_m) const {
    const State& from = states_[number];
    const Side facing = opposite(side);
    width_m = foot_point(graph_->position(vertex),
                         {graph_->position(from.before[facing]), graph_->position(from.last[facing])})
                  .distance_m;
    return width_m > bounds_.w_min_m && !is_on_lane(number, vertex);
}

double LaneBeam::bound_after(const State& from, Side side, const Continuation& next, double width_m) const {
    const Side facing = opposite(side);
    const double* const values = scores_->values.data();
    double bound = from.score + next.bound;
    if (from.vertices[side] > 2) {
        bound +=
            nearly_score<kTurnChangeMeasure>(values, std::abs(next.nearly_turn_rad - from.turn_rad[side]));
    }
    if (from.vertices[facing] > 1) {
        bound += nearly_score<kSkewMeasure>(
            values, nearly_angle_rad(turning_measure(from.direction[facing], next.segment)));
    }
    bound += nearly_score<kWidthMeasure>(values, width_m);
    bound += nearly_score<kWidthChangeMeasure>(values, std::abs(width_m - from.width_m));
    return bound + nearly_score<kAdvanceMeasure>(values, advance_m(from, facing, next));
}

double LaneBeam::advance_m(const State& from, Side facing, const Continuation& next) const {
    const Point along = next.direction + from.direction[facing];
    const double along_length = along.norm();
    const Point from_facing = graph_->position(next.vertex) - graph_->position(from.last[facing]);
    return along_length == 0.0 ? 0.0 : from_facing.dot(along) / along_length;
}

void LaneBeam::measure(const State& from, Side side, Continuation& next, double width_m, Step& step) {
    const Side facing = opposite(side);
    step.vertex = next.vertex;
    step.direction = next.direction;
    step.segment_m = next.segment_m;
    if (std::isnan(next.turn_rad)) next.turn_rad = turning_angle(from.direction[side], next.segment);
    step.turn_rad = next.turn_rad;
    step.width_m = width_m;
    StepMeasures& measures = step.measures;
    measures.fill(kNotThere);
    measures[kStepsMeasure] = 0.0;
    measures[kSegmentMeasure] = step.segment_m;
    if (from.vertices[side] == 1) {
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
        measures[kSkewMeasure] = std::abs(turning_angle(from.direction[facing], next.segment));
    }
    measures[kWidthMeasure] = step.width_m;
    measures[kWidthChangeMeasure] = std::abs(step.width_m - from.width_m);
    measures[kAdvanceMeasure] = advance_m(from, facing, next);
    const Neighbourhood& cones = cones_around(from.last[side], next.vertex, from.last[facing]);
    measures[kBesideMeasure] = cones.beside;
    measures[kCloseMeasure] = cones.close;
    measures[kInsideMeasure] = cones.inside;
}

const Neighbourhood& LaneBeam::cones_around(Vertex tip, Vertex vertex, Vertex facing) {
    const std::array<Vertex, 3> vertices{tip, vertex, facing};
    KnownNeighbourhood& known =
        neighbourhoods_[(tip * 0x9e3779b1U ^ vertex * 0x85ebca6bU ^ facing * 0xc2b2ae35U) >>
                        kNeighbourhoodShift];
    if (known.vertices != vertices) {
        known = {vertices, neighbourhood(*graph_, tip,
                                         {.tip = graph_->position(tip),
                                          .point = graph_->position(vertex),
                                          .facing = graph_->position(facing),
                                          .leaves_ends_out = true})};
    }
    return known.cones;
}

std::size_t LaneBeam::extend(std::size_t number, Vertex vertex) {
    const State& from = states_[number];
    const Side side = next_side(from);
    Continuation next;
    double width_m = 0.0;
    if (!turns_to(from, side, vertex, next) || !has_room(number, side, vertex, width_m)) return kNone;
    Step step;
    measure(from, side, next, width_m, step);
    return add_state(number, side, step, from.score + scores_->score(step.measures));
}

std::size_t LaneBeam::add_state(std::size_t number, Side side, const Step& step, double score) {
    State state = states_[number];
    state.before[side] = state.last[side];
    state.last[side] = step.vertex;
    state.bits.set(step.vertex % kBits);
    state.direction[side] = step.direction;
    state.segment_m[side] = step.segment_m;
    state.turn_rad[side] = step.turn_rad;
    ++state.vertices[side];
    state.width_m = step.width_m;
    state.length_m += step.segment_m;
    state.parent = number;
    state.pushed = side;
    state.step = step.measures;
    state.score = score;
    states_.push_back(state);
    return states_.size() - 1;
}

bool LaneBeam::is_on_lane(std::size_t number, Vertex vertex) const {
    if (!states_[number].bits[vertex % kBits]) return false;
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
        return std::tuple(a.exact, a.length_m, a.low, a.high) >
               std::tuple(b.exact, b.length_m, b.low, b.high);
    };
    const auto is_behind = [&](const Ranked& a, const Ranked& b) {
        return a.score != b.score ? a.score < b.score : is_worse(next_[a.number], next_[b.number]);
    };
    Step step;
    heap_.clear();
    for (const Extension& extension : next_)
        heap_.push_back({extension.score, static_cast<std::uint32_t>(heap_.size())});
    std::ranges::make_heap(heap_, is_behind);
    level_.clear();
    steps_.clear();
    while (!heap_.empty()) {
        // The level may be full of states that are no lanes yet.
        const bool is_full = level_.size() == width_;
        if (is_full && heap_.front().score <= best_.score) break;
        std::ranges::pop_heap(heap_, is_behind);
        Ranked& last = heap_.back();
        Extension& extension = next_[last.number];
        if ((is_full && !extension.is_lane) || is_known(extension)) {
            heap_.pop_back();
            continue;
        }
        const std::size_t parent = extension.parent;
        const Side side = extension.side;
        if (extension.exact) {
            heap_.pop_back();
            if (extension.is_lane && extension.score > best_.score) best_ = extension;
            if (is_full) continue;
            level_.push_back(extension.vertex == kNoVertex
                                 ? parent
                                 : add_state(parent, side, steps_[extension.step], extension.score));
            continue;
        }
        const State& from = states_[parent];
        measure(from, side, continuations_[extension.step], extension.width_m, step);
        extension.score = last.score = from.score + scores_->score(step.measures);
        extension.exact = true;
        extension.step = static_cast<std::uint32_t>(steps_.size());
        steps_.push_back(step);
        std::ranges::push_heap(heap_, is_behind);
    }
}

bool LaneBeam::is_known(const Extension& extension) const {
    const State& from = states_[extension.parent];
    std::array<Vertex, 2> last = from.last;
    std::array<Vertex, 2> before = from.before;
    if (extension.vertex != kNoVertex) {
        before[extension.side] = last[extension.side];
        last[extension.side] = extension.vertex;
    }
    // States with a segment on each side and the same last vertices have the same continuations.
    return std::ranges::any_of(level_, [&](std::size_t better) {
        return states_[better].last == last && states_[better].before == before;
    });
}

}  // namespace conelane
