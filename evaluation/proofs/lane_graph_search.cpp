#include "evaluation/proofs/lane_graph_search.hpp"

#include "conelane/check.hpp"
#include "model/deadline.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include <boost/dynamic_bitset.hpp>

namespace conelane {
namespace {

/// The search may try what the checker then rejects, but must not leave out what the checker accepts.
constexpr double kSlack_m = 1e-6;
constexpr std::uint64_t kStepsBetweenLooksAtTheClock = 1024;

/// Costs do not decide whether there is a lane graph, and some take long to compute.
RldParameters without_costs(RldParameters parameters) {
    parameters.facing_weight = 0.0;
    parameters.w_color = 0.0;
    parameters.learned_costs.reset();
    return parameters;
}

using EdgeSet = boost::dynamic_bitset<>;

class LaneGraphSearch {
  public:
    LaneGraphSearch(const Scene& scene, const RldParameters& parameters, double time_limit_ms)
        : scene_(scene), parameters_(without_costs(parameters)), deadline_(time_limit_ms) {}

    LaneGraphSearchResult run() {
        if (!find_edges()) return {};
        used_.assign(scene_.cones.size(), false);
        possible_.assign(1, ~EdgeSet(edges_.size()));
        for (std::size_t start = 0; start < scene_.cones.size() && !ended(); ++start) {
            if (!near_[start]) continue;
            first_start_ = start;
            used_[start] = true;
            extend(start, Path::first);
            used_[start] = false;
        }
        return {!stopped_, std::move(witness_)};
    }

  private:
    enum class Path { first, second };

    [[nodiscard]] bool ended() const { return stopped_ || witness_.has_value(); }

    /// Reads the clock every few calls.
    void count_step() {
        if (++steps_ % kStepsBetweenLooksAtTheClock == 0) stopped_ = deadline_.passed();
    }

    [[nodiscard]] CheckReport ask(std::vector<Edge> edges) const {
        std::ranges::sort(edges);
        return check(scene_, parameters_, {std::move(edges)});
    }

    [[nodiscard]] double distance_m(std::size_t a, std::size_t b) const {
        return (scene_.cones[a].position - scene_.cones[b].position).norm();
    }

    /// By how much a place is farther from the car's axis than d_side; no limit is infinitely far.
    [[nodiscard]] double beyond_side_m(const Point& place) const {
        if (parameters_.d_side == 0.0) return -std::numeric_limits<double>::infinity();
        return std::abs(scene_.pose.left_m(place)) - parameters_.d_side;
    }

    /// False if the time ended.
    bool find_edges() {
        const std::size_t cones = scene_.cones.size();
        for (const Cone& cone : scene_.cones) {
            const double distance = (cone.position - scene_.pose.position).norm();
            const double beyond_m = std::max(distance - parameters_.d_near, beyond_side_m(cone.position));
            near_.push_back(beyond_m <= kSlack_m);
            far_.push_back(beyond_m >= -kSlack_m);
        }
        edges_at_.resize(cones);
        for (std::size_t i = 0; i < cones; ++i) {
            for (std::size_t j = i + 1; j < cones; ++j) {
                const CheckReport report = ask({{i, j}});
                if (report.is_final) continue;
                edges_at_[i].push_back(edges_.size());
                edges_at_[j].push_back(edges_.size());
                edges_.push_back({i, j});
                along_heading_.push_back(report.along_heading > 0);
            }
        }
        compatible_.assign(edges_.size(), EdgeSet(edges_.size()));
        for (std::size_t e = 0; e < edges_.size(); ++e) {
            for (std::size_t f = e + 1; f < edges_.size(); ++f) {
                count_step();
                if (stopped_) return false;
                if (ask({edges_[e], edges_[f]}).is_final) continue;
                compatible_[e].set(f);
                compatible_[f].set(e);
            }
        }
        return true;
    }

    /// Adds the edge to the graph. False if two edges along the heading are no longer possible.
    bool choose(std::size_t edge) {
        chosen_.push_back(edge);
        if (along_heading_[edge]) ++along_chosen_;
        if (possible_.size() == chosen_.size()) possible_.emplace_back();
        EdgeSet& after = possible_[chosen_.size()];
        after = possible_[chosen_.size() - 1];
        after &= compatible_[edge];
        along_ = after;
        along_ &= along_heading_;
        return along_chosen_ + along_.count() >= 2;
    }
    void take_back() {
        if (along_heading_[chosen_.back()]) --along_chosen_;
        chosen_.pop_back();
    }

    /// Tries every continuation from the last cone of a path, and after each step also the end of the path.
    void extend(std::size_t last, Path path) {
        for (const std::size_t edge : edges_at_[last]) {
            if (ended()) return;
            const std::size_t next = edges_[edge].i == last ? edges_[edge].j : edges_[edge].i;
            if (used_[next] || !possible_[chosen_.size()][edge]) continue;
            count_step();
            if (choose(edge)) {
                used_[next] = true;
                if (path == Path::first) {
                    start_second_path(next);
                } else {
                    judge(next);
                }
                extend(next, path);
                used_[next] = false;
            }
            take_back();
        }
    }

    void start_second_path(std::size_t first_end) {
        const bool near_to_far = parameters_.pairing == Pairing::near_far;
        if (near_to_far && !far_[first_end]) return;
        first_end_ = first_end;
        for (std::size_t start = near_to_far ? first_start_ + 1 : 0; start < scene_.cones.size(); ++start) {
            if (ended()) return;
            if (used_[start] || (near_to_far && !near_[start])) continue;
            used_[start] = true;
            extend(start, Path::second);
            used_[start] = false;
        }
    }

    void judge(std::size_t second_end) {
        if (along_chosen_ < 2) return;
        if (parameters_.pairing == Pairing::near_far &&
            (!far_[second_end] || distance_m(first_end_, second_end) > parameters_.d_max + kSlack_m)) {
            return;
        }
        std::vector<Edge> edges;
        for (const std::size_t edge : chosen_) edges.push_back(edges_[edge]);
        if (!ask(edges).violations.empty()) return;
        std::ranges::sort(edges);
        witness_ = LaneGraph{std::move(edges)};
    }

    const Scene& scene_;
    const RldParameters parameters_;
    const Deadline deadline_;
    std::vector<bool> near_;  ///< may be a near endpoint; a cone at the radius may be both
    std::vector<bool> far_;
    std::vector<Edge> edges_;                         ///< that may be part of a lane graph
    std::vector<std::vector<std::size_t>> edges_at_;  ///< by cone
    EdgeSet along_heading_;
    std::vector<EdgeSet> compatible_;  ///< by edge: those that may be in one graph with it

    std::vector<bool> used_;  ///< by cone
    std::vector<std::size_t> chosen_;
    std::vector<EdgeSet> possible_;  ///< after each number of chosen edges: compatible with all of them
    EdgeSet along_;                  ///< of the last of these, those along the heading
    std::size_t along_chosen_ = 0;
    std::size_t first_start_ = 0;
    std::size_t first_end_ = 0;
    std::uint64_t steps_ = 0;
    bool stopped_ = false;
    std::optional<LaneGraph> witness_;
};

}  // namespace

LaneGraphSearchResult search_lane_graph(const Scene& scene, const RldParameters& parameters,
                                        double time_limit_ms) {
    return LaneGraphSearch(scene, parameters, time_limit_ms).run();
}

}  // namespace conelane
