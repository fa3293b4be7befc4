#include "solvers/detail/exclusive_section.hpp"
#include "solvers/relaxation/relaxation_solver.hpp"

#include <coin/IpIpoptApplication.hpp>
#include <coin/IpTNLP.hpp>

namespace conelane {
namespace {

using Ipopt::Index;
using Ipopt::Number;

constexpr Number kInfinity = 2e19;  // beyond Ipopt's default of 1e19
/// The rounding uses values down to 1e-3 only.
constexpr double kTolerance = 1e-5;
constexpr int kMaxIterations = 200;

class RelaxationProgram : public Ipopt::TNLP {
  public:
    RelaxationProgram(const EdgeRelaxation& relaxation, std::vector<double> start, const Deadline& deadline)
        : relaxation_(relaxation), point_(std::move(start)), deadline_(deadline) {}

    [[nodiscard]] const std::vector<double>& point() const { return point_; }

    bool get_nlp_info(Index& n, Index& m, Index& jacobian_entries, Index& hessian_entries,
                      IndexStyleEnum& style) override {
        n = static_cast<Index>(relaxation_.variables());
        m = static_cast<Index>(relaxation_.rows().size());
        jacobian_entries = 0;
        for (const EdgeRelaxation::Row& row : relaxation_.rows()) {
            jacobian_entries += static_cast<Index>(row.terms.size());
        }
        hessian_entries = static_cast<Index>(relaxation_.products().size());
        style = C_STYLE;
        return true;
    }

    bool get_bounds_info(Index n, Number* lower, Number* upper, Index /*m*/, Number* row_lower,
                         Number* row_upper) override {
        std::fill(lower, lower + n, 0.0);
        std::fill(upper, upper + n, 1.0);
        for (const EdgeRelaxation::Row& row : relaxation_.rows()) {
            *row_lower++ = std::max(row.lower, -kInfinity);
            *row_upper++ = std::min(row.upper, kInfinity);
        }
        return true;
    }

    bool get_starting_point(Index /*n*/, bool /*with_x*/, Number* x, bool /*with_z*/, Number* /*z_lower*/,
                            Number* /*z_upper*/, Index /*m*/, bool /*with_lambda*/,
                            Number* /*lambda*/) override {
        std::ranges::copy(point_, x);
        return true;
    }

    bool eval_f(Index n, const Number* x, bool /*is_new*/, Number& value) override {
        value = relaxation_.objective({x, static_cast<std::size_t>(n)});
        return true;
    }

    bool eval_grad_f(Index n, const Number* x, bool /*is_new*/, Number* gradient) override {
        relaxation_.gradient({x, static_cast<std::size_t>(n)}, {gradient, static_cast<std::size_t>(n)});
        return true;
    }

    bool eval_g(Index /*n*/, const Number* x, bool /*is_new*/, Index /*m*/, Number* g) override {
        for (const EdgeRelaxation::Row& row : relaxation_.rows()) {
            Number sum = 0.0;
            for (const auto& [variable, factor] : row.terms) sum += factor * x[variable];
            *g++ = sum;
        }
        return true;
    }

    bool eval_jac_g(Index /*n*/, const Number* /*x*/, bool /*is_new*/, Index /*m*/, Index /*entries*/,
                    Index* row_index, Index* column_index, Number* values) override {
        Index index = 0;
        for (const EdgeRelaxation::Row& row : relaxation_.rows()) {
            for (const auto& [variable, factor] : row.terms) {
                if (values != nullptr) {
                    *values++ = factor;
                } else {
                    *row_index++ = index;
                    *column_index++ = variable;
                }
            }
            ++index;
        }
        return true;
    }

    bool eval_h(Index /*n*/, const Number* /*x*/, bool /*is_new_x*/, Number objective_factor, Index /*m*/,
                const Number* /*lambda*/, bool /*is_new_lambda*/, Index /*entries*/, Index* row_index,
                Index* column_index, Number* values) override {
        for (const EdgeRelaxation::Product& product : relaxation_.products()) {  // lower triangle
            if (values != nullptr) {
                *values++ = objective_factor * product.factor;
            } else {
                *row_index++ = product.second;
                *column_index++ = product.first;
            }
        }
        return true;
    }

    bool intermediate_callback(Ipopt::AlgorithmMode /*mode*/, Index /*iteration*/, Number /*objective*/,
                               Number /*primal*/, Number /*dual*/, Number /*barrier*/, Number /*step*/,
                               Number /*regularisation*/, Number /*dual_step*/, Number /*primal_step*/,
                               Index /*trials*/, const Ipopt::IpoptData* /*data*/,
                               Ipopt::IpoptCalculatedQuantities* /*quantities*/) override {
        return !deadline_.passed();
    }

    void finalize_solution(Ipopt::SolverReturn /*status*/, Index n, const Number* x,
                           const Number* /*z_lower*/, const Number* /*z_upper*/, Index /*m*/,
                           const Number* /*g*/, const Number* /*lambda*/, Number /*objective*/,
                           const Ipopt::IpoptData* /*data*/,
                           Ipopt::IpoptCalculatedQuantities* /*quantities*/) override {
        if (x != nullptr) point_.assign(x, x + n);
    }

  private:
    const EdgeRelaxation& relaxation_;
    std::vector<double> point_;
    const Deadline& deadline_;
};

std::timed_mutex one_at_a_time;

/// Edge values at Ipopt's last point, also without convergence: the rounding repairs them.
std::optional<std::vector<double>> minimise(const LaneGraphProblem& problem, const std::vector<double>& start,
                                            const Deadline& deadline) {
    const auto lock = detail::lock_until(one_at_a_time, deadline);
    if (!lock.owns_lock()) return std::nullopt;
    const EdgeRelaxation relaxation(problem);
    const Ipopt::SmartPtr<RelaxationProgram> program =
        new RelaxationProgram(relaxation, relaxation.point(start), deadline);
    const Ipopt::SmartPtr<Ipopt::IpoptApplication> application = new Ipopt::IpoptApplication(false);
    application->Options()->SetIntegerValue("print_level", 0);
    application->Options()->SetStringValue("sb", "yes");
    application->Options()->SetStringValue("jac_c_constant", "yes");
    application->Options()->SetStringValue("jac_d_constant", "yes");
    application->Options()->SetStringValue("hessian_constant", "yes");
    application->Options()->SetNumericValue("tol", kTolerance);
    application->Options()->SetIntegerValue("max_iter", kMaxIterations);
    if (application->Initialize("") == Ipopt::Solve_Succeeded) {
        (void)application->OptimizeTNLP(Ipopt::SmartPtr<Ipopt::TNLP>(Ipopt::GetRawPtr(program)));
    }
    return relaxation.edge_values(program->point());
}

}  // namespace

/// A local minimum of EdgeRelaxation. One solve at a time in a process: Ipopt's linear solver MUMPS keeps
/// global state; the time limit includes waiting for another solve. Ipopt checks the clock only between its
/// iterations, so one iteration may overrun a limit, and so may its start-up, some milliseconds in the first
/// solve of a process.
constexpr RldSolverEntry kIpopt{.name = "ipopt",
                                .description = "Ipopt on the relaxation with products, rounded; no proof",
                                .traits = SolverTrait::refuses_huge_costs,
                                .make = [](Formulation) { return make_relaxation_solver(minimise); },
                                .library = "Ipopt " IPOPT_VERSION};

}  // namespace conelane
