#include "evaluation/proofs/exact_arithmetic.hpp"

#include "conelane/check.hpp"
#include "model/lane_graph_model.hpp"
#include "model/lane_graph_reference.hpp"

#include <set>
#include <stdexcept>

#include <boost/multiprecision/cpp_bin_float.hpp>

namespace conelane {
namespace {

using Real = boost::multiprecision::cpp_bin_float_50;

/// Pairs of edges whose distance exceeds d_min by more than this are not tested.
constexpr double kSlack_m = 1e-3;

/// One unit below the rounded-down value: the error of 50 digits is far smaller.
Exact rounded_down(const Real& value) {
    return Exact(boost::multiprecision::floor(ldexp(value, kExactFractionBits))) - 1;
}

class Builder {
  public:
    Builder(const Scene& scene, const RldParameters& parameters)
        : scene_(scene), p_(parameters), without_costs_(parameters), reference_(scene, parameters) {
        without_costs_.facing_weight = 0.0;
        without_costs_.w_color = 0.0;
        without_costs_.learned_costs.reset();
    }

    ExactScene run() {
        find_edges();
        find_excluded();
        find_successions();
        find_ends();
        return std::move(result_);
    }

  private:
    void find_edges() {
        for (std::size_t i = 0; i < scene_.cones.size(); ++i) {
            for (std::size_t j = i + 1; j < scene_.cones.size(); ++j) {
                const CheckReport report = check(scene_, without_costs_, {{{i, j}}});
                if (report.is_final) continue;
                result_.edges.push_back({i, j});
                result_.along_heading.push_back(report.along_heading > 0);
                result_.edge_cost.push_back(rounded_down(reference_.edge_cost({i, j})));
            }
        }
    }

    [[nodiscard]] bool are_far_from_each_other(const Edge& a, const Edge& b) const {
        const auto position = [&](std::size_t cone) -> const Point& { return scene_.cones[cone].position; };
        const double apart =
            (0.5 * (position(a.i) + position(a.j)) - 0.5 * (position(b.i) + position(b.j))).norm();
        const double reach =
            0.5 * (position(a.i) - position(a.j)).norm() + 0.5 * (position(b.i) - position(b.j)).norm();
        return apart > reach + p_.d_min + kSlack_m;
    }

    void find_excluded() {
        const std::size_t count = result_.edges.size();
        result_.excluded.assign(count, boost::dynamic_bitset<>(count));
        for (std::size_t e = 0; e < count; ++e) {
            for (std::size_t f = e + 1; f < count; ++f) {
                if (are_far_from_each_other(result_.edges[e], result_.edges[f])) continue;
                if (!check(scene_, without_costs_, {{result_.edges[e], result_.edges[f]}}).is_final) continue;
                result_.excluded[e].set(f);
                result_.excluded[f].set(e);
            }
        }
    }

    void find_successions() {
        std::vector<std::vector<std::size_t>> leaving(scene_.cones.size());
        for (std::size_t a = 0; a < 2 * result_.edges.size(); ++a) leaving[result_.tail(a)].push_back(a);
        result_.successions.resize(2 * result_.edges.size());
        for (std::size_t a = 0; a < 2 * result_.edges.size(); ++a) {
            for (const std::size_t b : leaving[result_.head(a)]) {
                if (b / 2 == a / 2 || result_.excluded[a / 2][b / 2]) continue;
                // A turn costs the same in both directions.
                const std::size_t back = b ^ 1U;
                const auto known = back < a ? std::ranges::find(result_.successions[back], a ^ 1U,
                                                                &ExactScene::Succession::arc)
                                            : result_.successions[back].end();
                const bool is_known = back < a && known != result_.successions[back].end();
                result_.successions[a].push_back(
                    {b, is_known ? known->cost
                                 : rounded_down(reference_.turn_cost(result_.tail(a), result_.head(a),
                                                                     result_.head(b)))});
            }
        }
    }

    void find_ends() {
        const std::size_t count = scene_.cones.size();
        for (std::size_t cone = 0; cone < count; ++cone) {
            result_.near.push_back(reference_.is_near(cone));
            const bool has_cost = result_.near.back() || p_.learned_costs;
            result_.end_cost.push_back(has_cost ? rounded_down(reference_.end_cost(cone)) : Exact(0));
        }
        result_.partners.assign(count, std::vector<bool>(count, false));
        for (std::size_t f = 0; f < count; ++f) {
            for (std::size_t g = 0; g < count; ++g) {
                if (f == g || result_.near[f] || result_.near[g]) continue;
                result_.partners[f][g] = !reference_.are_apart(f, g);
            }
        }
    }

