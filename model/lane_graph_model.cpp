#include "model/lane_graph_model.hpp"

#include "model/constraints/families.hpp"

namespace conelane {
namespace {

/// The cost of a column that rows fix at 0 has no effect. The real cost grows with the fourth power of a
/// distance and would exceed what a solver can represent.
double column_cost(double cost, bool never_chosen) {
    constexpr double kMaxOfNeverChosen = 1e9;
    return never_chosen && !(cost <= kMaxOfNeverChosen) ? kMaxOfNeverChosen : cost;
}
double column_cost(const ProblemEdge& edge) {
    return column_cost(edge.cost, edge.high_cost);
}
double column_cost(const ProblemTurn& turn, const LaneGraphProblem& problem) {
    return column_cost(turn.cost, turn.high_cost || problem.edges[turn.edge_i].high_cost ||
                                      problem.edges[turn.edge_k].high_cost);
}

}  // namespace

LaneGraphModel::LaneGraphModel(const LaneGraphProblem& problem, Formulation formulation)
    : formulation_(formulation) {
    update(problem);
}

void LaneGraphModel::update(const LaneGraphProblem& problem) {
    (void)update(problem, nullptr);
}

std::optional<StopReason> LaneGraphModel::update(const LaneGraphProblem& problem, const Deadline& deadline) {
    const bool too_large =
        is_too_large(problem) || problem.turns.size() + problem.edges.size() > kMaxProgramEntries;
    const std::optional<StopReason> stopped_by =
        too_large ? std::optional(StopReason::memory) : update(problem, &deadline);
    if (stopped_by) problem_cones_.reset();
    return stopped_by;
}

std::optional<StopReason> LaneGraphModel::update(const LaneGraphProblem& problem, const Deadline* deadline) {
    const bool same_size = problem.cone_count == problem_cones_;
    problem_ = &problem;
    if (!same_size || parts(formulation_).fixed_families.empty()) return build(deadline);
    refresh_costs();
    program_.truncate_rows(fixed_rows_);
    return write_rows(parts(formulation_).families, deadline);
}

std::optional<StopReason> LaneGraphModel::build(const Deadline* deadline) {
    problem_cones_ = problem_->cone_count;
    columns_.edge.clear();
    columns_.turn.clear();
    columns_.inlier.clear();
    columns_.not_far.clear();
    columns_.end.clear();
    program_.columns.clear();
    program_.truncate_rows(0);
    add_columns();
    if (const auto stopped_by = write_rows(parts(formulation_).fixed_families, deadline)) return stopped_by;
    fixed_rows_ = program_.rows.size();
    return write_rows(parts(formulation_).families, deadline);
}

void LaneGraphModel::add_columns() {
    const FormulationParts& formulation_parts = parts(formulation_);
    const bool all_integer = formulation_parts.all_integer;
    const auto index = [](std::size_t value) { return static_cast<std::int32_t>(value); };
    const LaneGraphProblem& problem = *problem_;
    program_.columns.reserve(problem.edges.size() + problem.turns.size() + 2 * problem.cone_count);

    columns_.edge.reserve(problem.edges.size());
    for (const ProblemEdge& edge : problem.edges) {
        columns_.edge.push_back(
            program_.add_column({"a", {index(edge.i), index(edge.j)}}, column_cost(edge), true));
    }
    columns_.turn.reserve(problem.turns.size());
    for (const ProblemTurn& turn : problem.turns) {
        if (turn.high_cost && !formulation_parts.high_cost_turns) {
            columns_.turn.push_back(-1);
            continue;
        }
        const ProblemEdge& a = problem.edges[turn.edge_i];
        const ProblemEdge& b = problem.edges[turn.edge_k];
        columns_.turn.push_back(
            program_.add_column({"f",
                                 {index(a.i == turn.middle ? a.j : a.i), index(turn.middle),
                                  index(b.i == turn.middle ? b.j : b.i)}},
                                column_cost(turn, problem), all_integer));
    }
    if (formulation_parts.inliers) {
        for (std::size_t cone = 0; cone < problem.cone_count; ++cone) {
            columns_.inlier.push_back(program_.add_column({"g", {index(cone)}}, 0.0, all_integer));
        }
    }
    if (formulation_parts.far_marks) {
        for (std::size_t cone = 0; cone < problem.cone_count; ++cone) {
            columns_.not_far.push_back(program_.add_column({"u", {index(cone)}}, 0.0, all_integer));
        }
    }
    if (formulation_parts.path_ends) {
        for (const ProblemEdge& edge : problem.edges) {
            // Columns of path ends are integral if the edges are. Which two ends face each other decides most
            // of the rest: branching on these columns first needs a quarter of the nodes at n = 30.
            const auto add_end = [&](std::size_t from, std::size_t end) {
                const int column = program_.add_column({"e", {index(from), index(end)}}, 0.0, true);
                program_.columns[static_cast<std::size_t>(column)].branch_first = true;
                return column;
            };
            const int at_i = add_end(edge.j, edge.i);
            columns_.end.push_back({at_i, add_end(edge.i, edge.j)});
        }
    }
}

void LaneGraphModel::refresh_costs() {
    for (std::size_t e = 0; e < problem_->edges.size(); ++e) {
        program_.columns[static_cast<std::size_t>(columns_.edge[e])].objective =
            column_cost(problem_->edges[e]);
    }
    for (std::size_t t = 0; t < problem_->turns.size(); ++t) {
        program_.columns[static_cast<std::size_t>(columns_.turn[t])].objective =
            column_cost(problem_->turns[t], *problem_);
    }
}

std::optional<StopReason> LaneGraphModel::write_rows(std::span<const ConstraintFamily> families,
                                                     const Deadline* deadline) {
    RowWriter rows(program_, deadline);
    for (const ConstraintFamily family : families) {
        family({*problem_, columns_, rows});
        if (rows.stop()) break;
    }
    return rows.stopped_by();
}

std::vector<bool> LaneGraphModel::chosen_edges(std::span<const double> point) const {
    std::vector<bool> chosen(problem_->edges.size());
    for (std::size_t edge = 0; edge < chosen.size(); ++edge) {
        chosen[edge] = point[static_cast<std::size_t>(columns_.edge[edge])] > 0.5;
    }
    return chosen;
}

LaneGraph LaneGraphModel::decode(std::span<const double> point) const {
    LaneGraph graph;
    for (std::size_t edge = 0; edge < problem_->edges.size(); ++edge) {
        if (point[static_cast<std::size_t>(columns_.edge[edge])] > 0.5) {
            graph.edges.push_back({problem_->edges[edge].i, problem_->edges[edge].j});
        }
    }
    return graph;
}

std::vector<ProgramRow> LaneGraphModel::separate(std::span<const double> point) const {
    const std::vector<bool> chosen = chosen_edges(point);
    std::vector<ProgramRow> rows = constraints::separate_cycles(*problem_, columns_, chosen);
    if (rows.empty() && problem_->parameters.pairing == Pairing::near_far) {
        rows = constraints::separate_near_near(*problem_, columns_, chosen);
    }
    return rows;
}

}  // namespace conelane
