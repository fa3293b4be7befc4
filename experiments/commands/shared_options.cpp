#include "experiments/commands/shared_options.hpp"

#include "detectors/rld_parameter_sets.hpp"
#include "experiments/files/atomic_file.hpp"
#include "experiments/files/input_error.hpp"
#include "experiments/files/parameter_file.hpp"

#include <charconv>
#include <cstdint>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace conelane::experiments {
namespace {

constexpr unsigned kMostThreads = 1024;

/// What is wrong with the text of a seed, nothing where it is right. Negative and larger ones would wrap.
std::string seed_fault(const std::string& text) {
    std::uint64_t seed = 0;
    const char* const end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data(), end, seed);
    if (error == std::errc{} && rest == end) return {};
    return fmt::format("'{}' is no non-negative integer of 64 bits", text);
}

/// Why a file cannot be written, nothing where it can.
std::string output_fault(const std::string& file) {
    try {
        require_writable(file);
        return {};
    } catch (const InputError& error) {
        return error.what();
    }
}

/// What is wrong with the text of a time limit, nothing where it is right.
std::string time_limit_fault(const std::string& text) {
    double limit_ms = 0.0;
    if (CLI::detail::lexical_cast(text, limit_ms) && limit_ms > 0.0) return {};
    return fmt::format("'{}' is no number above 0", text);
}

}  // namespace

void add_scene_options(CLI::App& command, SceneOptions& options) {
    command.add_option("--fp", options.false_positive_rates, "false positives / all points of a scene")
        ->delimiter(',')
        ->capture_default_str();
    command.add_option("--range", options.ranges_m, "radius of the visible half disc [m]")
        ->delimiter(',')
        ->capture_default_str();
    command.add_option("--every", options.every_m, "travel between poses [m]")->capture_default_str();
    command.add_option("--noise", options.noise_sigma_m, "standard deviation of the seen positions [m]");
    command
        .add_option_function<std::vector<double>>(
            "--pose-noise",
            [&options](const std::vector<double>& values) {
                options.pose_noise_lateral_m = values[0];
                options.pose_noise_yaw_rad = values[1];
            },
            "standard deviations of the pose: LATERAL [m], YAW [rad]")
        ->delimiter(',')
        ->expected(2);
    command.add_option("--miss", options.miss_rate, "share of the cones not seen");
    command.add_flag("--color", options.with_color, "scenes carry the colours of their cones");
    command.add_option("--color-error", options.color_error_rate,
                       "with --color: share of the cones seen in the other boundary's colour");
    command.add_flag("--confidence", options.with_confidence,
                     "scenes carry simulated confidences, lower ones for false positives");
    command.add_option("--seed", options.seed, "base seed")
        ->check(CLI::Validator(seed_fault, ""))
        ->capture_default_str();
}

void add_seed_option(CLI::App& command, std::optional<std::uint64_t>& seed, const std::string& meaning) {
    command.add_option("--seed", seed, meaning)->check(CLI::Validator(seed_fault, ""));
}

RldParameters ParameterSource::load() const {
    DetectorOptions options;
    apply_to(options);
    RldParameters parameters = options.rld_parameters.value_or(RldParameters{});
    if (options.pairing) parameters.pairing = *options.pairing;
    return parameters;
}

void ParameterSource::apply_to(DetectorOptions& options) const {
    if (!name.empty()) {
        const auto shipped = rld_parameter_set(name);
        options.rld_parameters = shipped ? *shipped : read_rld_parameters(name);
    }
    if (!pairing.empty()) options.pairing = pairing == "paper" ? Pairing::paper : Pairing::near_far;
}

void add_parameter_options(CLI::App& command, ParameterSource& source, const std::string& without) {
    command.add_option("--params", source.name,
                       fmt::format("RLD parameters: {} or a file (JSON); without it {}",
                                   fmt::join(rld_parameter_set_names(), ", "), without));
    command.add_option("--pairing", source.pairing, "overrides the pairing of the parameters")
        ->check(CLI::IsMember({"paper", "near_far"}));
}

void add_nearest_option(CLI::App& command, std::optional<std::size_t>& nearest, const std::string& meaning) {
    command
        .add_option_function<std::size_t>(
            "--nearest", [&nearest](std::size_t count) { nearest = count; }, meaning)
        ->check(CLI::Range(1, 100000));
}

void add_time_limit_option(CLI::App& command, double& time_limit_ms) {
    command.add_option("--time-limit", time_limit_ms, "per scene, wall clock [ms]; inf for none")
        ->check(CLI::Validator(time_limit_fault, "POSITIVE"))
        ->capture_default_str();
}

CLI::Option* add_output_option(CLI::App& command, const std::string& name, std::string& file,
                               const std::string& meaning) {
    return command.add_option(name, file, meaning)->check(CLI::Validator(output_fault, ""));
}

void add_threads_option(CLI::App& command, unsigned& threads, const std::string& meaning) {
    command.add_option("--threads", threads, meaning)
        ->check(CLI::Range(1U, kMostThreads))
        ->capture_default_str();
}

}  // namespace conelane::experiments
