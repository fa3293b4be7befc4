#include "learning/training/clc_training.hpp"

#include "evaluation/formats/provenance.hpp"
#include "evaluation/formats/track_spec.hpp"
#include "evaluation/formats/weights_file.hpp"
#include "evaluation/progress/progress.hpp"
#include "evaluation/scoring/score.hpp"
#include "evaluation/seeded_random.hpp"

#include <iterator>
#include <numeric>

#include <boost/random/uniform_real_distribution.hpp>
#include <fmt/format.h>

namespace conelane::learning {
namespace {

/// If a score rarely has an effect, its derivative is mostly rounding.
constexpr double kMinDeviation = 1e-6;

/// Less likely lanes add nothing to a derivative.
constexpr double kMinProbability = 1e-3;

/// A scene in the search graph with its ground truth, and the beam that should keep it.
class RightLane {
  public:
    explicit RightLane(CandidateSearchOptions search) : search_(std::move(search)) {}

    /// The fate of the right lane.
    struct Course {
        bool started = false;
        bool near_kept = false;
        bool kept = false;
        std::size_t levels = 0;  ///< whose loss was added up
    };

    /// Follows the right lane while the beam keeps it; with `derivatives`, to its end, and adds the
    /// derivatives of the loss.
    Course follow(const AnnotatedScene& annotated, const StepScores& scores,
                  std::vector<double>* derivatives) {
        Course course;
        set_scene(annotated);
        const StartPair start{truth_[kLeft].front(), truth_[kRight].front()};
        if (std::ranges::find(starts_, start) == starts_.end()) return course;
        course.started = true;
        beam_.start(graph_, annotated.scene, starts_, scores, search_.bounds, search_.beam_width);
        const auto starts_right = [&](std::size_t number) {
            return beam_.state(number).last == std::array{start.left, start.right};
        };
        auto found = std::ranges::find_if(beam_.level(), starts_right);
        std::size_t right = found != beam_.level().end() ? *found : beam_.add_start(start);
        while (true) {
            const bool is_in = std::ranges::find(beam_.level(), right) != beam_.level().end();
            if (!is_in && derivatives == nullptr) return course;
            if (derivatives != nullptr) add_loss(right, course, *derivatives);
            if (!is_in) beam_.restart(right);
            const LaneBeam::State& state = beam_.state(right);
            const Side side = beam_.next_side(state);
            const std::size_t place = state.vertices[side];
            if (place >= near_vertices_[side]) course.near_kept = true;
            if (place == truth_[side].size()) break;
            const Vertex vertex = truth_[side][place];
            SearchBudget unlimited;
            (void)beam_.advance(unlimited);
            const auto follows = [&](std::size_t number) {
                const LaneBeam::State& next = beam_.state(number);
                return next.parent == right && next.last[side] == vertex;
            };
            found = std::ranges::find_if(beam_.level(), follows);
            const std::size_t next = found != beam_.level().end() ? *found : beam_.extend(right, vertex);
            if (next == LaneBeam::kNone) break;
            right = next;
        }
        course.near_kept = course.kept = true;
        SearchBudget unlimited;
        if (derivatives != nullptr && beam_.advance(unlimited)) add_loss(right, course, *derivatives);
        return course;
    }

  private:
    void set_scene(const AnnotatedScene& annotated) {
        std::unordered_map<ConeId, Vertex> vertex_of;  // for look-up only
        std::vector<Point> points;
        for (const Cone& cone : annotated.scene.cones) {
            vertex_of.emplace(cone.id, static_cast<Vertex>(points.size()));
            points.push_back(cone.position);
        }
        graph_.build(points, search_.d_max_m);
        starts_ = start_pairs(annotated.scene, std::numeric_limits<std::size_t>::max(), search_.start,
                              search_.bounds);
        for (const Side side : {kLeft, kRight}) {
            truth_[side].clear();
            near_vertices_[side] = 0;
            double along_m = 0.0;
            for (const ConeId id :
                 side == kLeft ? annotated.ground_truth->left : annotated.ground_truth->right) {
                const Vertex vertex = vertex_of.at(id);
                if (!truth_[side].empty()) along_m += (points[vertex] - points[truth_[side].back()]).norm();
                truth_[side].push_back(vertex);
                if (along_m <= kNearPart_m) ++near_vertices_[side];
            }
        }
    }

