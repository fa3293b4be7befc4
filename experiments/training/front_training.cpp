#include "experiments/training/front_training.hpp"

#include "conelane/invalid_input.hpp"
#include "evaluation/scoring/score.hpp"
#include "evaluation/seeded_random.hpp"
#include "experiments/training/adam.hpp"
#include "experiments/training/front_checkpoint.hpp"
#include "experiments/training/front_gradient.hpp"
#include "experiments/training/training_checkpoint.hpp"
#include "graph_search/front/front_detector.hpp"
#include "graph_search/front/front_judge_features.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <span>
#include <string_view>
#include <utility>

#include <boost/random/normal_distribution.hpp>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

namespace conelane::experiments {
namespace {

/// If a weight rarely has an effect, its derivative is mostly rounding.
constexpr double kMinDeviation = 1e-5;
/// Limit of the gradient's length, because single scenes may be completely wrong.
constexpr double kMaxGradient = 5.0;

/// Initial values: He's for the hidden layer, small ones for the outputs.
FrontWeights initial_weights(std::uint64_t seed) {
    FrontWeights weights = FrontWeights::zero();
    auto random = generator_of("front weights", seed);
    for (FrontNetworkWeights* network :
         {&weights.extend, &weights.stop, &weights.start, &weights.rank, &weights.usable, &weights.right}) {
        boost::random::normal_distribution<double> of_hidden(
            0.0, std::sqrt(2.0 / static_cast<double>(network->inputs)));
        for (float& weight : network->hidden) weight = static_cast<float>(of_hidden(random));
        boost::random::normal_distribution<double> of_output(
            0.0, 0.3 / std::sqrt(static_cast<double>(kFrontUnits)));
        for (float& weight : network->output) weight = static_cast<float>(of_output(random));
    }
    return weights;
}

/// The names of the inputs of the networks of the cost, in their order.
std::array<std::vector<std::string_view>, 3> cost_inputs() {
    std::array<std::vector<std::string_view>, 3> names;
    const auto add = [](std::vector<std::string_view>& to, std::span<const FrontFeature> table) {
        for (const FrontFeature& feature : table) to.push_back(feature.name);
    };
    add(names[0], state_feature_table());
    add(names[0], extend_feature_table());
    add(names[1], state_feature_table());
    add(names[1], stop_feature_table());
    add(names[2], start_feature_table());
    return names;
}

/// Sets the weights of those inputs to 0.
void leave_out(const std::vector<std::string>& names, FrontWeights& weights) {
    if (names.empty()) return;
    const std::array networks{&weights.extend, &weights.stop, &weights.start};
    const auto inputs = cost_inputs();
    for (std::size_t network = 0; network < networks.size(); ++network) {
        for (std::size_t input = 0; input < inputs[network].size(); ++input) {
            if (std::ranges::find(names, inputs[network][input]) == names.end()) continue;
            networks[network]->linear[input] = 0.0F;
            std::fill_n(networks[network]->hidden.begin() + static_cast<std::ptrdiff_t>(input * kFrontUnits),
                        kFrontUnits, 0.0F);
        }
    }
}

/// The networks of the judge by their names in FrontTrainingOptions::judge_parts.
constexpr std::array<std::pair<std::string_view, FrontNetworkWeights FrontWeightSet::*>, 3> kJudgeParts{
    {{"rank", &FrontWeightSet::rank},
     {"usable", &FrontWeightSet::usable},
     {"right", &FrontWeightSet::right}}};

/// Sets the derivatives of the judge's other networks to 0.
void keep_only(const std::vector<std::string>& parts, FrontWeights& derivatives) {
    for (const auto& [name, network] : kJudgeParts) {
        if (std::ranges::find(parts, name) != parts.end()) continue;
        derivatives.*network = FrontNetworkWeights::zero((derivatives.*network).inputs);
    }
}

/// The weights with which a training begins; the set that is learned serves every scene meanwhile.
FrontWeights first_weights(const FrontTrainingOptions& options) {
    if (!options.initial) return initial_weights(options.seed);
    const FrontWeightSet& plain = *options.initial;
    FrontWeights weights;
    static_cast<FrontWeightSet&>(weights) =
        options.only_colors ? options.initial->colored.value_or(plain) : plain;
    return weights;
}

/// The courses on which least_trust is chosen, all with colors if the set is for colors.
std::optional<FrontScenes> scenes_of_trust(const FrontTrainingOptions& options) {
    if (options.trust_courses.empty()) return std::nullopt;
    FrontSceneOptions scenes = options.scenes;
    if (options.only_colors) scenes.colored_share = 1.0;
    return FrontScenes(options.trust_courses, scenes, options.seed);
}

/// The result of one draw of a step.
struct Slot {
    FrontLearner learner;
    FrontJudgeLearner judge_learner;
    FrontWeights derivatives = FrontWeights::zero();
    std::vector<FrontLearner::Loss> losses;
};

Eigen::ArrayXd flat(const FrontWeights& weights) {
    Eigen::ArrayXd result(static_cast<Eigen::Index>(parameter_count(weights)));
    Eigen::Index at = 0;
    for_each_block(weights, [&](std::span<const float> block) {
        for (const float number : block) result[at++] = static_cast<double>(number);
    });
    return result;
}

void set(FrontWeights& weights, const Eigen::ArrayXd& values) {
    Eigen::Index at = 0;
    for_each_block(weights, [&](std::span<float> block) {
        for (float& number : block) number = static_cast<float>(values[at++]);
    });
}

class Training {
  public:
    Training(const std::vector<Track>& courses, const FrontTrainingOptions& options)
        : options_(options),
          scenes_(courses, options.scenes, options.seed),
          trust_scenes_(scenes_of_trust(options)),
          weights_(first_weights(options)),
          adam_(static_cast<Eigen::Index>(parameter_count(weights_)), kMinDeviation),
          slots_(options.draws_per_step) {
        leave_out(options.without, weights_);
        values_ = flat(weights_);
    }

