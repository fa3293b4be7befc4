#include "graph_search/clc/deciders.hpp"

#include <utility>

namespace conelane {
namespace {

/// Up to about this number, insertion sort is fastest.
constexpr std::size_t kFew = 48;

/// Stable: the options come in the order of their vertices, so equal ones stay in that order.
void sort_by_cost(std::span<NextVertex> options) {
    if (options.size() > kFew) {
        std::ranges::sort(options, {},
                          [](const NextVertex& option) { return std::pair(option.cost, option.vertex); });
        return;
    }
    for (std::size_t i = 1; i < options.size(); ++i) {
        const NextVertex option = options[i];
        std::size_t place = i;
        for (; place > 0 && options[place - 1].cost > option.cost; --place)
            options[place] = options[place - 1];
        options[place] = option;
    }
}

/// (cos, sin) of the absolute angle between two directions; (1, 0) if one has no length.
Point absolute_angle_on_circle(const Point& a, const Point& b) {
    const double lengths = std::sqrt(a.squaredNorm() * b.squaredNorm());
    if (lengths == 0.0) return {1.0, 0.0};
    return {a.dot(b) / lengths, std::abs(cross(a, b)) / lengths};
}

}  // namespace

void StepReach::reset(const SearchGraph& graph, std::size_t most) {
    graph_ = &graph;
    most_ = most;
    left_out_ = false;
    squared_m2_.assign(graph.vertex_count(), -1.0);
    first_.resize(graph.vertex_count());
    count_.resize(graph.vertex_count());
    allowed_.clear();
}

void StepReach::find(Vertex vertex) {
    const std::span<const Vertex> neighbours = graph_->neighbours(vertex);
    first_[vertex] = static_cast<std::uint32_t>(allowed_.size());
    double& reach_m2 = squared_m2_[vertex];
    if (most_ == 0 || neighbours.size() <= most_) {
        reach_m2 = std::numeric_limits<double>::infinity();
        for (std::uint32_t i = 0; i < neighbours.size(); ++i) allowed_.push_back(i);
    } else {
        distances_m2_.clear();
        for (const Vertex neighbour : neighbours)
            distances_m2_.push_back((graph_->position(neighbour) - graph_->position(vertex)).squaredNorm());
        nearest_m2_ = distances_m2_;
        const auto last = nearest_m2_.begin() + static_cast<std::ptrdiff_t>(most_ - 1);
        std::ranges::nth_element(nearest_m2_, last);
        reach_m2 = *last;
        for (std::uint32_t i = 0; i < distances_m2_.size(); ++i) {
            if (distances_m2_[i] <= reach_m2) allowed_.push_back(i);
        }
    }
    count_[vertex] = static_cast<std::uint32_t>(allowed_.size()) - first_[vertex];
    left_out_ |= count_[vertex] < neighbours.size();
}

void NextVertexDecider::reset(const SearchGraph& graph, double distance_weight_per_m, StepReach* reach) {
    graph_ = &graph;
    reach_ = reach;
    if (reach_ == nullptr) all_.reset(graph, 0);
    distance_weight_per_m_ = distance_weight_per_m;
    options_.clear();
    ranges_.assign(graph.directed_edge_count(), Range{kUnknown, kUnknown});
}

NextVertexDecider::Range NextVertexDecider::after_start(Vertex start, const Point& heading) {
    return sorted(start, heading);
}

NextVertexDecider::Range NextVertexDecider::sorted(Vertex vertex, const Point& direction) {
    const auto begin = static_cast<std::uint32_t>(options_.size());
    const SearchGraph::DirectedEdge first = graph_->first_edge(vertex);
    const std::span<const Vertex> neighbours = graph_->neighbours(vertex);
    for (const std::uint32_t place : (reach_ != nullptr ? *reach_ : all_).steps(vertex)) {
        const Vertex neighbour = neighbours[place];
        const Point segment = graph_->position(neighbour) - graph_->position(vertex);
        const double turning = turning_measure(direction, segment);
        double cost = turning;
        if (distance_weight_per_m_ > 0.0) cost += distance_weight_per_m_ * segment.norm();
        options_.push_back({neighbour, first + place, turning, cost});
    }
    sort_by_cost(std::span(options_).subspan(begin));
    return {begin, static_cast<std::uint32_t>(options_.size())};
}

double advance_deviation(const Point& left_last, const Point& left_direction, const Point& right_last,
                         const Point& right_direction) {
    const Point across = right_last - left_last;
    // Both angles lie in [0, pi], so the chord between them on the unit circle grows with their difference.
    return (absolute_angle_on_circle(left_direction, across) -
            absolute_angle_on_circle(right_direction, -across))
        .squaredNorm();
}

Side left_right_decision(const std::array<BoundaryTip, 2>& tips, Side tie) {
    const BoundaryTip& left = tips[kLeft];
    const BoundaryTip& right = tips[kRight];
    const double left_extended =
        advance_deviation(left.next, left.next - left.last, right.last, right.direction);
    const double right_extended =
        advance_deviation(left.last, left.direction, right.next, right.next - right.last);
    if (left_extended == right_extended) return tie;
    return left_extended < right_extended ? kLeft : kRight;
}

}  // namespace conelane
