#include "conelane/invalid_input.hpp"
#include "evaluation/formats/file_text.hpp"
#include "evaluation/formats/weights_file.hpp"
#include "evaluation/scoring/score.hpp"
#include "evaluation/scoring/statistics.hpp"
#include "experiments/progress/progress.hpp"
#include "experiments/studies/study.hpp"
#include "graph_search/front/front_detector.hpp"
#include "graph_search/front/front_judge.hpp"
#include "graph_search/front/front_search.hpp"
#include "model/deadline.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace conelane::experiments {
namespace {

/// Scores that differ by less are equal: the order of the sums may differ.
constexpr double kSameScore = 1e-4;
constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();

struct FrontBeamOptions {
    FrontWeights weights;
    std::vector<std::size_t> beams{5, 10, 15, 30, 100};  ///< states a level, with the detector's other limits
    /// The last row except for those of `exhaustive_ms`: the widest search, with which the others are
    /// compared.
    std::size_t reference_beam = 400;
    double reference_drop = 12.0;
    /// A row for each: the search that leaves nothing out (no drop, no merge), stopped after this time.
    std::vector<double> exhaustive_ms;
};

/// One width over all scenes with a ground truth. Shares are of these.
struct FrontBeamRow {
    std::size_t beam = 0;  ///< 0: no limit
    double drop = 0.0;     ///< infinity: none
    std::size_t scenes = 0;
    double proven = 0.0;        ///< share whose search left nothing out: no lane has a higher score
    double best_score = 0.0;    ///< share with a lane of the highest score that any row has met
    double first_usable = 0.0;  ///< by score alone
    double usable = 0.0;        ///< as the judge orders the best lanes
    double any_usable = 0.0;    ///< share with a usable lane among those judged
    double iou = 0.0;           ///< mean, of the judge's first lane
    double median_ms = 0.0;     ///< of search and judge together
    double p95_ms = 0.0;
    double worst_ms = 0.0;
};

/// One width, scene by scene.
class Width {
  public:
    Width(const FrontWeights& weights, const FrontSearchOptions& search,
          double limit_ms = std::numeric_limits<double>::infinity())
        : cost_(weights), judge_(weights), options_(search), limit_ms_(limit_ms) {
        row_.beam = search.beam_width == kAll ? 0 : search.beam_width;
        row_.drop = search.drop;
    }

    /// The highest score of a lane; minus infinity if there is none.
    double drive(const AnnotatedScene& scene, const TrackBoundaries* boundaries) {
        const Stopwatch watch;
        SearchBudget budget;
        budget.deadline = Deadline(limit_ms_);
        search_.begin(scene.scene, cost_, options_);
        search_.run(budget);
        if (!budget.stopped_by && !search_.left_out()) row_.proven += 1.0;
        search_.sort_finished(FrontJudge::kContenders);
        contenders_.clear();
        for (const FrontSearch::Finished& lane : search_.finished()) {
            if (contenders_.size() == FrontJudge::kContenders) break;
            contenders_.push_back({lane.parent, lane.score});
        }
        if (!contenders_.empty()) judge_.compare(search_, contenders_);
        times_ms_.push_back(watch.elapsed_ms());
        ++row_.scenes;
        if (contenders_.empty()) return -std::numeric_limits<double>::infinity();
        bool any = false;
        for (std::size_t place = 0; place < contenders_.size(); ++place) {
            const SceneScore scored = scored_lane(scene, contenders_[place].node, boundaries);
            const bool usable = scored.usable().value_or(false);
            any = any || usable;
            if (place == 0 && usable) row_.first_usable += 1.0;
            if (place != judge_.order().front()) continue;
            if (usable) row_.usable += 1.0;
            row_.iou += scored.iou.value_or(0.0);
        }
        if (any) row_.any_usable += 1.0;
        return contenders_.front().score;
    }

    void add_best() { row_.best_score += 1.0; }

    [[nodiscard]] FrontBeamRow row() const {
        FrontBeamRow row = row_;
        for (double* share :
             {&row.proven, &row.best_score, &row.first_usable, &row.usable, &row.any_usable, &row.iou})
            *share /= static_cast<double>(row.scenes);
        row.median_ms = median(times_ms_);
        row.p95_ms = quantile(times_ms_, 0.95);
        row.worst_ms = quantile(times_ms_, 1.0);
        return row;
    }

  private:
    SceneScore scored_lane(const AnnotatedScene& scene, std::size_t node, const TrackBoundaries* boundaries) {
        search_.cones(node, cones_);
        even_far_ends(search_.map(), cones_);
        LaneAnswer answer;
        answer.status = LaneStatus::found;
        for (const Side side : {kLeft, kRight}) {
            std::vector<ConeId>& boundary = side == kLeft ? answer.lane.left : answer.lane.right;
            for (const Vertex cone : cones_[side])
                boundary.push_back(scene.scene.cones[search_.map().scene_index(cone)].id);
        }
        return score(scene, answer, 0.0, std::nullopt, boundaries);
    }

