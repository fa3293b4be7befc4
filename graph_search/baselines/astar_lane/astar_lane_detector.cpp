#include "graph_search/baselines/astar_lane/astar_lane_detector.hpp"

#include "graph_search/baselines/astar_lane/path_boundaries.hpp"
#include "graph_search/shared/search_budget.hpp"
#include "graph_search/shared/search_graph.hpp"
#include "model/geometry.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <unordered_set>
#include <utility>
#include <vector>

namespace conelane {
namespace {

using P = AstarLaneParameters;

constexpr std::array kFields{
    ParameterField<P>{"least_radius_m", &P::least_radius_m, "m", 2.5, 8.0, false, "of the tightest turn"},
    ParameterField<P>{"horizon_m", &P::horizon_m, "m", 10.0, 60.0, false, "length of a path"},
    ParameterField<P>{"w_end", &P::w_end, "1", 0.1, 2.0, true, "of each metre short of the horizon"},
    ParameterField<P>{"w_turn", &P::w_turn, "1", 0.001, 10.0, true, "weight of the curvature"},
    ParameterField<P>{"w_steer", &P::w_steer, "1", 0.001, 10.0, true, "weight of its change"},
    ParameterField<P>{"clearance_m", &P::clearance_m, "m", 0.8, 2.5, false, "kept from cones"},
    ParameterField<P>{"w_clearance", &P::w_clearance, "1", 0.1, 100.0, true, "weight of missing clearance"},
    ParameterField<P>{"w_hit", &P::w_hit, "1", 1.0, 1000.0, true, "of a metre too near to a cone"},
    ParameterField<P>{"window_m", &P::window_m, "m", 1.0, 5.0, false, "reach of `beside` along the path"},
    ParameterField<P>{"widest_side_m", &P::widest_side_m, "m", 2.0, 6.5, false, "reach of `beside` across"},
    ParameterField<P>{"expected_width_m", &P::expected_width_m, "m", 2.5, 6.5, false, "of the lane"},
    ParameterField<P>{"w_width", &P::w_width, "1/m^2", 0.001, 10.0, true, "weight of the width's error"},
    ParameterField<P>{"w_slope", &P::w_slope, "1", 0.1, 100.0, true, "weight of a boundary's slope"},
    ParameterField<P>{"heuristic", &P::heuristic, "1/m", 0.0, 1.0, false, "estimated cost ahead"},
};
constexpr std::int64_t kMaxSteps = 1'000'000;

/// Length of an arc, and width of a cell of the lattice [m].
constexpr double kStep_m = 1.5;
constexpr double kCell_m = 0.5;
/// Half the width of a car [m]: a path hits nearer cones.
constexpr double kCarHalfWidth_m = 0.75;
/// Curvatures are -2 to 2 times half the largest one. A heading is counted in the same units, a step's turn.
constexpr int kHardestTurn = 2;
/// Distance between the samples of a path from which boundaries are read [m].
constexpr double kSample_m = 0.25;
/// Number of paths tried for boundaries; later paths hardly differ.
constexpr int kMaxReadings = 50;
/// Work that reading boundaries may still do after the time has ended.
constexpr double kLastReading_ms = 2.0;
/// A lane has at least two cones a side.
constexpr std::size_t kMinPlaces = 4;

struct Node {
    std::int32_t parent;
    std::int32_t steps;    ///< from the car
    std::int32_t heading;  ///< in units
    std::int32_t turn;     ///< of the step that led here
    Point position;        ///< in the frame of the car
    double cost;
};

/// An entry of the open list; an `end` is a path that stops at its node.
struct Open {
    double estimate;
    std::int32_t node;
    bool end;
};

/// The heap's top is the next entry: the lowest estimate; of equal ones the latest, which has come
/// farthest.
struct TakenLater {
    bool operator()(const Open& a, const Open& b) const {
        if (a.estimate != b.estimate) return a.estimate > b.estimate;
        return a.node != b.node ? a.node < b.node : a.end < b.end;
    }
};

Point direction_of(double angle_rad) {
    return {std::cos(angle_rad), std::sin(angle_rad)};
}

class AstarLaneDetector : public LaneDetector {
  public:
    explicit AstarLaneDetector(const AstarLaneParameters& parameters) : parameters_(parameters) {
        validate(parameters);
        unit_rad_ = kStep_m / parameters.least_radius_m / kHardestTurn;
        last_step_ = static_cast<std::int32_t>(std::ceil(parameters.horizon_m / kStep_m));
        radius_m_ = std::max(std::hypot(parameters.window_m, parameters.widest_side_m),
                             std::max(parameters.clearance_m, kCarHalfWidth_m));
    }

