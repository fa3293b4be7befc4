#pragma once

#include "evaluation/formats/scene_set.hpp"

namespace conelane::learning {

/// A parameter that tuning changes, and its range.
struct TunedParameter {
    std::string_view key;  ///< as in rld_parameter_fields()
    double RldParameters::*value;
    double lowest;
    double highest;
    bool logarithmic;  ///< equal steps are equal ratios
};

/// The parameters that tuning changes. The others have no effect of their own: w_b sets the unit of the
/// objective, and d_t, theta_t with their weights and limits occur only as w_s / d_t^4, d_t^4 s_crit, w_t /
/// theta_t^4 and theta_t^4 t_crit. An expected angle below pi would prefer bends to straights. The pairing
/// stays too. If the shape costs have a weight in `start`, their parameters are changed instead of the
/// limits.
[[nodiscard]] std::span<const TunedParameter> tuned_parameters(const RldParameters& start);

/// Values of w_color to choose from, beside fixed other parameters; ascending.
inline constexpr std::array kColorWeights{0.0, 0.05, 0.1, 0.2, 0.4, 0.8, 1.6, 3.2};

/// To four decimals: short numbers in files, and the same ones on every machine, whose logarithms differ in
/// the last bits.
[[nodiscard]] double rounded(double value);

/// The parameters that are tuned from this start as a point of the unit cube; values outside a range are
/// moved to its end.
[[nodiscard]] std::vector<double> to_unit_cube(const RldParameters& parameters);

/// `rest`, its limits moved into their ranges, with the parameters tuned from it at a point of the unit cube,
/// rounded to four decimals.
/// Precondition: as many coordinates as tuned parameters, each in [0, 1].
[[nodiscard]] RldParameters from_unit_cube(std::span<const double> point, const RldParameters& rest);

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

struct TunerOptions {
    std::size_t evaluations = 400;
    std::uint64_t seed = 0;
};

struct Tuned {
    RldParameters parameters;
    double figure = 0.0;
    double figure_of_start = 0.0;
};

/// The figure of parameters, as Evaluation gives it.
using Evaluate = std::function<double(const RldParameters&)>;

/// Parameters that maximise the figure as far as the search finds, in the ranges of tuned_parameters(start).
/// NLopt's controlled random search (GN_CRS2_LM) runs around the start on 30 % of the evaluations, then
/// Subplex (LN_SBPLX) from the best point in the whole ranges; the best point evaluated counts, the start
/// included. The same seed and figures give the same answer. Throws the exceptions of `evaluate`.
[[nodiscard]] Tuned tune(const Evaluate& evaluate, const RldParameters& start, const TunerOptions& options);

}  // namespace conelane::learning
