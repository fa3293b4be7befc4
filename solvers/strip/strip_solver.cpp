#include "solvers/strip/strip_solver.hpp"

#include "solvers/strip/costs_to_go.hpp"

#include <deque>
#include <exception>
#include <queue>

namespace conelane {
namespace {

constexpr double kTolerance = 1e-6;
/// A partial strip.
struct Label {
    StripState state;
    double cost = 0.0;    ///< without multipliers
    double unused = 0.0;  ///< sum of the multipliers of the cones that it does not use
    std::int32_t parent = -1;
    std::int32_t by = 0;        ///< its last triangle; of a start -1 less the rung
    std::int32_t next_at = -1;  ///< the label before it that was expanded in the same state
    bool is_end = false;
};

}  // namespace

class StripSolver::Search {
  public:
    void run(const StripProblem& problem, const StripOptions& options, StripReport& report) {
        const Deadline deadline(options.limits.time_limit_ms);
        problem_ = &problem;
        options_ = &options;
        words_ = (problem.graph.cone_count + 63) / 64;
        const Stopwatch watch;
        report.rounds = 1;
        lanes_.clear();
        open_ = {};
        labels_.clear();
        const auto stopped_by = to_go_.compute(problem, deadline);
        report.build_ms = watch.elapsed_ms();
        if (stopped_by) {
            stop(*stopped_by, report);
        } else {
            search(deadline, report);
        }
        report.nodes = static_cast<std::int64_t>(labels_.size());
        report.solve_ms = watch.elapsed_ms() - report.build_ms;
    }

  private:
    void search(const Deadline& deadline, StripReport& report) {
        cones_.clear();
        if (!fill(expanded_, to_go_.size(), std::int32_t{-1}, deadline))
            return stop(StopReason::time, report);
        add_starts();
        const std::size_t wanted = std::max<std::size_t>(1, options_->lanes);
        std::size_t popped = 0;
        std::size_t most = options_->max_labels;
        while (!open_.empty()) {
            const auto [estimate, negated] = open_.top();
            const std::int32_t label = -negated;
            const double bound = lanes_.empty() ? estimate : lanes_.front().cost;
            if (!lanes_.empty() && estimate > lanes_.front().cost + options_->worst_of_lanes) break;
            if (popped++ % 64 == 0 && deadline.passed()) return stop(StopReason::time, report, bound);
            if (labels_.size() > most) return stop(StopReason::iterations, report, bound);
            open_.pop();
            if (at(label).is_end) {
                if (lanes_.empty()) most = std::min(most, labels_.size() + options_->labels_of_others);
                if (add_lane(label) && lanes_.size() >= wanted) break;
                continue;
            }
            if (was_expanded(label)) continue;
            expand(label);
        }
        if (lanes_.empty()) {
            report.status = SolveStatus::infeasible;
            return;
        }
        finish(lanes_.front().cost, report);
    }

    void finish(double bound, StripReport& report) {
        take_lanes(report);
        report.status = SolveStatus::optimal;
        report.bound = std::min(bound, *report.objective);
    }
    void stop(StopReason reason, StripReport& report, std::optional<double> bound = {}) {
        if (!lanes_.empty())
            return finish(*bound, report);  // the best lane is proven, only others are missing
        if (!open_.empty()) dive(-open_.top().second);
        take_lanes(report);
        report.stopped_by = reason;
        report.bound = bound;
        report.status = report.objective ? SolveStatus::feasible : SolveStatus::stopped;
        if (report.bound && report.objective) report.bound = std::min(*report.bound, *report.objective);
    }
    void take_lanes(StripReport& report) const {
        for (const FoundLane& found : lanes_) report.lanes.push_back(found.lane);
        if (report.lanes.empty()) return;
        report.lane_graph = lane_graph_of(report.lanes.front());
        if (const auto strip = cheapest_strip(*problem_, report.lanes.front()))
            report.objective = strip->cost;
    }