  private:
    LaneAnswer search(const Scene& scene, const DetectionLimits& limits) override {
        SearchBudget budget;
        budget.deadline = Deadline(limits.time_limit_ms);
        budget.iteration_limit = parameters_.max_steps;
        boundaries_.reset();
        LaneAnswer answer;
        bool complete = false;
        if (!budget.read_clock()) {
            keep_near_cones(scene);
            complete = !has_enough_places() || find_path(budget);
        }
        answer.stopped_by = budget.stopped_by;
        if (boundaries_) {
            answer.status = LaneStatus::found;
            answer.lane = lane(scene);
        } else if (complete) {
            answer.status = LaneStatus::none;
        } else {
            answer.status = LaneStatus::stopped;
            if (!answer.stopped_by) answer.stopped_by = StopReason::iterations;
        }
        return answer;
    }

    void keep_near_cones(const Scene& scene) {
        points_.clear();
        cones_.clear();
        const double reach_m = (last_step_ + 1) * kStep_m + radius_m_;
        for (std::uint32_t i = 0; i < scene.cones.size(); ++i) {
            const Point& position = scene.cones[i].position;
            if (!((position - scene.pose.position).norm() <= reach_m)) continue;
            points_.emplace_back(scene.pose.ahead_m(position), scene.pose.left_m(position));
            cones_.push_back(i);
        }
        near_.build(points_, reach_m * (1.0 + 1e-9), radius_m_);
    }

    [[nodiscard]] bool has_enough_places() const {
        std::vector<Point> places;
        for (const Point& point : points_) {
            if (std::ranges::find(places, point) == places.end()) places.push_back(point);
            if (places.size() >= kMinPlaces) return true;
        }
        return false;
    }

    /// Takes paths in the order of their estimates until one has boundaries. Returns whether the search is
    /// complete: it found boundaries, or it met all paths.
    bool find_path(SearchBudget& budget) {
        nodes_.assign(1, Node{-1, 0, 0, 0, {0.0, 0.0}, 0.0});
        open_.clear();
        closed_.clear();
        put({estimate(nodes_.front()), 0, false});
        int readings = 0;
        while (!open_.empty()) {
            std::ranges::pop_heap(open_, TakenLater{});
            const Open taken = open_.back();
            open_.pop_back();
            const Node node = nodes_[static_cast<std::size_t>(taken.node)];
            if (taken.end) {
                if (read_boundaries(taken.node, budget)) return true;
                if (++readings >= kMaxReadings || budget.stopped_by) return false;
                continue;
            }
            if (!closed_.insert(key_of(node)).second) continue;
            put({node.cost + parameters_.w_end * remaining_m(node), taken.node, true});
            if (node.steps >= last_step_) continue;
            ++budget.iterations;
            if (budget.spent() || budget.occupy(occupied_bytes())) {
                read_best_so_far(budget);
                return false;
            }
            for (int turn = -kHardestTurn; turn <= kHardestTurn; ++turn) step(taken.node, turn, budget);
        }
        return true;
    }

