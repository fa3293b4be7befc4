#include "learning/tuning/tuner.hpp"

#include "learning/tuning/parameter_ranges.hpp"

#include <algorithm>
#include <exception>
#include <vector>

#include <nlopt.hpp>

namespace conelane::learning {
namespace {

constexpr double kGlobalShare = 0.3;
/// Largest distance of the global search from the start on each axis of the unit cube. In the whole cube,
/// nearly every point is worse than a start set by hand: none of 118 evaluations was better.
constexpr double kReach = 0.2;
/// Distance in the unit cube: between closer points, the figures are flat.
constexpr double kFirstStep = 0.08;
constexpr double kMinStep = 1e-3;

/// One fit. Keeps the best point evaluated, whatever an algorithm returns.
class Fit {
  public:
    Fit(const Evaluate& evaluate, const RldParameters& start)
        : evaluate_(evaluate), rest_(start), best_point_(to_unit_cube(start)) {
        best_.parameters = start;
        best_.figure = best_.figure_of_start = evaluate_(start);
    }

    /// Starts from the best point so far and stays within `reach` of it on each axis.
    void run(nlopt::algorithm algorithm, std::size_t evaluations, double reach) {
        if (evaluations == 0) return;
        nlopt::opt search(algorithm, static_cast<unsigned>(best_point_.size()));
        std::vector<double> lower;
        std::vector<double> upper;
        for (const double coordinate : best_point_) {
            lower.push_back(std::max(0.0, coordinate - reach));
            upper.push_back(std::min(1.0, coordinate + reach));
        }
        search.set_lower_bounds(lower);
        search.set_upper_bounds(upper);
        search.set_max_objective(&Fit::value, this);
        search.set_maxeval(static_cast<int>(evaluations));
        search.set_initial_step(kFirstStep);
        search.set_xtol_abs(kMinStep);
        // Fewer random points at first than NLopt's ten for each dimension, which are meant for longer
        // searches.
        if (algorithm == nlopt::GN_CRS2_LM) {
            const std::size_t fewest = best_point_.size() + 1;
            search.set_population(static_cast<unsigned>(std::clamp(evaluations / 4, fewest, 10 * fewest)));
        }
        std::vector<double> point = best_point_;
        double reached = 0.0;
        try {
            search.optimize(point, reached);
        } catch (const nlopt::roundoff_limited&) {
            // The best point is kept.
        } catch (const nlopt::forced_stop&) {
            std::rethrow_exception(failure_);
        }
    }

    [[nodiscard]] const Tuned& best() const { return best_; }

  private:
    static double value(const std::vector<double>& point, std::vector<double>& /*gradient*/, void* self) {
        return static_cast<Fit*>(self)->value(point);
    }
    double value(const std::vector<double>& point) {
        try {
            const RldParameters parameters = from_unit_cube(point, rest_);
            const double figure = evaluate_(parameters);
            if (figure > best_.figure) {
                best_point_ = point;
                best_.parameters = parameters;
                best_.figure = figure;
            }
            return figure;
        } catch (...) {
            failure_ = std::current_exception();  // NLopt passes on only exceptions of its own
            throw nlopt::forced_stop();
        }
    }

    const Evaluate& evaluate_;
    RldParameters rest_;
    std::vector<double> best_point_;
    Tuned best_;
    std::exception_ptr failure_;
};

}  // namespace

Tuned tune(const Evaluate& evaluate, const RldParameters& start, const TunerOptions& options) {
    nlopt::srand(options.seed);
    Fit fit(evaluate, start);
    const auto global = static_cast<std::size_t>(kGlobalShare * static_cast<double>(options.evaluations));
    constexpr double kWholeCube = 1.0;
    fit.run(nlopt::GN_CRS2_LM, global, kReach);
    fit.run(nlopt::LN_SBPLX, options.evaluations - global, kWholeCube);
    return fit.best();
}

}  // namespace conelane::learning
