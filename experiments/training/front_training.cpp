#include "experiments/training/front_training.hpp"

#include "conelane/invalid_input.hpp"
#include "experiments/scoring/score.hpp"
#include "experiments/seeded_random.hpp"
#include "experiments/training/adam.hpp"
#include "experiments/training/front_checkpoint.hpp"
#include "experiments/training/front_gradient.hpp"
#include "graph_search/front/front_detector.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>

#include <boost/random/normal_distribution.hpp>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

namespace conelane::experiments {
namespace {

/// Where a weight hardly ever counts, its derivative is mostly rounding.
constexpr double kSmallestDeviation = 1e-5;
/// No step follows a longer gradient: single scenes that went all wrong.
constexpr double kLongestGradient = 5.0;

/// He's initial values for the hidden layer; the outputs start at 0, so all moves are judged alike.
FrontWeights initial_weights(std::uint64_t seed) {
    FrontWeights weights = FrontWeights::zero();
    auto random = generator_of("front weights", seed);
    for (FrontNetworkWeights* network : {&weights.extend, &weights.stop, &weights.start}) {
        boost::random::normal_distribution<double> of_hidden(
            0.0, std::sqrt(2.0 / static_cast<double>(network->inputs)));
        for (float& weight : network->hidden) weight = static_cast<float>(of_hidden(random));
        boost::random::normal_distribution<double> of_output(
            0.0, 0.3 / std::sqrt(static_cast<double>(kFrontUnits)));
        for (float& weight : network->output) weight = static_cast<float>(of_output(random));
    }
    return weights;
}

/// What one draw of a step gives.
struct Slot {
    FrontLearner learner;
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
          weights_(initial_weights(options.seed)),
          values_(flat(weights_)),
          adam_(values_.size(), kSmallestDeviation),
          slots_(options.draws_per_step) {}

    [[nodiscard]] std::size_t steps() const { return options_.imitation_steps + options_.search_steps; }
    [[nodiscard]] const FrontWeights& weights() const { return weights_; }

    void step(std::size_t number, FrontProgress& progress) {
        const bool through_search = number >= options_.imitation_steps;
        if (number == options_.imitation_steps) adam_ = Adam(values_.size(), kSmallestDeviation);
        oneapi::tbb::parallel_for(std::size_t{0}, slots_.size(), [&](std::size_t i) {
            fill(slots_[i], static_cast<std::uint64_t>(number) * slots_.size() + i, through_search);
        });
        FrontWeights sum = FrontWeights::zero();
        std::size_t scenes = 0;
        for (const Slot& slot : slots_) {
            add(sum, slot.derivatives);
            scenes += slot.losses.size();
            for (const FrontLearner::Loss& loss : slot.losses) note(loss, progress);
        }
        if (scenes == 0) return;
        Eigen::ArrayXd derivatives = flat(sum) / static_cast<double>(scenes);
        const double length = std::sqrt(derivatives.square().sum());
        if (length > kLongestGradient) derivatives *= kLongestGradient / length;
        adam_.add(derivatives);
        const double done = through_search
                                ? static_cast<double>(number - options_.imitation_steps) /
                                      static_cast<double>(options_.search_steps)
                                : static_cast<double>(number) / static_cast<double>(options_.imitation_steps);
        values_ -= cosine_rate(through_search ? options_.search_rate : options_.imitation_rate, done) *
                   adam_.mean() / adam_.deviation();
        set(weights_, values_);
    }

    [[nodiscard]] FrontCheckpoint checkpoint(std::size_t step) const {
        return {step, values_, adam_.state()};
    }
    void restore(const FrontCheckpoint& checkpoint) {
        values_ = checkpoint.values;
        adam_.restore(checkpoint.adam);
        set(weights_, values_);
    }

    /// Counts that `note` adds up, until they are reported.
    struct Counts {
        std::size_t scenes = 0;
        std::size_t decisions = 0;
    };
    Counts counts;

  private:
    void fill(Slot& slot, std::uint64_t number, bool through_search) {
        set_zero(slot.derivatives);
        slot.losses.clear();
        FrontCost cost(weights_);
        const FrontScenes::Drawn drawn = scenes_.draw(number);
        for (const AnnotatedScene& scene : drawn.scenes) {
            slot.losses.push_back(
                through_search
                    ? slot.learner.search(scene, drawn.boundaries, weights_, cost, options_.loss,
                                          slot.derivatives)
                    : slot.learner.imitate(scene, weights_, cost, options_.loss.search, slot.derivatives));
        }
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
    require(options.draws_per_step > 0, "draws_per_step", "must be positive");
    require(options.scenes.scenes_per_draw > 0, "scenes_per_draw", "must be positive");
    require(options.imitation_rate > 0.0 && std::isfinite(options.imitation_rate), "imitation_rate",
            "must be positive");
    require(options.search_rate > 0.0 && std::isfinite(options.search_rate), "search_rate",
            "must be positive");
    require(options.figures_every > 0, "figures_every", "must be positive");
    require(options.checkpoint_every > 0, "checkpoint_every", "must be positive");
    require(options.threads > 0, "threads", "must be positive");
}

FrontFigures front_figures(const SceneSet& set, const FrontWeights& weights, const FrontSearchOptions& search,
                           unsigned threads) {
    struct Row {
        bool usable = false;
        bool exact = false;
        double iou = 0.0;
    };
    std::vector<Row> rows(set.scenes.size());
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
                    const AnnotatedScene& scene = set.scenes[i];
                    const SceneScore scored = score(scene, detector->detect(scene.scene, limits), 0.0,
                                                    std::nullopt, &set.tracks.at(scene.track));
                    rows[i] = {scored.usable().value_or(false), scored.category == Category::ground_truth,
                               scored.iou.value_or(0.0)};
                }
            });
    });
    FrontFigures figures;
    figures.scenes = rows.size();
    if (rows.empty()) return figures;
    for (const Row& row : rows) {
        figures.usable += row.usable ? 1.0 : 0.0;
        figures.exact += row.exact ? 1.0 : 0.0;
        figures.iou += row.iou;
    }
    const auto count = static_cast<double>(rows.size());
    figures.usable /= count;
    figures.exact /= count;
    figures.iou /= count;
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
        if (const auto checkpoint = read_front_checkpoint(options.checkpoint, identity)) {
            training.restore(*checkpoint);
            step = checkpoint->step;
        }
    }
    FrontProgress progress;
    while (step < training.steps()) {
        arena.execute([&] { training.step(step, progress); });
        ++step;
        const bool is_last = step == training.steps();
        if (!options.checkpoint.empty() && (is_last || step % options.checkpoint_every == 0)) {
            write_front_checkpoint(options.checkpoint, identity, training.checkpoint(step));
        }
        if (!report || (!is_last && step % options.figures_every != 0)) continue;
        const auto scenes = static_cast<double>(std::max<std::size_t>(training.counts.scenes, 1));
        progress.step = step;
        progress.steps = training.steps();
        progress.through_search = step > options.imitation_steps;
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
