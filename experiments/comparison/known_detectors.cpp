#include "experiments/comparison/known_detectors.hpp"

#include "conelane/invalid_input.hpp"
#include "graph_search/baselines/delaunay_beam/delaunay_triangulation.hpp"
#include "graph_search/clc/clc_detector.hpp"
#include "solvers/registry.hpp"

#include <algorithm>
#include <memory>
#include <optional>
#include <string>

namespace conelane::experiments {
namespace {

/// Cone-set size of the RLD paper's on-board runs.
constexpr std::size_t kRldConeSet = 12;

std::unique_ptr<RldSolver> tight_cbc() {
    return find_rld_solver("cbc")->make(Formulation::tight);
}

std::unique_ptr<RldSolver> printed_cbc() {
    return find_rld_solver("cbc-main")->make(Formulation::paper);
}

std::unique_ptr<LaneDetector> without_beam() {
    ClcOptions clc = extended_clc_options();
    clc.step_scores = nullptr;
    return make_clc_detector(clc);
}

std::unique_ptr<LaneDetector> on_delaunay_graph() {
    ClcOptions clc = paper_clc_options();
    clc.edge_rule = delaunay_edges;
    return make_clc_detector(clc);
}

std::unique_ptr<LaneDetector> longest_lane() {
    return make_clc_detector({});
}

std::vector<KnownDetector> all_detectors() {
    std::vector<KnownDetector> all;
    for (const DetectorRecipe& recipe : detector_recipes()) all.push_back({recipe});
    const auto add_rld = [&all](std::string_view name, std::string_view description,
                                std::unique_ptr<RldSolver> (*make_solver)()) {
        all.push_back({{name, description, LearnedFrom::nothing(), ClosedLanes::never, ColorUse::by_weight,
                        RldRecipe{make_solver, {kRldConeSet, std::nullopt}}}});
    };
    const auto add_clc_ablation = [&all](std::string_view name, std::string_view description,
                                         const LearnedFrom& learned_from,
                                         std::unique_ptr<LaneDetector> (*make)()) {
        all.push_back(
            {{name, description, learned_from, ClosedLanes::possible, ColorUse::ignored, OtherRecipe{make}},
             true});
    };
    if (find_rld_solver("cbc") != nullptr) {
        add_rld("rld-cbc", "RLD, tight formulation by CBC, on the nearest cones", tight_cbc);
        add_rld("rld-paper", "RLD, the printed formulation by CBC's full machinery, on the nearest cones",
                printed_cbc);
    }
    add_clc_ablation("clc-no-beam", "clc whose first search follows no lane of a beam search",
                     LearnedFrom(kClcRankWeights), without_beam);
    add_clc_ablation("clc-delaunay", "clc-paper on the Delaunay triangulation (section IV-B)",
                     LearnedFrom(kPaperClcWeights), on_delaunay_graph);
    add_clc_ablation("clc-longest", "CLC without network: the longest of the enumerated lanes",
                     LearnedFrom::nothing(), longest_lane);
    return all;
}

}  // namespace

std::span<const KnownDetector> known_detectors() {
    static const std::vector<KnownDetector> kDetectors = all_detectors();
    return kDetectors;
}

const KnownDetector& find_detector(std::string_view name) {
    const auto detector = std::ranges::find(known_detectors(), name, &KnownDetector::name);
    if (detector == known_detectors().end()) {
        throw InvalidInput("method",
                           "there is no method '" + std::string(name) + "', see `conelane methods`");
    }
    return *detector;
}

std::set<std::string> training_courses(std::string_view name) {
    const auto detector = std::ranges::find(known_detectors(), name, &KnownDetector::name);
    return detector != known_detectors().end() ? conelane::training_courses(*detector)
                                               : std::set<std::string>{};
}

std::optional<OutsideDetector> find_outside_detector(std::string_view text) {
    std::optional<OutsideDetector> detector = parse_outside_detector(text);
    if (detector &&
        std::ranges::find(known_detectors(), detector->name, &KnownDetector::name) != known_detectors().end())
        throw InvalidInput("method", "'" + detector->name + "' is the name of a method of this program");
    return detector;
}

}  // namespace conelane::experiments
