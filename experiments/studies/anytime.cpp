#include "experiments/options/shared_options.hpp"
#include "experiments/studies/solve_study.hpp"
#include "experiments/studies/study.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace conelane::experiments {
namespace {

constexpr double kCloseIncumbent = 0.01;  ///< relative to the best one known

/// One scene under one limit.
struct AnytimeRow : SolveRow {
    double limit_ms = 0.0;
    std::optional<double> best_known = {};  ///< the lowest objective under any limit

    /// From the bound to the best one known, relative; 0 of a proven scene.
    [[nodiscard]] std::optional<double> gap() const {
        if (is_proven()) return 0.0;
        if (!best_known || !bound) return std::nullopt;
        return std::max(0.0, *best_known - *bound) / std::max(1.0, std::abs(*best_known));
    }
    [[nodiscard]] bool is_open() const { return !is_proven(); }
    [[nodiscard]] bool is_close() const {
        return is_proven() || (objective && relative_gap(*objective, *best_known) <= kCloseIncumbent);
    }
    [[nodiscard]] std::optional<double> open_gap() const { return is_proven() ? std::nullopt : gap(); }
};

std::optional<double> close_share_of_open(const RowGroup<AnytimeRow>& group) {
    const std::size_t open = group.count(&AnytimeRow::is_open);
    return share(group.count(&AnytimeRow::is_close) + open - group.size(), open);
}

class AnytimeStudy : public SolveStudy {
  public:
    AnytimeStudy()
        : SolveStudy({"anytime", "what does path-pair know when its time is up?",
                      "All cones of each scene, solved again under each limit, wall clock, one thread. Gap: "
                      "from the bound to the best lane graph known under any limit, divided by the larger of "
                      "1 and its cost's size. An incumbent is close where it costs within 1 % of that lane "
                      "graph."},
                     {.backends = {{"path-pair"}}, .time_limit_ms = 0.0}) {}

    void add_options(CLI::App& command) override {
        SolveStudy::add_options(command);
        add_limits_option(command, "--limits", limits_ms_, "milliseconds, ascending")->capture_default_str();
    }

  protected:
    StudyResult aggregate(const SceneSet& set, SolveOptions solves) override {
        require_ascending("--limits", limits_ms_);
        const std::vector<AnnotatedScene> scenes = spread(set.scenes, solves.limit);
        solves.sizes = {kAllVisible};
        solves.limit.reset();
        std::map<const AnnotatedScene*, std::vector<AnytimeRow>> of_scene;
        // What is proven under a limit is proven under longer ones.
        solves.wanted = [&](const AnnotatedScene& scene, std::size_t /*size*/) {
            const std::vector<AnytimeRow>& known = of_scene[&scene];
            return known.empty() || !known.back().is_proven();
        };
        for (const double limit_ms : limits_ms_) {
            solves.time_limit_ms = limit_ms;
            for (SolveRow& row : solved_scenes(scenes, solves))
                of_scene[row.scene].push_back({std::move(row), limit_ms});
            for (const AnnotatedScene& scene : scenes) {
                std::vector<AnytimeRow>& known = of_scene[&scene];
                if (known.back().limit_ms != limit_ms) known.push_back(known.back());
                known.back().limit_ms = limit_ms;
            }
        }
        std::vector<AnytimeRow> rows;
        for (const AnnotatedScene& scene : scenes) {
            std::optional<double> best;
            for (const AnytimeRow& row : of_scene[&scene]) {
                if (row.objective) best = std::min(best.value_or(*row.objective), *row.objective);
            }
            for (AnytimeRow& row : of_scene[&scene]) {
                row.best_known = best;
                rows.push_back(std::move(row));
            }
        }
        return result_of(rows);
    }

  private:
    static StudyResult result_of(const std::vector<AnytimeRow>& rows) {
        using Row = AnytimeRow;
        const RowFields<Row> fields =
            with_scene<Row>({{"cones", &Row::cones},
                             {"limit_ms", &Row::limit_ms},
                             {"proven", &Row::is_proven},
                             {"objective", &Row::objective},
                             {"bound", [](const Row& row) { return bound_value(row.bound); }},
                             {"best_known", &Row::best_known},
                             {"gap", &Row::gap}});
        const RowFields<RowGroup<Row>> of_limits{
            {"", first_of(&Row::limit_ms), Shown::number("limit ms")},
            {"", &RowGroup<Row>::size, Shown::number("scenes")},
            {"", share_of(&Row::is_proven), Shown::percent("proven %", 1)},
            {"", count_of(&Row::is_open), Shown::number("open")},
            {"", share_of(&Row::is_close), Shown::percent("close %", 1)},
            {"", close_share_of_open, Shown::percent("open: close %", 1)},
            {"", median_of(&Row::open_gap), Shown::percent("median gap %", 1)},
            {"", quantile_of(&Row::open_gap, 0.9), Shown::percent("p90 gap %", 1)}};
        StudyResult result;
        result.add_rows(rows, fields);
        result.table =
            row_table(groups_of<Row>(rows, [](const Row& row) { return row.limit_ms; }), of_limits);
        return result;
    }

    std::vector<double> limits_ms_{5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0};
};

}  // namespace

std::unique_ptr<Study> make_anytime_study() {
    return std::make_unique<AnytimeStudy>();
}

}  // namespace conelane::experiments