    [[nodiscard]] std::size_t steps() const { return first_judging() + options_.judge_steps; }
    /// Together with the set that is not learned, if there is one.
    [[nodiscard]] FrontWeights weights() const {
        FrontWeights result = weights_;
        if (!options_.initial) return result;
        if (!options_.only_colors) {
            result.colored = options_.initial->colored;
            return result;
        }
        result = *options_.initial;
        result.colored = weights_;
        return result;
    }
    [[nodiscard]] Eigen::Index size() const { return values_.size(); }  ///< number of all weights

    [[nodiscard]] FrontProgress::Stage stage(std::size_t step) const {
        if (step < options_.imitation_steps) return FrontProgress::Stage::move_by_move;
        return step < first_judging() ? FrontProgress::Stage::through_search : FrontProgress::Stage::judging;
    }

    void step(std::size_t number, FrontProgress& progress) {
        if (number == options_.imitation_steps || number == first_judging())
            adam_ = Adam(values_.size(), kMinDeviation);
        oneapi::tbb::parallel_for(std::size_t{0}, slots_.size(), [&](std::size_t i) {
            fill(slots_[i], static_cast<std::uint64_t>(number) * slots_.size() + i, stage(number));
        });
        FrontWeights sum = FrontWeights::zero();
        std::size_t scenes = 0;
        for (const Slot& slot : slots_) {
            add(sum, slot.derivatives);
            scenes += slot.losses.size();
            for (const FrontLearner::Loss& loss : slot.losses) note(loss, progress);
        }
        if (scenes == 0) return;
        leave_out(options_.without, sum);
        if (stage(number) == FrontProgress::Stage::judging) keep_only(options_.judge_parts, sum);
        Eigen::ArrayXd derivatives = flat(sum) / static_cast<double>(scenes);
        const double length = std::sqrt(derivatives.square().sum());
        if (length > kMaxGradient) derivatives *= kMaxGradient / length;
        adam_.add(derivatives);
        values_ -= rate(number) * adam_.mean() / adam_.deviation();
        set(weights_, values_);
    }