    [[nodiscard]] const Label& at(std::int32_t label) const {
        return labels_[static_cast<std::size_t>(label)];
    }
    [[nodiscard]] std::uint64_t* cones_of(std::int32_t label) {
        const auto number = static_cast<std::size_t>(label);
        return cones_[number / kBlock].data() + number % kBlock * words_;
    }
    [[nodiscard]] bool uses(std::int32_t label, std::size_t cone) {
        return (cones_of(label)[cone / 64] >> (cone % 64) & 1U) != 0;
    }

    void push(Label label, std::int32_t parent, std::initializer_list<std::size_t> entered) {
        const double rest = label.is_end ? label.unused : to_go_.of(label.state);
        const double estimate = label.cost + rest - label.unused;
        if (!(estimate < StripProblem::kForbidden)) return;
        const auto number = static_cast<std::int32_t>(labels_.size());
        label.parent = parent;
        labels_.push_back(label);
        if (labels_.size() > cones_.size() * kBlock) cones_.emplace_back(kBlock * words_, 0);
        if (parent >= 0) std::copy_n(cones_of(parent), words_, cones_of(number));
        for (const std::size_t cone : entered) cones_of(number)[cone / 64] |= std::uint64_t{1} << (cone % 64);
        open_.emplace(estimate, -number);
    }

    void add_starts() {
        const std::vector<double>& multipliers = to_go_.multipliers();
        for (std::uint32_t r = 0; r < problem_->rungs.size(); ++r) {
            const StripRung& rung = problem_->rungs[r];
            if (!rung.may_start) continue;
            push({.state = to_go_.first(r),
                  .cost = rung.start_cost,
                  .unused = to_go_.sum() - multipliers[rung.left] - multipliers[rung.right],
                  .by = -1 - static_cast<std::int32_t>(r)},
                 -1, {rung.left, rung.right});
        }
    }

    /// Whether the same state was expanded before with the same cones, which cost no more then; of several
    /// lanes, with the same lane.
    bool was_expanded(std::int32_t label) {
        std::int32_t& head = expanded_[to_go_.index(at(label).state)];
        for (std::int32_t other = head; other >= 0; other = at(other).next_at) {
            if (std::equal(cones_of(label), cones_of(label) + words_, cones_of(other)) &&
                (options_->lanes <= 1 || lane_of(label) == lane_of(other)))
                return true;
        }
        labels_[static_cast<std::size_t>(label)].next_at = head;
        head = label;
        return false;
    }

    void expand(std::int32_t parent) {
        const Label label = at(parent);
        if (const double cost = to_go_.end_cost(label.state); cost < StripProblem::kForbidden)
            push({.state = label.state, .cost = label.cost + cost, .unused = label.unused, .is_end = true},
                 parent, {});
        to_go_.for_each_step(label.state, [&](const StripStep& step) {
            const std::size_t cone = entered(step);
            if (uses(parent, cone)) return;
            push({.state = step.to,
                  .cost = label.cost + step.cost,
                  .unused = label.unused - to_go_.multipliers()[cone],
                  .by = static_cast<std::int32_t>(step.triangle)},
                 parent, {cone});
        });
    }
    [[nodiscard]] std::size_t entered(const StripStep& step) const {
        return problem_->entered(problem_->triangles[step.triangle]);
    }

    /// Completes a partial strip by the cheapest step each time: a lane, unless it gets stuck.
    void dive(std::int32_t label) {
        std::vector<std::uint64_t> used(cones_of(label), cones_of(label) + words_);
        StripState state = at(label).state;
        double cost = at(label).cost;
        StripLane lane = lane_of(label);
        while (true) {
            std::optional<StripStep> best;
            double to_go = to_go_.end_cost(state);
            to_go_.for_each_step(state, [&](const StripStep& step) {
                const std::size_t cone = entered(step);
                const double by_step = step.cost + to_go_.multipliers()[cone] + to_go_.of(step.to);
                if (by_step >= to_go || (used[cone / 64] >> (cone % 64) & 1U) != 0) return;
                to_go = by_step;
                best = step;
            });
            if (!best) break;
            const std::size_t cone = entered(*best);
            used[cone / 64] |= std::uint64_t{1} << (cone % 64);
            (problem_->triangles[best->triangle].is_left ? lane.left : lane.right).push_back(cone);
            cost += best->cost;
            state = best->to;
        }
        cost += to_go_.end_cost(state);
        if (cost < StripProblem::kForbidden) lanes_.push_back({std::move(lane), cost});
    }

