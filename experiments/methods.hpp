#pragma once

#include "model/lane.hpp"
#include "model/rld_parameters.hpp"

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

namespace conelane::experiments {

struct MethodOptions {
    RldParameters rld_parameters;
    std::optional<std::size_t> nearest;  ///< cone-set size instead of the method's own
};

/// A lane detector by its name.
struct MethodEntry {
    std::string_view name;
    std::string_view meaning;
    std::optional<std::size_t>
        nearest;  ///< cone-set size of its own: the nearest ahead; all cones where absent
    std::unique_ptr<LaneDetector> (*make)(const MethodOptions& options);
};

/// All methods of this build.
[[nodiscard]] std::span<const MethodEntry> methods();

/// Throws InvalidInput naming the method where there is none of that name.
[[nodiscard]] const MethodEntry& find_method(std::string_view name);

/// The cone-set size that the method gets under these options.
[[nodiscard]] std::optional<std::size_t> cone_set_size(const MethodEntry& method,
                                                       const MethodOptions& options);

}  // namespace conelane::experiments
