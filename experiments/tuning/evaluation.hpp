#pragma once

#include "conelane/lane_detector.hpp"
#include "conelane/rld_parameters.hpp"
#include "conelane/rld_solver.hpp"
#include "conelane/solve_scene.hpp"
#include "evaluation/formats/scene_set.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace conelane::experiments {

/// The objective of a tuning, as a mean over scenes.
enum class TuningObjective {
    accuracy,  ///< share accurate (RLD paper, IV-B)
    iou,       ///< mean intersection over union (CLC paper)
    success,   ///< share successful (CLC paper, Table I)
    usable,    ///< share usable
};
[[nodiscard]] std::string_view to_string(TuningObjective objective);
/// In the order of the enumeration.
[[nodiscard]] std::span<const std::string_view> objective_names();

struct EvaluationOptions {
    TuningObjective objective = TuningObjective::accuracy;
    std::optional<std::size_t> nearest{};  ///< cone-set size; all cones if absent
    std::optional<std::size_t> context{};  ///< as ConeSet::context
    /// A scene whose search exceeds one of these limits has value 0, because slow parameters are not useful.
    double time_limit_ms = 20.0;
    std::int64_t max_nodes = 1000;
    /// If more than this number of scenes have reached the time limit, all scenes have value 0.
    double max_timed_out = 0.02;
    unsigned threads = 1;
};

/// A scene solved with some parameters, and its answer.
struct EvaluatedScene : SolvedScene {
    Scene seen;  ///< the cone set, or the context if that is larger
    LaneAnswer answer;
};
[[nodiscard]] EvaluatedScene evaluate(RldSolver& solver, const Scene& scene, const RldParameters& parameters,
                                      const EvaluationOptions& options);

/// The lane of a lane graph over the cones seen, cut to the cone set; not found if nothing is left.
[[nodiscard]] LaneAnswer answer_of(const LaneGraph& graph, const Scene& seen,
                                   const EvaluationOptions& options);
/// The value of an answer under the objective, in [0, 1]; 0 without a lane.
[[nodiscard]] double value_of(const LaneAnswer& answer, const AnnotatedScene& scene,
                              const TrackBoundaries& boundaries, const EvaluationOptions& options);

/// Number of nearest cones that a lane is found among; all cones if absent.
[[nodiscard]] std::optional<std::size_t> seen_count(const EvaluationOptions& options);

/// The values that parameters reach on the scenes of one track, rate and range.
struct LapFigure {
    std::string track;
    double rate = 0.0;
    double range_m = 0.0;
    std::size_t scenes = 0;
    double sum = 0.0;  ///< over the scenes, each in [0, 1]

    bool operator==(const LapFigure&) const = default;
};

/// Scenes that parameters are evaluated on. Each is solved to optimality by path-pair.
class Evaluation {
  public:
    /// Keeps the scenes on which the objective is defined. Throws InvalidInput if there are none.
    Evaluation(SceneSet set, const EvaluationOptions& options);

    /// A figure for each lap, in the order of the scenes. The same for any number of threads, if no scene
    /// reaches the time limit.
    [[nodiscard]] std::vector<LapFigure> operator()(const RldParameters& parameters) const;

    [[nodiscard]] const std::vector<AnnotatedScene>& scenes() const { return set_.scenes; }
    [[nodiscard]] const TrackBoundaries& boundaries_of(const AnnotatedScene& scene) const {
        return set_.tracks.at(scene.track);
    }
    [[nodiscard]] const EvaluationOptions& options() const { return options_; }

  private:
    SceneSet set_;
    EvaluationOptions options_;
};

}  // namespace conelane::experiments
