#include "graph_search/baselines/delaunay_beam/delaunay_beam_detector.hpp"

#include "graph_search/baselines/delaunay_beam/delaunay_triangulation.hpp"
#include "graph_search/shared/moments.hpp"
#include "graph_search/shared/search_budget.hpp"
#include "model/geometry.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

namespace conelane {
namespace {

using P = DelaunayBeamParameters;
using HalfEdge = DelaunayTriangulation::HalfEdge;

constexpr std::array kFields{
    ParameterField<P>{"w_turn", &P::w_turn, "1/rad^2", 0.001, 10.0, true, "weight of the largest turn"},
    ParameterField<P>{"w_width_spread", &P::w_width_spread, "1/m^2", 0.001, 10.0, true,
                      "weight of the variance of the track width"},
    ParameterField<P>{"w_width", &P::w_width, "1/m^2", 0.001, 10.0, true,
                      "weight of the error of the mean width"},
    ParameterField<P>{"w_spacing", &P::w_spacing, "1/m^2", 0.001, 10.0, true,
                      "weight of the variance of the boundaries' spacing"},
    ParameterField<P>{"w_start", &P::w_start, "1/m^2", 0.0001, 1.0, true,
                      "weight of the distance to the first middle point"},
    ParameterField<P>{"expected_width_m", &P::expected_width_m, "m", 2.5, 6.5, false, "of the track"},
    ParameterField<P>{"expected_length_m", &P::expected_length_m, "m", 10.0, 60.0, false, "of the path"},
    ParameterField<P>{"widest_m", &P::widest_m, "m", 3.0, 12.0, false, "longest edge that is crossed"},
    ParameterField<P>{"longest_spacing_m", &P::longest_spacing_m, "m", 3.0, 12.0, false,
                      "longest edge of a boundary"},
    ParameterField<P>{"start_radius_m", &P::start_radius_m, "m", 3.0, 15.0, false,
                      "farthest first middle point"},
};
constexpr double kMaxColorWeight = 1000.0;
constexpr std::size_t kMaxBeamWidth = 10'000;
/// The direction from the car to a nearer middle point carries no information [m].
constexpr double kNoDirection_m = 0.5;
/// For SearchBudget::spend.
constexpr std::size_t kWorkPerNode = 40;

/// A path's end: the edge crossed last.
struct Node {
    std::int32_t parent = -1;
    Vertex left = 0;
    Vertex right = 0;
    HalfEdge ahead = DelaunayTriangulation::kNone;  ///< a side of the triangle ahead, from left to right
    Side advanced = kLeft;                          ///< the boundary that has one cone more than the parent's
    Point middle{0.0, 0.0};
    Point direction{0.0, 0.0};  ///< unit vector of the last segment
    Moments width;
    std::array<Moments, 2> spacing;
    double largest_turn_rad = 0.0;
    double length_m = 0.0;
    double start_m = 0.0;
    double wrong_colors = 0.0;  ///< expected number of cones of a wrong color
    double cost = 0.0;
};

double turn_rad(const Point& a, const Point& b) {
    return std::abs(std::atan2(cross(a, b), a.dot(b)));
}

/// Probability that a cone of this color does not belong to that side.
double wrong_color(ConeColor color, Side side) {
    if (color == ConeColor::blue) return side == kLeft ? 0.0 : 1.0;
    if (color == ConeColor::yellow) return side == kRight ? 0.0 : 1.0;
    return 0.5;
}

class DelaunayBeamDetector : public LaneDetector {
  public:
    explicit DelaunayBeamDetector(const DelaunayBeamParameters& parameters) : parameters_(parameters) {
        validate(parameters);
    }

  private:
    LaneAnswer search(const Scene& scene, const DetectionLimits& limits) override {
        SearchBudget budget;
        budget.deadline = Deadline(limits.time_limit_ms);
        tree_.clear();
        best_.reset();
        left_out_ = false;
        if (!budget.read_clock()) {
            keep_near_cones(scene);
            if (triangulation_.build(points_, budget)) grow(scene, budget);
        }
        LaneAnswer answer;
        answer.stopped_by = budget.stopped_by;
        if (best_) {
            answer.status = LaneStatus::found;
            answer.lane = lane_to(*best_, scene);
        } else if (budget.stopped_by || left_out_) {
            answer.status = LaneStatus::stopped;
            if (!answer.stopped_by) answer.stopped_by = StopReason::iterations;
        } else {
            answer.status = LaneStatus::none;
        }
        return answer;
    }

