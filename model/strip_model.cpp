#include "model/strip_model.hpp"

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

}  // namespace

std::optional<StopReason> StripModel::build(const Deadline& deadline) {
    if (problem_->turn_costs.size() > kMaxProgramEntries) return StopReason::memory;
    label_rows();
    add_lane_columns();
    for (const bool is_left : {true, false}) add_boundary_columns(is_left);
    RowWriter writer(program_, &deadline);
    for (const ProgramRow& row : std::exchange(rows_, {})) {
        if (writer.stop()) break;
        writer.begin(row.label, row.lower, row.upper);
        for (const auto& [column, coefficient] : row.terms) writer.add(column, coefficient);
        writer.end();
    }
    (void)writer.stop();
    return writer.stopped_by();
}

void StripModel::label_rows() {
    const StripProblem& problem = *problem_;
    const std::size_t n = problem.graph.cone_count;
    const auto add = [&](std::size_t count, double lower, double upper, const auto& label) {
        for (std::size_t k = 0; k < count; ++k) rows_.push_back({label(k), {}, lower, upper});
        return rows_.size() - count;
    };
    (void)add(1, 1.0, 1.0, [](std::size_t) { return Label{"start"}; });
    rung_row_ = add(problem.rungs.size(), 0.0, 0.0, [&](std::size_t r) {
        return Label{"rung", {index(problem.rungs[r].left), index(problem.rungs[r].right)}};
    });
    once_row_ = add(n, -kInfinity, 1.0, [](std::size_t cone) { return Label{"cone_once", {index(cone)}}; });
    std::vector<std::pair<std::int32_t, std::int32_t>> edges;  // by place: its other cone and the cone
    for (std::size_t cone = 0; cone < n; ++cone) {
        for (const std::size_t edge : problem.graph.incident[cone])
            edges.emplace_back(index(problem.other(edge, cone)), index(cone));
    }
    for (std::size_t side = 0; side < 2; ++side) {
        const auto of_cones = [&](std::string_view family) {
            return add(n, 0.0, 0.0, [&](std::size_t cone) { return Label{family, {index(cone)}}; });
        };
        SideRows& rows = side_rows_[side];
        rows.begins = of_cones(kBegins[side]);
        rows.ends = of_cones(kEnds[side]);
        rows.goes_on = add(edges.size(), 0.0, 0.0, [&](std::size_t k) {
            return Label{kGoesOn[side], {edges[k].first, edges[k].second}};
        });
        rows.comes = add(edges.size(), 0.0, 0.0, [&](std::size_t k) {
            return Label{kComes[side], {edges[k].second, edges[k].first}};
        });
    }
}

int StripModel::add_column(const Label& label, double cost, bool integer,
                           std::initializer_list<std::pair<std::size_t, double>> entries) {
    const int column = program_.add_column(label, cost, integer);
    for (const auto& [row, coefficient] : entries) rows_[row].terms.emplace_back(column, coefficient);
    return column;
}

/// Starts and ends of the lane, and triangles.
void StripModel::add_lane_columns() {
    const StripProblem& problem = *problem_;
    const auto& [left, right] = side_rows_;
    for (std::size_t k = 0; k < problem.rungs.size(); ++k) {
        const auto& [l, r, may_start, may_end, cost] = problem.rungs[k];
        const Label::Index cones{index(l), index(r)};
        start_.push_back(-1);
        if (may_start)
            start_.back() = add_column({"s", cones}, cost, true,
                                       {{0, 1.0},
                                        {rung_row_ + k, 1.0},
                                        {once_row_ + l, 1.0},
                                        {once_row_ + r, 1.0},
                                        {left.begins + l, -1.0},
                                        {right.begins + r, -1.0}});
        if (may_end)
            add_column({"t", cones}, 0.0, true,
                       {{rung_row_ + k, -1.0}, {left.ends + l, -1.0}, {right.ends + r, -1.0}});
    }
    for (const StripTriangle& t : problem.triangles) {
        const StripRung& from = problem.rungs[t.from];
        const StripRung& to = problem.rungs[t.to];
        const SideRows& rows = rows_of(t.is_left);
        const Label label = t.is_left ? Label{"y_L", {index(from.left), index(to.left), index(from.right)}}
                                      : Label{"y_R", {index(from.left), index(from.right), index(to.right)}};
        triangle_.push_back(add_column(label, t.cost, true,
                                       {{rung_row_ + t.from, -1.0},
                                        {rung_row_ + t.to, 1.0},
                                        {once_row_ + to.of(t.is_left), 1.0},
                                        {rows.goes_on + problem.places_of[to.of(t.is_left)] + t.in, 1.0},
                                        {rows.comes + problem.places_of[from.of(t.is_left)] + t.out, 1.0}}));
    }
}

/// Turns, and the first and last edges.
void StripModel::add_boundary_columns(bool is_left) {
    const StripProblem& problem = *problem_;
    const std::size_t side = is_left ? 0 : 1;
    const SideRows& rows = rows_of(is_left);
    for (std::size_t cone = 0; cone < problem.graph.cone_count; ++cone) {
        const auto& incident = problem.graph.incident[cone];
        const bool may_begin = !rows_[rows.begins + cone].terms.empty();
        const bool may_end = !rows_[rows.ends + cone].terms.empty();
        const std::size_t first = problem.places_of[cone];
        for (std::size_t in = 0; in < incident.size(); ++in) {
            const std::size_t other = problem.other(incident[in], cone);
            if (may_begin)
                add_column({kBegin[side], {index(cone), index(other)}}, 0.0, false,
                           {{rows.comes + first + in, -1.0}, {rows.begins + cone, 1.0}});
            if (may_end)
                add_column({kEnd[side], {index(other), index(cone)}}, problem.end_cost(cone, in), false,
                           {{rows.goes_on + first + in, -1.0}, {rows.ends + cone, 1.0}});
            for (std::size_t out = 0; out < incident.size(); ++out) {
                const double turn = problem.turn_cost(cone, is_left, in, out);
                if (!(turn < StripProblem::kForbidden)) continue;
                const std::size_t to = problem.other(incident[out], cone);
                add_column({kTurn[side], {index(other), index(cone), index(to)}}, turn, false,
                           {{rows.goes_on + first + in, -1.0}, {rows.comes + first + out, -1.0}});
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
        (triangle.is_left ? lane.left : lane.right).push_back(problem_->entered(triangle));
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
