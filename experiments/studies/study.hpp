#pragma once

#include "experiments/comparison/answer_errors.hpp"

#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

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
    std::string table;                         ///< for a terminal; ends with a line feed
    std::vector<nlohmann::ordered_json> rows;  ///< for a file, an object each
    AnswerErrors errors = {};                  ///< if answers of status error are counted instead of thrown
};

template <typename Rows, typename ToJson>
[[nodiscard]] StudyResult study_result(std::string table, const Rows& rows, const ToJson& to_json) {
    StudyResult result{std::move(table), {}, {}};
    for (const auto& row : rows) result.rows.push_back(to_json(row));
    return result;
}

/// One measured question. Each study is a file of this folder with a line in studies().
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

/// All studies, in the order in which they are listed.
[[nodiscard]] std::vector<std::unique_ptr<Study>> make_studies();

}  // namespace conelane::experiments
