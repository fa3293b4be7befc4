#include "experiments/studies/backend.hpp"

#include "conelane/invalid_input.hpp"
#include "conelane/version.hpp"
#include "experiments/studies/permuted_solver.hpp"
#include "solvers/registry.hpp"

#include <algorithm>
#include <utility>

#include <coin/CbcConfig.h>
#include <coin/ClpConfig.h>
#include <fmt/format.h>

namespace conelane::experiments {
namespace {

const RldSolverEntry& entry_of(const Backend& backend) {
    const RldSolverEntry* entry = find_rld_solver(backend.solver);
    if (entry == nullptr) throw InvalidInput("--solvers", "there is no solver '" + backend.solver + "'");
    return *entry;
}

}  // namespace

bool Backend::uses_formulation() const {
    if (outside) return true;
    const RldSolverEntry* entry = find_rld_solver(solver);
    return entry != nullptr && entry->uses_formulation;
}

std::string Backend::label() const {
    std::string label = solver;
    if (uses_formulation()) label += fmt::format("/{}", to_string(formulation));
    if (all_rows) label += " whole";
    return warm_start ? label + " warm" : label;
}

bool Backend::takes(std::size_t cones) const {
    if (outside) return true;
    const RldSolverEntry& entry = entry_of(*this);
    return !entry.max_cones || cones <= *entry.max_cones;
}

std::vector<Backend> exact_backends() {
    std::vector<Backend> backends;
    for (const RldSolverEntry& entry : rld_solvers()) {
        if (entry.exact) backends.push_back({std::string(entry.name)});
    }
    return backends;
}

Backend backend_of(std::string_view name) {
    if (const auto outside = parse_outside_solver(name)) {
        return {.solver = outside->name,
                .formulation = outside->formulation.value_or(Formulation::tight),
                .outside = *outside};
    }
    const std::size_t slash = std::min(name.find('/'), name.size());
    Backend backend{std::string(name.substr(0, slash))};
    const RldSolverEntry& entry = entry_of(backend);
    if (!entry.exact) throw InvalidInput("--solvers", "'" + backend.solver + "' proves no optimum");
    if (slash == name.size()) return backend;
    for (const Formulation formulation : {Formulation::tight, Formulation::paper}) {
        if (!entry.uses_formulation || to_string(formulation) != name.substr(slash + 1)) continue;
        backend.formulation = formulation;
        return backend;
    }
    throw InvalidInput("--solvers",
                       fmt::format("'{}' has no formulation '{}'", backend.solver, name.substr(slash + 1)));
}

BackendSolver::BackendSolver(const Backend& backend, std::uint64_t seed) : name_(backend.solver) {
    if (backend.outside) {
        outside_ = std::make_unique<OutsideSolver>(
            *backend.outside, OutsideSolverOptions{backend.formulation, backend.all_rows});
        outside_->set_seed(seed);
        return;
    }
    const RldSolverEntry& entry = entry_of(backend);
    if (seed != 0) inside_ = make_permuted_solver(backend.solver, backend.formulation, seed);
    if (!inside_) inside_ = entry.make(backend.formulation);
}

std::optional<double> BackendSolver::engine_ms() const {
    return outside_ ? outside_->engine_ms() : std::nullopt;
}

bool BackendSolver::set_seed(std::uint64_t seed) {
    if (outside_) outside_->set_seed(seed);
    return outside_ != nullptr;
}

std::string BackendSolver::version() const {
    if (outside_) return outside_->version();
    if (name_.starts_with("cbc")) return "CBC " CBC_VERSION ", Clp " CLP_VERSION;
    if (name_.starts_with("clp")) return "Clp " CLP_VERSION;
    return "conelane " + std::string(conelane::version());
}

std::optional<std::size_t> BackendSolver::end() {
    if (!outside_) return std::nullopt;
    outside_->end();
    return outside_->peak_bytes();
}

}  // namespace conelane::experiments