    /// The search was interrupted: of the paths met, take the one that would cost least if it ended here.
    void read_best_so_far(const SearchBudget& budget) {
        SearchBudget reading;
        if (budget.stopped_by) reading.deadline = Deadline(kLastReading_ms);
        const auto end_cost = [this](const Node& node) {
            return node.cost + parameters_.w_end * remaining_m(node);
        };
        const auto best = std::ranges::min_element(nodes_, {}, end_cost);
        (void)read_boundaries(static_cast<std::int32_t>(best - nodes_.begin()), reading);
    }

    void put(const Open& entry) {
        open_.push_back(entry);
        std::ranges::push_heap(open_, TakenLater{});
    }

    [[nodiscard]] double remaining_m(const Node& node) const {
        return kStep_m * static_cast<double>(last_step_ - node.steps);
    }
    [[nodiscard]] double estimate(const Node& node) const {
        return node.cost + std::min(parameters_.heuristic, parameters_.w_end) * remaining_m(node);
    }
    [[nodiscard]] std::size_t occupied_bytes() const {
        return nodes_.capacity() * sizeof(Node) + open_.capacity() * sizeof(Open) +
               closed_.size() * 4 * sizeof(std::uint64_t);
    }

    /// Key of the lattice cell. A position is less than 2^14 cells from the car, a heading less than 2^14
    /// units from the car's, and a path has less than 2^8 steps.
    static std::uint64_t key_of(const Node& node) {
        const auto shifted = [](std::int64_t value) {
            return static_cast<std::uint64_t>(value + (std::int64_t{1} << 14)) & 0x7fffU;
        };
        const std::uint64_t x = shifted(std::llround(node.position.x() / kCell_m));
        const std::uint64_t y = shifted(std::llround(node.position.y() / kCell_m));
        return ((x << 15U | y) << 15U | shifted(node.heading)) << 8U | static_cast<std::uint64_t>(node.steps);
    }

    /// Where an arc of `along_m` ends that begins at the node.
    [[nodiscard]] PathSample on_arc(const Node& from, int turn, double along_m) const {
        const double heading_rad = from.heading * unit_rad_;
        const double turned_rad = turn * unit_rad_ * along_m / kStep_m;
        const double half_rad = 0.5 * turned_rad;
        const double chord_m = turn == 0 ? along_m : along_m * std::sin(half_rad) / half_rad;
        return {from.position + chord_m * direction_of(heading_rad + half_rad),
                direction_of(heading_rad + turned_rad), kStep_m * from.steps + along_m};
    }

    void step(std::int32_t parent, int turn, SearchBudget& budget) {
        const Node& from = nodes_[static_cast<std::size_t>(parent)];
        double sample_costs = 0.0;
        for (const double along_m : {0.5 * kStep_m, kStep_m}) {
            sample_costs += 0.5 * cost_at(on_arc(from, turn, along_m), budget);
        }
        const auto squared_share = [](int change) {
            return static_cast<double>(change * change) / (kHardestTurn * kHardestTurn);
        };
        const double rate = sample_costs + parameters_.w_turn * squared_share(turn) +
                            parameters_.w_steer * squared_share(turn - from.turn);
        const Node to{parent,
                      from.steps + 1,
                      from.heading + turn,
                      turn,
                      on_arc(from, turn, kStep_m).position,
                      from.cost + kStep_m * rate};
        if (closed_.contains(key_of(to))) return;
        nodes_.push_back(to);
        put({estimate(to), static_cast<std::int32_t>(nodes_.size() - 1), false});
    }

