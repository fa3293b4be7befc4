#include "experiments/training/step_score_training.hpp"

#include "conelane/invalid_input.hpp"
#include "evaluation/scoring/score.hpp"
#include "evaluation/seeded_random.hpp"
#include "experiments/progress/progress.hpp"
#include "experiments/training/adam.hpp"
#include "graph_search/clc/lane_features.hpp"
#include "graph_search/clc/start_vertices.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <unordered_map>
#include <vector>

#include <boost/random/mersenne_twister.hpp>

namespace conelane::experiments {
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
        graph_.build(points, search_.d_max_m, search_.edge_rule);
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
        double highest = beam_.state(right).score;
        for (const std::size_t number : competitors_) {
            highest = std::max(highest, beam_.state(number).score);
        }
        double sum = 0.0;
        for (const std::size_t number : competitors_) sum += std::exp(beam_.state(number).score - highest);
        for (const std::size_t number : competitors_) {
            const double probability = std::exp(beam_.state(number).score - highest) / sum;
            const double factor = number == right ? probability - 1.0 : probability;
            if (std::abs(factor) < kMinProbability) continue;
            for (std::size_t at = number; at != LaneBeam::kNone; at = beam_.state(at).parent) {
                add_score_derivatives(beam_.state(at).step, factor, derivatives);
            }
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
};

void validate(const StepScoreTrainingOptions& options) {
    const auto require = [](bool valid, const char* key, const char* reason) {
        if (!valid) throw InvalidInput(key, reason);
    };
    conelane::validate(options.search);
    require(options.epochs > 0, "epochs", "must be positive");
    require(std::isfinite(options.learning_rate) && options.learning_rate > 0.0, "learning_rate",
            "must be positive");
    require(std::isfinite(options.weight_decay) && options.weight_decay >= 0.0, "weight_decay",
            "must not be negative");
}

}  // namespace

StepScores train_step_scores(const SceneSet& set, const StepScoreTrainingOptions& options) {
    validate(options);
    std::vector<const AnnotatedScene*> scenes;
    for (const AnnotatedScene& scene : set.scenes) {
        if (counts(scene)) scenes.push_back(&scene);
    }
    const std::size_t count = step_score_count();
    StepScores scores{std::vector<double>(count, 0.0)};
    std::vector<double> derivatives(count);
    const auto size = static_cast<Eigen::Index>(count);
    Adam adam(size, kMinDeviation);
    boost::random::mt19937_64 random(options.seed);
    RightLane lane(options.search);
    Progress progress("training", options.show_progress ? options.epochs : 0);
    std::size_t met = 0;
    std::size_t learned_from = 0;
    for (std::size_t epoch = 0; epoch < options.epochs; ++epoch) {
        shuffle(scenes, random);
        for (const AnnotatedScene* scene : scenes) {
            const double done =
                static_cast<double>(met++) / static_cast<double>(options.epochs * scenes.size());
            const double rate = cosine_rate(options.learning_rate, done);
            std::ranges::fill(derivatives, 0.0);
            const RightLane::Course course = lane.follow(*scene, scores, &derivatives);
            if (course.levels == 0) continue;
            ++learned_from;
            adam.add(Eigen::Map<const Eigen::ArrayXd>(derivatives.data(), size) /
                     static_cast<double>(course.levels));
            Eigen::Map<Eigen::ArrayXd> values(scores.values.data(), size);
            values -= rate * (adam.mean() / adam.deviation() + options.weight_decay * values);
        }
        progress.advance();
    }
    if (learned_from == 0) throw InvalidInput("tracks", "no scene has a right lane to start with");
    return scores;
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
    if (figures.scenes == 0) return figures;
    const auto count = static_cast<double>(figures.scenes);
    figures.start_share /= count;
    figures.near_kept_share /= count;
    figures.kept_share /= count;
    return figures;
}

}  // namespace conelane::experiments
