#pragma once

#include "detectors/parameters/learned_costs_reader.hpp"
#include "evaluation/formats/provenance.hpp"
#include "learning/training/front_scenes.hpp"

#include <functional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <oneapi/tbb/parallel_for.h>

// What trainings of learned costs share: an exact search is the oracle, a network is learned for each part.
namespace conelane::learning {

/// Calls `use` with the numbers of all networks, list by list. `costs`: PartNetworks.
template <typename Costs, typename Use>
requires requires(Costs& costs) {
    costs.networks;
}
void for_each_block(Costs& costs, const Use& use) {
    for_each_costs_list(costs, [&](const std::string& /*key*/, auto& numbers) { use(std::span(numbers)); });
}

/// Adds the derivatives of the network's value at these features, times `factor`.
void add_gradient(const LearnedNetwork& network, std::span<const double> features, double factor,
                  LearnedNetwork& gradient);

/// Gives the networks hidden units, drawn by the seed, which contribute almost nothing.
/// Precondition: they have none.
void add_hidden_units(std::span<LearnedNetwork> networks, std::size_t units, std::uint64_t seed);

/// Most are explained by option_fields.
struct CostTrainingOptions : DrawnTrainingOptions {
    CostTrainingOptions() {
        scenes.colored_share = 0.0;
        scenes.noise_share = 0.0;
        scenes.highest_rate = 0.6;
    }
    std::size_t units = 16;
    std::size_t steps = 2000;
    double learning_rate = 5e-3;  ///< of Adam, falls to 0 along a cosine
};
/// Those of all such trainings, with `own` among them.
[[nodiscard]] OptionFields cost_fields(CostTrainingOptions& options, const OptionFields& own);

/// What a scene has taught.
struct CostLoss {
    bool allowed = false;  ///< the truth is a lane of the problem; else the rest is unset
    bool proven = false;   ///< there is no cheaper rival
    bool found = false;    ///< the truth is its own cheapest rival
    double loss = 0.0;     ///< not negative
};

/// A JSON object: the names of the courses and the options of the record.
template <typename Options>
std::string describe_training(const std::vector<Track>& courses, Options options) {
    nlohmann::ordered_json record{{"tracks", nlohmann::ordered_json::array()}};
    for (const Track& track : courses) record["tracks"].push_back(track.name);
    record.update(record_of(option_fields(options)));
    return record.dump();
}
/// The same with the commit.
template <typename Options>
std::string training_record(const std::vector<Track>& courses, const Options& options) {
    auto record = nlohmann::ordered_json::parse(describe_training(courses, options));
    record["commit"] = provenance().commit;
    return record.dump();
}

/// Throws InvalidInput if costs with which a training begins have another number of hidden units.
void require_units(std::span<const LearnedNetwork> networks, std::size_t units);

/// Learns from drawn scenes with Adam. Learner: names its Costs and is made of the options; `with` puts costs
/// into parameters, `add` adds the derivatives of the loss of a scene and returns a CostLoss.
template <typename Learner, typename Options>
class CostTraining : public GradientLearner {
  public:
    using Costs = typename Learner::Costs;
    CostTraining(const std::vector<Track>& courses, const Options& options, Costs initial,
                 const std::function<void(const std::string&)>& say)
        : options_(options),
          say_(say),
          scenes_(courses, options.scenes, options.seed),
          costs_(std::move(initial)),
          slots_(options.draws_per_step) {
        for (Slot& slot : slots_) {
            slot.learner = std::make_unique<Learner>(options);
            slot.gradient = Costs::zero(options.units);
        }
    }

    /// All steps, from the checkpoint on if there is one.
    [[nodiscard]] Costs run(const std::vector<Track>& courses) {
        /// If a weight rarely has an effect, its derivative is mostly rounding.
        constexpr double kMinDeviation = 1e-3;
        learn(*this, flat(costs_),
              loop_of(options_, kMinDeviation, describe_training(courses, options_), say_ != nullptr));
        return costs_;
    }
    [[nodiscard]] bool is_done(std::size_t steps) const override { return steps >= options_.steps; }
    void set_values(const Eigen::ArrayXd& values) override { set(costs_, values); }

    [[nodiscard]] Step step(std::size_t number) override {
        // Limit of the gradient's length, because single scenes may be completely wrong.
        constexpr double kMaxGradient = 20.0;
        const auto parameters = Learner::with(options_.parameters, costs_);
        oneapi::tbb::parallel_for(std::size_t{0}, slots_.size(), [&](std::size_t i) {
            Slot& slot = slots_[i];
            slot.gradient = Costs::zero(options_.units);
            slot.losses.clear();
            for (const AnnotatedScene& scene :
                 scenes_.draw(static_cast<std::uint64_t>(number) * slots_.size() + i).scenes) {
                if (scene.ground_truth && !scene.ground_truth->closed)
                    slot.losses.push_back(slot.learner->add(scene, parameters, slot.gradient));
            }
        });
        Eigen::ArrayXd gradient = flat(Costs::zero(options_.units));
        double allowed = 0.0;
        for (const Slot& slot : slots_) {
            gradient += flat(slot.gradient);
            for (const CostLoss& loss : slot.losses) {
                ++sums_.scenes;
                if (!loss.allowed) continue;
                allowed += 1.0;
                sums_.proven += loss.proven ? 1.0 : 0.0;
                sums_.found += loss.found ? 1.0 : 0.0;
                sums_.loss += loss.loss;
            }
        }
        sums_.allowed += allowed;
        if (allowed == 0.0) return {};
        const double done = static_cast<double>(number) / static_cast<double>(options_.steps);
        return {limited_mean(gradient, allowed, kMaxGradient), cosine_rate(options_.learning_rate, done)};
    }

    void report(std::size_t steps) override {
        if (sums_.scenes == 0) return say_(fmt::format("step {} of {}", steps, options_.steps));
        const double allowed = std::max(sums_.allowed, 1.0);
        say_(fmt::format(
            "step {} of {}: loss {:.4f}; of {} scenes the true lane is allowed in {:.1f} %; of these "
            "{:.1f} % have no cheaper rival, {:.1f} % searched to the end",
            steps, options_.steps, sums_.loss / allowed, sums_.scenes,
            100.0 * (sums_.allowed / static_cast<double>(std::max<std::size_t>(sums_.scenes, 1))),
            100.0 * (sums_.found / allowed), 100.0 * (sums_.proven / allowed)));
        sums_ = {};
    }

  private:
    struct Slot {  ///< the result of one draw of a step
        std::unique_ptr<Learner> learner;
        Costs gradient;
        std::vector<CostLoss> losses;
    };

    const Options& options_;
    const std::function<void(const std::string&)>& say_;
    FrontScenes scenes_;
    Costs costs_;
    std::vector<Slot> slots_;
    struct Sums {  ///< since the last report
        std::size_t scenes = 0;
        double allowed = 0.0;  ///< scenes whose truth is a lane of the problem; of these:
        double proven = 0.0;   ///< searches for a rival that ended with a proof
        double found = 0.0;    ///< scenes without a cheaper rival
        double loss = 0.0;
    } sums_;
};

}  // namespace conelane::learning