    [[nodiscard]] StripLane lane_of(std::int32_t label) const {
        StripLane lane;
        for (; label >= 0; label = at(label).parent) {
            const Label& last = at(label);
            if (last.is_end) continue;
            if (last.parent < 0) {
                const StripRung& rung = problem_->rungs[static_cast<std::size_t>(-1 - last.by)];
                lane.left.push_back(rung.left);
                lane.right.push_back(rung.right);
            } else {
                const StripTriangle& t = problem_->triangles[static_cast<std::size_t>(last.by)];
                (t.is_left ? lane.left : lane.right).push_back(problem_->entered(t));
            }
        }
        std::ranges::reverse(lane.left);
        std::ranges::reverse(lane.right);
        return lane;
    }

    /// False if another strip of the same lane was cheaper.
    bool add_lane(std::int32_t label) {
        StripLane lane = lane_of(label);
        for (const FoundLane& found : lanes_) {
            if (found.lane == lane) return false;
        }
        lanes_.push_back({std::move(lane), at(label).cost});
        return true;
    }

    struct FoundLane {
        StripLane lane;
        double cost;
    };

    const StripProblem* problem_ = nullptr;
    const StripOptions* options_ = nullptr;
    CostsToGo to_go_;
    // These grow by blocks: a copy of all would take milliseconds.
    static constexpr std::size_t kBlock = 1024;
    std::deque<Label> labels_;
    std::vector<std::vector<std::uint64_t>> cones_;  ///< of a block: a bit for each cone, words_ a label
    std::size_t words_ = 0;
    /// Estimate and negated number: of equal estimates the later label first, which is nearer to an end.
    using Open = std::pair<double, std::int32_t>;
    std::priority_queue<Open, std::deque<Open>, std::greater<>> open_;
    std::vector<std::int32_t> expanded_;  ///< by state the label that was expanded last
    std::vector<FoundLane> lanes_;
};

StripSolver::StripSolver() : search_(std::make_unique<Search>()) {}
StripSolver::~StripSolver() = default;

StripReport StripSolver::solve(const StripProblem& problem, const StripOptions& options) {
    return verified_strip(problem, options.limits,
                          [&](StripReport& report) { search_->run(problem, options, report); });
}

StripReport verified_strip(const StripProblem& problem, const SolveLimits& limits,
                           const std::function<void(StripReport&)>& run) {
    StripReport report;
    const auto fail = [&report](std::string message) {
        report = {};
        report.message = std::move(message);
        return report;
    };
    try {
        if (const std::string_view wrong = invalidity(limits); !wrong.empty())
            return fail(std::string(wrong));
        run(report);
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& error) {
        return fail(error.what());
    }
    const bool claims_lane = report.status == SolveStatus::optimal || report.status == SolveStatus::feasible;
    if (claims_lane != !report.lanes.empty())
        return fail("the answer fails its check: a lane without such a status, or a status without lane");
    if (!claims_lane) return report;
    const StripLane& lane = report.lanes.front();
    std::vector<std::size_t> cones = lane.left;
    cones.insert(cones.end(), lane.right.begin(), lane.right.end());
    std::ranges::sort(cones);
    if (std::ranges::adjacent_find(cones) != cones.end())
        return fail("the answer fails its check: a cone is used twice");
    const auto strip = cheapest_strip(problem, lane);
    if (!strip) return fail("the answer fails its check: no strip joins the boundaries");
    const double tolerance = kTolerance * std::max(1.0, std::abs(strip->cost));
    if (!report.objective || !(std::abs(*report.objective - strip->cost) <= tolerance))
        return fail("the answer fails its check: the objective is not the cheapest strip's, " +
                    std::to_string(strip->cost));
    if (report.bound && !(*report.bound <= strip->cost + tolerance))
        return fail("the answer fails its check: the bound is above the lane");
    return report;
}

}  // namespace conelane
