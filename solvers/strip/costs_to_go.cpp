#include "solvers/strip/costs_to_go.hpp"

namespace conelane {
namespace {

/// A smaller gain is rounding.
constexpr double kGain = 1e-11;
/// Passes over the rungs until loops of negative cost are searched, and searched again.
constexpr int kPassesBeforeLoops = 6;
constexpr int kMaxRestarts = 60;
/// 8 bytes each, and an entry of the search.
constexpr std::size_t kMaxStates = 8'000'000;

std::uint64_t bit(std::size_t place) {
    return std::uint64_t{1} << std::min<std::size_t>(place, 63);
}

}  // namespace

std::optional<StopReason> CostsToGo::compute(const StripProblem& problem, const Deadline& deadline) {
    problem_ = &problem;
    multipliers_.assign(problem.graph.cone_count, 0.0);
    sum_ = 0.0;
    list_turns();
    if (!reach(deadline) || !list_states(deadline)) return StopReason::time;
    if (size_ > kMaxStates) return StopReason::memory;
    if (!list_moves(deadline) || !sort_rungs(deadline)) return StopReason::time;
    const auto restart = [&] {
        relaxed_at_.assign(blocks_.size(), 0);
        changed_at_.assign(blocks_.size(), 0);
        clock_ = 0;
        return fill(costs_, size_, StripProblem::kForbidden, deadline);
    };
    if (!restart()) return StopReason::time;
    std::uint32_t looked = 0;
    int restarts = 0;
    int passes = 0;
    for (bool changed = true; changed;) {
        changed = false;
        for (const std::uint32_t rung : order_) {
            if (++looked % 32 == 0 && deadline.passed()) return StopReason::time;
            if (!is_stale(rung)) continue;
            ++clock_;
            if (relax(rung)) {
                changed_at_[rung] = clock_;
                changed = true;
            }
            relaxed_at_[rung] = clock_;
        }
        if (++passes % kPassesBeforeLoops != 0 || !changed || !raise_loops(deadline)) continue;
        if (++restarts > kMaxRestarts) return StopReason::iterations;
        if (!restart()) return StopReason::time;
    }
    return std::nullopt;
}

void CostsToGo::list_turns() {
    can_precede_.clear();
    for (std::size_t cone = 0; cone < problem_->graph.cone_count; ++cone) {
        const std::size_t degree = problem_->degree(cone);
        for (std::size_t out = 0; out < degree; ++out) {
            Edges edges = bit(degree);
            // A turn is allowed or forbidden for both boundaries.
            for (std::size_t in = 0; in < degree; ++in) {
                if (problem_->turn_cost(cone, false, in, out) < StripProblem::kForbidden) edges |= bit(in);
            }
            can_precede_.push_back(edges);
        }
    }
}

bool CostsToGo::can_turn(const StripTriangle& t) const {
    const std::size_t cone = problem_->rungs[t.from].of(t.is_left);
    return (reached_[t.from][t.is_left ? 0 : 1] & can_precede_[problem_->places_of[cone] + t.out]) != 0;
}

/// Follows the last edges from the starts. False if the deadline passed.
bool CostsToGo::reach(const Deadline& deadline) {
    const auto& rungs = problem_->rungs;
    reached_.assign(rungs.size(), {0, 0});
    is_waiting_.assign(rungs.size(), 0);
    waiting_.clear();
    for (std::uint32_t r = 0; r < rungs.size(); ++r) {
        if (!rungs[r].may_start) continue;
        reached_[r] = {bit(problem_->degree(rungs[r].left)), bit(problem_->degree(rungs[r].right))};
        waiting_.push_back(r);
        is_waiting_[r] = 1;
    }
    for (std::size_t k = 0; k < waiting_.size(); ++k) {
        if (k % 64 == 0 && deadline.passed()) return false;
        is_waiting_[waiting_[k]] = 0;
        for (const StripTriangle& t : problem_->leaving(waiting_[k])) {
            if (!can_turn(t)) continue;
            const std::size_t side = t.is_left ? 0 : 1;
            const std::array<Edges, 2> before = reached_[t.to];
            reached_[t.to][side] |= bit(t.in);
            reached_[t.to][1 - side] |= reached_[t.from][1 - side];
            if (before != reached_[t.to] && std::exchange(is_waiting_[t.to], 1) == 0)
                waiting_.push_back(t.to);
        }
    }
    return true;
}

bool CostsToGo::list_states(const Deadline& deadline) {
    size_ = 0;
    blocks_.clear();
    ins_.clear();
    end_costs_.clear();
    ins_of_.assign(1, 0);
    for (std::size_t r = 0; r < problem_->rungs.size(); ++r) {
        if (r % 64 == 0 && deadline.passed()) return false;
        for (const bool is_left : {true, false}) {
            const std::size_t cone = problem_->rungs[r].of(is_left);
            const std::size_t degree = problem_->degree(cone);
            for (std::size_t in = 0; in <= degree; ++in) {
                if ((reached_[r][is_left ? 0 : 1] & bit(in)) == 0) continue;
                ins_.push_back(static_cast<std::uint16_t>(in));
                end_costs_.push_back(in < degree ? problem_->end_cost(cone, in) : StripProblem::kForbidden);
            }
            ins_of_.push_back(ins_.size());
        }
        blocks_.push_back({size_, static_cast<std::uint32_t>(ins_of_[2 * r + 1] - ins_of_[2 * r]),
                           static_cast<std::uint32_t>(ins_of_[2 * r + 2] - ins_of_[2 * r + 1])});
        size_ += std::size_t{blocks_.back().rows} * blocks_.back().columns;
    }
    return true;
}

bool CostsToGo::list_moves(const Deadline& deadline) {
    std::size_t turns = 0;
    std::size_t others = 0;
    for (std::size_t r = 0; r < blocks_.size(); ++r) {
        for (const StripTriangle& t : problem_->leaving(r)) {
            turns += t.is_left ? blocks_[r].rows : blocks_[r].columns;
            others += t.is_left ? blocks_[r].columns : blocks_[r].rows;
        }
    }
    moves_.clear();
    turns_.clear();
    others_.clear();
    moves_.reserve(problem_->triangles.size());
    turns_.reserve(turns);
    others_.reserve(others);
    for (const StripTriangle& triangle : problem_->triangles) {
        if (moves_.size() % 64 == 0 && deadline.passed()) return false;
        add_move(triangle);
    }
    return true;
}

void CostsToGo::add_move(const StripTriangle& t) {
    Move& move = moves_.emplace_back();
    if (!can_turn(t)) return;
    move = {true, 0, static_cast<std::uint32_t>(turns_.size()), static_cast<std::uint32_t>(others_.size())};
    const auto position = [&](std::span<const std::uint16_t> among, std::size_t from, std::uint16_t in) {
        while (among[from] != in) ++from;
        return static_cast<std::uint16_t>(from);
    };
    const std::size_t cone = problem_->rungs[t.from].of(t.is_left);
    move.in = position(ins(t.to, t.is_left), 0, t.in);
    for (const std::uint16_t in : ins(t.from, t.is_left))
        turns_.push_back(problem_->step_cost(cone, t.is_left, in, t.out));
    std::uint16_t other = 0;
    for (const std::uint16_t in : ins(t.from, !t.is_left))
        others_.push_back(other = position(ins(t.to, !t.is_left), other, in));
}

/// The order in which a search by depth leaves the rungs.
bool CostsToGo::sort_rungs(const Deadline& deadline) {
    order_.clear();
    stack_.clear();                                 // a search that was stopped left some
    is_waiting_.assign(problem_->rungs.size(), 0);  // now: was seen
    const auto enter = [&](std::uint32_t rung) {
        if (std::exchange(is_waiting_[rung], 1) == 0) stack_.emplace_back(rung, problem_->triangles_of[rung]);
    };
    for (std::uint32_t start = 0; start < problem_->rungs.size(); ++start) {
        if (problem_->rungs[start].may_start) enter(start);
        for (std::uint32_t steps = 0; !stack_.empty(); ++steps) {
            if (steps % 256 == 0 && deadline.passed()) return false;
            auto& [rung, next] = stack_.back();
            if (next < problem_->triangles_of[rung + 1]) {
                const std::uint32_t k = next++;
                if (moves_[k].is_possible) enter(problem_->triangles[k].to);
            } else {
                order_.push_back(rung);
                stack_.pop_back();
            }
        }
    }
    return true;
}

/// Whether a rung that it leads to has changed since it was relaxed.
bool CostsToGo::is_stale(std::uint32_t rung) const {
    const std::uint32_t at = relaxed_at_[rung];
    return at == 0 || std::ranges::any_of(problem_->leaving(rung), [&](const StripTriangle& triangle) {
               return changed_at_[triangle.to] > at;
           });
}

/// Whether a cost of the rung fell. Only triangles to rungs that have changed can lower one.
bool CostsToGo::relax(std::uint32_t rung) {
    const Block& block = blocks_[rung];
    const std::uint32_t at = relaxed_at_[rung];
    double* const costs = costs_.data() + block.first;
    row_.assign(costs, costs + std::size_t{block.rows} * block.columns);
    if (at == 0 && problem_->rungs[rung].may_end) {
        const double* const left = end_costs_.data() + begin(rung, true);
        const double* const right = end_costs_.data() + begin(rung, false);
        for (std::size_t a = 0; a < block.rows; ++a) {
            for (std::size_t b = 0; b < block.columns; ++b) row_[a * block.columns + b] = left[a] + right[b];
        }
    }
    for (std::uint32_t k = problem_->triangles_of[rung]; k < problem_->triangles_of[rung + 1]; ++k) {
        const StripTriangle& triangle = problem_->triangles[k];
        if (moves_[k].is_possible && changed_at_[triangle.to] > at) relax(triangle, moves_[k]);
    }
    bool fell = false;
    for (std::size_t k = 0; k < row_.size(); ++k) {
        fell = fell || row_[k] < costs[k] - kGain;
        costs[k] = std::min(costs[k], row_[k]);
    }
    return fell;
}

void CostsToGo::relax(const StripTriangle& t, const Move& move) {
    const Block& from = blocks_[t.from];
    const Block& to = blocks_[t.to];
    const std::size_t columns = from.columns;
    const std::size_t count = t.is_left ? columns : from.rows;
    const double cost = t.cost + (sum_ > 0.0 ? multipliers_[problem_->entered(t)] : 0.0);
    const double* const next = costs_.data() + to.first + std::size_t{move.in} * (t.is_left ? to.columns : 1);
    const std::size_t step = t.is_left ? 1 : to.columns;
    const std::uint16_t* const others = others_.data() + move.others;
    const double* const turns = turns_.data() + move.turns;
    gathered_.resize(count);
    for (std::size_t k = 0; k < count; ++k) gathered_[k] = cost + next[others[k] * step];
    const auto lower = [&](std::size_t row, double all, const double* each) {
        double* const costs = row_.data() + row * columns;
        for (std::size_t b = 0; b < columns; ++b) {
            const double by_it = all + each[b];
            costs[b] = by_it < costs[b] ? by_it : costs[b];
        }
    };
    for (std::size_t a = 0; a < from.rows; ++a) {
        const double all = t.is_left ? turns[a] : gathered_[a];
        if (all < StripProblem::kForbidden) lower(a, all, t.is_left ? gathered_.data() : turns);
    }
}

std::optional<StripStep> CostsToGo::cheapest(const StripState& state) const {
    std::optional<StripStep> best;
    double least = end_cost(state);
    for_each_step(state, [&](const StripStep& step) {
        const double cost = step.cost + multipliers_[entered(step)] + of(step.to);
        if (cost >= least) return;
        least = cost;
        best = step;
    });
    return best;
}

/// From the rungs that still change along the cheapest steps: whether a loop of negative cost was found.
bool CostsToGo::raise_loops(const Deadline& deadline) {
    bool found = false;
    for (const std::uint32_t rung : order_) {
        if (!is_stale(rung)) continue;
        if (deadline.passed()) return false;
        const Block& block = blocks_[rung];
        const double* const costs = costs_.data() + block.first;
        const auto least = static_cast<std::size_t>(
            std::min_element(costs, costs + std::size_t{block.rows} * block.columns) - costs);
        found = raise_loop_from({rung, static_cast<std::uint16_t>(least / block.columns),
                                 static_cast<std::uint16_t>(least % block.columns)},
                                deadline) ||
                found;
    }
    return found;
}

bool CostsToGo::raise_loop_from(StripState state, const Deadline& deadline) {
    std::vector<StripStep> steps;
    std::vector<std::size_t> visited{index(state)};
    const std::size_t most = 4 * problem_->graph.cone_count + 8;
    while (visited.size() < most) {
        const std::optional<StripStep> best = cheapest(state);
        if (!best || (steps.size() % 64 == 63 && deadline.passed())) return false;
        steps.push_back(*best);
        state = best->to;
        const auto before = std::ranges::find(visited, index(state));
        if (before == visited.end()) {
            visited.push_back(index(state));
            continue;
        }
        const auto loop = std::span(steps).subspan(static_cast<std::size_t>(before - visited.begin()));
        double cost = 0.0;
        for (const StripStep& step : loop) cost += step.cost + multipliers_[entered(step)];
        if (cost > -kGain) return false;
        const double raise = -1.05 * cost / static_cast<double>(loop.size()) + 1e-6;
        for (const StripStep& step : loop) multipliers_[entered(step)] += raise;
        sum_ += raise * static_cast<double>(loop.size());
        return true;
    }
    return false;
}

}  // namespace conelane
