#include "experiments/training/rld_training.hpp"

#include "conelane/invalid_input.hpp"
#include "conelane/rld_parameter_sets.hpp"
#include "evaluation/formats/parameter_tag.hpp"
#include "evaluation/seeded_random.hpp"
#include "experiments/training/adam.hpp"
#include "experiments/training/training_checkpoint.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string_view>

#include <boost/random/normal_distribution.hpp>
#include <nlohmann/json.hpp>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

namespace conelane::experiments {
namespace {

/// If a weight rarely has an effect, its derivative is mostly rounding.
constexpr double kMinDeviation = 1e-3;
/// Limit of the gradient's length, because single scenes may be completely wrong.
constexpr double kMaxGradient = 20.0;

/// The place of a feature among those of its part.
std::size_t place_of(LearnedPart part, std::string_view name) {
    const auto features = learned_features(part);
    const auto found = std::ranges::find(features, name, &LearnedFeature::name);
    return static_cast<std::size_t>(found - features.begin());
}

double& weight(LearnedCosts& costs, LearnedPart part, std::string_view name) {
    return costs.of(part).linear.at(place_of(part, name));
}

/// The result of one draw of a step.
struct Slot {
    std::unique_ptr<RldLearner> learner;
    LearnedCosts gradient;
    std::vector<RldLearner::Loss> losses;
};

LearnedCosts initial_costs(const RldTrainingOptions& options) {
    const LearnedCosts start =
        options.parameters.learned_costs ? *options.parameters.learned_costs : shape_as_learned_costs();
    const bool is_linear = std::ranges::all_of(
        start.networks, [](const LearnedNetwork& network) { return network.units() == 0; });
    return is_linear ? with_hidden_units(start, options.units, options.seed) : start;
}

class Training {
  public:
    Training(const std::vector<Track>& courses, const RldTrainingOptions& options)
        : options_(options),
          scenes_(courses, options.scenes, options.seed),
          costs_(initial_costs(options)),
          values_(flat(costs_)),
          adam_(values_.size(), kMinDeviation),
          slots_(options.draws_per_step) {
        for (Slot& slot : slots_) {
            slot.learner = std::make_unique<RldLearner>(options.margin, options.max_work);
            slot.gradient = LearnedCosts::zero(options.units);
        }
    }

    [[nodiscard]] const LearnedCosts& costs() const { return costs_; }
    [[nodiscard]] Eigen::Index size() const { return values_.size(); }

    /// Adds the result of a draw to the sums of `progress`.
    void step(std::size_t number, RldProgress& progress) {
        RldParameters parameters = options_.parameters;
        parameters.learned_costs = std::make_shared<const LearnedCosts>(costs_);
        oneapi::tbb::parallel_for(std::size_t{0}, slots_.size(), [&](std::size_t i) {
            fill(slots_[i], static_cast<std::uint64_t>(number) * slots_.size() + i, parameters);
        });
        Eigen::ArrayXd gradient = Eigen::ArrayXd::Zero(values_.size());
        double allowed = 0.0;
        for (const Slot& slot : slots_) {
            gradient += flat(slot.gradient);
            for (const RldLearner::Loss& loss : slot.losses) {
                ++progress.scenes;
                if (!loss.allowed) continue;
                allowed += 1.0;
                progress.proven += loss.proven ? 1.0 : 0.0;
                progress.found += loss.found ? 1.0 : 0.0;
                progress.hinge += loss.hinge;
            }
        }
        progress.allowed += allowed;
        if (allowed == 0.0) return;
        gradient /= allowed;
        const double length = std::sqrt(gradient.square().sum());
        if (length > kMaxGradient) gradient *= kMaxGradient / length;
        adam_.add(gradient);
        const double done = static_cast<double>(number) / static_cast<double>(options_.steps);
        values_ -= cosine_rate(options_.learning_rate, done) * adam_.mean() / adam_.deviation();
        set(costs_, values_);
    }

