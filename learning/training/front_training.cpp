#include "learning/training/front_training.hpp"

#include "evaluation/formats/provenance.hpp"
#include "evaluation/progress/parallel.hpp"
#include "evaluation/scoring/score.hpp"
#include "evaluation/seeded_random.hpp"
#include "graph_search/front/front_detector.hpp"

#include <numeric>

#include <boost/random/normal_distribution.hpp>
#include <fmt/format.h>

namespace conelane::learning {
namespace {

using Json = nlohmann::ordered_json;

/// If a weight rarely has an effect, its derivative is mostly rounding.
constexpr double kMinDeviation = 1e-5;
/// Limit of the gradient's length, because single scenes may be completely wrong.
constexpr double kMaxGradient = 5.0;

/// Initial values: He's for the hidden layer, small ones for the outputs.
FrontWeights initial_weights(std::uint64_t seed) {
    FrontWeights weights = FrontWeights::zero();
    auto random = generator_of("front weights", seed);
    for (const FrontNetworkPlace& place : kFrontNetworks) {
        FrontNetworkWeights& network = weights.*place.network;
        boost::random::normal_distribution<double> of_hidden(
            0.0, std::sqrt(2.0 / static_cast<double>(network.inputs)));
        for (float& weight : network.hidden) weight = static_cast<float>(of_hidden(random));
        boost::random::normal_distribution<double> of_output(
            0.0, 0.3 / std::sqrt(static_cast<double>(kFrontUnits)));
        for (float& weight : network.output) weight = static_cast<float>(of_output(random));
    }
    return weights;
}

/// The networks of the cost, and those of the judge by their names in FrontTrainingOptions::judge_parts.
constexpr auto kCost = std::span(kFrontNetworks).first<3>();
constexpr auto kJudge = std::span(kFrontNetworks).last<3>();

/// The names of a network's inputs, in their order.
std::vector<std::string_view> inputs_of(const FrontNetworkPlace& place) {
    std::vector<std::string_view> names;
    for (const FrontFeatureList& list : input_lists(place)) {
        for (const FrontFeature& feature : list.features) names.push_back(feature.name);
    }
    return names;
}

/// Sets the weights of those inputs of the cost to 0.
void leave_out(const std::vector<std::string>& names, FrontWeights& weights) {
    if (names.empty()) return;
    for (const FrontNetworkPlace& place : kCost) {
        FrontNetworkWeights& network = weights.*place.network;
        std::size_t input = 0;
        for (const std::string_view name : inputs_of(place)) {
            const std::size_t at = input++;
            if (std::ranges::find(names, name) == names.end()) continue;
            network.linear[at] = 0.0F;
            std::fill_n(network.hidden.begin() + static_cast<std::ptrdiff_t>(at * kFrontUnits), kFrontUnits,
                        0.0F);
        }
    }
}

/// Sets the derivatives of the judge's other networks to 0.
void keep_only(const std::vector<std::string>& parts, FrontWeights& derivatives) {
    for (const FrontNetworkPlace& place : kJudge) {
        if (std::ranges::find(parts, place.key) != parts.end()) continue;
        derivatives.*place.network = FrontNetworkWeights::zero((derivatives.*place.network).inputs);
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

/// Sums over the scenes since the last report.
struct Sums {
    std::size_t scenes = 0;
    std::size_t decisions = 0;
    double loss = 0.0;
    double reached = 0.0;
    double kept = 0.0;
    double found = 0.0;
    double risk = 0.0;

    void add(const FrontLearner::Loss& of_scene) {
        ++scenes;
        decisions += of_scene.decisions;
        loss += of_scene.sum;
        reached += of_scene.reached ? 1.0 : 0.0;
        kept += of_scene.kept ? 1.0 : 0.0;
        found += of_scene.found ? 1.0 : 0.0;
        risk += of_scene.risk;
    }
};

class FrontTraining : public GradientLearner {
  public:
    FrontTraining(const std::vector<Track>& courses, const std::vector<SceneSet>& held_out,
                  const FrontTrainingOptions& options, const FrontReport& report)
        : options_(options),
          held_out_(held_out),
          report_(report),
          scenes_(courses, options.scenes, options.seed),
          trust_scenes_(scenes_of_trust(options)),
          weights_(first_weights(options)),
          slots_(options.draws_per_step) {
        leave_out(options.without, weights_);
        stages_[kSearch].first = options.imitation_steps;
        stages_[kJudging].first = options.imitation_steps + options.search_steps;
        stages_[kMoves].rate = options.imitation_rate;
        stages_[kSearch].rate = options.search_rate;
        stages_[kJudging].rate = options.judge_rate;
    }

    [[nodiscard]] Eigen::ArrayXd values() const { return flat(weights_); }
    void set_values(const Eigen::ArrayXd& values) override { set(weights_, values); }
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

    [[nodiscard]] bool is_done(std::size_t steps) const override { return steps >= all_steps(); }
    [[nodiscard]] bool begins_stage(std::size_t step) const override {
        return std::ranges::find(stages_, step, &Stage::first) != stages_.end();
    }

    [[nodiscard]] Step step(std::size_t number) override {
        const StageName stage = stage_of(number);
        oneapi::tbb::parallel_for(std::size_t{0}, slots_.size(), [&](std::size_t i) {
            fill(slots_[i], static_cast<std::uint64_t>(number) * slots_.size() + i, stage);
        });
        FrontWeights sum = FrontWeights::zero();
        std::size_t scenes = 0;
        for (const Slot& slot : slots_) {
            add(sum, slot.derivatives);
            scenes += slot.losses.size();
            for (const FrontLearner::Loss& loss : slot.losses) sums_.add(loss);
        }
        if (scenes == 0) return {};
        leave_out(options_.without, sum);
        if (stage == kJudging) keep_only(options_.judge_parts, sum);
        // In each stage the rate falls from the beginning to the end.
        const std::size_t first = stages_[stage].first;
        const std::size_t end = stage == kJudging ? all_steps() : stages_[stage + 1].first;
        const double done = static_cast<double>(number - first) / static_cast<double>(end - first);
        return {limited_mean(flat(sum), static_cast<double>(scenes), kMaxGradient),
                cosine_rate(stages_[stage].rate, done)};
    }

    /// Sets least_trust so that the requested share of lanes is right up to their trusted length: on scenes
    /// of trust_courses, or else on scenes drawn after all those learned from.
    void finish() override {
        std::vector<std::vector<double>> wrong(options_.trust_draws);
        std::vector<std::size_t> scenes(options_.trust_draws);
        oneapi::tbb::parallel_for(std::size_t{0}, options_.trust_draws, [&](std::size_t i) {
            FrontJudgeLearner learner;
            FrontCost cost(weights_);
            FrontJudge judge(weights_);
            const FrontScenes::Drawn drawn =
                (trust_scenes_ ? *trust_scenes_ : scenes_).draw(all_steps() * slots_.size() + i);
            scenes[i] = drawn.scenes.size();
            for (const AnnotatedScene& scene : drawn.scenes) {
                const FrontJudgeLearner::Loss loss =
                    learner.judge(scene, drawn.boundaries, weights_, cost, judge, judge_options(), nullptr);
                if (loss.trust_where_wrong >= 0.0) wrong[i].push_back(loss.trust_where_wrong);
            }
        });
        std::vector<double> all;
        for (const std::vector<double>& some : wrong) all.insert(all.end(), some.begin(), some.end());
        const std::size_t count = std::accumulate(scenes.begin(), scenes.end(), std::size_t{0});
        std::ranges::sort(all, std::greater());
        const auto allowed = static_cast<std::size_t>((1.0 - options_.trusted) * static_cast<double>(count));
        // Just above the value at which one wrong lane more than allowed would count as right.
        weights_.least_trust = allowed < all.size() ? std::nextafter(all[allowed], 2.0) : 0.0;
        weights_.least_trust = std::min(weights_.least_trust, 1.0);
    }

    void report(std::size_t steps) override {
        const StageName stage = stage_of(steps - std::min<std::size_t>(steps, 1));
        const auto scenes = static_cast<double>(std::max<std::size_t>(sums_.scenes, 1));
        const auto percent = [&](double sum) { return 100.0 * (sum / scenes); };
        std::string line =
            fmt::format("step {} of {}, {}: loss {:.4f}", steps, all_steps(), stages_[stage].name,
                        sums_.loss / static_cast<double>(std::max<std::size_t>(sums_.decisions, 1)));
        if (stage != kJudging) line += fmt::format(", true lane allowed {:.1f} %", percent(sums_.reached));
        if (stage == kSearch)
            line +=
                fmt::format(", kept {:.1f} %, answered {:.1f} %", percent(sums_.kept), percent(sums_.found));
        if (stage == kJudging) line += fmt::format(", usable {:.1f} %", percent(sums_.found));
        if (stage != kMoves) line += fmt::format(", risk {:.4f}", sums_.risk / scenes);
        if (sums_.scenes == 0) line = fmt::format("step {} of {}", steps, all_steps());
        std::vector<FrontFigures> figures;
        for (const SceneSet& set : held_out_)
            figures.push_back(front_figures(set, weights(), options_.loss.search, options_.threads));
        sums_ = {};
        report_(line, figures);
    }

  private:
    enum StageName : std::size_t { kMoves, kSearch, kJudging };
    struct Stage {
        const char* name;
        std::size_t first = 0;  ///< step
        double rate = 0.0;
    };

    [[nodiscard]] std::size_t all_steps() const { return stages_[kJudging].first + options_.judge_steps; }
    [[nodiscard]] StageName stage_of(std::size_t step) const {
        return step < stages_[kSearch].first ? kMoves : step < stages_[kJudging].first ? kSearch : kJudging;
    }
    [[nodiscard]] FrontLossOptions judge_options() const {
        FrontLossOptions options = options_.loss;
        options.search = {};  // the detector's
        return options;
    }

    void fill(Slot& slot, std::uint64_t number, StageName stage) {
        set_zero(slot.derivatives);
        slot.losses.clear();
        FrontCost cost(weights_);
        FrontJudge judge(weights_);
        const FrontScenes::Drawn drawn = scenes_.draw(number);
        for (const AnnotatedScene& scene : drawn.scenes)
            slot.losses.push_back(loss_of(slot, scene, drawn.boundaries, cost, judge, stage));
        if (stage != kJudging) return;
        for (const Scene& scene : drawn.noise)
            static_cast<void>(slot.judge_learner.judge_noise(scene, weights_, cost, judge, judge_options(),
                                                             slot.derivatives));
    }

    [[nodiscard]] FrontLearner::Loss loss_of(Slot& slot, const AnnotatedScene& scene,
                                             const TrackBoundaries& boundaries, FrontCost& cost,
                                             FrontJudge& judge, StageName stage) const {
        if (stage == kMoves)
            return slot.learner.imitate(scene, weights_, cost, options_.loss.search, slot.derivatives);
        if (stage == kSearch)
            return slot.learner.search(scene, boundaries, weights_, cost, options_.loss, slot.derivatives);
        const FrontJudgeLearner::Loss judged = slot.judge_learner.judge(
            scene, boundaries, weights_, cost, judge, judge_options(), &slot.derivatives);
        FrontLearner::Loss loss;
        loss.sum = judged.sum;
        loss.decisions = 1;
        loss.found = judged.is_usable;
        loss.risk = judged.risk;
        return loss;
    }

    const FrontTrainingOptions& options_;
    const std::vector<SceneSet>& held_out_;
    const FrontReport& report_;
    FrontScenes scenes_;
    std::optional<FrontScenes> trust_scenes_;
    FrontWeights weights_;
    std::vector<Slot> slots_;
    std::array<Stage, 3> stages_{{{"move by move"}, {"through the search"}, {"judging"}}};
    Sums sums_;
};

Json names_of(const std::vector<Track>& courses) {
    Json names = Json::array();
    for (const Track& track : courses) names.push_back(track.name);
    return names;
}

void require_not_used(const std::string& name, const std::vector<Track>& courses, const char* option,
                      const std::string& use) {
    if (std::ranges::find(courses, name, &Track::name) != courses.end())
        throw InputError("", 0, option, "track '" + name + "' is " + use);
}

Json record_of(const FrontFigures& figures) {
    const auto rounded = [](double value) { return std::round(value * 1e6) / 1e6; };
    const Calibration& said = figures.calibration;
    return {{"scenes", figures.scenes},
            {"usable", rounded(figures.usable)},
            {"iou", rounded(figures.iou)},
            {"exact", rounded(figures.exact)},
            {"calibration_error", rounded(said.error().value_or(0.0))},
            {"usable_where_sure", rounded(said.usable_where_sure().value_or(0.0))},
            {"trusted", rounded(said.trusted_share().value_or(0.0))},
            {"right_where_trusted", rounded(said.right_where_trusted().value_or(0.0))}};
}

std::string line_of(const std::string& condition, const FrontFigures& figures) {
    const auto percent = [](std::optional<double> share) { return 100.0 * share.value_or(0.0); };
    const Calibration& said = figures.calibration;
    return fmt::format(
        "  {:<6} {:>6} scenes  usable {:.2f} %, IoU {:.2f} %, exact {:.1f} %; confidence off by {:.2f} %, "
        "{:.1f} % sure, of these usable {:.2f} %; trusted {:.1f} %, right there {:.2f} %",
        condition, figures.scenes, 100.0 * figures.usable, 100.0 * figures.iou, 100.0 * figures.exact,
        percent(said.error()), percent(said.sure()), percent(said.usable_where_sure()),
        percent(said.trusted_share()), percent(said.right_where_trusted()));
}

}  // namespace

OptionFields option_fields(FrontTrainingOptions& options) {
    OptionFields fields = draw_fields(options, true);
    FrontLossOptions& loss = options.loss;
    const OptionFields own{
        {"--without", "without", &options.without, kAny,
         "inputs of the cost to leave out, by their names in front_features.cpp"},
        {"--only-colors", "only_colors", &options.only_colors, kAny,
         "with --from: only the set of weights for scenes with colours is learned, so that without colours "
         "nothing changes"},
        {"--imitation-steps", "imitation.steps", &options.imitation_steps, kCountOrNone,
         "steps of Adam move by move"},
        {"--imitation-rate", "imitation.learning_rate", &options.imitation_rate, kPositive,
         "learning rate move by move"},
        {"--search-steps", "through_search.steps", &options.search_steps, kCountOrNone,
         "steps of Adam through the search"},
        {"--search-rate", "through_search.learning_rate", &options.search_rate, kPositive,
         "learning rate through the search"},
        {"--beam", "through_search.beam", &loss.search.beam_width, kCount, "width of the beam in training"},
        {"", "through_search.drop", &loss.search.drop},
        {"", "through_search.finished_drop", &loss.search.finished_drop},
        {"", "through_search.level_m", &loss.search.level_m},
        {"", "through_search.far_m", &loss.search.far_m},
        {"", "through_search.listed", &loss.listed},
        {"--fall-out", "through_search.fall_out", &loss.fall_out, kNotNegative,
         "weight of the loss where the true lane leaves the beam"},
        {"--minimum-risk", "through_search.minimum_risk", &loss.minimum_risk, kNotNegative,
         "weight of the expected risk"},
        {"--listwise", "through_search.listwise", &loss.listwise, kNotNegative,
         "weight of the loss over the best lanes"},
        {"", "through_search.risk_scale", &loss.risk_scale},
        {"", "through_search.unusable", &loss.risk.unusable},
        {"", "through_search.cones", &loss.risk.cones},
        {"--judge-parts", "judge.parts", &options.judge_parts, kAny,
         "networks of the judge that are learned: rank, usable (its confidence), right; the others stay as "
         "they are. With usable alone the order of the lanes does not change"},
        {"--judge-steps", "judge.steps", &options.judge_steps, kCountOrNone,
         "steps of Adam of the judge of whole lanes"},
        {"--judge-rate", "judge.learning_rate", &options.judge_rate, kPositive, "learning rate of the judge"},
        {"--trusted", "judge.trusted", &options.trusted, kPositiveShare,
         "target share of lanes that are right as far as they are trusted"},
        {"--trust-draws", "judge.trust_draws", &options.trust_draws, kCountOrNone,
         "changed courses on which the threshold for it is set, after the training"}};
    fields.insert(fields.end(), own.begin(), own.end());
    const OptionFields run = run_fields(options, "--figures-every");
    fields.insert(fields.end(), run.begin(), run.end());
    return fields;
}

void validate(const FrontTrainingOptions& options) {
    FrontTrainingOptions copy = options;
    require_in_range(option_fields(copy));
    validate(options.loss.search);
    if (options.initial) validate(*options.initial);
    if (options.only_colors && !options.initial)
        throw InvalidInput("--only-colors", "needs weights to begin with");
    for (const std::string& name : options.judge_parts) {
        if (std::ranges::find(kJudge, name, &FrontNetworkPlace::key) == kJudge.end())
            throw InvalidInput("--judge-parts", "no network of the judge is called " + name);
    }
    for (const std::string& name : options.without) {
        const bool known = std::ranges::any_of(kCost, [&](const FrontNetworkPlace& place) {
            const auto inputs = inputs_of(place);
            return std::ranges::find(inputs, name) != inputs.end();
        });
        if (!known) throw InvalidInput("--without", "no input of the cost is called " + name);
    }
}

std::string describe_training(const std::vector<Track>& courses, const FrontTrainingOptions& options) {
    FrontTrainingOptions copy = options;
    Json record{{"tracks", names_of(courses)}};
    record.update(record_of(option_fields(copy)));
    if (!options.trust_courses.empty()) record["trust_tracks"] = names_of(options.trust_courses);
    if (options.initial) record["begins_with"] = options.initial_name;
    return record.dump();
}

FrontFigures front_figures(const SceneSet& set, const FrontWeights& weights, const FrontSearchOptions& search,
                           unsigned threads) {
    std::vector<const AnnotatedScene*> scenes;
    for (const AnnotatedScene& scene : set.scenes) {
        if (counts(scene, &set.tracks.at(scene.track))) scenes.push_back(&scene);
    }
    std::vector<SceneScore> scores(scenes.size());
    in_parallel(
        scores.size(), threads,
        [&] {
            return make_front_detector({weights, search});
        },
        [&](std::unique_ptr<LaneDetector>& detector, std::size_t i) {
            const LaneAnswer answer = detector->detect(
                scenes[i]->scene, {.time_limit_ms = std::numeric_limits<double>::infinity()});
            scores[i] = score(*scenes[i], answer, 0.0, std::nullopt, &set.tracks.at(scenes[i]->track));
        });
    FrontFigures figures;
    figures.scenes = scores.size();
    std::size_t annotated = 0;
    for (const SceneScore& scored : scores) {
        const bool usable = scored.usable().value_or(false);
        figures.usable += usable ? 1.0 : 0.0;
        figures.exact += scored.category == Category::ground_truth ? 1.0 : 0.0;
        figures.iou += scored.iou.value_or(0.0);
        annotated += scored.iou ? 1 : 0;
        if (scored.confidence) figures.calibration.add(*scored.confidence, usable);
        if (scored.trusted_m)
            figures.calibration.add_trust(*scored.trusted_m, scored.lane_length_m,
                                          scored.divergence_distance_m);
    }
    const auto truths = static_cast<double>(std::max<std::size_t>(annotated, 1));
    figures.usable /= static_cast<double>(std::max<std::size_t>(scores.size(), 1));
    figures.exact /= truths;
    figures.iou /= truths;
    return figures;
}

FrontWeights train_front(const std::vector<Track>& courses, const std::vector<SceneSet>& held_out,
                         const FrontTrainingOptions& options, const FrontReport& report) {
    validate(options);
    FrontTraining training(courses, held_out, options, report);
    learn(training, training.values(),
          loop_of(options, kMinDeviation, describe_training(courses, options), report != nullptr));
    return training.weights();
}

FrontTrainingRun run_front_training(const FrontTrainingRunOptions& options,
                                    const std::function<void(const std::string&)>& say) {
    const std::vector<Track> courses = annotated_tracks(options.tracks);
    FrontTrainingOptions training = options.training;
    training.trust_courses = annotated_tracks(options.trust_tracks);
    if (training.trust_courses.empty() && !options.trust_tracks.empty())
        throw InputError("", 0, "--trust-tracks", "have no annotated boundaries");
    for (const Track& track : training.trust_courses)
        require_not_used(track.name, courses, "--trust-tracks", "trained on");
    std::vector<SceneSet> held_out;
    for (const std::string& condition : options.conditions) {
        if (options.hold_out.empty()) break;
        SceneOptions scenes;
        scenes.conditions = {condition};
        scenes.false_positive_rates = options.rates;
        scenes.ranges_m = {30.0, 50.0};
        scenes.every_m = options.hold_out_every_m;
        scenes.threads = training.threads;
        held_out.push_back(make_scene_set(options.hold_out, scenes));
    }
    Json held_out_names = Json::array();
    if (!held_out.empty()) {
        for (const auto& [name, boundaries] : held_out.front().tracks) {
            held_out_names.push_back(name);
            require_not_used(name, courses, "--hold-out", "trained on");
            require_not_used(name, training.trust_courses, "--hold-out", "one of --trust-tracks");
        }
    }
    FrontTrainingRun run;
    Json figures = Json::object();
    run.weights = train_front(courses, held_out, training,
                              [&](const std::string& line, const std::vector<FrontFigures>& last) {
                                  if (say) say(line);
                                  for (std::size_t i = 0; i < last.size(); ++i) {
                                      figures[options.conditions[i]] = record_of(last[i]);
                                      if (say) say(line_of(options.conditions[i], last[i]));
                                  }
                              });
    Json record = Json::parse(describe_training(courses, training));
    record["hold_out_tracks"] = held_out_names;
    record["hold_out_every"] = options.hold_out_every_m;
    record["figures_of_hold_out"] = figures;
    record["commit"] = provenance().commit;
    run.record = record.dump();
    return run;
}

}  // namespace conelane::learning
