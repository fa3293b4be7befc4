#include "solvers/relaxation/relaxation_solver.hpp"

#include <nlopt.hpp>

namespace conelane {
namespace {

/// Allowed violation of rows: the rounding uses values down to 1e-3 only.
constexpr double kRowTolerance = 1e-5;
constexpr double kMinStep = 1e-4;
constexpr int kMaxEvaluations = 500;
constexpr int kMaxEvaluationsOfOneBoxProblem = 100;

/// One side of a row in NLopt's form: factor (terms - limit), at most zero or equal to zero.
struct RowSide {
    const EdgeRelaxation::Row* row;
    double factor;
    double limit;

    [[nodiscard]] double value(const double* x) const {
        double sum = 0.0;
        for (const auto& [variable, term] : row->terms) sum += term * x[variable];
        return factor * (sum - limit);
    }
};

class RelaxationDescent {
  public:
    RelaxationDescent(const EdgeRelaxation& relaxation, std::vector<double> start, const Deadline& deadline)
        : relaxation_(relaxation), deadline_(deadline), best_point_(std::move(start)) {
        for (const EdgeRelaxation::Row& row : relaxation.rows()) {
            if (row.lower == row.upper) {
                equalities_.push_back({&row, 1.0, row.upper});
                continue;
            }
            if (std::isfinite(row.upper)) inequalities_.push_back({&row, 1.0, row.upper});
            if (std::isfinite(row.lower)) inequalities_.push_back({&row, -1.0, row.lower});
        }
    }

    /// The best point that was evaluated before NLopt or the deadline ended the search.
    std::vector<double> run() {
        const auto n = static_cast<unsigned>(relaxation_.variables());
        nlopt::opt in_box(nlopt::LD_MMA, n);
        in_box.set_xtol_abs(kMinStep);
        in_box.set_maxeval(kMaxEvaluationsOfOneBoxProblem);
        nlopt::opt search(nlopt::AUGLAG, n);
        search.set_local_optimizer(in_box);
        search.set_lower_bounds(0.0);
        search.set_upper_bounds(1.0);
        search.set_min_objective(&RelaxationDescent::objective, this);
        search.add_inequality_mconstraint(&RelaxationDescent::row_values, &inequalities_,
                                          std::vector<double>(inequalities_.size(), kRowTolerance));
        search.add_equality_mconstraint(&RelaxationDescent::row_values, &equalities_,
                                        std::vector<double>(equalities_.size(), kRowTolerance));
        search.set_xtol_abs(kMinStep);
        search.set_maxeval(kMaxEvaluations);
        std::vector<double> point = best_point_;
        double reached = 0.0;
        try {
            (void)search.optimize(point, reached);
        } catch (const nlopt::roundoff_limited&) {
            // The best point is kept, as below.
        } catch (const nlopt::forced_stop&) {
        }
        return best_point_;
    }

  private:
    /// The gradient is dense, row after row.
    static void row_values(unsigned /*m*/, double* result, unsigned n, const double* x, double* gradient,
                           void* sides) {
        for (const RowSide& side : *static_cast<const std::vector<RowSide>*>(sides)) {
            *result++ = side.value(x);
            if (gradient == nullptr) continue;
            std::fill(gradient, gradient + n, 0.0);
            for (const auto& [variable, term] : side.row->terms) gradient[variable] = side.factor * term;
            gradient += n;
        }
    }

    static double objective(const std::vector<double>& x, std::vector<double>& gradient, void* self) {
        return static_cast<RelaxationDescent*>(self)->objective(x, gradient);
    }
    double objective(const std::vector<double>& x, std::vector<double>& gradient) {
        if (deadline_.passed()) throw nlopt::forced_stop();
        if (!gradient.empty()) relaxation_.gradient(x, gradient);
        const double value = relaxation_.objective(x);
        const double violation = std::max(kRowTolerance, largest_violation(x));
        if (std::pair(violation, value) < best_) {
            best_ = {violation, value};
            best_point_ = x;
        }
        return value;
    }

    [[nodiscard]] double largest_violation(const std::vector<double>& x) const {
        double largest = 0.0;
        for (const RowSide& side : inequalities_) largest = std::max(largest, side.value(x.data()));
        for (const RowSide& side : equalities_) largest = std::max(largest, std::abs(side.value(x.data())));
        return largest;
    }

    const EdgeRelaxation& relaxation_;
    const Deadline& deadline_;
    std::vector<RowSide> inequalities_;
    std::vector<RowSide> equalities_;
    std::vector<double> best_point_;
    /// Violation and objective of the best point.
    std::pair<double, double> best_{std::numeric_limits<double>::infinity(), 0.0};
};

std::optional<std::vector<double>> minimise(const LaneGraphProblem& problem,
                                            const std::vector<double>& linear, const Deadline& deadline) {
    const EdgeRelaxation relaxation(problem);
    return relaxation.edge_values(RelaxationDescent(relaxation, relaxation.point(linear), deadline).run());
}

}  // namespace

/// A point near a local minimum of EdgeRelaxation. NLopt's augmented Lagrangian (AUGLAG) moves the rows into
/// the objective, and the method of moving asymptotes (LD_MMA) minimises it in the box; their cost is that of
/// the entries of the rows. Other choices on 20 scenes a size: SLSQP is as good at n = 12 and takes eight
/// times as long at n = 30, because its quadratic program is dense; LD_MMA with the inequalities as its
/// constraints takes seconds, with a dual variable for each of hundreds of rows; LD_LBFGS under AUGLAG is as
/// fast and ends in worse points; LD_CCSAQ under it is worse at n = 12 and 20, as good at 30. Of the points
/// evaluated, the one with the least violation counts; within the tolerance, the cheapest.
constexpr RldSolverEntry kNlopt{.name = "nlopt",
                                .description = "NLopt on the relaxation with products, rounded; no proof",
                                .traits = SolverTrait::refuses_huge_costs,
                                .make = [](Formulation) { return make_relaxation_solver(minimise); },
                                .library = "NLopt"};

}  // namespace conelane
