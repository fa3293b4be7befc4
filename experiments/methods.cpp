#include "experiments/methods.hpp"

#include "experiments/delaunay.hpp"
#include "graph_search/clc_detector.hpp"
#include "model/invalid_input.hpp"
#include "solvers/registry.hpp"
#include "solvers/rld_detector.hpp"

#include <algorithm>
#include <array>
#include <string>

namespace conelane::experiments {
namespace {

/// Cone-set size of the RLD paper's on-board runs.
constexpr std::size_t kRldConeSet = 12;
/// More do not make lanes more accurate.
constexpr std::size_t kRldContext = 24;

std::unique_ptr<LaneDetector> make_rld(std::string_view name, std::string_view solver,
                                       Formulation formulation, const MethodOptions& options) {
    const MethodEntry& method = find_method(name);
    return make_rld_detector(find_rld_solver(solver)->make(formulation),
                             {.parameters = rld_parameters(method, options),
                              .nearest = cone_set_size(method, options),
                              .context = method.context});
}

/// Shows its detector the nearest cones only.
class NearestCones : public LaneDetector {
  public:
    NearestCones(std::unique_ptr<LaneDetector> detector, std::size_t nearest)
        : detector_(std::move(detector)), nearest_(nearest) {}
    LaneAnswer detect(const Scene& scene, const DetectionLimits& limits) override {
        return detector_->detect(nearest_ahead(scene, nearest_), limits);
    }
    void reset() override { detector_->reset(); }

  private:
    std::unique_ptr<LaneDetector> detector_;
    std::size_t nearest_;
};

std::unique_ptr<LaneDetector> cut_to(std::unique_ptr<LaneDetector> detector,
                                     std::optional<std::size_t> nearest) {
    if (!nearest) return detector;
    return std::make_unique<NearestCones>(std::move(detector), *nearest);
}

std::unique_ptr<LaneDetector> make_clc(const ClcOptions& clc, const MethodOptions& options) {
    return cut_to(make_clc_detector(clc), options.nearest);
}

constexpr std::array<MethodEntry, 13> kMethods{{
    {"rld-cbc", "RLD, tight formulation by CBC, on the nearest cones", kRldConeSet, std::nullopt, true, false,
     [](const MethodOptions& options) { return make_rld("rld-cbc", "cbc", Formulation::tight, options); }},
    {"rld-paper", "RLD, the printed formulation by CBC's full machinery, on the nearest cones", kRldConeSet,
     std::nullopt, true, false,
     [](const MethodOptions& options) {
         return make_rld("rld-paper", "cbc-main", Formulation::paper, options);
     }},
    {"rld-pair", "RLD, exact search over pairs of paths, on all cones", std::nullopt, std::nullopt, true,
     false,
     [](const MethodOptions& options) {
         return make_rld("rld-pair", "path-pair", Formulation::tight, options);
     }},
    {"rld-context", "RLD by the exact search among more cones, then cut to the nearest", kRldConeSet,
     kRldContext, true, false,
     [](const MethodOptions& options) {
         return make_rld("rld-context", "path-pair", Formulation::tight, options);
     }},
    {"rld-shape", "rld-pair with the costs of the lane's shape: even spacing, facing edges, near ends",
     std::nullopt, std::nullopt, true, true,
     [](const MethodOptions& options) {
         return make_rld("rld-shape", "path-pair", Formulation::tight, options);
     }},
    {"rld-shape-context", "rld-context with the costs of the lane's shape", kRldConeSet, kRldContext, true,
     true,
     [](const MethodOptions& options) {
         return make_rld("rld-shape-context", "path-pair", Formulation::tight, options);
     }},
    {"clc",
     "CLC led by a beam search; NVD weighs distances, a second search, a network on all features and "
     "consensus of the candidates that it puts first",
     std::nullopt, std::nullopt, false, false,
     [](const MethodOptions& options) { return make_clc(extended_clc_options(), options); }},
    {"clc-warm", "clc that starts from its last lane along a lap (section IV-F)", std::nullopt, std::nullopt,
     false, false,
     [](const MethodOptions& options) {
         ClcOptions clc = extended_clc_options();
         clc.warm_start = true;
         return make_clc(clc, options);
     }},
    {"clc-no-beam", "clc whose first search follows no lane of a beam search", std::nullopt, std::nullopt,
     false, false,
     [](const MethodOptions& options) {
         ClcOptions clc = extended_clc_options();
         clc.step_scores = nullptr;
         return make_clc(clc, options);
     }},
    {"clc-no-consensus", "clc that answers with the candidate of the highest score", std::nullopt,
     std::nullopt, false, false,
     [](const MethodOptions& options) {
         ClcOptions clc = extended_clc_options();
         clc.consensus_candidates = 0;
         return make_clc(clc, options);
     }},
    {"clc-paper", "CLC as printed: equation (3), eight features, equation (14)", std::nullopt, std::nullopt,
     false, false, [](const MethodOptions& options) { return make_clc(paper_clc_options(), options); }},
    {"clc-delaunay", "clc-paper on the Delaunay triangulation (section IV-B)", std::nullopt, std::nullopt,
     false, false,
     [](const MethodOptions& options) {
         ClcOptions clc = paper_clc_options();
         clc.edge_rule = delaunay_edges;
         return make_clc(clc, options);
     }},
    {"clc-longest", "CLC without network: the longest of the enumerated lanes", std::nullopt, std::nullopt,
     false, false, [](const MethodOptions& options) { return make_clc({}, options); }},
}};

}  // namespace

std::span<const MethodEntry> methods() {
    return kMethods;
}

const MethodEntry& find_method(std::string_view name) {
    const auto entry = std::ranges::find(kMethods, name, &MethodEntry::name);
    if (entry == kMethods.end()) {
        throw InvalidInput("method",
                           "there is no method '" + std::string(name) + "', see `conelane methods`");
    }
    return *entry;
}

std::optional<std::size_t> cone_set_size(const MethodEntry& method, const MethodOptions& options) {
    return options.nearest ? options.nearest : method.nearest;
}

Scene seen_by(const MethodEntry& method, const MethodOptions& options, const Scene& scene) {
    const std::optional<std::size_t> nearest = cone_set_size(method, options);
    return nearest ? nearest_ahead(scene, std::max(*nearest, method.context.value_or(0))) : scene;
}

RldParameters rld_parameters(const MethodEntry& method, const MethodOptions& options) {
    RldParameters parameters = options.rld_parameters.value_or(RldParameters{});
    if (options.pairing) parameters.pairing = *options.pairing;
    return method.has_shape ? with_shape_costs(parameters) : parameters;
}

}  // namespace conelane::experiments
