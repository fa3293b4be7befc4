#pragma once

#include "evaluation/formats/scene_set.hpp"
#include "evaluation/scoring/statistics.hpp"
#include "evaluation/scoring/text_table.hpp"
#include "experiments/comparison/answer_errors.hpp"

#include <iterator>
#include <ranges>

/// Rows of figures, described once by their fields: for a file, for a table, and with statistics of groups of
/// rows.
namespace CLI {
class App;
}

namespace conelane::experiments {

using Json = nlohmann::ordered_json;

/// Nothing: it is unknown, without a key in a file and "-" in a table.
using FieldValue = std::optional<Json>;

template <typename Value>
[[nodiscard]] FieldValue field_value(const Value& value) {
    if constexpr (requires { value.has_value(); }) {
        return value ? field_value(*value) : std::nullopt;
    } else if constexpr (std::is_enum_v<Value>) {
        return Json(to_string(value));
    } else {
        return Json(value);
    }
}

/// How tables show a field.
struct Shown {
    enum class As { nothing, text, number, fixed, percent };
    As as = As::nothing;
    std::string title = {};
    int decimals = 0;

    [[nodiscard]] std::string cell(const FieldValue& value) const;
    static Shown text(std::string title) { return {As::text, std::move(title)}; }
    /// A count, or a number with the digits that it needs.
    static Shown number(std::string title) { return {As::number, std::move(title)}; }
    static Shown fixed(std::string title, int decimals) { return {As::fixed, std::move(title), decimals}; }
    static Shown percent(std::string title, int decimals) {
        return {As::percent, std::move(title), decimals};
    }
};

template <typename Row>
struct RowField {
    /// `get`: a member of the row, or a function of it.
    template <typename Get>
    RowField(std::string file_key, const Get& get, Shown in_tables = {})
        : key(std::move(file_key)),
          value([get](const Row& row) { return field_value(std::invoke(get, row)); }),
          shown(std::move(in_tables)) {}

    std::string key;  ///< in files; empty: in tables alone
    std::function<FieldValue(const Row&)> value;
    Shown shown;
};
template <typename Row>
using RowFields = std::vector<RowField<Row>>;

template <typename Row>
[[nodiscard]] Json row_json(const Row& row, const RowFields<Row>& fields) {
    Json json = Json::object();
    for (const RowField<Row>& field : fields) {
        if (field.key.empty()) continue;
        if (FieldValue value = field.value(row)) json[field.key] = *std::move(value);
    }
    return json;
}

template <typename Rows, typename Row>
[[nodiscard]] std::string row_table(const Rows& rows, const RowFields<Row>& fields) {
    std::vector<RowField<Row>> columns;
    std::ranges::copy_if(fields, std::back_inserter(columns),
                         [](const RowField<Row>& field) { return field.shown.as != Shown::As::nothing; });
    std::vector<TextTable::Column> titles;
    for (const RowField<Row>& column : columns)
        titles.push_back({column.shown.title, column.shown.as == Shown::As::text});
    TextTable table(std::move(titles));
    for (const Row& row : rows) {
        std::vector<std::string> cells;
        for (const RowField<Row>& column : columns) cells.push_back(column.shown.cell(column.value(row)));
        table.add(std::move(cells));
    }
    return table.text();
}

/// Rows that have a key in common.
template <typename Row>
struct RowGroup {
    std::vector<const Row*> rows;  ///< at least one

    [[nodiscard]] std::size_t size() const { return rows.size(); }
    [[nodiscard]] const Row& first() const { return *rows.front(); }
    [[nodiscard]] auto each() const {
        return rows | std::views::transform([](const Row* row) -> const Row& { return *row; });
    }

    template <typename Is>
    [[nodiscard]] std::size_t count(const Is& is) const {
        return static_cast<std::size_t>(
            std::ranges::count_if(rows, [&](const Row* row) { return bool(std::invoke(is, *row)); }));
    }
    /// Values that may be absent, or true and false as 1 and 0.
    template <typename Get>
    [[nodiscard]] Sample sample(const Get& get) const {
        Sample sample;
        for (const Row* row : rows) {
            const auto value = std::invoke(get, *row);
            if constexpr (requires { value.has_value(); }) {
                sample.add(value);
            } else {
                sample.add(static_cast<double>(value));
            }
        }
        return sample;
    }
};

/// The groups by key in the order in which they first appear; rows without a key are in none.
template <typename Row, typename Rows, typename KeyOf>
[[nodiscard]] std::vector<RowGroup<Row>> groups_of(const Rows& rows, const KeyOf& key_of) {
    std::vector<std::decay_t<decltype(key_of(*rows.begin()))>> keys;
    std::vector<RowGroup<Row>> groups;
    for (const Row& row : rows) {
        auto key = key_of(row);
        if constexpr (requires { key.has_value(); }) {
            if (!key) continue;
        }
        const auto place = static_cast<std::size_t>(std::ranges::find(keys, key) - keys.begin());
        if (place == keys.size()) {
            keys.push_back(std::move(key));
            groups.emplace_back();
        }
        groups[place].rows.push_back(&row);
    }
    return groups;
}

/// Statistics of groups, as fields use them.
template <typename Get>
[[nodiscard]] auto first_of(const Get& get) {
    return [get](const auto& group) { return std::invoke(get, group.first()); };
}
template <typename Is>
[[nodiscard]] auto count_of(const Is& is) {
    return [is](const auto& group) { return group.count(is); };
}
template <typename Is>
[[nodiscard]] auto share_of(const Is& is) {
    return [is](const auto& group) { return share(group.count(is), group.size()); };
}
template <typename Get>
[[nodiscard]] auto mean_of(const Get& get) {
    return [get](const auto& group) { return group.sample(get).mean(); };
}
template <typename Get>
[[nodiscard]] auto median_of(const Get& get) {
    return [get](const auto& group) { return group.sample(get).median(); };
}
template <typename Get>
[[nodiscard]] auto quantile_of(const Get& get, double share) {
    return [get, share](const auto& group) { return group.sample(get).quantile(share); };
}

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
