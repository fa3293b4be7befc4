#include "experiments/tuning/tuner.hpp"

#include "conelane/invalid_input.hpp"
#include "experiments/tuning/parameter_ranges.hpp"

#include <algorithm>
#include <exception>
#include <limits>
#include <set>

#include <nlopt.hpp>

namespace conelane::experiments {
namespace {

constexpr double kGlobalShare = 0.3;
/// Largest distance of the global search from the start on each axis of the unit cube. In the whole cube,
/// nearly every point is worse than a start set by hand: none of 118 evaluations was better.
constexpr double kReach = 0.2;
/// Distance in the unit cube: between closer points, the figures are flat.
constexpr double kFirstStep = 0.08;
constexpr double kMinStep = 1e-3;

std::vector<LapFigure> laps_of(const std::vector<LapFigure>& laps, const std::set<std::string>& tracks) {
    std::vector<LapFigure> chosen;
    std::ranges::copy_if(laps, std::back_inserter(chosen),
                         [&](const LapFigure& lap) { return tracks.contains(lap.track); });
    return chosen;
}

/// One fit. Keeps the best point evaluated, whatever an algorithm returns.
class Fit {
  public:
    Fit(const Evaluate& evaluate, const RldParameters& start, std::set<std::string> tracks)
        : evaluate_(evaluate), rest_(start), tracks_(std::move(tracks)), best_point_(to_unit_cube(start)) {
        best_parameters_ = start;
        best_ = mean_over_scenes(laps_of(evaluate_(start), tracks_));
    }

    void try_out(const RldParameters& parameters) {
        const double mean = mean_over_scenes(laps_of(evaluate_(parameters), tracks_));
        if (mean <= best_) return;
        best_ = mean;
        best_point_ = to_unit_cube(parameters);
        best_parameters_ = parameters;
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

    [[nodiscard]] const RldParameters& parameters() const { return best_parameters_; }
    [[nodiscard]] double figure() const { return best_; }

  private:
    static double value(const std::vector<double>& point, std::vector<double>& /*gradient*/, void* self) {
        return static_cast<Fit*>(self)->value(point);
    }
    double value(const std::vector<double>& point) {
        try {
            const RldParameters parameters = from_unit_cube(point, rest_);
            const double mean = mean_over_scenes(laps_of(evaluate_(parameters), tracks_));
            if (mean > best_) {
                best_ = mean;
                best_point_ = point;
                best_parameters_ = parameters;
            }
            return mean;
        } catch (...) {
            failure_ = std::current_exception();  // NLopt passes on only exceptions of its own
            throw nlopt::forced_stop();
        }
    }

    const Evaluate& evaluate_;
    RldParameters rest_;
    std::set<std::string> tracks_;
    std::vector<double> best_point_;
    RldParameters best_parameters_;
    double best_ = 0.0;
    std::exception_ptr failure_;
};

Fit fit(const Evaluate& evaluate, const RldParameters& start, const std::set<std::string>& tracks,
        const TunerOptions& options, const Propose& propose) {
    nlopt::srand(options.seed);
    Fit result(evaluate, start, tracks);
    if (propose) {
        for (const RldParameters& parameters : propose(start, tracks)) result.try_out(parameters);
    }
    const auto global = static_cast<std::size_t>(kGlobalShare * static_cast<double>(options.evaluations));
    constexpr double kWholeCube = 1.0;
    result.run(nlopt::GN_CRS2_LM, global, kReach);
    result.run(nlopt::LN_SBPLX, options.evaluations - global, kWholeCube);
    return result;
}

}  // namespace

double mean_over_scenes(std::span<const LapFigure> laps) {
    double sum = 0.0;
    std::size_t scenes = 0;
    for (const LapFigure& lap : laps) {
        sum += lap.sum;
        scenes += lap.scenes;
    }
    return scenes == 0 ? 0.0 : sum / static_cast<double>(scenes);
}

Tuned tune(const Evaluate& evaluate, const RldParameters& start, const TunerOptions& options,
           const Propose& propose) {
    const std::vector<LapFigure> laps_of_start = evaluate(start);
    std::vector<std::string> tracks;
    for (const LapFigure& lap : laps_of_start) {
        if (std::ranges::find(tracks, lap.track) == tracks.end()) tracks.push_back(lap.track);
    }
    if (options.folds > tracks.size()) throw InvalidInput("--folds", "there are fewer tracks than folds");

    Tuned tuned;
    for (std::size_t fold = 0; options.folds > 1 && fold < options.folds; ++fold) {
        std::set<std::string> seen;
        std::set<std::string> held_out;
        for (std::size_t i = 0; i < tracks.size(); ++i) {
            (i % options.folds == fold ? held_out : seen).insert(tracks[i]);
        }
        const Fit result = fit(evaluate, start, seen, options, propose);
        tuned.folds.push_back({{held_out.begin(), held_out.end()},
                               result.parameters(),
                               result.figure(),
                               laps_of(evaluate(result.parameters()), held_out),
                               laps_of(laps_of_start, held_out)});
    }
    const Fit all = fit(evaluate, start, {tracks.begin(), tracks.end()}, options, propose);
    tuned.parameters = all.parameters();
    tuned.laps = evaluate(all.parameters());
    tuned.laps_of_start = laps_of_start;
    return tuned;
}

}  // namespace conelane::experiments
