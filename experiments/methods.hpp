#pragma once

#include "model/lane_detector.hpp"
#include "model/rld_parameters.hpp"
#include "model/scene.hpp"

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

namespace conelane::experiments {

struct MethodOptions {
    std::optional<RldParameters> rld_parameters;  ///< instead of the defaults
    std::optional<Pairing> pairing;               ///< instead of the parameters'
    std::optional<std::size_t> nearest;           ///< cone-set size instead of the method's own
};

/// A lane detector by its name.
struct MethodEntry {
    std::string_view name;
    std::string_view meaning;
    std::optional<std::size_t>
        nearest;  ///< cone-set size of its own: the nearest ahead; all cones where absent
    /// The nearest cones that it finds its lane among before it cuts it to the cone set, where these are
    /// more.
    std::optional<std::size_t> context;
    bool is_rld;     ///< uses RLD parameters ...
    bool has_shape;  ///< ... with the costs of a lane's shape, weighted by hand where the options do not
    std::unique_ptr<LaneDetector> (*make)(const MethodOptions& options);
};

/// All methods of this build.
[[nodiscard]] std::span<const MethodEntry> methods();

/// Throws InvalidInput naming the method where there is none of that name.
[[nodiscard]] const MethodEntry& find_method(std::string_view name);

/// The cone-set size that the method gets under these options.
[[nodiscard]] std::optional<std::size_t> cone_set_size(const MethodEntry& method,
                                                       const MethodOptions& options);

/// What of a scene the method finds its lane among: its cone set, or the context where that is larger.
[[nodiscard]] Scene seen_by(const MethodEntry& method, const MethodOptions& options, const Scene& scene);

/// The parameters that an RLD method gets under these options.
[[nodiscard]] RldParameters rld_parameters(const MethodEntry& method, const MethodOptions& options);

}  // namespace conelane::experiments
