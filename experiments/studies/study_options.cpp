#include "experiments/studies/study_options.hpp"

#include "experiments/options/shared_options.hpp"

namespace conelane::experiments {

void add_input_options(CLI::App& command, StudyInput& input) {
    command.add_option("--scenes", input.scenes, "*.scenes.jsonl")->required();
    add_parameter_options(command, input.parameters, "the defaults");
}

void add_sizes_option(CLI::App& command, std::vector<std::size_t>& sizes) {
    command.add_option("--sizes", sizes, "cones of a scene, the nearest ahead")
        ->delimiter(',')
        ->check(whole_number(1, 1000))
        ->capture_default_str();
}

void add_cone_set_options(CLI::App& command, ConeSetOptions& options) {
    add_sizes_option(command, options.sizes);
    command
        .add_option_function<std::size_t>(
            "--limit", [&options](std::size_t count) { options.limit = count; },
            "scenes of each size at most, evenly spread")
        ->check(whole_number(1, 1'000'000));
    add_time_limit_option(command, options.time_limit_ms);
}

}  // namespace conelane::experiments