    /// Cones that no path can reach would only enlarge the triangulation.
    void keep_near_cones(const Scene& scene) {
        points_.clear();
        cones_.clear();
        const double reach_m =
            parameters_.start_radius_m + parameters_.expected_length_m + 2.0 * parameters_.widest_m;
        for (std::uint32_t i = 0; i < scene.cones.size(); ++i) {
            const Point from_car = scene.cones[i].position - scene.pose.position;
            if (!(from_car.norm() <= reach_m)) continue;
            points_.push_back(from_car);
            cones_.push_back(i);
        }
    }

    void grow(const Scene& scene, SearchBudget& budget) {
        add_first_nodes(scene);
        std::size_t level = 0;
        for (std::size_t depth = 0; level < tree_.size(); ++depth) {
            if (budget.occupy(tree_.capacity() * sizeof(Node))) return;
            const std::size_t end = keep_best(level);
            for (std::size_t node = level; node < end; ++node) {
                note_lane(node);
                if (budget.spend(kWorkPerNode + depth)) return;
                if (tree_[node].length_m >= parameters_.expected_length_m) continue;
                add_children(node, scene);
            }
            level = end;
        }
    }

    /// Orders the nodes from `level` on by cost, drops those beyond the beam and returns the end of the rest.
    std::size_t keep_best(std::size_t level) {
        const auto first = tree_.begin() + static_cast<std::ptrdiff_t>(level);
        std::stable_sort(first, tree_.end(), [](const Node& a, const Node& b) { return a.cost < b.cost; });
        if (tree_.size() - level > parameters_.beam_width) {
            tree_.resize(level + parameters_.beam_width);
            left_out_ = true;
        }
        return tree_.size();
    }

    void note_lane(std::size_t node) {
        const Node& end = tree_[node];
        const bool is_lane = end.spacing[kLeft].count > 0.0 && end.spacing[kRight].count > 0.0;
        if (is_lane && (!best_ || end.cost < tree_[*best_].cost)) best_ = node;
    }

    void add_first_nodes(const Scene& scene) {
        for (HalfEdge side = 0; side < triangulation_.half_edge_count(); ++side) {
            const Vertex from = triangulation_.origin(side);
            const Vertex to = triangulation_.target(side);
            add_first_node(from, to, side, scene);
            if (triangulation_.twin(side) == DelaunayTriangulation::kNone)
                add_first_node(to, from, DelaunayTriangulation::kNone, scene);
        }
    }

    void add_first_node(Vertex left, Vertex right, HalfEdge ahead, const Scene& scene) {
        const double width_m = (points_[left] - points_[right]).norm();
        const Point middle = 0.5 * (points_[left] + points_[right]);
        const double distance_m = middle.norm();
        if (width_m > parameters_.widest_m || distance_m > parameters_.start_radius_m) return;
        const Point heading = scene.pose.heading();
        const Point direction = distance_m > kNoDirection_m ? Point(middle / distance_m) : heading;
        if (direction.dot(heading) <= 0.0 || cross(direction, points_[left] - points_[right]) <= 0.0) return;
        Node node;
        node.left = left;
        node.right = right;
        node.ahead = ahead;
        node.middle = middle;
        node.direction = direction;
        node.width.add(width_m);
        node.largest_turn_rad = turn_rad(heading, direction);
        node.start_m = distance_m;
        node.wrong_colors =
            wrong_color(color_of(left, scene), kLeft) + wrong_color(color_of(right, scene), kRight);
        node.cost = cost_of(node);
        tree_.push_back(node);
    }

    /// The third cone of the triangle ahead is the next cone of one of the two boundaries.
    void add_children(std::size_t parent, const Scene& scene) {
        const HalfEdge ahead = tree_[parent].ahead;
        if (ahead == DelaunayTriangulation::kNone) return;
        const HalfEdge from_right = DelaunayTriangulation::next(ahead);
        const HalfEdge to_left = DelaunayTriangulation::next(from_right);
        const Vertex third = triangulation_.origin(to_left);
        if (is_on_path(third, parent)) return;
        add_child(parent, kLeft, third, triangulation_.twin(from_right), scene);
        add_child(parent, kRight, third, triangulation_.twin(to_left), scene);
    }

