#include "model/strip_model.hpp"

#include "model/deadline.hpp"

#include <algorithm>
#include <array>
#include <string_view>

namespace conelane {
namespace {

constexpr std::array<std::string_view, 2> kTurn{"f_L", "f_R"};
constexpr std::array<std::string_view, 2> kBegin{"b_L", "b_R"};
constexpr std::array<std::string_view, 2> kEnd{"e_L", "e_R"};
constexpr std::array<std::string_view, 2> kGoesOn{"edge_goes_on_L", "edge_goes_on_R"};
constexpr std::array<std::string_view, 2> kComes{"edge_comes_L", "edge_comes_R"};
constexpr std::array<std::string_view, 2> kBegins{"boundary_begins_L", "boundary_begins_R"};
constexpr std::array<std::string_view, 2> kEnds{"boundary_ends_L", "boundary_ends_R"};

std::int32_t index(std::size_t value) {
    return static_cast<std::int32_t>(value);
}

/// A term, unless there is no such column.
void add(RowWriter& rows, int column, double coefficient) {
    if (column >= 0) rows.add(column, coefficient);
}

}  // namespace

std::optional<StopReason> StripModel::build(const Deadline& deadline) {
    if (problem_->turn_costs.size() > kMaxProgramEntries) return StopReason::memory;
    add_columns();
    RowWriter rows(program_, &deadline);
    add_rung_rows(rows);
    add_cone_rows(rows);
    add_edge_rows(rows);
    (void)rows.stop();
    return rows.stopped_by();
}

void StripModel::add_columns() {
    const StripProblem& problem = *problem_;
    const auto of_rung = [&](std::string_view family, const StripRung& rung, double cost) {
        return program_.add_column({family, {index(rung.left), index(rung.right)}}, cost, true);
    };
    for (const StripRung& rung : problem.rungs) {
        start_.push_back(rung.may_start ? of_rung("s", rung, rung.start_cost) : -1);
        end_.push_back(rung.may_end ? of_rung("t", rung, 0.0) : -1);
    }
    for (const StripTriangle& triangle : problem.triangles) {
        const StripRung& from = problem.rungs[triangle.from];
        const StripRung& to = problem.rungs[triangle.to];
        const Label label = triangle.is_left
                                ? Label{"y_L", {index(from.left), index(to.left), index(from.right)}}
                                : Label{"y_R", {index(from.left), index(from.right), index(to.right)}};
        triangle_.push_back(program_.add_column(label, triangle.cost, true));
    }
    for (std::size_t side = 0; side < 2; ++side) {
        SideColumns& columns = sides_[side];
        columns.turn.assign(problem.turn_costs.size(), -1);
        std::vector<char> may_begin(problem.graph.cone_count, 0);
        std::vector<char> may_end(problem.graph.cone_count, 0);
        for (const StripRung& rung : problem.rungs) {
            const std::size_t cone = side == 0 ? rung.left : rung.right;
            may_begin[cone] = static_cast<char>(may_begin[cone] != 0 || rung.may_start);
            may_end[cone] = static_cast<char>(may_end[cone] != 0 || rung.may_end);
        }
        for (std::size_t cone = 0; cone < problem.graph.cone_count; ++cone) {
            const auto& incident = problem.graph.incident[cone];
            for (std::size_t in = 0; in < incident.size(); ++in) {
                const std::size_t other = problem.other(incident[in], cone);
                const double cost = problem.end_cost(cone, in);
                const auto of_edge = [&](std::string_view family, std::size_t from, std::size_t to,
                                         double edge_cost) {
                    return program_.add_column({family, {index(from), index(to)}}, edge_cost, false);
                };
                columns.begin.push_back(may_begin[cone] != 0 ? of_edge(kBegin[side], cone, other, 0.0) : -1);
                columns.end.push_back(may_end[cone] != 0 ? of_edge(kEnd[side], other, cone, cost) : -1);
                for (std::size_t out = 0; out < incident.size(); ++out) {
                    const double turn = problem.turn_cost(cone, side == 0, in, out);
                    if (!(turn < StripProblem::kForbidden)) continue;
                    const std::size_t to = problem.other(incident[out], cone);
                    columns.turn[problem.turns_of[cone] + in * incident.size() + out] = program_.add_column(
                        {kTurn[side], {index(other), index(cone), index(to)}}, turn, false);
                }
            }
        }
    }
}

/// What enters a rung leaves it; the lane begins once.
void StripModel::add_rung_rows(RowWriter& rows) const {
    const StripProblem& problem = *problem_;
    rows.begin({"start"}, 1.0, 1.0);
    for (const int column : start_) add(rows, column, 1.0);
    rows.end();
    std::vector<std::vector<int>> entering(problem.rungs.size());
    for (std::size_t k = 0; k < problem.triangles.size(); ++k)
        entering[problem.triangles[k].to].push_back(triangle_[k]);
    for (std::size_t r = 0; r < problem.rungs.size() && !rows.stop(); ++r) {
        const StripRung& rung = problem.rungs[r];
        rows.begin({"rung", {index(rung.left), index(rung.right)}}, 0.0, 0.0);
        for (const int column : entering[r]) rows.add(column, 1.0);
        add(rows, start_[r], 1.0);
        for (std::size_t k = problem.triangles_of[r]; k < problem.triangles_of[r + 1]; ++k)
            rows.add(triangle_[k], -1.0);
        add(rows, end_[r], -1.0);
        rows.end();
    }
}

/// A cone is entered once at most. A boundary begins and ends where the lane does.
void StripModel::add_cone_rows(RowWriter& rows) const {
    const StripProblem& problem = *problem_;
    const std::size_t n = problem.graph.cone_count;
    std::vector<std::vector<int>> entering(n);
    std::array<std::vector<std::vector<int>>, 2> starts{std::vector<std::vector<int>>(n),
                                                        std::vector<std::vector<int>>(n)};
    auto ends = starts;
    for (std::size_t r = 0; r < problem.rungs.size(); ++r) {
        const std::array cones{problem.rungs[r].left, problem.rungs[r].right};
        for (std::size_t side = 0; side < 2; ++side) {
            if (start_[r] >= 0) starts[side][cones[side]].push_back(start_[r]);
            if (start_[r] >= 0) entering[cones[side]].push_back(start_[r]);
            if (end_[r] >= 0) ends[side][cones[side]].push_back(end_[r]);
        }
    }
    for (std::size_t k = 0; k < problem.triangles.size(); ++k) {
        const StripRung& to = problem.rungs[problem.triangles[k].to];
        entering[problem.triangles[k].is_left ? to.left : to.right].push_back(triangle_[k]);
    }
    const auto balance = [&](std::string_view family, std::size_t cone, const std::vector<int>& of_edges,
                             const std::vector<int>& of_rungs) {
        rows.begin({family, {index(cone)}}, 0.0, 0.0);
        for (std::size_t place = 0; place < problem.degree(cone); ++place)
            add(rows, of_edges[problem.places_of[cone] + place], 1.0);
        for (const int column : of_rungs) rows.add(column, -1.0);
        rows.end();
    };
    for (std::size_t cone = 0; cone < n && !rows.stop(); ++cone) {
        rows.begin({"cone_once", {index(cone)}}, -kInfinity, 1.0);
        for (const int column : entering[cone]) rows.add(column, 1.0);
        rows.end();
        for (std::size_t side = 0; side < 2; ++side) {
            balance(kBegins[side], cone, sides_[side].begin, starts[side][cone]);
            balance(kEnds[side], cone, sides_[side].end, ends[side][cone]);
        }
    }
}

/// A directed edge of a side: its triangles arrive by a turn or begin, and go on by a turn or end.
void StripModel::add_edge_rows(RowWriter& rows) const {
    const StripProblem& problem = *problem_;
    for (std::size_t side = 0; side < 2; ++side) {
        const SideColumns& columns = sides_[side];
        // By cone and place: triangles that arrive at the cone by that edge, and those that leave it.
        std::vector<std::vector<int>> arriving(columns.end.size());
        std::vector<std::vector<int>> leaving(columns.end.size());
        for (std::size_t k = 0; k < problem.triangles.size(); ++k) {
            const StripTriangle& triangle = problem.triangles[k];
            if (triangle.is_left != (side == 0)) continue;
            const auto cone = [&](const StripRung& rung) { return side == 0 ? rung.left : rung.right; };
            arriving[problem.places_of[cone(problem.rungs[triangle.to])] + triangle.in].push_back(
                triangle_[k]);
            leaving[problem.places_of[cone(problem.rungs[triangle.from])] + triangle.out].push_back(
                triangle_[k]);
        }
        for (std::size_t cone = 0; cone < problem.graph.cone_count; ++cone) {
            const std::size_t degree = problem.degree(cone);
            const int* const turns = columns.turn.data() + problem.turns_of[cone];
            for (std::size_t place = 0; place < degree && !rows.stop(); ++place) {
                const std::size_t at = problem.places_of[cone] + place;
                const auto other = index(problem.other(problem.graph.incident[cone][place], cone));
                rows.begin({kGoesOn[side], {other, index(cone)}}, 0.0, 0.0);
                for (const int column : arriving[at]) rows.add(column, 1.0);
                add(rows, columns.end[at], -1.0);
                for (std::size_t out = 0; out < degree; ++out) add(rows, turns[place * degree + out], -1.0);
                rows.end();
                rows.begin({kComes[side], {index(cone), other}}, 0.0, 0.0);
                for (const int column : leaving[at]) rows.add(column, 1.0);
                add(rows, columns.begin[at], -1.0);
                for (std::size_t in = 0; in < degree; ++in) add(rows, turns[in * degree + place], -1.0);
                rows.end();
            }
        }
    }
}

std::optional<std::size_t> StripModel::next(std::span<const double> point, std::size_t rung) const {
    for (std::size_t k = problem_->triangles_of[rung]; k < problem_->triangles_of[rung + 1]; ++k) {
        if (point[static_cast<std::size_t>(triangle_[k])] > 0.5) return k;
    }
    return std::nullopt;
}

std::size_t StripModel::start(std::span<const double> point) const {
    const auto chosen = std::ranges::find_if(
        start_, [&](int column) { return column >= 0 && point[static_cast<std::size_t>(column)] > 0.5; });
    return static_cast<std::size_t>(chosen - start_.begin());
}

std::vector<std::size_t> StripModel::walk(std::span<const double> point) const {
    std::vector<std::size_t> triangles;
    std::size_t rung = start(point);
    while (const auto k = next(point, rung)) {
        triangles.push_back(*k);
        rung = problem_->triangles[*k].to;
        if (triangles.size() > 2 * problem_->graph.cone_count) break;
    }
    return triangles;
}

StripLane StripModel::decode(std::span<const double> point) const {
    const StripRung& first = problem_->rungs[start(point)];
    StripLane lane{{first.left}, {first.right}};
    for (const std::size_t k : walk(point)) {
        const StripTriangle& triangle = problem_->triangles[k];
        const StripRung& to = problem_->rungs[triangle.to];
        if (triangle.is_left) {
            lane.left.push_back(to.left);
        } else {
            lane.right.push_back(to.right);
        }
    }
    return lane;
}

std::vector<ProgramRow> StripModel::separate(std::span<const double> point) const {
    std::vector<char> seen(triangle_.size(), 0);
    for (const std::size_t k : walk(point)) seen[k] = 1;
    std::vector<ProgramRow> rows;
    for (std::size_t first = 0; first < triangle_.size(); ++first) {
        if (seen[first] != 0 || point[static_cast<std::size_t>(triangle_[first])] <= 0.5) continue;
        ProgramRow row{{"no_circulation", {index(first)}}, {}, -kInfinity, 0.0};
        for (std::optional<std::size_t> k = first; k && seen[*k] == 0;
             k = next(point, problem_->triangles[*k].to)) {
            seen[*k] = 1;
            row.terms.emplace_back(triangle_[*k], 1.0);
        }
        row.upper = static_cast<double>(row.terms.size()) - 1.0;
        rows.push_back(std::move(row));
    }
    return rows;
}

}  // namespace conelane
