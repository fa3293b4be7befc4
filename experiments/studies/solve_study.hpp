#pragma once

#include "experiments/options/shared_options.hpp"
#include "experiments/studies/solve_rows.hpp"
#include "experiments/studies/study.hpp"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace conelane::experiments {

/// A study that solves the scenes of a file: the options that such studies have in common. `solves` are the
/// defaults; without sizes there, the study has no --sizes, with a time limit of 0 no --time-limit.
class SolveStudy : public SceneStudy {
  public:
    SolveStudy(const StudyDescription& description, SolveOptions solves);
    void add_options(CLI::App& command) override;
    [[nodiscard]] StudyResult measure(const SceneSet& set) final;

  protected:
    /// With the options that were given.
    [[nodiscard]] virtual StudyResult aggregate(const SceneSet& set, SolveOptions solves) = 0;

    SolveOptions solves_;

  private:
    std::vector<std::string> sizes_;
    ParameterSource parameters_;
};

/// Reads "--limit N" into `limit`.
void add_limit_option(CLI::App& command, std::optional<std::size_t>& limit, const std::string& description);
/// Reads time limits [ms] that ascend; `require_ascending` throws InvalidInput where they do not.
CLI::Option* add_limits_option(CLI::App& command, const std::string& name, std::vector<double>& limits_ms,
                               const std::string& description);
void require_ascending(const std::string& name, const std::vector<double>& limits_ms);

/// Scene and track, then the other fields of a row.
template <typename Row>
[[nodiscard]] RowFields<Row> with_scene(const RowFields<Row>& others) {
    RowFields<Row> fields{{"scene", [](const Row& row) { return row.scene->scene.id; }},
                          {"track", [](const Row& row) { return row.scene->track; }}};
    fields.insert(fields.end(), others.begin(), others.end());
    return fields;
}

}  // namespace conelane::experiments