    /// Sets least_trust so that the requested share of lanes is right up to their trusted length: on scenes
    /// of trust_courses, or else on scenes drawn after all those learned from.
    void choose_least_trust() {
        std::vector<std::vector<double>> wrong(options_.trust_draws);
        std::vector<std::size_t> scenes(options_.trust_draws);
        oneapi::tbb::parallel_for(std::size_t{0}, options_.trust_draws, [&](std::size_t i) {
            FrontJudgeLearner learner;
            FrontCost cost(weights_);
            FrontJudge judge(weights_);
            const FrontScenes::Drawn drawn =
                (trust_scenes_ ? *trust_scenes_ : scenes_).draw(steps() * slots_.size() + i);
            scenes[i] = drawn.scenes.size();
            for (const AnnotatedScene& scene : drawn.scenes) {
                const FrontJudgeLearner::Loss loss =
                    learner.judge(scene, drawn.boundaries, weights_, cost, judge, judge_options(), nullptr);
                if (loss.trust_where_wrong >= 0.0) wrong[i].push_back(loss.trust_where_wrong);
            }
        });
        std::vector<double> all;
        std::size_t count = 0;
        for (std::size_t i = 0; i < wrong.size(); ++i) {
            all.insert(all.end(), wrong[i].begin(), wrong[i].end());
            count += scenes[i];
        }
        std::ranges::sort(all, std::greater());
        const auto allowed = static_cast<std::size_t>((1.0 - options_.trusted) * static_cast<double>(count));
        // Just above the value at which one wrong lane more than allowed would count as right.
        weights_.least_trust = allowed < all.size() ? std::nextafter(all[allowed], 2.0) : 0.0;
        weights_.least_trust = std::min(weights_.least_trust, 1.0);
    }

    [[nodiscard]] TrainingCheckpoint checkpoint(std::size_t step) const {
        return {step, values_, adam_.state()};
    }
    void restore(const TrainingCheckpoint& checkpoint) {
        values_ = checkpoint.values;
        adam_.restore(checkpoint.adam);
        set(weights_, values_);
    }

    /// Sums that `note` adds up until they are reported.
    struct Counts {
        std::size_t scenes = 0;
        std::size_t decisions = 0;
    };
    Counts counts;

  private:
    [[nodiscard]] std::size_t first_judging() const {
        return options_.imitation_steps + options_.search_steps;
    }

    /// In each stage it falls from the beginning to the end.
    [[nodiscard]] double rate(std::size_t number) const {
        const auto falling = [&](double learning_rate, std::size_t first, std::size_t steps) {
            return cosine_rate(learning_rate,
                               static_cast<double>(number - first) / static_cast<double>(steps));
        };
        switch (stage(number)) {
            case FrontProgress::Stage::move_by_move:
                return falling(options_.imitation_rate, 0, options_.imitation_steps);
            case FrontProgress::Stage::through_search:
                return falling(options_.search_rate, options_.imitation_steps, options_.search_steps);
            case FrontProgress::Stage::judging:
                break;
        }
        return falling(options_.judge_rate, first_judging(), options_.judge_steps);
    }

    [[nodiscard]] FrontJudgeLossOptions judge_options() const {
        FrontJudgeLossOptions options;  // with the detector's search
        options.risk = options_.loss.risk;
        options.minimum_risk = options_.loss.minimum_risk;
        options.listwise = options_.loss.listwise;
        options.risk_scale = options_.loss.risk_scale;
        return options;
    }

    void fill(Slot& slot, std::uint64_t number, FrontProgress::Stage stage) {
        set_zero(slot.derivatives);
        slot.losses.clear();
        FrontCost cost(weights_);
        FrontJudge judge(weights_);
        const FrontScenes::Drawn drawn = scenes_.draw(number);
        for (const AnnotatedScene& scene : drawn.scenes)
            slot.losses.push_back(loss_of(slot, scene, drawn.boundaries, cost, judge, stage));
        if (stage != FrontProgress::Stage::judging) return;
        for (const Scene& scene : drawn.noise)
            static_cast<void>(slot.judge_learner.judge_noise(scene, weights_, cost, judge, judge_options(),
                                                             slot.derivatives));
    }