    const Scene& scene_;
    const RldParameters& p_;
    RldParameters without_costs_;
    LaneGraphReference<Real> reference_;
    ExactScene result_;
};

double magnitude(const Rational& value) {
    return Rational(abs(value)).convert_to<double>();
}

/// By how much the value is outside its bounds; kInfinity stands for an absent bound.
double outside(const Rational& value, double lower, double upper) {
    if (lower > -kInfinity && value < Rational(lower)) return magnitude(Rational(lower) - value);
    if (upper < kInfinity && value > Rational(upper)) return magnitude(value - Rational(upper));
    return 0.0;
}

void note_violation(ExactProgramReport& report, double violation, const Label& label) {
    if (violation <= report.violation) return;
    report.violation = violation;
    report.violated = to_string(label);
}

}  // namespace

Exact exact_below(double value) {
    return Exact(boost::multiprecision::floor(ldexp(Real(value), kExactFractionBits)));
}

std::optional<std::size_t> ExactScene::find(const Edge& edge) const {
    const auto found = std::ranges::lower_bound(edges, edge);
    if (found == edges.end() || *found != edge) return std::nullopt;
    return static_cast<std::size_t>(found - edges.begin());
}

Exact ExactScene::cost_limit() const {
    Exact sum = Exact(1) << kExactFractionBits;
    for (const Exact& cost : edge_cost) {
        if (cost > 0) sum += cost;
    }
    for (std::size_t a = 0; a < successions.size(); ++a) {
        for (const Succession& next : successions[a]) {
            if (a < (next.arc ^ 1U)) sum += next.cost;
        }
    }
    return sum;
}

ExactScene make_exact_scene(const Scene& scene, const RldParameters& parameters) {
    return Builder(scene, parameters).run();
}

double exact_difference(const Rational& exact, double stated) {
    return magnitude(exact - Rational(stated));
}

ExactProgramReport recompute_exactly(const BinaryProgram& program, std::span<const double> point) {
    ExactProgramReport report;
    report.rows = program.rows.size();
    double sum = 0.0;
    for (std::size_t c = 0; c < program.columns.size(); ++c) {
        const BinaryProgram::Column& column = program.columns[c];
        note_violation(report, outside(Rational(point[c]), column.lower, column.upper), column.label);
        if (point[c] == 0.0 || column.objective == 0.0) continue;
        report.objective += Rational(column.objective) * Rational(point[c]);
        sum += column.objective * point[c];
        ++report.terms;
    }
    report.objective_rounding = exact_difference(report.objective, sum);
    for (std::size_t r = 0; r < program.rows.size(); ++r) {
        Rational activity = 0;
        double rounded = 0.0;
        program.for_each_entry(r, [&](std::size_t column, double value) {
            if (point[column] == 0.0) return;
            activity += Rational(value) * Rational(point[column]);
            rounded += value * point[column];
            ++report.terms;
        });
        report.row_rounding = std::max(report.row_rounding, exact_difference(activity, rounded));
        const BinaryProgram::RowBounds& row = program.rows[r];
        note_violation(report, outside(activity, row.lower, row.upper), row.label);
    }
    return report;
}

std::vector<double> point_of(const BinaryProgram& program, const LaneGraph& graph,
                             const std::vector<bool>& near) {
    const std::set<Edge> chosen(graph.edges.begin(), graph.edges.end());
    std::vector<std::size_t> degree(near.size(), 0);
    for (const Edge& edge : graph.edges) {
        ++degree.at(edge.i);
        ++degree.at(edge.j);
    }
    std::size_t edges_met = 0;
    std::vector<double> point;
    point.reserve(program.columns.size());
    for (const BinaryProgram::Column& column : program.columns) {
        const std::string_view family = column.label.family;
        const auto first = static_cast<std::size_t>(column.label.index.first);
        const auto second = static_cast<std::size_t>(column.label.index.second);
        const auto third = static_cast<std::size_t>(column.label.index.third);
        const auto is_chosen = [&](std::size_t a, std::size_t b) { return chosen.contains(make_edge(a, b)); };
        bool value = false;
        if (family == "a") {
            value = is_chosen(first, second);
            if (value) ++edges_met;
        } else if (family == "f") {
            value = is_chosen(first, second) && is_chosen(second, third);
        } else if (family == "g") {
            value = degree.at(first) > 0;
        } else if (family == "u") {
            value = near.at(first) || degree.at(first) != 1;
        } else if (family == "e") {
            value = is_chosen(first, second) && degree.at(second) == 1;
        } else {
            throw std::invalid_argument("the column " + to_string(column.label) + " has no meaning");
        }
        point.push_back(value ? 1.0 : 0.0);
    }
    if (edges_met != chosen.size()) throw std::invalid_argument("an edge of the lane graph has no column");
    return point;
}

std::optional<ExactProgramReport> recompute_exactly(const Scene& scene, const RldParameters& parameters,
                                                    Formulation formulation, const LaneGraph& graph) {
    const Deadline never(std::numeric_limits<double>::infinity());
    const LimitedProblem limited = make_problem(scene, parameters, parts(formulation).extent, never);
    if (!limited.problem) return std::nullopt;
    LaneGraphModel model(formulation);
    if (model.update(*limited.problem, never)) return std::nullopt;
    const std::vector<double> point = point_of(model.program(), graph, limited.problem->near);
    ExactProgramReport report = recompute_exactly(model.program(), point);
    for (const ProgramRow& row : model.separate(point)) {
        Rational activity = 0;
        for (const auto& [column, value] : row.terms)
            activity += Rational(value) * Rational(point[static_cast<std::size_t>(column)]);
        note_violation(report, outside(activity, row.lower, row.upper), row.label);
    }
    return report;
}

}  // namespace conelane
