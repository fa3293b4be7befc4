#include "evaluation/world/scene_options.hpp"

#include "conelane/invalid_input.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace conelane {
namespace {

/// At most 99 false positives for each seen point; the ids are drawn from a space of that size.
constexpr double kMaxRate = 0.99;

void require_between(double value, double lowest, double highest, const std::string& key) {
    if (!(value >= lowest && value <= highest)) {
        throw InvalidInput(key, fmt::format("must be in [{}, {}]", lowest, highest));
    }
}

void require_list(const std::vector<double>& values, double lowest, double highest, const std::string& key) {
    if (values.empty()) throw InvalidInput(key, "must hold at least one value");
    for (const double value : values) {
        require_between(value, lowest, highest, key);
        if (std::ranges::count(values, value) > 1) {
            throw InvalidInput(key, fmt::format("{} is there twice", value));
        }
    }
}

/// The condition with the changes of the options.
Condition adapted(Condition condition, const SceneOptions& options) {
    const Condition own = condition;
    condition.noise_sigma_m = options.noise_sigma_m.value_or(own.noise_sigma_m);
    condition.noise_by_range = options.noise_by_range.value_or(own.noise_by_range);
    condition.pose_noise_lateral_m = options.pose_noise_lateral_m.value_or(own.pose_noise_lateral_m);
    condition.pose_noise_yaw_rad = options.pose_noise_yaw_rad.value_or(own.pose_noise_yaw_rad);
    condition.miss_rate = options.miss_rate.value_or(own.miss_rate);
    condition.persistent = options.persistent.value_or(own.persistent);
    if (own.name.empty()) return condition;
    if (condition.noise_sigma_m != own.noise_sigma_m) condition.name += "+" + noise_text(condition);
    if (condition.noise_by_range != own.noise_by_range)
        condition.name += "+" + noise_by_range_text(condition);
    if (condition.pose_noise_lateral_m != own.pose_noise_lateral_m ||
        condition.pose_noise_yaw_rad != own.pose_noise_yaw_rad) {
        condition.name += "+" + pose_noise_text(condition);
    }
    if (condition.miss_rate != own.miss_rate) condition.name += "+" + miss_text(condition);
    if (condition.persistent != own.persistent) {
        condition.name += condition.persistent ? "+persist" : "+no_persist";
    }
    return condition;
}

}  // namespace

std::span<const Condition> named_conditions() {
    constexpr double kDegree_rad = std::numbers::pi / 180.0;
    // Noise [m], pose noise [m] and [rad], misses; whether false positives persist.
    static const std::array<Condition, 4> conditions{{{"paper"},
                                                      {"car", 0.1, 0.3, 5.0 * kDegree_rad, 0.05, true},
                                                      {"harsh", 0.2, 0.5, 8.0 * kDegree_rad, 0.1, true},
                                                      {"slam", 0.1, 0.1, 1.0 * kDegree_rad, 0.05, true}}};
    return conditions;
}

double Condition::noise_m(double distance_m) const {
    return noise_by_range > 0.0 ? std::hypot(noise_sigma_m, noise_by_range * distance_m) : noise_sigma_m;
}

std::string noise_text(const Condition& condition) {
    return fmt::format("noise_{}", condition.noise_sigma_m);
}
std::string pose_noise_text(const Condition& condition) {
    return fmt::format("pose_noise_{}_{}", condition.pose_noise_lateral_m, condition.pose_noise_yaw_rad);
}
std::string miss_text(const Condition& condition) {
    return fmt::format("miss_{}", condition.miss_rate);
}
std::string noise_by_range_text(const Condition& condition) {
    return fmt::format("noise_by_range_{}", condition.noise_by_range);
}

std::vector<std::string> disturbances(const Condition& condition) {
    std::vector<std::string> parts;
    if (condition.noise_sigma_m > 0.0) parts.push_back(noise_text(condition));
    if (condition.noise_by_range > 0.0) parts.push_back(noise_by_range_text(condition));
    if (condition.pose_noise_lateral_m > 0.0 || condition.pose_noise_yaw_rad > 0.0) {
        parts.push_back(pose_noise_text(condition));
    }
    if (condition.miss_rate > 0.0) parts.push_back(miss_text(condition));
    if (condition.persistent) parts.emplace_back("persist");
    return parts;
}

void validate(const SceneOptions& options) {
    constexpr double kMax = 1000.0;
    require_list(options.false_positive_rates, 0.0, kMaxRate, "fp");
    require_list(options.ranges_m, 0.1, kMax, "range");
    require_between(options.every_m, 0.01, kMax, "every");
    if (options.nearest == 0U) throw InvalidInput("nearest", "must be at least 1");
    static_cast<void>(conditions_of(options));
    require_between(options.noise_sigma_m.value_or(0.0), 0.0, kMax, "noise");
    require_between(options.noise_by_range.value_or(0.0), 0.0, 1.0, "noise-by-range");
    require_between(options.pose_noise_lateral_m.value_or(0.0), 0.0, kMax, "pose-noise");
    require_between(options.pose_noise_yaw_rad.value_or(0.0), 0.0, kMax, "pose-noise");
    const double miss_rate = options.miss_rate.value_or(0.0);
    if (!(miss_rate >= 0.0 && miss_rate < 1.0)) {
        throw InvalidInput("miss", "must be in [0, 1)");
    }
    for (const auto& [rate, key] : {std::pair{options.color_error_rate, "color-error"},
                                    {options.color_unknown_rate, "color-unknown"}}) {
        require_between(rate, 0.0, 1.0, key);
        if (rate > 0.0 && !options.with_color) throw InvalidInput(key, "needs scenes with colour");
    }
    if (options.threads < 1 || options.threads > 1024) {
        throw InvalidInput("threads", "must be in [1, 1024]");
    }
}

std::vector<Condition> conditions_of(const SceneOptions& options) {
    if (options.conditions.empty()) return {adapted(Condition{}, options)};
    std::vector<Condition> conditions;
    for (const std::string& name : options.conditions) {
        const auto known = std::ranges::find(named_conditions(), name, &Condition::name);
        if (known == named_conditions().end()) {
            std::vector<std::string> names;
            for (const Condition& condition : named_conditions()) names.push_back(condition.name);
            throw InvalidInput("condition",
                               fmt::format("'{}' is not one of {}", name, fmt::join(names, ", ")));
        }
        if (std::ranges::count(options.conditions, name) > 1) {
            throw InvalidInput("condition", fmt::format("{} is there twice", name));
        }
        conditions.push_back(adapted(*known, options));
    }
    return conditions;
}

std::vector<std::string> condition_names(const SceneOptions& options) {
    std::vector<std::string> names;
    if (options.conditions.empty()) return names;
    for (const Condition& condition : conditions_of(options)) names.push_back(condition.name);
    return names;
}

}  // namespace conelane
