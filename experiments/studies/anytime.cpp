#include "experiments/studies/anytime.hpp"

#include "conelane/invalid_input.hpp"
#include "conelane/solve_scene.hpp"
#include "evaluation/formats/json_node.hpp"
#include "evaluation/formats/scene_file.hpp"
#include "evaluation/scoring/statistics.hpp"
#include "experiments/options/whole_number.hpp"
#include "experiments/progress/progress.hpp"
#include "experiments/studies/cone_sets.hpp"
#include "experiments/studies/study.hpp"
#include "experiments/studies/study_options.hpp"
#include "experiments/studies/text_table.hpp"
#include "solvers/registry.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include <fmt/format.h>

namespace conelane::experiments {
namespace {

constexpr double kCloseIncumbent = 0.01;  ///< relative to the best one known

void add_rows(const AnnotatedScene& scene, RldSolver& solver, const AnytimeOptions& options,
              std::vector<AnytimeRow>& rows) {
    const std::size_t first = rows.size();
    for (const double limit_ms : options.limits_ms) {
        if (rows.size() > first && rows.back().proven) {
            rows.push_back(rows.back());
            rows.back().limit_ms = limit_ms;
            continue;
        }
        const RldReport report =
            solve_scene(solver, scene.scene, options.parameters, {.limits = {limit_ms}}).report;
        if (report.status == SolveStatus::error) throw InvalidInput(scene.scene.id, report.message);
        const bool proven = report.status == SolveStatus::optimal || report.status == SolveStatus::infeasible;
        rows.push_back({&scene, limit_ms, proven, report.objective, report.bound, {}});
    }
    std::optional<double> best;
    for (std::size_t k = first; k < rows.size(); ++k) {
        if (rows[k].objective) best = std::min(best.value_or(*rows[k].objective), *rows[k].objective);
    }
    for (std::size_t k = first; k < rows.size(); ++k) rows[k].best_known = best;
}

bool is_close(const AnytimeRow& row) {
    return row.objective && relative_gap(*row.objective, *row.best_known) <= kCloseIncumbent;
}

nlohmann::ordered_json row_to_json(const AnytimeRow& row) {
    nlohmann::ordered_json json{{"scene", row.scene->scene.id},
                                {"track", row.scene->track},
                                {"cones", row.scene->scene.cones.size()},
                                {"limit_ms", row.limit_ms},
                                {"proven", row.proven}};
    if (row.objective) json["objective"] = *row.objective;
    if (row.bound) put_bound(json, *row.bound, "bound");
    if (row.best_known) json["best_known"] = *row.best_known;
    if (const auto gap = proven_gap(row)) json["gap"] = *gap;
    return json;
}

class AnytimeStudy : public Study {
  public:
    AnytimeStudy()
        : Study({"anytime", "what does path-pair know when its time is up?",
                 "All cones of each scene, solved again under each limit, wall clock, one thread. Gap: from "
                 "the "
                 "bound to the best lane graph known under any limit, divided by the larger of 1 and its "
                 "cost's size. An incumbent is close where it costs within 1 % of that lane graph."}) {}

    void add_options(CLI::App& command) override {
        add_input_options(command, input_);
        command.add_option("--limits", options_.limits_ms, "milliseconds, ascending")
            ->delimiter(',')
            ->check(CLI::Range(0.1, 1e7))
            ->capture_default_str();
        command
            .add_option_function<std::size_t>(
                "--limit", [this](std::size_t count) { options_.limit = count; },
                "scenes at most, evenly spread")
            ->check(whole_number(1, 1'000'000));
    }

    StudyResult run() override {
        options_.parameters = input_.parameters.load();
        const std::vector<AnnotatedScene> scenes = read_scenes(input_.scenes);
        const std::vector<AnytimeRow> rows = anytime_rows(scenes, options_);
        return study_result(anytime_table(rows, options_.limits_ms), rows,
                            [](const AnytimeRow& row) { return row_to_json(row); });
    }

  private:
    StudyInput input_;
    AnytimeOptions options_;
};

}  // namespace

std::vector<AnytimeRow> anytime_rows(std::span<const AnnotatedScene> scenes, const AnytimeOptions& options) {
    if (!std::ranges::is_sorted(options.limits_ms, std::less_equal()) || options.limits_ms.empty())
        throw InvalidInput("--limits", "must be in ascending order");
    const std::unique_ptr<RldSolver> solver = find_rld_solver("path-pair")->make(Formulation::tight);
    const std::size_t count = std::min(options.limit.value_or(scenes.size()), scenes.size());
    std::vector<AnytimeRow> rows;
    Progress progress("anytime", count);
    for (std::size_t k = 0; k < count; ++k) {
        add_rows(scenes[k * scenes.size() / count], *solver, options, rows);
        progress.advance();
    }
    return rows;
}

std::optional<double> proven_gap(const AnytimeRow& row) {
    if (row.proven) return 0.0;
    if (!row.best_known || !row.bound) return std::nullopt;
    return std::max(0.0, *row.best_known - *row.bound) / std::max(1.0, std::abs(*row.best_known));
}

std::string anytime_table(std::span<const AnytimeRow> rows, std::span<const double> limits_ms) {
    TextTable table({{"limit ms"},
                     {"scenes"},
                     {"proven %"},
                     {"open"},
                     {"close %"},
                     {"open: close %"},
                     {"median gap %"},
                     {"p90 gap %"}});
    for (const double limit_ms : limits_ms) {
        std::size_t scenes = 0;
        std::size_t proven = 0;
        std::size_t close = 0;
        std::vector<double> gaps;
        for (const AnytimeRow& row : rows) {
            if (row.limit_ms != limit_ms) continue;
            ++scenes;
            if (row.proven) {
                ++proven;
                continue;
            }
            if (is_close(row)) ++close;
            if (const auto gap = proven_gap(row)) gaps.push_back(*gap);
        }
        const auto of_gaps = [&](double share) {
            return gaps.empty() ? std::nullopt : std::optional(quantile(gaps, share));
        };
        table.add({fmt::format("{:g}", limit_ms), std::to_string(scenes), percent(share(proven, scenes), 1),
                   std::to_string(scenes - proven), percent(share(proven + close, scenes), 1),
                   percent(share(close, scenes - proven), 1), percent(of_gaps(0.5), 1),
                   percent(of_gaps(0.9), 1)});
    }
    return table.text();
}

std::unique_ptr<Study> make_anytime_study() {
    return std::make_unique<AnytimeStudy>();
}

}  // namespace conelane::experiments
