#pragma once

#include "evaluation/formats/scene_set.hpp"
#include "experiments/comparison/answer_errors.hpp"
#include "experiments/studies/row_fields.hpp"

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace CLI {
class App;
}

namespace conelane::experiments {

/// Description of a study, for its help and the list of studies.
struct StudyDescription {
    std::string_view name;      ///< as in `conelane study NAME`; its rows are shown from DIR/NAME.jsonl
    std::string_view question;  ///< one line
    std::string_view protocol;  ///< data and method of the measurement
};

struct StudyResult {
    std::string table = {};       ///< for a terminal; ends with a line feed
    std::vector<Json> rows = {};  ///< for a file, an object each
    AnswerErrors errors = {};     ///< if answers of status error are counted instead of thrown

    template <typename Rows, typename Row>
    void add_rows(const Rows& all, const RowFields<Row>& fields) {
        for (const Row& row : all) rows.push_back(row_json(row, fields));
    }
};

/// The same rows in file and table.
template <typename Rows, typename Row>
[[nodiscard]] StudyResult study_result(const Rows& rows, const RowFields<Row>& fields) {
    StudyResult result{row_table(rows, fields)};
    result.add_rows(rows, fields);
    return result;
}

/// One measured question. Each study is a file of this folder with a line in make_studies().
class Study {
  public:
    explicit Study(const StudyDescription& description) : description_(description) {}
    virtual ~Study() = default;
    Study(const Study&) = delete;
    Study& operator=(const Study&) = delete;

    [[nodiscard]] const StudyDescription& description() const { return description_; }

    /// Declares all options but --out. They are stored in this object, which must outlive the parsing.
    virtual void add_options(CLI::App& command) = 0;

    /// Measures with the parsed options. Throws InputError or InvalidInput.
    [[nodiscard]] virtual StudyResult run() = 0;

  private:
    StudyDescription description_;
};

/// A study of the scenes of a file. What a derived class adds to `add_options` comes after --scenes.
class SceneStudy : public Study {
  public:
    using Study::Study;
    void add_options(CLI::App& command) override;
    [[nodiscard]] StudyResult run() final;
    [[nodiscard]] virtual StudyResult measure(const SceneSet& set) = 0;

  private:
    std::string scenes_;
};

/// All studies, in the order in which they are listed.
[[nodiscard]] std::vector<std::unique_ptr<Study>> make_studies();

[[nodiscard]] std::unique_ptr<Study> make_backends_study();
[[nodiscard]] std::unique_ptr<Study> make_formulations_study();
[[nodiscard]] std::unique_ptr<Study> make_front_beam_study();
[[nodiscard]] std::unique_ptr<Study> make_growth_study();
[[nodiscard]] std::unique_ptr<Study> make_optimality_study();
[[nodiscard]] std::unique_ptr<Study> make_relaxations_study();

}  // namespace conelane::experiments
