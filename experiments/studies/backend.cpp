#include "experiments/studies/backend.hpp"

#include "conelane/detectors.hpp"
#include "conelane/invalid_input.hpp"
#include "solvers/milp/milp_solver.hpp"
#include "solvers/registry.hpp"

#include <fmt/format.h>

namespace conelane::experiments {
namespace {

const RldSolverEntry& entry_of(const Backend& backend) {
    const RldSolverEntry* entry = find_rld_solver(backend.solver);
    if (entry == nullptr) throw InvalidInput("--solvers", "there is no solver '" + backend.solver + "'");
    return *entry;
}

class PermutedSession : public MilpSession {
  public:
    PermutedSession(const MilpBackend& backend, PermutedProgram program)
        : program_(std::move(program)), session_(backend.load(program_.program)) {}

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

std::unique_ptr<RldSolver> make_inside(const RldSolverEntry& entry, const ProgramForm& form) {
    const MilpBackend* const milp = find_milp_backend(entry.name);
    if (milp == nullptr) return entry.make(form.formulation);
    return make_milp_rld_solver(
        [&backend = *milp](const BinaryProgram& program, std::uint64_t seed) -> std::unique_ptr<MilpSession> {
            if (seed == 0) return backend.load(program);
            return std::make_unique<PermutedSession>(backend, permuted(program, seed));
        },
        form);
}

}  // namespace

bool Backend::uses_formulation() const {
    if (outside) return true;
    const RldSolverEntry* entry = find_rld_solver(solver);
    return entry != nullptr && entry->has(SolverTrait::uses_formulation);
}

std::string Backend::label() const {
    std::string label = solver;
    if (uses_formulation()) label += fmt::format("/{}", to_string(formulation));
    if (all_rows) label += " whole";
    return warm_start ? label + " warm" : label;
}

std::string Backend::treatment() const {
    const std::string start = warm_start ? "the last lane as start" : "no start";
    if (!uses_formulation()) return "no program; " + start;
    const bool tuned = !outside && entry_of(*this).has(SolverTrait::tuned);
    return fmt::format("{} rows, {}; settings: {}; {}",
                       formulation == Formulation::paper ? "printed" : "tight",
                       all_rows ? "all" : "on demand",
                       outside ? "of its command"
                       : tuned ? "tuned"
                               : "defaults",
                       start);
}

bool Backend::takes(std::size_t cones) const {
    if (outside) return true;
    const RldSolverEntry& entry = entry_of(*this);
    return !entry.max_cones || (cones > 0 && cones <= *entry.max_cones);
}

std::vector<Backend> exact_backends() {
    std::vector<Backend> backends;
    for (const RldSolverEntry& entry : rld_solvers()) {
        if (entry.has(SolverTrait::exact)) backends.push_back({std::string(entry.name)});
    }
    return backends;
}

Backend backend_of(std::string_view text) {
    std::string name(text);
    constexpr std::string_view kAllRows = "/all-rows";
    const std::size_t named = std::min(name.find('='), name.size());  // a command may hold anything
    if (std::string_view(name).substr(0, named).ends_with(kAllRows)) {
        Backend backend = backend_of(name.erase(named - kAllRows.size(), kAllRows.size()));
        if (!backend.uses_formulation())
            throw InvalidInput("--solvers", fmt::format("'{}' has no rows", backend.solver));
        backend.all_rows = true;
        return backend;
    }
    if (const auto outside = parse_outside_solver(name)) {
        return {.solver = outside->name,
                .formulation = outside->formulation.value_or(Formulation::tight),
                .outside = *outside};
    }
    const std::size_t slash = std::min(name.find('/'), name.size());
    Backend backend{name.substr(0, slash)};
    const RldSolverEntry& entry = entry_of(backend);
    if (!entry.has(SolverTrait::exact))
        throw InvalidInput("--solvers", "'" + backend.solver + "' proves no optimum");
    if (slash == name.size()) return backend;
    for (const Formulation formulation : {Formulation::tight, Formulation::paper}) {
        if (!entry.has(SolverTrait::uses_formulation) || to_string(formulation) != name.substr(slash + 1))
            continue;
        backend.formulation = formulation;
        return backend;
    }
    throw InvalidInput("--solvers",
                       fmt::format("'{}' has no formulation '{}'", backend.solver, name.substr(slash + 1)));
}

BackendSolver::BackendSolver(const Backend& backend) {
    if (backend.outside) {
        outside_ = std::make_unique<OutsideSolver>(
            *backend.outside, OutsideSolverOptions{backend.formulation, backend.all_rows});
        return;
    }
    const RldSolverEntry& entry = entry_of(backend);
    library_ = entry.library;
    inside_ = make_inside(entry, {backend.formulation, backend.all_rows});
}

std::optional<double> BackendSolver::engine_ms() const {
    return outside_ ? outside_->engine_ms() : std::nullopt;
}

std::string BackendSolver::version() const {
    if (outside_) return outside_->version();
    return library_.empty() ? "conelane " + std::string(conelane::version()) : std::string(library_);
}

std::optional<std::size_t> BackendSolver::end() {
    if (!outside_) return std::nullopt;
    outside_->end();
    return outside_->peak_bytes();
}

}  // namespace conelane::experiments
