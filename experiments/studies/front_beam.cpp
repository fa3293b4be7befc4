#include "experiments/studies/front_beam.hpp"

#include "conelane/invalid_input.hpp"
#include "evaluation/formats/file_text.hpp"
#include "evaluation/formats/scene_file.hpp"
#include "evaluation/formats/weights_file.hpp"
#include "evaluation/scoring/score.hpp"
#include "evaluation/scoring/statistics.hpp"
#include "experiments/options/shared_options.hpp"
#include "experiments/progress/progress.hpp"
#include "experiments/studies/study.hpp"
#include "experiments/studies/study_options.hpp"
#include "experiments/studies/text_table.hpp"
#include "graph_search/front/front_detector.hpp"
#include "graph_search/front/front_judge.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <limits>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace conelane::experiments {
namespace {

/// Scores that differ by less are equal: the order of the sums may differ.
constexpr double kSameScore = 1e-4;
constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();

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
        const auto begin = std::chrono::steady_clock::now();
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
        const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - begin;
        times_ms_.push_back(took.count());
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

nlohmann::ordered_json to_json(const FrontBeamRow& row) {
    return {{"beam", row.beam},
            {"drop", std::isfinite(row.drop) ? nlohmann::ordered_json(row.drop) : nlohmann::ordered_json()},
            {"scenes", row.scenes},
            {"proven", row.proven},
            {"best_score", row.best_score},
            {"first_usable", row.first_usable},
            {"usable", row.usable},
            {"any_usable", row.any_usable},
            {"iou", row.iou},
            {"median_ms", row.median_ms},
            {"p95_ms", row.p95_ms},
            {"worst_ms", row.worst_ms}};
}

std::string table_of(std::span<const FrontBeamRow> rows) {
    TextTable table({{"beam"},
                     {"drop"},
                     {"scenes"},
                     {"proven %"},
                     {"best score %"},
                     {"usable by score %"},
                     {"usable, judged %"},
                     {"any usable %"},
                     {"IoU %"},
                     {"median ms"},
                     {"p95 ms"},
                     {"worst ms"}});
    for (const FrontBeamRow& row : rows) {
        table.add({row.beam == 0 ? "all" : std::to_string(row.beam),
                   std::isfinite(row.drop) ? fixed(row.drop, 1) : "-", std::to_string(row.scenes),
                   percent(row.proven, 2), percent(row.best_score, 2), percent(row.first_usable, 2),
                   percent(row.usable, 2), percent(row.any_usable, 2), percent(row.iou, 2),
                   fixed(row.median_ms, 2), fixed(row.p95_ms, 2), fixed(row.worst_ms, 2)});
    }
    return table.text();
}

class FrontBeamStudy : public Study {
  public:
    FrontBeamStudy()
        : Study(
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
        command.add_option("--scenes", scenes_, "*.scenes.jsonl; *.tracks.json beside it")->required();
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

    StudyResult run() override {
        options_.weights =
            weights_.empty()
                ? shipped_front_options().weights
                : parsed_file(weights_, [](const std::string& text) { return parse_front_weights(text); });
        SceneSet set;
        set.scenes = read_scenes(scenes_);
        const std::filesystem::path boundaries = track_boundaries_path(scenes_);
        if (std::filesystem::exists(boundaries)) set.tracks = read_track_boundaries(boundaries);
        const std::vector<FrontBeamRow> rows = front_beam_rows(set, options_);
        return study_result(table_of(rows), rows, [](const FrontBeamRow& row) { return to_json(row); });
    }

  private:
    std::string scenes_;
    std::string weights_;
    FrontBeamOptions options_;
};

}  // namespace

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

std::unique_ptr<Study> make_front_beam_study() {
    return std::make_unique<FrontBeamStudy>();
}

}  // namespace conelane::experiments
