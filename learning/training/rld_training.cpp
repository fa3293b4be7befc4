#include "learning/training/rld_training.hpp"

#include "conelane/invalid_input.hpp"
#include "conelane/rld_parameter_sets.hpp"
#include "evaluation/formats/parameter_tag.hpp"
#include "evaluation/formats/provenance.hpp"
#include "evaluation/seeded_random.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string_view>

#include <boost/random/normal_distribution.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <oneapi/tbb/parallel_for.h>

namespace conelane::learning {
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

class RldTraining : public GradientLearner {
  public:
    RldTraining(const std::vector<Track>& courses, const RldTrainingOptions& options,
                const std::function<void(const std::string&)>& say)
        : options_(options),
          say_(say),
          scenes_(courses, options.scenes, options.seed),
          costs_(initial_costs(options)),
          slots_(options.draws_per_step) {
        for (Slot& slot : slots_) {
            slot.learner = std::make_unique<RldLearner>(options.margin, options.max_work);
            slot.gradient = LearnedCosts::zero(options.units);
        }
    }

    [[nodiscard]] const LearnedCosts& costs() const { return costs_; }
    [[nodiscard]] bool is_done(std::size_t steps) const override { return steps >= options_.steps; }
    void set_values(const Eigen::ArrayXd& values) override { set(costs_, values); }

    [[nodiscard]] Step step(std::size_t number) override {
        RldParameters parameters = options_.parameters;
        parameters.learned_costs = std::make_shared<const LearnedCosts>(costs_);
        oneapi::tbb::parallel_for(std::size_t{0}, slots_.size(), [&](std::size_t i) {
            fill(slots_[i], static_cast<std::uint64_t>(number) * slots_.size() + i, parameters);
        });
        Eigen::ArrayXd gradient = flat(LearnedCosts::zero(options_.units));
        double allowed = 0.0;
        for (const Slot& slot : slots_) {
            gradient += flat(slot.gradient);
            for (const RldLearner::Loss& loss : slot.losses) {
                ++sums_.scenes;
                if (!loss.allowed) continue;
                allowed += 1.0;
                sums_.proven += loss.proven ? 1.0 : 0.0;
                sums_.found += loss.found ? 1.0 : 0.0;
                sums_.hinge += loss.hinge;
            }
        }
        sums_.allowed += allowed;
        if (allowed == 0.0) return {};
        const double done = static_cast<double>(number) / static_cast<double>(options_.steps);
        return {limited_mean(gradient, allowed, kMaxGradient), cosine_rate(options_.learning_rate, done)};
    }

    void report(std::size_t steps) override {
        const double allowed = std::max(sums_.allowed, 1.0);
        say_(fmt::format(
            "step {} of {}: loss {:.4f}; of {} scenes the true lane is allowed in {:.1f} %; of these "
            "{:.1f} % have no cheaper rival, {:.1f} % searched to the end",
            steps, options_.steps, sums_.hinge / allowed, sums_.scenes,
            100.0 * (sums_.allowed / static_cast<double>(std::max<std::size_t>(sums_.scenes, 1))),
            100.0 * (sums_.found / allowed), 100.0 * (sums_.proven / allowed)));
        sums_ = {};
    }

  private:
    void fill(Slot& slot, std::uint64_t number, const RldParameters& parameters) const {
        slot.gradient = LearnedCosts::zero(options_.units);
        slot.losses.clear();
        for (const AnnotatedScene& scene : scenes_.draw(number).scenes) {
            if (scene.ground_truth && !scene.ground_truth->closed)
                slot.losses.push_back(slot.learner->add(scene, parameters, slot.gradient));
        }
    }