    /// The loss of the right lane among its level, to which it is added if it is missing.
    void add_loss(std::size_t right, Course& course, std::vector<double>& derivatives) {
        competitors_.assign(beam_.level().begin(), beam_.level().end());
        if (std::ranges::find(competitors_, right) == competitors_.end()) competitors_.push_back(right);
        probabilities_.clear();
        for (const std::size_t number : competitors_) probabilities_.push_back(beam_.state(number).score);
        to_probabilities(probabilities_);
        for (std::size_t i = 0; i < competitors_.size(); ++i) {
            const double factor = probabilities_[i] - (competitors_[i] == right ? 1.0 : 0.0);
            if (std::abs(factor) < kMinProbability) continue;
            for (std::size_t at = competitors_[i]; at != LaneBeam::kNone; at = beam_.state(at).parent)
                add_score_derivatives(beam_.state(at).step, factor, derivatives);
        }
        ++course.levels;
    }

    CandidateSearchOptions search_;
    SearchGraph graph_;
    LaneBeam beam_;
    std::vector<StartPair> starts_;
    PathPairVertices truth_;
    std::array<std::size_t, 2> near_vertices_{0, 0};
    std::vector<std::size_t> competitors_;
    std::vector<double> probabilities_;  ///< of the competitors
};

class StepScoreTraining : public GradientLearner {
  public:
    StepScoreTraining(const SceneSet& set, const StepScoreTrainingOptions& options)
        : options_(options),
          random_(options.seed),
          lane_(options.search),
          derivatives_(step_score_count()),
          progress_("training", options.show_progress ? options.epochs : 0) {
        scores.values.assign(step_score_count(), 0.0);
        for (const AnnotatedScene& scene : set.scenes) {
            if (counts(scene)) scenes_.push_back(&scene);
        }
    }

    StepScores scores;
    bool has_learned = false;

    void set_values(const Eigen::ArrayXd& values) override {
        scores.values.assign(values.begin(), values.end());
    }
    [[nodiscard]] bool is_done(std::size_t steps) const override { return steps == all_steps(); }
    /// One scene. In an epoch each one comes once, in random order.
    [[nodiscard]] Step step(std::size_t number) override {
        const std::size_t place = number % scenes_.size();
        if (place == 0) shuffle(scenes_, random_);
        std::ranges::fill(derivatives_, 0.0);
        const RightLane::Course course = lane_.follow(*scenes_[place], scores, &derivatives_);
        if (place + 1 == scenes_.size()) progress_.advance();
        if (course.levels == 0) return {};
        has_learned = true;
        const double done = static_cast<double>(number) / static_cast<double>(all_steps());
        return {Eigen::Map<const Eigen::ArrayXd>(derivatives_.data(),
                                                 static_cast<Eigen::Index>(derivatives_.size())) /
                    static_cast<double>(course.levels),
                cosine_rate(options_.learning_rate, done)};
    }
    /// With weight decay.
    void move(const Adam& adam, double rate, Eigen::ArrayXd& values) const override {
        values -= rate * (adam.mean() / adam.deviation() + options_.weight_decay * values);
    }

  private:
    [[nodiscard]] std::size_t all_steps() const { return options_.epochs * scenes_.size(); }

