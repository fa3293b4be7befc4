#include "detectors/recipe.hpp"

#include "conelane/invalid_input.hpp"
#include "conelane/rld_parameter_sets.hpp"
#include "detectors/drivable/drivable_answers.hpp"
#include "detectors/parameters/learned_costs_reader.hpp"
#include "detectors/strip_detector.hpp"
#include "graph_search/clc/clc_detector.hpp"
#include "graph_search/front/front_detector.hpp"
#include "graph_search/shared/json_reader.hpp"
#include "solvers/path_pair/path_pair_solver.hpp"

#include <functional>

namespace conelane {
namespace {

/// Cone-set size of the RLD paper's on-board runs.
constexpr std::size_t kRldConeSet = 12;
/// More cones do not make lanes more accurate.
constexpr std::size_t kRldContext = 24;
/// Of `rld-learned`: for the far ends of a short view, then for first cones that were missed.
constexpr std::array kOtherNear_m{5.0, 13.0};

std::unique_ptr<RldSolver> path_pair() {
    return make_path_pair_solver();
}

std::unique_ptr<LaneDetector> clc() {
    return make_clc_detector(extended_clc_options());
}

std::unique_ptr<LaneDetector> warm_clc() {
    ClcOptions options = extended_clc_options();
    options.warm_start = true;
    return make_clc_detector(options);
}

std::unique_ptr<LaneDetector> paper_clc() {
    return make_clc_detector(paper_clc_options());
}

/// Courses in view when the costs of the shape were set by hand.
constexpr std::string_view kShapeCourses[]{"fsd_1", "fsd_2", "fsd_4", "fsd_5", "fsd_6", "fsd_7", "fsd_9"};

constexpr DetectorRecipe kRecipes[]{
    {{"front",
      "both boundaries grow as one front under a learned cost, searched by a beam; steps over "
      "missed cones, answers with one boundary where it sees one alone",
      ClosedLanes::never, ColorUse::used},
     LearnedFrom(kFrontWeights),
     FrontRecipe{shipped_front_options}},
    {{"front-warm", "front that favours the cones of its last lane along a lap", ClosedLanes::never,
      ColorUse::used},
     LearnedFrom(kFrontWeights),
     FrontRecipe{warm_front_options}},
    {{"clc",
      "CLC led by a beam search; steps over missed cones, NVD weighs distances, a second "
      "search, a network on all features trained for usable lanes",
      ClosedLanes::possible, ColorUse::ignored},
     LearnedFrom(kClcWeights),
     OtherRecipe{clc}},
    {{"clc-warm", "clc that starts from its last lane along a lap (section IV-F)", ClosedLanes::possible,
      ColorUse::ignored},
     LearnedFrom(kClcWeights),
     OtherRecipe{warm_clc}},
    {{"clc-paper", "CLC as printed: equation (3), eight features, equation (14)", ClosedLanes::possible,
      ColorUse::ignored},
     LearnedFrom(kPaperClcWeights),
     OtherRecipe{paper_clc}},
    {{"rld-pair", "RLD, exact search over pairs of paths, on all cones", ClosedLanes::never,
      ColorUse::by_weight},
     LearnedFrom::nothing(),
     RldRecipe{.make_solver = path_pair}},
    {{"rld-shape", "rld-pair with the costs of the lane's shape: even spacing, facing edges, near ends",
      ClosedLanes::never, ColorUse::by_weight},
     LearnedFrom({}, kShapeCourses),
     RldRecipe{.make_solver = path_pair, .shape_costs = true}},
    {{"rld-learned",
      "rld-pair with learned costs of edges, turns and ends; steps over missed cones, and proves "
      "that no lane is better by these costs",
      ClosedLanes::never, ColorUse::by_weight},
     LearnedFrom(kLearnedRldWeights),
     RldRecipe{.make_solver = path_pair, .parameter_set = "learned", .other_d_near_m = kOtherNear_m}},
    {{"rld-strip",
      "exact search for the cheapest strip of triangles between two boundaries, by learned costs of both "
      "together; proves its lane, and says how far it is to be trusted",
      ClosedLanes::never, ColorUse::ignored},
     LearnedFrom(kStripWeights),
     StripRecipe{}},
    {{"rld-context", "RLD by the exact search among more cones, then cut to the nearest", ClosedLanes::never,
      ColorUse::by_weight},
     LearnedFrom::nothing(),
     RldRecipe{.make_solver = path_pair, .cones = {kRldConeSet, kRldContext}}},
};

/// The courses that the record of a weight file names.
std::set<std::string> courses_of(std::string_view weight_file) {
    std::set<std::string> courses;
    JsonReader json(weight_file, "weights");
    json.object([&](const std::string& key) {
        if (key != "training") return json.skip();
        json.object([&](const std::string& of_training) {
            if (of_training != "tracks") return json.skip();
            json.array([&] { courses.insert(json.string()); });
        });
    });
    if (courses.empty()) json.fail("the record names no courses");
    return courses;
}

/// Gives its detector only the nearest cones.
class NearestCones : public LaneDetector {
  public:
    NearestCones(std::unique_ptr<LaneDetector> detector, std::size_t nearest)
        : LaneDetector(detector->doubled_cone_m()), detector_(std::move(detector)), nearest_(nearest) {}
    void reset() override { detector_->reset(); }

  private:
    LaneAnswer search(const Scene& scene, const DetectionLimits& limits) override {
        return search_by(*detector_, nearest_ahead(scene, nearest_), limits);
    }