    [[nodiscard]] FrontLearner::Loss loss_of(Slot& slot, const AnnotatedScene& scene,
                                             const TrackBoundaries& boundaries, FrontCost& cost,
                                             FrontJudge& judge, FrontProgress::Stage stage) const {
        switch (stage) {
            case FrontProgress::Stage::move_by_move:
                return slot.learner.imitate(scene, weights_, cost, options_.loss.search, slot.derivatives);
            case FrontProgress::Stage::through_search:
                return slot.learner.search(scene, boundaries, weights_, cost, options_.loss,
                                           slot.derivatives);
            case FrontProgress::Stage::judging:
                break;
        }
        const FrontJudgeLearner::Loss judged = slot.judge_learner.judge(
            scene, boundaries, weights_, cost, judge, judge_options(), &slot.derivatives);
        FrontLearner::Loss loss;
        loss.sum = judged.sum;
        loss.decisions = 1;
        loss.found = judged.is_usable;
        loss.risk = judged.risk;
        return loss;
    }

    void note(const FrontLearner::Loss& loss, FrontProgress& progress) {
        ++counts.scenes;
        counts.decisions += loss.decisions;
        progress.loss += loss.sum;
        progress.reached += loss.reached ? 1.0 : 0.0;
        progress.kept += loss.kept ? 1.0 : 0.0;
        progress.found += loss.found ? 1.0 : 0.0;
        progress.risk += loss.risk;
    }