    /// Cost of one metre at a place.
    [[nodiscard]] double cost_at(const PathSample& place, SearchBudget& budget) const {
        constexpr double kNowhere = std::numeric_limits<double>::infinity();
        std::array<double, 2> side_m{kNowhere, kNowhere};
        double nearest = kNowhere;
        const std::size_t visited = near_.visit_near(place.position, [&](const Point& cone) {
            const Point offset = cone - place.position;
            nearest = std::min(nearest, offset.squaredNorm());
            if (std::abs(place.direction.dot(offset)) > parameters_.window_m) return;
            const double across_m = cross(place.direction, offset);
            double& side = side_m[across_m > 0.0 ? kLeft : kRight];
            side = std::min(side, std::abs(across_m));
        });
        (void)budget.spend(8 + visited / 4);
        const double nearest_m = std::sqrt(nearest);
        const auto squared = [](double value) { return value * value; };
        double cost = nearest_m < kCarHalfWidth_m ? parameters_.w_hit : 0.0;
        if (nearest_m < parameters_.clearance_m)
            cost += parameters_.w_clearance * squared(1.0 - nearest_m / parameters_.clearance_m);
        const bool left = side_m[kLeft] <= parameters_.widest_side_m;
        const bool right = side_m[kRight] <= parameters_.widest_side_m;
        if (!left) cost += 1.0;
        if (!right) cost += 1.0;
        if (left && right) {
            const double error = side_m[kLeft] + side_m[kRight] - parameters_.expected_width_m;
            cost += std::min(1.0, parameters_.w_width * squared(error));
        }
        return cost;
    }

    /// Returns whether the path that ends at the node has boundaries.
    bool read_boundaries(std::int32_t end, SearchBudget& budget) {
        std::vector<std::int32_t> way;
        for (std::int32_t node = end; node >= 0; node = nodes_[static_cast<std::size_t>(node)].parent) {
            way.push_back(node);
        }
        std::ranges::reverse(way);
        std::vector<PathSample> path{{{0.0, 0.0}, {1.0, 0.0}, 0.0}};
        for (std::size_t i = 1; i < way.size(); ++i) {
            const Node& from = nodes_[static_cast<std::size_t>(way[i - 1])];
            const int turn = nodes_[static_cast<std::size_t>(way[i])].turn;
            const int samples = static_cast<int>(std::lround(kStep_m / kSample_m));
            for (int s = 1; s <= samples; ++s) path.push_back(on_arc(from, turn, kStep_m * s / samples));
        }
        PathBoundaries read = boundaries_along(
            path, points_, {kCarHalfWidth_m, parameters_.widest_side_m, parameters_.w_slope}, budget);
        if (read[kLeft].size() < 2 || read[kRight].size() < 2) return false;
        boundaries_ = std::move(read);
        return true;
    }

    [[nodiscard]] Lane lane(const Scene& scene) const {
        Lane lane;
        for (const std::uint32_t point : (*boundaries_)[kLeft])
            lane.left.push_back(scene.cones[cones_[point]].id);
        for (const std::uint32_t point : (*boundaries_)[kRight])
            lane.right.push_back(scene.cones[cones_[point]].id);
        even_far_ends(lane, scene);
        return lane;
    }

    const AstarLaneParameters parameters_;
    double unit_rad_ = 0.0;             ///< one unit of heading
    std::int32_t last_step_ = 0;        ///< number of steps of a path as long as the horizon
    double radius_m_ = 0.0;             ///< radius within which cones affect a place
    std::vector<Point> points_;         ///< of the cones within reach, in the frame of the car
    std::vector<std::uint32_t> cones_;  ///< by point: its index in the scene
    NearCones near_;
    std::vector<Node> nodes_;
    std::vector<Open> open_;  ///< a heap
    std::unordered_set<std::uint64_t> closed_;
    std::optional<PathBoundaries> boundaries_;
};

}  // namespace

std::span<const ParameterField<AstarLaneParameters>> astar_lane_fields() {
    return kFields;
}

void validate(const AstarLaneParameters& parameters) {
    require_in_range(parameters, astar_lane_fields());
    if (parameters.max_steps < 1 || parameters.max_steps > kMaxSteps)
        throw InvalidInput("max_steps", "must be between 1 and " + std::to_string(kMaxSteps));
}

std::unique_ptr<LaneDetector> make_astar_lane_detector(const AstarLaneParameters& parameters) {
    return std::make_unique<AstarLaneDetector>(parameters);
}

}  // namespace conelane
