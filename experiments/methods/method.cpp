#include "experiments/methods/method.hpp"

#include "conelane/invalid_input.hpp"
#include "detectors/drivable/drivable_answers.hpp"
#include "evaluation/outside/outside_program.hpp"
#include "evaluation/outside/outside_solver.hpp"
#include "evaluation/proofs/answer_check.hpp"
#include "model/doubled_cones.hpp"
#include "solvers/registry.hpp"

#include <fmt/format.h>

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

constexpr DetectorRecipe kCbcRecipes[]{
    {{"rld-cbc", "RLD, tight formulation by CBC, on the nearest cones", ClosedLanes::never,
      ColorUse::by_weight},
     LearnedFrom::nothing(),
     RldRecipe{tight_cbc, {kRldConeSet, {}}}},
    {{"rld-paper", "RLD, the printed formulation by CBC's full machinery, on the nearest cones",
      ClosedLanes::never, ColorUse::by_weight},
     LearnedFrom::nothing(),
     RldRecipe{printed_cbc, {kRldConeSet, {}}}},
};

/// The problem that lanes of RLD are checked against.
struct CheckedRld {
    ConeSet cones;
    RldParameters parameters;
};

class TimedLaneDetector : public TimedDetector {
  public:
    TimedLaneDetector(std::string name, std::unique_ptr<LaneDetector> detector, const DetectionLimits& limits,
                      std::optional<std::size_t> nearest, std::optional<CheckedRld> check)
        : name_(std::move(name)),
          limits_(limits),
          detector_(std::move(detector)),
          nearest_(nearest),
          check_(std::move(check)),
          doubled_(detector_->doubled_cone_m()) {}

    LaneRecord answer(const Scene& scene) override {
        const Stopwatch watch;
        LaneAnswer answer = detector_->detect(scene, limits_);
        const double latency_ms = watch.elapsed_ms();
        LaneRecord record{scene.id, name_, std::move(answer), latency_ms, nearest_};
        if (check_) check_answer(record, check_->cones.seen(doubled_.merge(scene)), check_->parameters);
        return record;
    }
    void warm_up(const Scene& scene) override {
        (void)detector_->detect(scene, limits_);
        detector_->reset();
    }
    void reset() override { detector_->reset(); }

  private:
    std::string name_;
    DetectionLimits limits_;
    std::unique_ptr<LaneDetector> detector_;
    std::optional<std::size_t> nearest_;
    std::optional<CheckedRld> check_;
    DoubledCones doubled_;  ///< a detector answers for the scene without doubled cones
};

/// A program from outside, taken from a pool of running programs and given back.
class TimedProgram : public TimedDetector {
  public:
    TimedProgram(std::shared_ptr<OutsideProgramPool> pool, std::optional<std::size_t> nearest)
        : pool_(std::move(pool)), program_(pool_->take()), nearest_(nearest) {}
    ~TimedProgram() override { pool_->give_back(std::move(program_)); }
    TimedProgram(const TimedProgram&) = delete;
    TimedProgram& operator=(const TimedProgram&) = delete;

    LaneRecord answer(const Scene& scene) override {
        if (!nearest_) return program_->answer(scene);
        const Stopwatch watch;
        const Scene seen = nearest_ahead(scene, *nearest_);
        const double cut_ms = watch.elapsed_ms();
        LaneRecord record = program_->answer(seen);
        record.latency_ms += cut_ms;
        record.nearest = nearest_;
        return record;
    }
    void warm_up(const Scene& /*scene*/) override {}  // warmed up once, at its start
    void reset() override { program_->reset(); }

  private:
    std::shared_ptr<OutsideProgramPool> pool_;
    std::unique_ptr<OutsideProgram> program_;
    std::optional<std::size_t> nearest_;
};

DetectorMaker maker_of_solver(const OutsideDetector& solver, const RldDetectorOptions& made,
                              const DetectionLimits& limits) {
    validate(made.parameters);
    const OutsideSolverOptions how{solver.formulation.value_or(Formulation::tight)};
    (void)OutsideSolver(solver, how);  // throws at once if the command is invalid
    return [=](const std::string& /*track*/) {
        auto detector =
            answer_drivable_lanes(make_rld_detector(std::make_unique<OutsideSolver>(solver, how), made));
        return std::make_unique<TimedLaneDetector>(solver.name, std::move(detector), limits,
                                                   made.cones.nearest,
                                                   CheckedRld{made.cones, made.parameters});
    };
}

