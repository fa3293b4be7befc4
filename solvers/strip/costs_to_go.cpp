#include "solvers/strip/costs_to_go.hpp"

#include "model/deadline.hpp"

#include <algorithm>
#include <cmath>

namespace conelane {
namespace {

/// A smaller gain is rounding.
constexpr double kGain = 1e-11;
/// Passes over the rungs until loops of negative cost are searched, and searched again.
constexpr int kPassesBeforeLoops = 12;
constexpr int kMaxRestarts = 60;

}  // namespace

void CostsToGo::begin(const StripProblem& problem, const StripStates& states) {
    problem_ = &problem;
    states_ = &states;
    multipliers_.assign(problem.graph.cone_count, 0.0);
    sum_ = 0.0;
    before_.resize(std::max(before_.size(), problem.rungs.size()));
    for (auto& rungs : before_) rungs.clear();
    for (const StripTriangle& triangle : problem.triangles) {
        if (states.has(triangle.from)) before_[triangle.to].push_back(triangle.from);
    }
}

bool CostsToGo::compute(const Deadline& deadline) {
    constexpr int kRungsPerClock = 32;
    int until_clock = kRungsPerClock;
    const auto restart = [&] {
        costs_.assign(states_->size(), StripProblem::kForbidden);
        is_stale_.assign(problem_->rungs.size(), 1);
    };
    restart();
    int passes = 0;
    int restarts = 0;
    for (bool changed = true; changed;) {
        changed = false;
        for (const std::uint32_t rung : states_->order()) {
            if (is_stale_[rung] == 0) continue;
            is_stale_[rung] = 0;
            if (--until_clock <= 0) {
                until_clock = kRungsPerClock;
                if (deadline.passed()) return false;
            }
            if (!relax(rung)) continue;
            changed = true;
            for (const std::uint32_t before : before_[rung]) is_stale_[before] = 1;
        }
        if (++passes % kPassesBeforeLoops != 0 || !changed || !raise_loops()) continue;
        if (++restarts > kMaxRestarts) return false;
        restart();
        passes = 0;
    }
    return true;
}

/// Whether a cost of the rung fell.
bool CostsToGo::relax(std::uint32_t rung) {
    const std::size_t rows = states_->rows(rung);
    const std::size_t columns = states_->columns(rung);
    row_.assign(rows * columns, StripProblem::kForbidden);
    const StripRung& at = problem_->rungs[rung];
    if (at.may_end) {
        for (std::size_t a = 0; a + 1 < rows; ++a) {
            for (std::size_t b = 0; b + 1 < columns; ++b)
                row_[a * columns + b] = problem_->end_cost(at.left, a) + problem_->end_cost(at.right, b);
        }
    }
    for (const StripTriangle& triangle : problem_->leaving(rung)) {
        if (triangle.is_left) {
            relax_left(triangle, rows, columns);
        } else {
            relax_right(triangle, rows, columns);
        }
    }
    bool fell = false;
    double* const costs = costs_.data() + states_->base(rung);
    for (std::size_t k = 0; k < row_.size(); ++k) {
        if (!(row_[k] < costs[k] - kGain)) continue;
        costs[k] = row_[k];
        fell = true;
    }
    return fell;
}

void CostsToGo::relax_left(const StripTriangle& triangle, std::size_t rows, std::size_t columns) {
    const std::size_t cone = problem_->rungs[triangle.from].left;
    const double cost = triangle.cost + multipliers_[problem_->rungs[triangle.to].left];
    const double* const next = costs_.data() + states_->base(triangle.to) + triangle.in * columns;
    for (std::size_t a = 0; a < rows; ++a) {
        const double turn = a + 1 < rows ? problem_->turn_cost(cone, true, a, triangle.out) : 0.0;
        if (!(turn < StripProblem::kForbidden)) continue;
        double* const row = row_.data() + a * columns;
        const double step = turn + cost;
        for (std::size_t b = 0; b < columns; ++b) row[b] = std::min(row[b], step + next[b]);
    }
}

void CostsToGo::relax_right(const StripTriangle& triangle, std::size_t rows, std::size_t columns) {
    const StripRung& to = problem_->rungs[triangle.to];
    const std::size_t cone = problem_->rungs[triangle.from].right;
    const double cost = triangle.cost + multipliers_[to.right];
    const std::size_t next_columns = states_->columns(triangle.to);
    const double* const next = costs_.data() + states_->base(triangle.to) + triangle.in;
    // The turns of the right boundary by `out` are a row of those of the left one.
    const double* const turns =
        problem_->turn_costs.data() + problem_->turns_of[cone] + triangle.out * (columns - 1);
    for (std::size_t a = 0; a < rows; ++a) {
        const double step = cost + next[a * next_columns];
        if (!(step < StripProblem::kForbidden)) continue;
        double* const row = row_.data() + a * columns;
        for (std::size_t b = 0; b + 1 < columns; ++b) row[b] = std::min(row[b], step + turns[b]);
        row[columns - 1] = std::min(row[columns - 1], step);
    }
}

CostsToGo::Cheapest CostsToGo::cheapest(const StripState& state) const {
    Cheapest best{{}, states_->end_cost(state)};
    states_->for_each_step(state, [&](const StripStep& step) {
        const double cost = step.cost + multipliers_[step.cone] + of(step.to);
        if (cost < best.cost) best = {step, cost};
    });
    return best;
}

/// From the rungs that still change along the cheapest steps: whether a loop of negative cost was found.
bool CostsToGo::raise_loops() {
    bool found = false;
    for (const std::uint32_t rung : states_->order()) {
        if (is_stale_[rung] == 0) continue;
        const double* const costs = costs_.data() + states_->base(rung);
        const std::size_t size = states_->rows(rung) * states_->columns(rung);
        const auto least = static_cast<std::size_t>(std::min_element(costs, costs + size) - costs);
        found = raise_loop_from({rung, static_cast<std::uint16_t>(least / states_->columns(rung)),
                                 static_cast<std::uint16_t>(least % states_->columns(rung))}) ||
                found;
    }
    return found;
}

bool CostsToGo::raise_loop_from(StripState state) {
    std::vector<StripStep> steps;
    std::vector<std::size_t> visited{states_->index(state)};
    const std::size_t most = 4 * problem_->graph.cone_count + 8;
    while (visited.size() < most) {
        const Cheapest best = cheapest(state);
        if (!best.step) return false;
        steps.push_back(*best.step);
        state = best.step->to;
        const auto before = std::ranges::find(visited, states_->index(state));
        if (before == visited.end()) {
            visited.push_back(states_->index(state));
            continue;
        }
        const auto loop = std::span(steps).subspan(static_cast<std::size_t>(before - visited.begin()));
        double cost = 0.0;
        for (const StripStep& step : loop) cost += step.cost + multipliers_[step.cone];
        if (cost > -kGain) return false;
        const double raise = -1.05 * cost / static_cast<double>(loop.size()) + 1e-6;
        for (const StripStep& step : loop) {
            multipliers_[step.cone] += raise;
            sum_ += raise;
        }
        return true;
    }
    return false;
}

}  // namespace conelane