    FrontCost cost_;
    FrontJudge judge_;
    FrontSearchOptions options_;
    double limit_ms_;
    FrontSearch search_;
    std::vector<FrontJudge::Contender> contenders_;
    std::array<std::vector<Vertex>, 2> cones_;
    std::vector<double> times_ms_;
    FrontBeamRow row_;
};

const RowFields<FrontBeamRow>& width_fields() {
    using Row = FrontBeamRow;
    static const RowFields<Row> kFields{
        {"beam", &Row::beam},
        {"", [](const Row& row) { return row.beam == 0 ? "all" : std::to_string(row.beam); },
         Shown::number("beam")},
        {"drop", [](const Row& row) { return std::isfinite(row.drop) ? Json(row.drop) : Json(); },
         Shown::fixed("drop", 1)},
        {"scenes", &Row::scenes, Shown::number("scenes")},
        {"proven", &Row::proven, Shown::percent("proven %", 2)},
        {"best_score", &Row::best_score, Shown::percent("best score %", 2)},
        {"first_usable", &Row::first_usable, Shown::percent("usable by score %", 2)},
        {"usable", &Row::usable, Shown::percent("usable, judged %", 2)},
        {"any_usable", &Row::any_usable, Shown::percent("any usable %", 2)},
        {"iou", &Row::iou, Shown::percent("IoU %", 2)},
        {"median_ms", &Row::median_ms, Shown::fixed("median ms", 2)},
        {"p95_ms", &Row::p95_ms, Shown::fixed("p95 ms", 2)},
        {"worst_ms", &Row::worst_ms, Shown::fixed("worst ms", 2)}};
    return kFields;
}

/// Throws InvalidInput if a width or drop is out of range, or no scene has a ground truth.
std::vector<FrontBeamRow> front_beam_rows(const SceneSet& set, const FrontBeamOptions& options) {
    std::vector<Width> widths;
    for (const std::size_t beam : options.beams) {
        FrontSearchOptions search;
        search.beam_width = beam;
        validate(search);
        widths.emplace_back(options.weights, search);
    }
    FrontSearchOptions reference;
    reference.beam_width = options.reference_beam;
    reference.drop = reference.finished_drop = options.reference_drop;
    reference.far_m = std::numeric_limits<double>::infinity();
    validate(reference);
    widths.emplace_back(options.weights, reference);
    for (const double limit_ms : options.exhaustive_ms) {
        FrontSearchOptions all;
        all.beam_width = kAll;
        all.drop = all.finished_drop = std::numeric_limits<double>::infinity();
        all.merge = false;
        widths.emplace_back(options.weights, all, limit_ms);
    }

    std::vector<const AnnotatedScene*> scenes;
    for (const AnnotatedScene& scene : set.scenes) {
        if (counts(scene)) scenes.push_back(&scene);
    }
    if (scenes.empty()) throw InvalidInput("scenes", "none has a ground truth");
    Progress progress("scenes", scenes.size());
    for (const AnnotatedScene* scene : scenes) {
        const auto track = set.tracks.find(scene->track);
        const TrackBoundaries* boundaries = track == set.tracks.end() ? nullptr : &track->second;
        std::vector<double> best;
        for (Width& width : widths) best.push_back(width.drive(*scene, boundaries));
        const double highest = std::ranges::max(best);
        for (std::size_t i = 0; i < widths.size(); ++i) {
            if (best[i] >= highest - kSameScore) widths[i].add_best();
        }
        progress.advance();
    }
    std::vector<FrontBeamRow> rows;
    for (const Width& width : widths) rows.push_back(width.row());
    return rows;
}

class FrontBeamStudy : public SceneStudy {
  public:
    FrontBeamStudy()
        : SceneStudy(
              {"front-beam",
               "how often does the beam of front miss the lane of the highest score, and what does the judge "
               "add to the score?",
               "Each scene with a ground truth by each width, one thread, times as wall clock; the last row "
               "is the widest search, except for --exhaustive. Best score: the highest of all rows was "
               "found. "
               "Proven: nothing was left out, so no allowed lane has a higher score. Any usable: one of the "
               "best 20 lanes, from which the judge chooses. *.tracks.json beside the scenes has the "
               "boundaries."}) {}

    void add_options(CLI::App& command) override {
        SceneStudy::add_options(command);
        command.add_option("--weights", weights_, "weights of front (JSON); those of the library without it");
        command.add_option("--beams", options_.beams, "numbers of states kept at each level")
            ->delimiter(',')
            ->capture_default_str();
        command.add_option("--reference-beam", options_.reference_beam, "beam of the last row")
            ->capture_default_str();
        command.add_option("--reference-drop", options_.reference_drop, "drop of the last row [score]")
            ->capture_default_str();
        command
            .add_option("--exhaustive", options_.exhaustive_ms,
                        "time limits [ms]: a row for each, by the search that leaves out nothing")
            ->delimiter(',')
            ->check(CLI::PositiveNumber);
    }

    StudyResult measure(const SceneSet& set) override {
        options_.weights =
            weights_.empty()
                ? shipped_front_options().weights
                : parsed_file(weights_, [](const std::string& text) { return parse_front_weights(text); });
        return study_result(front_beam_rows(set, options_), width_fields());
    }

  private:
    std::string weights_;
    FrontBeamOptions options_;
};

}  // namespace

std::unique_ptr<Study> make_front_beam_study() {
    return std::make_unique<FrontBeamStudy>();
}

}  // namespace conelane::experiments