std::vector<Method> all_methods() {
    std::vector<Method> all;
    const auto add = [&all](std::span<const DetectorRecipe> recipes) {
        for (const DetectorRecipe& recipe : recipes) {
            all.push_back(
                {.name = std::string(recipe.name), .recipe = &recipe, .learner = find_learner(recipe)});
        }
    };
    add(detector_recipes());
    if (find_rld_solver("cbc") != nullptr) add(kCbcRecipes);
    return all;
}

}  // namespace

RldParameters Method::rld_parameters(const DetectorOptions& options) const {
    if (recipe != nullptr) return conelane::rld_parameters(*recipe, options);
    RldParameters parameters = options.rld_parameters.value_or(RldParameters{});
    if (options.pairing) parameters.pairing = *options.pairing;
    return parameters;
}

DetectorMaker Method::maker(const RunOptions& options) const {
    if (maker_of_folds) return maker_of_folds(options);
    if (programs) {
        return [pool = programs, size = nearest](const std::string& /*track*/) {
            return std::make_unique<TimedProgram>(pool, size);
        };
    }
    if (recipe == nullptr) {
        return maker_of_solver(*outside,
                               {.parameters = rld_parameters(options.detector), .cones = {nearest, {}}},
                               options.limits);
    }
    DetectorOptions used = options_used_by(*recipe, options.detector);
    used.nearest = nearest;
    return [&known = *recipe, used, limits = options.limits](const std::string& /*track*/) {
        const ConeSet cones = cone_set(known, used);
        std::optional<CheckedRld> check;
        if (known.is_rld()) check = CheckedRld{cones, conelane::rld_parameters(known, used)};
        return std::make_unique<TimedLaneDetector>(std::string(known.name), make_detector(known, used),
                                                   limits, cones.nearest, check);
    };
}

DetectorMaker Method::learned_maker(const std::filesystem::path& folder, const RunOptions& options) const {
    auto learned = learner->load(*recipe, folder);
    if (auto* const parameters = std::get_if<RldParameters>(&learned)) {
        RunOptions with_parameters = options;
        with_parameters.detector.rld_parameters = std::move(*parameters);
        return maker(with_parameters);
    }
    return [made = std::get<DetectorFactory>(std::move(learned)), known = name, size = nearest,
            limits = options.limits](const std::string& /*track*/) {
        return std::make_unique<TimedLaneDetector>(known, drivable_lanes_among(size, made()), limits, size,
                                                   std::nullopt);
    };
}

std::span<const Method> known_methods() {
    static const std::vector<Method> kMethods = all_methods();
    return kMethods;
}

const Method* known_method(std::string_view name) {
    const auto method = std::ranges::find(known_methods(), name, &Method::name);
    return method == known_methods().end() ? nullptr : &*method;
}

const Method& find_method(std::string_view name) {
    if (const Method* const known = known_method(name)) return *known;
    throw InvalidInput("method", fmt::format("there is no method '{}', see `conelane methods`", name));
}

std::set<std::string> training_courses(std::string_view name) {
    const Method* const known = known_method(name);
    return known != nullptr ? conelane::training_courses(*known->recipe) : std::set<std::string>{};
}

Method parse_method(const std::string& text, std::optional<std::size_t> nearest) {
    auto outside = parse_outside_detector(text);
    if (!outside) {
        Method method = find_method(text);
        method.nearest = nearest;
        return method;
    }
    if (known_method(outside->name) != nullptr)
        throw InvalidInput("method", "'" + outside->name + "' is the name of a method of this program");
    if (nearest && outside->is_lanes_file()) {
        throw InvalidInput("method",
                           "'" + outside->name + "' is a finished lanes file, no cone-set size can be given");
    }
    Method method{.name = outside->name, .nearest = nearest};
    if (outside->is_program())
        method.programs = std::make_shared<OutsideProgramPool>(outside->name, outside->source);
    method.outside = std::move(outside);
    return method;
}

}  // namespace conelane::experiments
