#include "evaluation/formats/file_text.hpp"
#include "evaluation/formats/weights_file.hpp"
#include "evaluation/progress/progress.hpp"
#include "evaluation/scoring/score.hpp"
#include "experiments/studies/study.hpp"
#include "graph_search/front/front_detector.hpp"
#include "graph_search/front/front_judge.hpp"

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

/// One scene by one width.
struct WidthRow {
    std::size_t width = 0;                                    ///< its place
    std::size_t beam = 0;                                     ///< 0: no limit
    double drop = 0.0;                                        ///< infinity: none
    double score = -std::numeric_limits<double>::infinity();  ///< the highest of a lane
    bool is_proven = false;     ///< the search left nothing out: no lane has a higher score
    bool is_best = false;       ///< no other width met a higher score
    bool first_usable = false;  ///< by score alone
    bool usable = false;        ///< as the judge orders the best lanes
    bool any_usable = false;    ///< of the lanes judged
    double iou = 0.0;           ///< of the judge's first lane
    double time_ms = 0.0;       ///< of search and judge together
};

class Width {
  public:
    Width(const FrontWeights& weights, const FrontSearchOptions& search,
          double limit_ms = std::numeric_limits<double>::infinity())
        : cost_(weights), judge_(weights), options_(search), limit_ms_(limit_ms) {}

    WidthRow drive(const AnnotatedScene& scene, const TrackBoundaries* boundaries) {
        WidthRow row;
        row.beam = options_.beam_width == kAll ? 0 : options_.beam_width;
        row.drop = options_.drop;
        const Stopwatch watch;
        SearchBudget budget;
        budget.deadline = Deadline(limit_ms_);
        search_.begin(scene.scene, cost_, options_);
        search_.run(budget);
        row.is_proven = !budget.stopped_by && !search_.left_out();
        search_.sort_finished(FrontJudge::kContenders);
        contenders_.clear();
        for (const FrontSearch::Finished& lane : search_.finished()) {
            if (contenders_.size() == FrontJudge::kContenders) break;
            contenders_.push_back({lane.parent, lane.score});
        }
        if (!contenders_.empty()) judge_.compare(search_, contenders_);
        row.time_ms = watch.elapsed_ms();
        for (std::size_t place = 0; place < contenders_.size(); ++place) {
            const SceneScore scored = scored_lane(scene, contenders_[place].node, boundaries);
            const bool usable = scored.usable().value_or(false);
            row.any_usable = row.any_usable || usable;
            if (place == 0) row.first_usable = usable;
            if (place == 0) row.score = contenders_.front().score;
            if (place != judge_.order().front()) continue;
            row.usable = usable;
            row.iou = scored.iou.value_or(0.0);
        }
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
};

/// Shares are of all scenes with a ground truth.
RowFields<RowGroup<WidthRow>> width_fields() {
    using Row = WidthRow;
    return {
        {"beam", first_of(&Row::beam)},
        {"", first_of([](const Row& row) { return row.beam == 0 ? "all" : std::to_string(row.beam); }),
         Shown::number("beam")},
        {"drop", first_of([](const Row& row) { return std::isfinite(row.drop) ? Json(row.drop) : Json(); }),
         Shown::fixed("drop", 1)},
        {"scenes", &RowGroup<Row>::size, Shown::number("scenes")},
        {"proven", share_of(&Row::is_proven), Shown::percent("proven %", 2)},
        {"best_score", share_of(&Row::is_best), Shown::percent("best score %", 2)},
        {"first_usable", share_of(&Row::first_usable), Shown::percent("usable by score %", 2)},
        {"usable", share_of(&Row::usable), Shown::percent("usable, judged %", 2)},
        {"any_usable", share_of(&Row::any_usable), Shown::percent("any usable %", 2)},
        {"iou", mean_of(&Row::iou), Shown::percent("IoU %", 2)},
        {"median_ms", median_of(&Row::time_ms), Shown::fixed("median ms", 2)},
        {"p95_ms", quantile_of(&Row::time_ms, 0.95), Shown::fixed("p95 ms", 2)},
        {"worst_ms", quantile_of(&Row::time_ms, 1.0), Shown::fixed("worst ms", 2)}};
}

/// Throws InvalidInput if a width or drop is out of range, or no scene has a ground truth.
std::vector<WidthRow> front_beam_rows(const SceneSet& set, const FrontBeamOptions& options) {
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

    Progress progress("scenes", set.scenes.size());
    std::vector<WidthRow> rows;
    for (const AnnotatedScene& scene : set.scenes) {
        progress.advance();
        if (!counts(scene)) continue;
        const auto track = set.tracks.find(scene.track);
        const TrackBoundaries* boundaries = track == set.tracks.end() ? nullptr : &track->second;
        double highest = -std::numeric_limits<double>::infinity();
        for (std::size_t k = 0; k < widths.size(); ++k) {
            WidthRow& row = rows.emplace_back(widths[k].drive(scene, boundaries));
            row.width = k;
            highest = std::max(highest, row.score);
        }
        for (WidthRow& row : std::span(rows).last(widths.size()))
            row.is_best = row.score >= highest - kSameScore;
    }
    if (rows.empty()) throw InvalidInput("scenes", "none has a ground truth");
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
        const std::vector<WidthRow> rows = front_beam_rows(set, options_);
        return study_result(groups_of<WidthRow>(rows, std::mem_fn(&WidthRow::width)), width_fields());
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
