#include "evaluation/world/shortest_tour.hpp"

#include <limits>

namespace conelane {
namespace {

constexpr double kMinGain_m = 1e-9;
constexpr std::size_t kMaxStarts = 16;
constexpr std::size_t kMaxMovedRun = 3;

using Tour = std::vector<std::size_t>;

class TourImprovement {
  public:
    TourImprovement(std::span<const Point> points, Tour tour) : points_(points), tour_(std::move(tour)) {}

    /// The tour that no move shortens any more.
    Tour run() && {
        while (reverse_a_run() || move_a_run()) {
        }
        return std::move(tour_);
    }

  private:
    [[nodiscard]] double distance_m(std::size_t a, std::size_t b) const {
        return is_joker(a) || is_joker(b) ? 0.0 : (points_[a] - points_[b]).norm();
    }
    /// A place at distance 0 from all others: a tour through it is a path between its two
    /// neighbours.
    [[nodiscard]] bool is_joker(std::size_t index) const { return index == points_.size(); }
    [[nodiscard]] std::size_t at(std::size_t position) const { return tour_[position % tour_.size()]; }

    /// 2-opt: makes the first exchange of two segments that shortens the tour.
    bool reverse_a_run() {
        const std::size_t n = tour_.size();
        for (std::size_t i = 0; i + 1 < n; ++i) {
            for (std::size_t j = i + 1; j < n; ++j) {
                const double old_m = distance_m(at(i), at(i + 1)) + distance_m(at(j), at(j + 1));
                const double new_m = distance_m(at(i), at(j)) + distance_m(at(i + 1), at(j + 1));
                if (new_m < old_m - kMinGain_m) {
                    std::reverse(tour_.begin() + static_cast<std::ptrdiff_t>(i) + 1,
                                 tour_.begin() + static_cast<std::ptrdiff_t>(j) + 1);
                    return true;
                }
            }
        }
        return false;
    }

    /// Or-opt: moves a run of one to three points to another place, in either direction; makes the first move
    /// that shortens the tour.
    bool move_a_run() {
        const std::size_t n = tour_.size();
        for (std::size_t length = 1; length <= kMaxMovedRun && length + 2 <= n; ++length) {
            for (std::size_t first = 0; first < n; ++first) {
                const std::size_t head = at(first);
                const std::size_t tail = at(first + length - 1);
                const std::size_t before = at(first + n - 1);
                const std::size_t after = at(first + length);
                const double removed_m =
                    distance_m(before, head) + distance_m(tail, after) - distance_m(before, after);
                for (std::size_t gap = length; gap + 1 < n; ++gap) {
                    const std::size_t a = at(first + gap);
                    const std::size_t b = at(first + gap + 1);
                    const double kept_m = distance_m(a, head) + distance_m(tail, b);
                    const double turned_m = distance_m(a, tail) + distance_m(head, b);
                    const double added_m = std::min(kept_m, turned_m) - distance_m(a, b);
                    if (added_m < removed_m - kMinGain_m) {
                        move_run(first, length, gap, turned_m < kept_m);
                        return true;
                    }
                }
            }
        }
        return false;
    }

    void move_run(std::size_t first, std::size_t length, std::size_t gap, bool turned) {
        std::rotate(tour_.begin(), tour_.begin() + static_cast<std::ptrdiff_t>(first), tour_.end());
        const auto run_end = tour_.begin() + static_cast<std::ptrdiff_t>(length);
        if (turned) std::reverse(tour_.begin(), run_end);
        std::rotate(tour_.begin(), run_end, tour_.begin() + static_cast<std::ptrdiff_t>(gap) + 1);
    }

    std::span<const Point> points_;
    Tour tour_;
};

Tour nearest_neighbour_tour(std::span<const Point> points, std::size_t start) {
    std::vector<bool> visited(points.size(), false);
    Tour tour{start};
    visited[start] = true;
    while (tour.size() < points.size()) {
        std::size_t nearest = points.size();
        double nearest_m = std::numeric_limits<double>::infinity();
        for (std::size_t candidate = 0; candidate < points.size(); ++candidate) {
            if (visited[candidate]) continue;
            const double distance_m = (points[candidate] - points[tour.back()]).norm();
            if (distance_m < nearest_m) {
                nearest_m = distance_m;
                nearest = candidate;
            }
        }
        visited[nearest] = true;
        tour.push_back(nearest);
    }
    return tour;
}

/// Length of a tour, or of a path if it is not closed.
double length_m(std::span<const Point> points, const Tour& tour, bool closed) {
    std::vector<Point> vertices;
    for (const std::size_t index : tour) vertices.push_back(points[index]);
    return polyline_length_m(vertices, closed);
}

Tour best_tour(std::span<const Point> points, bool closed) {
    Tour best;
    double best_m = std::numeric_limits<double>::infinity();
    const std::size_t starts = std::min(points.size(), kMaxStarts);
    for (std::size_t start = 0; start < starts; ++start) {
        Tour tour = nearest_neighbour_tour(points, start * points.size() / starts);
        if (!closed) tour.push_back(points.size());
        tour = TourImprovement(points, std::move(tour)).run();
        if (!closed) {
            std::rotate(tour.begin(), std::ranges::find(tour, points.size()), tour.end());
            tour.erase(tour.begin());
        }
        const double tour_m = length_m(points, tour, closed);
        if (tour_m < best_m - kMinGain_m) {
            best_m = tour_m;
            best = std::move(tour);
        }
    }
    return best;
}

}  // namespace

std::vector<std::size_t> shortest_tour(std::span<const Point> points) {
    return best_tour(points, true);
}

std::vector<std::size_t> shortest_path(std::span<const Point> points) {
    return best_tour(points, false);
}

}  // namespace conelane