    std::unique_ptr<LaneDetector> detector_;
    std::size_t nearest_;
};

/// Throws InvalidInput naming an option that the detector does not use, and those that it does.
void require_used(const DetectorRecipe& recipe, const DetectorOptions& options) {
    const auto refuse = [&](const char* option) {
        const char* const used = recipe.is_rld()          ? "nearest, rld_parameters, pairing"
                                 : recipe.takes_weights() ? "nearest, weights"
                                                          : "nearest";
        throw InvalidInput(
            option, "the detector '" + std::string(recipe.name) + "' does not use it; it takes " + used);
    };
    if (options.rld_parameters && !recipe.is_rld()) refuse("rld_parameters");
    if (options.pairing && !recipe.is_rld()) refuse("pairing");
    if (options.weights && !recipe.takes_weights()) refuse("weights");
    if (options.nearest == std::size_t{0}) throw InvalidInput("nearest", "must be at least 1");
}

using WeightsSource = std::variant<std::filesystem::path, WeightsBytes>;

FrontWeights weights_of(const WeightsSource& source) {
    const auto* const file = std::get_if<std::filesystem::path>(&source);
    return file != nullptr ? read_front_weights(*file)
                           : parse_front_weights(std::get<WeightsBytes>(source).bytes);
}

std::shared_ptr<const StripCosts> strip_costs_of(const std::optional<WeightsSource>& source) {
    if (!source) return parse_strip_costs(kStripWeightsFile);
    const auto* const file = std::get_if<std::filesystem::path>(&*source);
    return file != nullptr ? read_strip_costs(*file)
                           : parse_strip_costs(std::get<WeightsBytes>(*source).bytes);
}

}  // namespace

std::span<const DetectorRecipe> detector_recipes() {
    return kRecipes;
}

std::vector<DetectorInfo> detectors() {
    return {std::begin(kRecipes), std::end(kRecipes)};
}

std::unique_ptr<LaneDetector> make_detector(std::string_view name, const DetectorOptions& options) {
    if (const DetectorRecipe* const recipe = find_recipe(name)) return make_detector(*recipe, options);
    std::string names;
    for (const DetectorRecipe& known : kRecipes)
        names += (names.empty() ? "" : ", ") + std::string(known.name);
    throw InvalidInput("detector", "there is no detector '" + std::string(name) + "', only " + names);
}

const DetectorRecipe* find_recipe(std::string_view name) {
    const auto recipe = std::ranges::find(kRecipes, name, &DetectorRecipe::name);
    return recipe == std::ranges::end(kRecipes) ? nullptr : recipe;
}

std::set<std::string> training_courses(const DetectorRecipe& recipe) {
    const auto set_with = recipe.learned_from.courses();
    std::set<std::string> courses(set_with.begin(), set_with.end());
    for (const std::string_view* const weights : recipe.learned_from.weights())
        courses.merge(courses_of(*weights));
    return courses;
}

DetectorOptions options_used_by(const DetectorRecipe& recipe, DetectorOptions options) {
    if (!recipe.is_rld()) {
        options.rld_parameters.reset();
        options.pairing.reset();
    }
    if (!recipe.takes_weights()) options.weights.reset();
    return options;
}

std::unique_ptr<LaneDetector> make_detector(const DetectorRecipe& recipe, const DetectorOptions& options) {
    require_used(recipe, options);
    if (const auto* rld = std::get_if<RldRecipe>(&recipe.how)) {
        RldDetectorOptions made{.parameters = rld_parameters(recipe, options),
                                .cones = cone_set(recipe, options),
                                .other_d_near_m = {rld->other_d_near_m.begin(), rld->other_d_near_m.end()}};
        validate(made.parameters);
        return answer_drivable_lanes(make_rld_detector(rld->make_solver(), made));
    }
    std::unique_ptr<LaneDetector> detector;
    if (const auto* front = std::get_if<FrontRecipe>(&recipe.how)) {
        FrontOptions made = front->options();
        if (options.weights) made.weights = weights_of(*options.weights);
        detector = make_front_detector(made);
    } else if (std::holds_alternative<StripRecipe>(recipe.how)) {
        StripParameters made = driving_strip_parameters();
        made.costs = strip_costs_of(options.weights);
        detector = make_strip_detector(std::move(made));
    } else {
        detector = std::get<OtherRecipe>(recipe.how).make();
    }
    return drivable_lanes_among(options.nearest, std::move(detector));
}

std::unique_ptr<LaneDetector> drivable_lanes_among(std::optional<std::size_t> nearest,
                                                   std::unique_ptr<LaneDetector> detector) {
    detector = answer_drivable_lanes(std::move(detector));
    if (!nearest) return detector;
    return std::make_unique<NearestCones>(std::move(detector), *nearest);
}

ConeSet cone_set(const DetectorRecipe& recipe, const DetectorOptions& options) {
    ConeSet cones;
    if (const auto* rld = std::get_if<RldRecipe>(&recipe.how)) cones = rld->cones;
    if (options.nearest) cones.nearest = options.nearest;
    return cones;
}

RldParameters rld_parameters(const DetectorRecipe& recipe, const DetectorOptions& options) {
    const auto* rld = std::get_if<RldRecipe>(&recipe.how);
    RldParameters parameters;
    if (options.rld_parameters) {
        parameters = *options.rld_parameters;
    } else if (rld != nullptr && !rld->parameter_set.empty()) {
        parameters = rld_parameter_set(rld->parameter_set).value();
    }
    if (options.pairing) parameters.pairing = *options.pairing;
    return rld != nullptr && rld->shape_costs ? with_shape_costs(parameters) : parameters;
}

}  // namespace conelane