    [[nodiscard]] TrainingCheckpoint checkpoint(std::size_t step) const {
        return {step, values_, adam_.state()};
    }
    void restore(const TrainingCheckpoint& checkpoint) {
        values_ = checkpoint.values;
        adam_.restore(checkpoint.adam);
        set(costs_, values_);
    }

  private:
    void fill(Slot& slot, std::uint64_t number, const RldParameters& parameters) const {
        set(slot.gradient, Eigen::ArrayXd::Zero(values_.size()));
        slot.losses.clear();
        for (const AnnotatedScene& scene : scenes_.draw(number).scenes) {
            if (scene.ground_truth && !scene.ground_truth->closed)
                slot.losses.push_back(slot.learner->add(scene, parameters, slot.gradient));
        }
    }

    RldTrainingOptions options_;
    FrontScenes scenes_;
    LearnedCosts costs_;
    Eigen::ArrayXd values_;
    Adam adam_;
    std::vector<Slot> slots_;
};

}  // namespace

RldParameters rld_learning_parameters() {
    RldParameters parameters = rld_parameter_set("shape").value();
    for (double RldParameters::*const weight :
         {&RldParameters::w_s, &RldParameters::w_t, &RldParameters::w_p, &RldParameters::w_b,
          &RldParameters::w_u, &RldParameters::w_v, &RldParameters::w_n}) {
        parameters.*weight = 0.0;
    }
    parameters.t_crit = 12.0;
    parameters.d_min = 1.7;
    parameters.d_h = 8.0;
    parameters.theta_heading = 1.4;
    parameters.d_near = 9.0;
    parameters.d_side = 4.5;
    parameters.d_max = 7.0;
    parameters.d_gap = 12.5;
    parameters.theta_gap = 1.3;
    parameters.d_clear = 0.2;
    parameters.k_edge = 8.0;
    parameters.k_gap = 16.0;
    return parameters;
}

LearnedCosts shape_as_learned_costs() {
    // Cost of each turn and end, so that training can lower it before a limit of LearnedCosts holds.
    constexpr double kMoved = 0.5;
    constexpr double kEnd = -1.0;
    const RldParameters shape = rld_parameter_set("shape").value();
    LearnedCosts costs = LearnedCosts::zero();
    weight(costs, LearnedPart::edge, "one") = -shape.w_b - kMoved;
    weight(costs, LearnedPart::edge, "spacing") = shape.w_s;
    weight(costs, LearnedPart::edge, "heading") = shape.w_p;
    weight(costs, LearnedPart::edge, "facing") = shape.w_v;
    weight(costs, LearnedPart::turn, "one") = kMoved;
    weight(costs, LearnedPart::turn, "angle_cost") = shape.w_t;
    weight(costs, LearnedPart::turn, "unevenness") = shape.w_u;
    weight(costs, LearnedPart::near_end, "one") = kEnd;
    weight(costs, LearnedPart::near_end, "fit") = -shape.w_n;
    weight(costs, LearnedPart::far_end, "one") = kEnd;
    return costs;
}

LearnedCosts with_hidden_units(const LearnedCosts& linear, std::size_t units, std::uint64_t seed) {
    LearnedCosts costs = LearnedCosts::zero(units);
    auto random = generator_of("learned costs", seed);
    for (const LearnedPart part : kLearnedParts) {
        LearnedNetwork& network = costs.of(part);
        network.linear = linear.of(part).linear;
        if (units == 0) continue;
        boost::random::normal_distribution<double> of_hidden(
            0.0, std::sqrt(2.0 / static_cast<double>(network.linear.size())));
        for (double& number : network.hidden) number = of_hidden(random);
        boost::random::normal_distribution<double> of_output(0.0,
                                                             0.02 / std::sqrt(static_cast<double>(units)));
        for (double& number : network.output) number = of_output(random);
    }
    // Without colours and confidences in the training these features are 0, and no weight of theirs changes.
    for (const std::string_view evidence : {"color_cost", "same_color", "doubt"}) {
        const std::size_t place = place_of(LearnedPart::edge, evidence);
        std::fill_n(costs.of(LearnedPart::edge).hidden.begin() + static_cast<std::ptrdiff_t>(place * units),
                    units, 0.0);
    }
    return costs;
}

void validate(const RldTrainingOptions& options) {
    const auto require = [](bool valid, const char* key, const char* reason) {
        if (!valid) throw InvalidInput(key, reason);
    };
    validate(options.parameters);
    require(options.units <= 256, "units", "must be at most 256");
    if (options.parameters.learned_costs) {
        for (const LearnedNetwork& network : options.parameters.learned_costs->networks)
            require(network.units() == 0 || network.units() == options.units, "units",
                    "must be those of the costs that the training begins with");
    }
    require(options.max_work > 0, "max_work", "must be positive");
    require(options.draws_per_step > 0, "draws_per_step", "must be positive");
    require(options.scenes.scenes_per_draw > 0, "scenes_per_draw", "must be positive");
    require(options.learning_rate > 0.0 && std::isfinite(options.learning_rate), "learning_rate",
            "must be positive");
    for (const double margin : {options.margin.near, options.margin.far})
        require(margin >= 0.0 && std::isfinite(margin), "margin", "must be 0 or positive");
    require(options.report_every > 0, "report_every", "must be positive");
    require(options.checkpoint_every > 0, "checkpoint_every", "must be positive");
    require(options.threads > 0, "threads", "must be positive");
}

std::string describe_training(const std::vector<Track>& courses, const RldTrainingOptions& options) {
    using Json = nlohmann::ordered_json;
    Json names = Json::array();
    for (const Track& track : courses) names.push_back(track.name);
    return Json{
        {"tracks", names},
        {"seed", options.seed},
        {"draws_per_step", options.draws_per_step},
        {"scenes",
         {{"per_draw", options.scenes.scenes_per_draw},
          {"warp", options.scenes.warp},
          {"respace", options.scenes.respace},
          {"disturb", options.scenes.disturb},
          {"short_sight", options.scenes.short_sight},
          {"other_course", options.scenes.other_course},
          {"colored_share", options.scenes.colored_share},
          {"highest_rate", options.scenes.highest_rate}}},
        {"parameters_hash", tag_of("", options.parameters).hash.value()},
        {"units", options.units},
        {"steps", options.steps},
        {"learning_rate", options.learning_rate},
        {"margin",
         {{"near", options.margin.near}, {"far", options.margin.far}, {"near_m", options.margin.near_m}}},
        {"max_work", options.max_work}}
        .dump();
}

LearnedCosts train_rld(const std::vector<Track>& courses, const RldTrainingOptions& options,
                       const std::function<void(const RldProgress&)>& report) {
    validate(options);
    oneapi::tbb::task_arena arena(
        std::min(static_cast<int>(options.threads), oneapi::tbb::info::default_concurrency()));
    Training training(courses, options);
    std::size_t step = 0;
    const std::string identity = describe_training(courses, options);
    if (!options.checkpoint.empty()) {
        if (const auto checkpoint = read_training_checkpoint(options.checkpoint, identity, training.size())) {
            training.restore(*checkpoint);
            step = checkpoint->step;
        }
    }
    RldProgress progress;
    while (step < options.steps) {
        arena.execute([&] { training.step(step, progress); });
        ++step;
        const bool is_last = step == options.steps;
        if (!options.checkpoint.empty() && (is_last || step % options.checkpoint_every == 0))
            write_training_checkpoint(options.checkpoint, identity, training.checkpoint(step));
        if (!report || (!is_last && step % options.report_every != 0)) continue;
        progress.step = step;
        progress.steps = options.steps;
        const double allowed = std::max(progress.allowed, 1.0);
        for (double* sum : {&progress.proven, &progress.found, &progress.hinge}) *sum /= allowed;
        progress.allowed /= static_cast<double>(std::max<std::size_t>(progress.scenes, 1));
        report(progress);
        progress = {};
    }
    return training.costs();
}

}  // namespace conelane::experiments
