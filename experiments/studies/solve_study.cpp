#include "experiments/studies/solve_study.hpp"

#include "conelane/invalid_input.hpp"
#include "experiments/options/shared_options.hpp"

#include <algorithm>
#include <functional>
#include <utility>

namespace conelane::experiments {

SolveStudy::SolveStudy(const StudyDescription& description, SolveOptions solves)
    : SceneStudy(description), solves_(std::move(solves)) {
    std::ranges::transform(solves_.sizes, std::back_inserter(sizes_), size_name);
}

void SolveStudy::add_options(CLI::App& command) {
    SceneStudy::add_options(command);
    add_parameter_options(command, parameters_, "the defaults");
    if (!sizes_.empty()) {
        add_sizes_option(command, sizes_, "cones of a scene, the nearest ahead; `all` for all visible cones");
    }
    add_limit_option(command, solves_.limit, "scenes of each size at most, evenly spread");
    if (solves_.time_limit_ms > 0.0) add_time_limit_option(command, solves_.time_limit_ms);
}

StudyResult SolveStudy::measure(const SceneSet& set) {
    SolveOptions solves = solves_;
    solves.parameters = parameters_.load();
    solves.sizes.clear();
    for (const std::optional<std::size_t>& size : cone_set_sizes("--sizes", sizes_))
        solves.sizes.push_back(size.value_or(kAllVisible));
    return aggregate(set, std::move(solves));
}

void add_limit_option(CLI::App& command, std::optional<std::size_t>& limit, const std::string& description) {
    command.add_option("--limit", limit, description)->check(whole_number(1, 1'000'000));
}

CLI::Option* add_limits_option(CLI::App& command, const std::string& name, std::vector<double>& limits_ms,
                               const std::string& description) {
    return command.add_option(name, limits_ms, description)->delimiter(',')->check(CLI::Range(0.1, 1e7));
}

void require_ascending(const std::string& name, const std::vector<double>& limits_ms) {
    if (!std::ranges::is_sorted(limits_ms, std::less_equal()))
        throw InvalidInput(name, "must be in ascending order");
}

}  // namespace conelane::experiments
