#include "learning/training/step_score_training.hpp"

#include "conelane/invalid_input.hpp"
#include "evaluation/progress/progress.hpp"
#include "evaluation/scoring/score.hpp"
#include "evaluation/seeded_random.hpp"
#include "graph_search/clc/lane_features.hpp"
#include "graph_search/clc/start_vertices.hpp"
#include "learning/training/training_loop.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <unordered_map>
#include <vector>

#include <boost/random/mersenne_twister.hpp>

namespace conelane::learning {
namespace {

/// If a score rarely has an effect, its derivative is mostly rounding.
constexpr double kMinDeviation = 1e-6;

/// Less likely lanes add nothing to a derivative.
constexpr double kMinProbability = 1e-3;

/// A scene in the search graph with its ground truth, and the beam that should keep it.
class RightLane {
  public:
    explicit RightLane(const CandidateSearchOptions& search) : search_(search) {}

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

}  // namespace conelane::learning