    FrontTrainingOptions options_;
    FrontScenes scenes_;
    std::optional<FrontScenes> trust_scenes_;
    FrontWeights weights_;
    Eigen::ArrayXd values_;  ///< of the weights, before they are rounded to float
    Adam adam_;
    std::vector<Slot> slots_;
};

}  // namespace

void validate(const FrontTrainingOptions& options) {
    const auto require = [](bool valid, const char* key, const char* reason) {
        if (!valid) throw InvalidInput(key, reason);
    };
    validate(options.loss.search);
    if (options.initial) validate(*options.initial);
    require(!options.only_colors || options.initial, "only_colors", "needs weights to begin with");
    require(options.scenes.colored_share >= 0.0 && options.scenes.colored_share <= 1.0, "colored_share",
            "must be in [0, 1]");
    const auto [fewest, most] = options.scenes.noise_cones;
    const auto [nearest_m, farthest_m] = options.scenes.noise_ranges_m;
    require(options.scenes.noise_share >= 0.0 && options.scenes.noise_share <= 1.0, "noise_share",
            "must be in [0, 1]");
    require(fewest > 0 && fewest <= most, "noise_cones", "must be positive, the smaller number first");
    require(nearest_m > 0.0 && nearest_m <= farthest_m && std::isfinite(farthest_m), "noise_ranges_m",
            "must be positive, the smaller number first");
    for (const std::string& name : options.judge_parts) {
        const bool known = std::ranges::find(kJudgeParts, name, [](const auto& part) {
                               return part.first;
                           }) != kJudgeParts.end();
        if (!known) throw InvalidInput("judge_parts", "no network of the judge is called " + name);
    }
    for (const std::string& name : options.without) {
        const auto all = cost_inputs();
        const bool known = std::ranges::any_of(
            all, [&](const auto& inputs) { return std::ranges::find(inputs, name) != inputs.end(); });
        if (!known) throw InvalidInput("without", "no input of the cost is called " + name);
    }
    require(options.draws_per_step > 0, "draws_per_step", "must be positive");
    require(options.scenes.scenes_per_draw > 0, "scenes_per_draw", "must be positive");
    require(options.imitation_rate > 0.0 && std::isfinite(options.imitation_rate), "imitation_rate",
            "must be positive");
    require(options.search_rate > 0.0 && std::isfinite(options.search_rate), "search_rate",
            "must be positive");
    require(options.judge_rate > 0.0 && std::isfinite(options.judge_rate), "judge_rate", "must be positive");
    require(options.trusted > 0.0 && options.trusted <= 1.0, "trusted", "must be in (0, 1]");
    require(options.figures_every > 0, "figures_every", "must be positive");
    require(options.checkpoint_every > 0, "checkpoint_every", "must be positive");
    require(options.threads > 0, "threads", "must be positive");
}

FrontFigures front_figures(const SceneSet& set, const FrontWeights& weights, const FrontSearchOptions& search,
                           unsigned threads) {
    struct Row {
        bool usable = false;
        bool exact = false;
        std::optional<double> iou;
        std::optional<double> confidence;
        std::optional<double> trusted_m;
        double length_m = 0.0;
        std::optional<double> divergence_m;
    };
    std::vector<const AnnotatedScene*> scenes;
    for (const AnnotatedScene& scene : set.scenes) {
        if (counts(scene, &set.tracks.at(scene.track))) scenes.push_back(&scene);
    }
    std::vector<Row> rows(scenes.size());
    constexpr std::size_t kAtOnce = 64;
    oneapi::tbb::task_arena arena(
        std::min(static_cast<int>(threads), oneapi::tbb::info::default_concurrency()));
    arena.execute([&] {
        oneapi::tbb::parallel_for(
            std::size_t{0}, (rows.size() + kAtOnce - 1) / kAtOnce, [&](std::size_t part) {
                const auto detector = make_front_detector({weights, search});
                for (std::size_t i = part * kAtOnce; i < std::min(rows.size(), (part + 1) * kAtOnce); ++i) {
                    DetectionLimits limits;
                    limits.time_limit_ms = std::numeric_limits<double>::infinity();
                    const AnnotatedScene& scene = *scenes[i];
                    const LaneAnswer answer = detector->detect(scene.scene, limits);
                    const SceneScore scored =
                        score(scene, answer, 0.0, std::nullopt, &set.tracks.at(scene.track));
                    rows[i] = {scored.usable().value_or(false),
                               scored.category == Category::ground_truth,
                               scored.iou,
                               scored.confidence,
                               scored.trusted_m,
                               scored.lane_length_m,
                               scored.divergence_distance_m};
                }
            });
    });
    FrontFigures figures;
    figures.scenes = rows.size();
    if (rows.empty()) return figures;
    std::size_t annotated = 0;
    for (const Row& row : rows) {
        figures.usable += row.usable ? 1.0 : 0.0;
        figures.exact += row.exact ? 1.0 : 0.0;
        figures.iou += row.iou.value_or(0.0);
        annotated += row.iou ? 1 : 0;
        if (row.confidence) figures.calibration.add(*row.confidence, row.usable);
        if (row.trusted_m) figures.calibration.add_trust(*row.trusted_m, row.length_m, row.divergence_m);
    }
    const auto count = static_cast<double>(rows.size());
    const auto truths = static_cast<double>(std::max<std::size_t>(annotated, 1));
    figures.usable /= count;
    figures.exact /= truths;
    figures.iou /= truths;
    return figures;
}

FrontWeights train_front(const std::vector<Track>& courses, const std::vector<SceneSet>& held_out,
                         const FrontTrainingOptions& options,
                         const std::function<void(const FrontProgress&)>& report) {
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
    const auto choose_least_trust = [&] { arena.execute([&] { training.choose_least_trust(); }); };
    if (step == training.steps()) choose_least_trust();
    FrontProgress progress;
    while (step < training.steps()) {
        arena.execute([&] { training.step(step, progress); });
        ++step;
        const bool is_last = step == training.steps();
        if (is_last) choose_least_trust();
        if (!options.checkpoint.empty() && (is_last || step % options.checkpoint_every == 0)) {
            write_training_checkpoint(options.checkpoint, identity, training.checkpoint(step));
        }
        if (!report || (!is_last && step % options.figures_every != 0)) continue;
        const auto scenes = static_cast<double>(std::max<std::size_t>(training.counts.scenes, 1));
        progress.step = step;
        progress.steps = training.steps();
        progress.stage = training.stage(step - 1);
        progress.loss /= static_cast<double>(std::max<std::size_t>(training.counts.decisions, 1));
        for (double* mean : {&progress.reached, &progress.kept, &progress.found, &progress.risk})
            *mean /= scenes;
        for (const SceneSet& set : held_out) {
            progress.held_out.push_back(
                front_figures(set, training.weights(), options.loss.search, options.threads));
        }
        report(progress);
        progress = {};
        training.counts = {};
    }
    return training.weights();
}

}  // namespace conelane::experiments
