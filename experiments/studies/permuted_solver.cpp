#include "experiments/studies/permuted_solver.hpp"

#include "evaluation/outside/permuted_program.hpp"
#include "solvers/milp/cbc_main_solver.hpp"
#include "solvers/milp/cbc_solver.hpp"
#include "solvers/milp/clp_bb_solver.hpp"
#include "solvers/milp/milp_rld_solver.hpp"

#include <array>
#include <span>
#include <utility>
#include <vector>

namespace conelane::experiments {
namespace {

class PermutedSession : public MilpSession {
  public:
    PermutedSession(const MilpSolver& solver, PermutedProgram program)
        : program_(std::move(program)), session_(solver.load(program_.program)) {}

    MilpReport solve(const MilpLimits& limits) override {
        MilpReport report = session_->solve(limits);
        report.point = program_.point_of(report.point);
        return report;
    }

    void add_rows(std::span<const ProgramRow> rows) override {
        std::vector<ProgramRow> renamed(rows.begin(), rows.end());
        for (ProgramRow& row : renamed) {
            for (auto& [column, value] : row.terms)
                column = static_cast<int>(program_.column_of[static_cast<std::size_t>(column)]);
        }
        session_->add_rows(renamed);
    }

  private:
    PermutedProgram program_;
    std::unique_ptr<MilpSession> session_;
};

class PermutedSolver : public MilpSolver {
  public:
    PermutedSolver(std::unique_ptr<MilpSolver> solver, std::uint64_t seed)
        : solver_(std::move(solver)), seed_(seed) {}

    std::unique_ptr<MilpSession> load(const BinaryProgram& program) const override {
        return std::make_unique<PermutedSession>(*solver_, permuted(program, seed_));
    }

  private:
    std::unique_ptr<MilpSolver> solver_;
    std::uint64_t seed_;
};

struct Maker {
    std::string_view name;
    std::unique_ptr<MilpSolver> (*make)();
};
constexpr std::array kMakers{Maker{"cbc", make_cbc_solver}, Maker{"cbc-main", make_cbc_main_solver},
                             Maker{"clp-bb", make_clp_bb_solver}};

}  // namespace

std::unique_ptr<RldSolver> make_permuted_solver(std::string_view name, Formulation formulation,
                                                std::uint64_t seed) {
    for (const Maker& maker : kMakers) {
        if (maker.name != name) continue;
        return make_milp_rld_solver(std::make_unique<PermutedSolver>(maker.make(), seed), formulation);
    }
    return nullptr;
}

}  // namespace conelane::experiments