    void add_child(std::size_t parent_index, Side advanced, Vertex third, HalfEdge ahead,
                   const Scene& scene) {
        Node node = tree_[parent_index];
        const Vertex before = advanced == kLeft ? node.left : node.right;
        const Vertex other = advanced == kLeft ? node.right : node.left;
        const double width_m = (points_[third] - points_[other]).norm();
        const double spacing_m = (points_[third] - points_[before]).norm();
        if (width_m > parameters_.widest_m || spacing_m > parameters_.longest_spacing_m) return;
        const Point middle = 0.5 * (points_[third] + points_[other]);
        const Point step = middle - node.middle;
        const double step_m = step.norm();
        if (step_m > 0.0) {
            const Point direction = step / step_m;
            node.largest_turn_rad = std::max(node.largest_turn_rad, turn_rad(node.direction, direction));
            node.direction = direction;
        }
        node.parent = static_cast<std::int32_t>(parent_index);
        (advanced == kLeft ? node.left : node.right) = third;
        node.ahead = ahead;
        node.advanced = advanced;
        node.middle = middle;
        node.width.add(width_m);
        node.spacing[advanced].add(spacing_m);
        node.length_m += step_m;
        node.wrong_colors += wrong_color(color_of(third, scene), advanced);
        node.cost = cost_of(node);
        tree_.push_back(node);
    }

    [[nodiscard]] bool is_on_path(Vertex vertex, std::size_t end) const {
        for (auto i = static_cast<std::int32_t>(end); i >= 0;) {
            const Node& node = tree_[static_cast<std::size_t>(i)];
            if (node.left == vertex || node.right == vertex) return true;
            i = node.parent;
        }
        return false;
    }

    [[nodiscard]] ConeColor color_of(Vertex vertex, const Scene& scene) const {
        return scene.cones[cones_[vertex]].color;
    }

    [[nodiscard]] Lane lane_to(std::size_t end, const Scene& scene) const {
        Lane lane;
        const auto id_of = [&](Vertex vertex) { return scene.cones[cones_[vertex]].id; };
        const Node* node = &tree_[end];
        for (; node->parent >= 0; node = &tree_[static_cast<std::size_t>(node->parent)]) {
            if (node->advanced == kLeft) {
                lane.left.push_back(id_of(node->left));
            } else {
                lane.right.push_back(id_of(node->right));
            }
        }
        lane.left.push_back(id_of(node->left));
        lane.right.push_back(id_of(node->right));
        std::ranges::reverse(lane.left);
        std::ranges::reverse(lane.right);
        return lane;
    }

    [[nodiscard]] double cost_of(const Node& node) const {
        const DelaunayBeamParameters& p = parameters_;
        const auto squared = [](double value) { return value * value; };
        const double cones = node.width.count + 1.0;
        return p.w_turn * squared(node.largest_turn_rad) + p.w_width_spread * node.width.variance() +
               p.w_width * squared(node.width.mean() - p.expected_width_m) +
               p.w_spacing * 0.5 * (node.spacing[kLeft].variance() + node.spacing[kRight].variance()) +
               squared(node.length_m / p.expected_length_m - 1.0) + p.w_start * squared(node.start_m) +
               p.w_color * node.wrong_colors / cones;
    }

    const DelaunayBeamParameters parameters_;
    DelaunayTriangulation triangulation_;
    std::vector<Point> points_;         ///< of the cones that are near enough, relative to the car
    std::vector<std::uint32_t> cones_;  ///< by point: its index in the scene
    std::vector<Node> tree_;            ///< one level after another
    std::optional<std::size_t> best_;
    bool left_out_ = false;  ///< the beam was too narrow for some paths
};

}  // namespace

std::span<const ParameterField<DelaunayBeamParameters>> delaunay_beam_fields() {
    return kFields;
}

void validate(const DelaunayBeamParameters& parameters) {
    require_in_range(parameters, delaunay_beam_fields());
    if (!(parameters.w_color >= 0.0 && parameters.w_color <= kMaxColorWeight))
        throw InvalidInput("w_color", "must be between 0 and " + std::to_string(kMaxColorWeight));
    if (parameters.beam_width < 1 || parameters.beam_width > kMaxBeamWidth)
        throw InvalidInput("beam_width", "must be between 1 and " + std::to_string(kMaxBeamWidth));
}

std::unique_ptr<LaneDetector> make_delaunay_beam_detector(const DelaunayBeamParameters& parameters) {
    return std::make_unique<DelaunayBeamDetector>(parameters);
}

}  // namespace conelane
