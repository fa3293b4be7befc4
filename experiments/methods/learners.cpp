#include "detectors/strip_detector.hpp"
#include "evaluation/formats/file_text.hpp"
#include "evaluation/formats/track_spec.hpp"
#include "evaluation/formats/weights_file.hpp"
#include "experiments/methods/method.hpp"
#include "graph_search/clc/clc_detector.hpp"
#include "graph_search/front/front_detector.hpp"
#include "learning/training/clc_training.hpp"
#include "learning/training/front_training.hpp"
#include "learning/training/rld_training.hpp"
#include "learning/training/strip_training.hpp"
#include "learning/tuning/rld_tuning.hpp"

namespace conelane::experiments {
namespace {

namespace fs = std::filesystem;
using namespace learning;

constexpr const char* kStepScores = "step_scores.json";
constexpr const char* kExtendedNet = "rank_net_extended.json";
constexpr const char* kPaperNet = "rank_net_paper.json";
constexpr const char* kShape = "rld-shape.json";
constexpr const char* kShapeRecord = "rld-shape.record.json";
constexpr const char* kLearnedRld = "rld-learned.json";
constexpr const char* kLearnedRldCheckpoint = "rld-learned.checkpoint.json";
constexpr const char* kColoredRldCheckpoint = "rld-learned.colors.checkpoint.json";
constexpr const char* kStripCheckpoint = "rld-strip.checkpoint.json";
constexpr const char* kFrontCheckpoint = "front.checkpoint.json";
constexpr const char* kFrontColorsCheckpoint = "front.colors.checkpoint.json";

using Learned = std::variant<DetectorFactory, RldParameters>;

void write(const fs::path& file, const std::string& text) {
    AtomicFile output(file);
    output.stream() << text;
    output.commit();
}

// The networks and step scores of clc and clc-paper, with the options of their shipped trainings.

TrainingRunOptions network_options(const LearningOptions& options) {
    TrainingRunOptions run;
    run.tracks = options.tracks;
    run.scenes = options.scenes;
    run.training.seed = options.scenes.seed;
    run.candidates.seed = options.scenes.seed;
    run.candidates.threads = options.scenes.threads;
    return run;
}

void learn_steps(const LearningOptions& options, const fs::path& file) {
    StepTrainingRunOptions run;
    run.tracks = options.tracks;
    run.scenes = options.scenes;
    run.training.search = extended_search_options();
    run.training.seed = options.scenes.seed;
    write(file, run_step_training(run).file);
}

void learn_clc(const LearningOptions& options, const fs::path& folder) {
    if (!fs::exists(folder / kStepScores)) learn_steps(options, folder / kStepScores);
    if (fs::exists(folder / kExtendedNet)) return;
    const std::string steps = text_of(folder / kStepScores);
    TrainingRunOptions run = network_options(options);
    run.variants = options.variants;
    run.candidates.search = extended_search_options();
    run.candidates.search.step_scores = std::make_shared<StepScores>(parse_step_scores(steps));
    run.steps_record = step_scores_training(steps);
    run.training.inputs = kLaneFeatureCount;
    run.training.loss = RankLoss::choice;
    run.training.units = 64;
    run.training.epochs = 20;
    run.training.scenes_a_step = 16;
    run.training.learning_rate = 0.004;
    run.training.weight_decay = 0.05;
    run.candidates.max_per_scene = 200;
    run.training.late_divergence_penalty = 0.2;
    run.training.unusable_penalty = 2.0;
    write(folder / kExtendedNet, run_training(run).file);
}

void learn_clc_paper(const LearningOptions& options, const fs::path& folder) {
    if (fs::exists(folder / kPaperNet)) return;
    TrainingRunOptions run = network_options(options);
    run.candidates.max_per_scene = 120;
    run.training.epochs = 30;
    write(folder / kPaperNet, run_training(run).file);
}

ClcOptions clc_options(const fs::path& folder) {
    ClcOptions options = extended_clc_options();
    options.step_scores = std::make_shared<StepScores>(
        parsed_file(folder / kStepScores, [](auto text) { return parse_step_scores(text); }));
    options.ranking =
        make_rank_net(parsed_file(folder / kExtendedNet, [](auto text) { return parse_rank_net(text); }));
    return options;
}

DetectorFactory made(const ClcOptions& options) {
    return [options] { return make_clc_detector(options); };
}

Learned load_clc(const DetectorRecipe& /*recipe*/, const fs::path& folder) {
    return made(clc_options(folder));
}

Learned load_warm_clc(const DetectorRecipe& /*recipe*/, const fs::path& folder) {
    ClcOptions clc = clc_options(folder);
    clc.warm_start = true;
    return made(clc);
}

Learned load_paper_clc(const DetectorRecipe& /*recipe*/, const fs::path& folder) {
    ClcOptions clc = paper_clc_options();
    clc.ranking =
        make_rank_net(parsed_file(folder / kPaperNet, [](auto text) { return parse_rank_net(text); }));
    return made(clc);
}

// The weights of the RLD objective with the costs of the lane's shape: a dozen numbers, so every fourth pose
// is enough.

SceneSet scenes_to_tune_on(const LearningOptions& options) {
    constexpr double kPoses = 4.0;
    SceneOptions scenes = options.scenes;
    scenes.every_m *= kPoses;
    return make_scene_set(options.tracks, scenes);
}

RldParameters tuned_shape(const LearningOptions& options, const EvaluationOptions& solved) {
    const Evaluation evaluation(scenes_to_tune_on(options), solved);
    return tune(std::cref(evaluation), with_shape_costs(RldParameters{}),
                {options.evaluations, options.scenes.seed})
        .parameters;
}

/// With the best w_color; of equal ones the smallest.
RldParameters with_color_weight(const RldParameters& parameters, const LearningOptions& options,
                                const EvaluationOptions& solved) {
    const Evaluation evaluation(scenes_to_tune_on(options), solved);
    RldParameters best = parameters;
    double best_value = -1.0;
    for (const double weight : kColorWeights) {
        RldParameters tried = parameters;
        tried.w_color = weight;
        const double value = evaluation(tried);
        if (value <= best_value) continue;
        best = tried;
        best_value = value;
    }
    return best;
}

void learn_shape(const LearningOptions& options, const fs::path& folder) {
    const fs::path file = folder / kShape;
    if (fs::exists(file)) return;
    EvaluationOptions solved;
    solved.objective = TuningObjective::usable;
    solved.max_timed_out = 1.0;  // Dense scenes are slow with any weight: they count as not usable, no more.
    solved.threads = options.scenes.threads;
    RldParameters parameters = options.without_colors.empty()
                                   ? tuned_shape(options, solved)
                                   : read_rld_parameters(options.without_colors / kShape);
    if (options.scenes.with_color) parameters = with_color_weight(parameters, options, solved);
    nlohmann::ordered_json record{{"training", {{"tracks", nlohmann::ordered_json::array()}}}};
    for (const std::string& spec : options.tracks) {
        for (const Track& track : load_tracks(spec)) record["training"]["tracks"].push_back(track.name);
    }
    write(folder / kShapeRecord, record.dump() + '\n');
    write_rld_parameters(file, parameters);
}

Learned load_shape(const DetectorRecipe& /*recipe*/, const fs::path& folder) {
    return read_rld_parameters(folder / kShape);
}

// The share of the draws with colors while colors are learned, as for the shipped set of front.
constexpr double kColoredShare = 0.85;

// The learned costs of RLD, with the options of the shipped ones. Their training draws its scenes itself, as
// that of front does.

constexpr std::size_t kLearnedRldUnits = 16;
constexpr std::size_t kLearnedRldSteps = 2000;
constexpr double kLearnedRldRate = 0.02;

void learn_rld(const LearningOptions& options, const fs::path& folder) {
    const fs::path file = folder / kLearnedRld;
    if (fs::exists(file)) return;
    RldTrainingOptions training;
    training.start = with_shape_costs({});  // set by hand: `shape` was tuned on courses that folds hold out
    training.units = kLearnedRldUnits;
    training.steps =
        static_cast<std::size_t>(std::lround(options.rld_steps * static_cast<double>(kLearnedRldSteps)));
    training.learning_rate = kLearnedRldRate;
    training.seed = options.scenes.seed;
    training.threads = options.scenes.threads;
    RldTrainingRun result;
    if (options.without_colors.empty()) {
        training.checkpoint = folder / kLearnedRldCheckpoint;
        result = run_rld_training(options.tracks, training, {});
    } else {
        result.parameters = read_rld_parameters(options.without_colors / kLearnedRld);
    }
    if (options.scenes.with_color) {
        training.parameters = result.parameters;
        training.scenes.colored_share = kColoredShare;
        training.checkpoint = folder / kColoredRldCheckpoint;
        result = run_rld_training(options.tracks, training, {});
    }
    write_rld_parameters(file, result.parameters, result.record);
    for (const char* checkpoint : {kLearnedRldCheckpoint, kColoredRldCheckpoint})
        fs::remove(folder / checkpoint);
}

Learned load_rld(const DetectorRecipe& /*recipe*/, const fs::path& folder) {
    return read_rld_parameters(folder / kLearnedRld);
}

// The costs of the strip program, with the options of the shipped ones. They ignore colours.

void learn_strip(const LearningOptions& options, const fs::path& folder) {
    const fs::path file = folder / kStripFoldFile;
    if (fs::exists(file)) return;
    StripTrainingOptions training;
    training.steps =
        static_cast<std::size_t>(std::lround(options.rld_steps * static_cast<double>(training.steps)));
    training.seed = options.scenes.seed;
    training.threads = options.scenes.threads;
    training.checkpoint = folder / kStripCheckpoint;
    write(file, run_strip_training(options.tracks, training, {}));
    fs::remove(training.checkpoint);
}

Learned load_strip(const DetectorRecipe& /*recipe*/, const fs::path& folder) {
    StripParameters parameters = driving_strip_parameters();
    parameters.costs = read_strip_costs(folder / kStripFoldFile);
    return DetectorFactory([parameters] { return make_strip_detector(parameters); });
}

// The weights of front. Its training draws its own scenes, so only these options count: seed, threads, and
// whether there are colors. A set for colors is learned after the first set, like the shipped one.

constexpr std::size_t kColoredSearchSteps = 5000;
constexpr double kColoredSearchRate = 7e-4;
constexpr std::size_t kColoredJudgeSteps = 3000;
constexpr double kColoredJudgeRate = 1.5e-3;

FrontWeights read_weights(const fs::path& file) {
    return parsed_file(file, [](auto text) { return parse_front_weights(text); });
}

FrontTrainingRun run_stage(FrontTrainingRunOptions run, const LearningOptions& options) {
    FrontTrainingOptions& training = run.training;
    for (std::size_t* steps :
         {&training.imitation_steps, &training.search_steps, &training.judge_steps, &training.trust_draws})
        *steps = static_cast<std::size_t>(std::lround(options.front_steps * static_cast<double>(*steps)));
    return run_front_training(run, {});
}

FrontTrainingRun learn_colors(FrontTrainingRunOptions run, const LearningOptions& options,
                              const FrontWeights& first, const std::string& name_of_first,
                              const fs::path& folder) {
    FrontTrainingOptions& training = run.training;
    training.initial = first;
    training.initial_name = name_of_first;
    training.only_colors = true;
    training.scenes.colored_share = kColoredShare;
    training.scenes.noise_share = 0.0;
    training.imitation_steps = 0;
    training.search_steps = kColoredSearchSteps;
    training.search_rate = kColoredSearchRate;
    training.judge_steps = kColoredJudgeSteps;
    training.judge_rate = kColoredJudgeRate;
    training.checkpoint = folder / kFrontColorsCheckpoint;
    FrontTrainingRun colors = run_stage(run, options);
    fs::remove(training.checkpoint);
    return colors;
}

void learn_front(const LearningOptions& options, const fs::path& folder) {
    if (fs::exists(folder / kFrontFoldFile)) return;
    FrontTrainingRunOptions run;
    run.tracks = options.tracks;
    run.training.seed = options.scenes.seed;
    run.training.threads = options.scenes.threads;
    run.training.checkpoint = folder / kFrontCheckpoint;
    FrontTrainingRun result;
    std::string name = "the first set";
    if (options.without_colors.empty()) {
        result = run_stage(run, options);
    } else {
        const fs::path first = options.without_colors / kFrontFoldFile;
        result.weights = read_weights(first);
        name = file_hash(first);
    }
    if (options.scenes.with_color) result = learn_colors(run, options, result.weights, name, folder);
    write(folder / kFrontFoldFile, front_weights_json(result.weights, result.record));
    fs::remove(run.training.checkpoint);
}

Learned load_front(const DetectorRecipe& recipe, const fs::path& folder) {
    FrontOptions front = std::get<FrontRecipe>(recipe.how).options();
    front.weights = read_weights(folder / kFrontFoldFile);
    return DetectorFactory([front] { return make_front_detector(front); });
}

struct NamedLearner {
    std::string_view detector;
    Learner learner;
};
constexpr std::array kLearners{NamedLearner{"front", {learn_front, load_front}},
                               NamedLearner{"front-warm", {learn_front, load_front}},
                               NamedLearner{"clc", {learn_clc, load_clc}},
                               NamedLearner{"clc-warm", {learn_clc, load_warm_clc}},
                               NamedLearner{"clc-paper", {learn_clc_paper, load_paper_clc}},
                               NamedLearner{"rld-shape", {learn_shape, load_shape}},
                               NamedLearner{"rld-learned", {learn_rld, load_rld}},
                               NamedLearner{"rld-strip", {learn_strip, load_strip}}};

}  // namespace

const Learner* find_learner(const DetectorRecipe& recipe) {
    const auto named = std::ranges::find(kLearners, recipe.name, &NamedLearner::detector);
    return named == kLearners.end() ? nullptr : &named->learner;
}

}  // namespace conelane::experiments