    const StepScoreTrainingOptions& options_;
    std::vector<const AnnotatedScene*> scenes_;
    boost::random::mt19937_64 random_;
    RightLane lane_;
    std::vector<double> derivatives_;
    Progress progress_;
};

using Json = nlohmann::ordered_json;

Json track_names(const SceneSet& set) {
    Json names = Json::array();
    for (const auto& [name, boundaries] : set.tracks) names.push_back(name);
    return names;
}

template <typename Figures>
Json record_of(const Figures& figures) {
    Json record{{"scenes", figures.scenes}};
    for (const auto& [name, figure] : Figures::fields())
        record[name] = std::round(figures.*figure * 1e6) / 1e6;
    return record;
}

std::string line_of(const RankingFigures& figures) {
    return fmt::format(
        "usable {:.2f} % of at most {:.2f} %, mean IoU {:.2f} % of at most {:.2f} %, a candidate of 98 % in "
        "{:.1f} %, critical {:.2f} % of at least {:.2f} %",
        100.0 * figures.usable_share, 100.0 * figures.most_usable_share, 100.0 * figures.mean_iou,
        100.0 * figures.mean_best_iou, 100.0 * figures.near_best_share, 100.0 * figures.critical_share,
        100.0 * figures.least_critical_share);
}

std::string line_of(const StepScoreFigures& figures) {
    return fmt::format("right start {:.1f} %, right lane kept for 20 m {:.1f} %, whole {:.1f} %",
                       100.0 * figures.start_share, 100.0 * figures.near_kept_share,
                       100.0 * figures.kept_share);
}

/// Adds the figures and the commit to the record. Returns the figures as text.
template <typename Figures>
std::string finish(const Figures& trained, const Figures& held_out, Json& record) {
    record["figures_of_training"] = record_of(trained);
    record["figures_of_hold_out"] = record_of(held_out);
    record["commit"] = provenance().commit;
    std::string text;
    for (const auto& [of, figures] : {std::pair("training", &trained), std::pair("hold-out", &held_out)}) {
        if (figures->scenes > 0)
            text += fmt::format("{:<9} {:>6} scenes  {}\n", of, figures->scenes, line_of(*figures));
    }
    return text;
}

/// The scenes to train on, and the held-out ones, which may be empty.
std::pair<SceneSet, SceneSet> make_scene_sets(const LearnedScenes& options) {
    std::pair<SceneSet, SceneSet> sets{make_scene_set(options.tracks, options.scenes), {}};
    SceneOptions hold_out_scenes = options.scenes;
    hold_out_scenes.every_m = options.hold_out_every_m;
    if (!options.hold_out.empty()) sets.second = make_scene_set(options.hold_out, hold_out_scenes);
    for (const auto& [name, boundaries] : sets.second.tracks) {
        if (sets.first.tracks.contains(name)) {
            throw InputError("", 0, "--hold-out", "track '" + name + "' is trained on");
        }
    }
    return sets;
}

void add_variants(const TrainingRunOptions& options, SceneSet& set) {
    for (const std::string& spec : options.tracks) {
        for (const Track& track : load_tracks(spec)) {
            if (!track.frames.empty()) continue;  // the maps of a run stay as they were recorded
            for (std::size_t number = 1; number <= options.variants; ++number) {
                const Track variant = track_variant(track, number, options.scenes.seed);
                set.tracks.emplace(variant.name, boundaries(variant));
                std::ranges::move(generate_scenes(variant, options.scenes), std::back_inserter(set.scenes));
            }
        }
    }
}

Json parsed(const std::string& steps_record) {
    Json json = Json::parse(steps_record, nullptr, false);
    if (json.is_discarded()) throw InvalidInput("training", "is not JSON");
    return json;
}

}  // namespace

OptionFields option_fields(StepScoreTrainingOptions& options) {
    return {{"", "width", &options.search.beam_width},
            {"--step-epochs", "epochs", &options.epochs, kCount, "rounds over the scenes, with --steps"},
            {"--step-rate", "learning_rate", &options.learning_rate, kPositive,
             "learning rate of Adam, with --steps"},
            {"--step-decay", "weight_decay", &options.weight_decay, kNotNegative,
             "decay of a score by each step, times the rate, with --steps"},
            {"", "seed", &options.seed}};
}

StepScores train_step_scores(const SceneSet& set, const StepScoreTrainingOptions& options) {
    validate(options.search);
    StepScoreTrainingOptions copy = options;
    require_in_range(option_fields(copy));
    StepScoreTraining training(set, options);
    learn(training, Eigen::ArrayXd::Zero(static_cast<Eigen::Index>(step_score_count())),
          {.smallest_deviation = kMinDeviation});
    if (!training.has_learned) throw InvalidInput("tracks", "no scene has a right lane to start with");
    return training.scores;
}

StepScoreFigures step_score_figures(const SceneSet& set, const StepScores& scores,
                                    const CandidateSearchOptions& search) {
    StepScoreFigures figures;
    RightLane lane(search);
    for (const AnnotatedScene& scene : set.scenes) {
        if (!counts(scene)) continue;
        const RightLane::Course course = lane.follow(scene, scores, nullptr);
        ++figures.scenes;
        figures.start_share += course.started ? 1.0 : 0.0;
        figures.near_kept_share += course.near_kept ? 1.0 : 0.0;
        figures.kept_share += course.kept ? 1.0 : 0.0;
    }
    divide_by_scenes(figures);
    return figures;
}

TrainingRun run_training(const TrainingRunOptions& options) {
    auto [set, held_out] = make_scene_sets(options);
    RankNetTrainingOptions training = options.training;
    Json record{{"tracks", track_names(set)},
                {"variants", options.variants},
                {"hold_out_tracks", track_names(held_out)},
                {"scenes", scene_options_json(options.scenes)},
                {"hold_out_every", options.hold_out_every_m},
                {"most_candidates_per_scene", options.candidates.max_per_scene},
                {"iterations", options.candidates.search.iteration_limit},
                {"steps", parsed(options.steps_record)},
                {"network", record_of(option_fields(training))}};
    add_variants(options, set);
    const std::vector<CandidateList> lists = enumerate_candidates(set, options.candidates);
    const RankNetWeights weights = train_rank_net(lists, options.training);
    const std::shared_ptr<const LaneRanking> ranking = make_rank_net(weights);
    CandidateListOptions all_candidates = options.candidates;
    all_candidates.max_per_scene = 0;
    TrainingRun run;
    run.summary = finish(ranking_figures(lists, *ranking),
                         ranking_figures(enumerate_candidates(held_out, all_candidates), *ranking), record);
    run.file = rank_net_json(weights, record.dump());
    return run;
}

TrainingRun run_step_training(const StepTrainingRunOptions& options) {
    const auto [set, held_out] = make_scene_sets(options);
    StepScoreTrainingOptions training = options.training;
    const StepScores scores = train_step_scores(set, training);
    Json record{{"tracks", track_names(set)},
                {"hold_out_tracks", track_names(held_out)},
                {"scenes", scene_options_json(options.scenes)},
                {"hold_out_every", options.hold_out_every_m},
                {"beam", record_of(option_fields(training))}};
    TrainingRun run;
    run.summary = finish(step_score_figures(set, scores, training.search),
                         step_score_figures(held_out, scores, training.search), record);
    run.file = step_scores_json(scores, record.dump());
    return run;
}

Track track_variant(Track track, std::size_t number, std::uint64_t seed) {
    constexpr double kMaxLogStretch = 0.15;
    track.name += fmt::format("_variant{}", number);
    track.frames.clear();  // a variant of a run is a course
    track.driven.clear();
    boost::random::mt19937_64 random = generator_of(track.name, seed);
    const double axis_rad = boost::random::uniform_real_distribution<double>(0.0, std::numbers::pi)(random);
    boost::random::uniform_real_distribution<double> log_stretch(-kMaxLogStretch, kMaxLogStretch);
    const double along = std::exp(log_stretch(random));
    const double across = std::exp(log_stretch(random));
    const Point axis(std::cos(axis_rad), std::sin(axis_rad));
    const Point normal(-axis.y(), axis.x());
    for (Cone& cone : track.cones) {
        cone.position = along * axis.dot(cone.position) * axis + across * normal.dot(cone.position) * normal;
    }
    if (number % 2 == 0) {
        std::swap(track.left, track.right);
        std::ranges::reverse(track.left);
        std::ranges::reverse(track.right);
    }
    return track;
}

}  // namespace conelane::learning
