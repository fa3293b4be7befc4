#pragma once

#include "conelane/core_solvers.hpp"
#include "model/binary_program.hpp"

#include <functional>

namespace conelane {

struct LinearRelaxation {
    double optimum;
    bool is_integral;  ///< no integer column has a fractional value
};

/// The optimum of the program without integrality, by Clp; nothing if it is infeasible. Precondition: the
/// program has a column.
[[nodiscard]] std::optional<LinearRelaxation> linear_relaxation(const BinaryProgram& program);

/// The lane-graph problem with edges between 0 and 1 and the products a_ij a_jk instead of f_ijk: a
/// quadratic, in general nonconvex objective under linear rows. Its minimum is not a bound, since (5) is left
/// out and solvers find local minima only. Variables: a_e of every edge that (27) allows, then g_i of every
/// cone.
class EdgeRelaxation {
  public:
    explicit EdgeRelaxation(const LaneGraphProblem& problem);

    struct Row {
        std::vector<std::pair<int, double>> terms;  ///< variable, factor; no variable twice
        double lower;
        double upper;
    };
    /// A term `factor` x_first x_second of the objective, first < second.
    struct Product {
        int first;
        int second;
        double factor;
    };

    [[nodiscard]] std::size_t variables() const { return edges_.size() + cone_count_; }
    [[nodiscard]] const std::vector<std::size_t>& edges() const { return edges_; }  ///< as problem edges
    [[nodiscard]] const std::vector<Row>& rows() const { return rows_; }
    /// The Hessian of the objective: constant, with these as its entries off the diagonal.
    [[nodiscard]] const std::vector<Product>& products() const { return products_; }

    [[nodiscard]] double objective(std::span<const double> x) const;
    void gradient(std::span<const double> x, std::span<double> result) const;

    /// Variables from values by problem edge; the variable of a cone is half its degree, at most 1.
    [[nodiscard]] std::vector<double> point(std::span<const double> edge_values) const;
    /// Values by problem edge, 0 for edges that (27) excludes.
    [[nodiscard]] std::vector<double> edge_values(std::span<const double> x) const;

  private:
    /// The rows of single paths: (1)-(3), (9), (11)-(17).
    void add_path_rows(const LaneGraphProblem& problem);

    std::size_t cone_count_;
    std::size_t problem_edges_;
    std::vector<std::size_t> edges_;
    std::vector<std::pair<int, int>> ends_;  ///< cones of each edge
    std::vector<double> costs_;
    std::vector<Product> products_;
    std::vector<Row> rows_;
};

/// Values in [0, 1] by problem edge, from those of the linear relaxation; nothing if the deadline passed
/// before there were any.
using Relax = std::function<std::optional<std::vector<double>>(
    const LaneGraphProblem& problem, const std::vector<double>& linear, const Deadline& deadline)>;

/// Solves the linear relaxation, improves its values by `relax` and rounds them by a search among the edges
/// that they favour. The bound is the linear relaxation's: a local minimum of a nonconvex problem is none.
/// Status feasible at best, infeasible if the linear relaxation is.
[[nodiscard]] std::unique_ptr<RldSolver> make_relaxation_solver(Relax relax);

/// Entries of relaxation_solvers, each defined beside its solver.
extern const RldSolverEntry kLpRounding;
extern const RldSolverEntry kNlopt;
extern const RldSolverEntry kIpopt;

}  // namespace conelane
