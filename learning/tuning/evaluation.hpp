#pragma once

#include "conelane/rld_parameters.hpp"
#include "evaluation/formats/scene_set.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace conelane::learning {

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

/// Scenes that parameters are evaluated on. Each is solved to optimality by path-pair.
class Evaluation {
  public:
    /// Keeps the scenes on which the objective is defined. Throws InvalidInput if there are none.
    Evaluation(SceneSet set, const EvaluationOptions& options);

    /// The mean over the scenes, in [0, 1]. The same for any number of threads, if no scene reaches the time
    /// limit.
    [[nodiscard]] double operator()(const RldParameters& parameters) const;

    [[nodiscard]] const std::vector<AnnotatedScene>& scenes() const { return set_.scenes; }

  private:
    SceneSet set_;
    EvaluationOptions options_;
};

}  // namespace conelane::learning