    const RldTrainingOptions& options_;
    const std::function<void(const std::string&)>& say_;
    FrontScenes scenes_;
    LearnedCosts costs_;
    std::vector<Slot> slots_;
    struct Sums {  ///< since the last report
        std::size_t scenes = 0;
        double allowed = 0.0;  ///< scenes whose truth is a lane graph of the problem; of these:
        double proven = 0.0;   ///< searches for a rival that ended with a proof
        double found = 0.0;    ///< scenes without a cheaper rival
        double hinge = 0.0;
    } sums_;
};

std::string describe_training(const std::vector<Track>& courses, const RldTrainingOptions& options) {
    nlohmann::ordered_json record{{"tracks", nlohmann::ordered_json::array()}};
    for (const Track& track : courses) record["tracks"].push_back(track.name);
    RldTrainingOptions copy = options;
    record.update(record_of(option_fields(copy)));
    return record.dump();
}

void validate(const RldTrainingOptions& options) {
    RldTrainingOptions copy = options;
    require_in_range(option_fields(copy));
    validate(options.parameters);
    if (!options.parameters.learned_costs) return;
    for (const LearnedNetwork& network : options.parameters.learned_costs->networks) {
        if (network.units() != 0 && network.units() != options.units)
            throw InvalidInput("--units", "must be those of the costs that the training begins with");
    }
}

}  // namespace

RldParameters rld_learning_parameters() {
    RldParameters parameters = rld_parameter_set("shape").value();
    for (double RldParameters::*const weight :
         {&RldParameters::w_s, &RldParameters::w_t, &RldParameters::w_p, &RldParameters::w_b,
          &RldParameters::unevenness_weight, &RldParameters::facing_weight,
          &RldParameters::near_end_weight}) {
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
    parameters.nearest_of_edge = 8.0;
    parameters.nearest_of_gap = 16.0;
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
    weight(costs, LearnedPart::edge, "facing") = shape.facing_weight;
    weight(costs, LearnedPart::turn, "one") = kMoved;
    weight(costs, LearnedPart::turn, "angle_cost") = shape.w_t;
    weight(costs, LearnedPart::turn, "unevenness") = shape.unevenness_weight;
    weight(costs, LearnedPart::near_end, "one") = kEnd;
    weight(costs, LearnedPart::near_end, "fit") = -shape.near_end_weight;
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

OptionFields option_fields(RldTrainingOptions& options) {
    options.parameters_hash = tag_of("", options.parameters).hash.value();
    OptionFields fields = draw_fields(options, false);
    const OptionFields own{
        {"", "parameters_hash", &options.parameters_hash},
        {"--units",
         "units",
         &options.units,
         {0.0, 256.0},
         "hidden units of each network; 0 for linear costs, a readable weight a feature"},
        {"--steps", "steps", &options.steps, kCountOrNone, "steps of Adam"},
        {"--rate", "learning_rate", &options.learning_rate, kPositive, "learning rate, which falls to 0"},
        {"--margin", "margin.near", &options.margin.near, kNotNegative,
         "cost by which the true lane has to beat another one, for each edge within 20 m that differs"},
        {"--far-margin", "margin.far", &options.margin.far, kNotNegative, "the same beyond 20 m"},
        {"", "margin.near_m", &options.margin.near_m},
        {"--max-work",
         "max_work",
         &options.max_work,
         {.least = 1.0},
         "limit of each exact search, in steps of about a nanosecond; then its best lane counts"}};
    fields.insert(fields.end(), own.begin(), own.end());
    const OptionFields run = run_fields(options, "--report-every");
    fields.insert(fields.end(), run.begin(), run.end());
    return fields;
}

LearnedCosts train_rld(const std::vector<Track>& courses, const RldTrainingOptions& options,
                       const std::function<void(const std::string&)>& say) {
    validate(options);
    RldTraining training(courses, options, say);
    learn(training, flat(training.costs()),
          loop_of(options, kMinDeviation, describe_training(courses, options), say != nullptr));
    return training.costs();
}

RldTrainingRun run_rld_training(const std::vector<std::string>& tracks, const RldTrainingOptions& options,
                                const std::function<void(const std::string&)>& say) {
    const std::vector<Track> courses = annotated_tracks(tracks);
    RldTrainingRun run;
    run.parameters = options.parameters;
    run.parameters.learned_costs = std::make_shared<const LearnedCosts>(train_rld(courses, options, say));
    auto record = nlohmann::ordered_json::parse(describe_training(courses, options));
    record["commit"] = provenance().commit;
    run.record = record.dump();
    return run;
}

}  // namespace conelane::learning
