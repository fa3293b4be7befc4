#include "evaluation/formats/cone_table.hpp"

#include "evaluation/formats/file_text.hpp"
#include "evaluation/input_error.hpp"
#include "evaluation/world/track_checks.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <set>
#include <sstream>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace conelane {
namespace {

enum Column : std::size_t { tag, x, y, direction };
constexpr std::array<const char*, 4> kColumns{"tag", "x", "y", "direction"};

/// Names of each column in headers, their letters only; the first one counts.
constexpr std::array<std::string_view, kColumns.size()> kColumnNames{
    "tag color colour conetype conecolor conecolour type class label side", "x xm posx xpos positionx",
    "y ym posy ypos positiony", "direction yaw yawrad heading"};

constexpr std::pair<std::string_view, ConeColor> kColorNames[] = {
    {"blue", ConeColor::blue},     {"b", ConeColor::blue},   {"left", ConeColor::blue},
    {"yellow", ConeColor::yellow}, {"y", ConeColor::yellow}, {"right", ConeColor::yellow},
    {"orange", ConeColor::orange}, {"o", ConeColor::orange}, {"unknown", ConeColor::unknown}};

std::string letters_of(std::string_view text) {
    std::string letters;
    for (const char c : text) {
        if (c >= 'A' && c <= 'Z') letters += static_cast<char>(c - 'A' + 'a');
        if (c >= 'a' && c <= 'z') letters += c;
    }
    return letters;
}

std::string_view trimmed(std::string_view text) {
    constexpr std::string_view kNoContent = " \t\r\"'";
    const std::size_t first = text.find_first_not_of(kNoContent);
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(kNoContent) - first + 1);
}

using Fields = std::vector<std::string_view>;

Fields fields_of(std::string_view line, char separator) {
    Fields fields;
    bool quoted = false;
    std::size_t begin = 0;
    for (std::size_t i = 0; i <= line.size(); ++i) {
        if (i < line.size() && line[i] == '"') quoted = !quoted;
        if (i < line.size() && (line[i] != separator || quoted)) continue;
        fields.push_back(trimmed(line.substr(begin, i - begin)));
        begin = i + 1;
    }
    if (separator == ' ') std::erase(fields, std::string_view());
    return fields;
}

/// Between other separators than commas, a comma is a decimal one.
std::optional<double> number_of(std::string_view field, char separator) {
    std::string text(field);
    if (separator != ',') std::ranges::replace(text, ',', '.');
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
    return value;
}

/// Where the columns are.
struct Layout {
    char separator = ',';
    bool has_header = true;
    std::array<std::optional<std::size_t>, kColumns.size()> places{};

    [[nodiscard]] bool is_whole() const { return places[tag] && places[x] && places[y]; }
};

Layout named_columns(std::string_view header, char separator) {
    Layout layout{separator};
    std::vector<std::string> names;
    for (const std::string_view field : fields_of(header, separator)) names.push_back(letters_of(field));
    for (std::size_t column = 0; column < kColumns.size(); ++column) {
        std::istringstream known{std::string(kColumnNames[column])};
        for (std::string name; !layout.places[column] && known >> name;) {
            const auto found = std::ranges::find(names, name);
            if (found != names.end()) layout.places[column] = static_cast<std::size_t>(found - names.begin());
        }
    }
    return layout;
}

/// The columns of a line without header, by its numbers.
Layout columns_of_row(std::string_view row, char separator) {
    Layout layout{separator, false};
    const Fields fields = fields_of(row, separator);
    const auto is_number = [&](std::size_t place) {
        return place < fields.size() && number_of(fields[place], separator);
    };
    if (is_number(1) && !is_number(0) && is_number(2)) layout.places = {0, 1, 2, {}};
    if (layout.is_whole() && is_number(3)) layout.places[direction] = 3;
    if (is_number(0) && is_number(1) && fields.size() > 2 && !is_number(2)) layout.places = {2, 0, 1, {}};
    return layout;
}

constexpr std::string_view kSeparators = ",;\t ";

/// The layout that the first line gives.
Layout layout_of(const std::filesystem::path& file, std::size_t line, std::string_view row) {
    for (const char separator : kSeparators) {
        if (const Layout layout = named_columns(row, separator); layout.is_whole()) return layout;
        if (const Layout layout = columns_of_row(row, separator); layout.is_whole()) return layout;
    }
    const Layout layout = named_columns(row, ',');
    for (std::size_t column = tag; column <= y; ++column) {
        const bool others = layout.places[tag] || layout.places[x] || layout.places[y];
        if (others && !layout.places[column])
            throw InputError(file, line, kColumns[column], "column missing");
    }
    throw InputError(
        file, line, "tag",
        "column missing: the line is neither a header that names tag, x and y nor a cone such as "
        "blue,1.0,2.0");
}

std::string guess_of(const Layout& layout, std::string_view first_line) {
    const Fields names = fields_of(first_line, layout.separator);
    std::vector<std::string> guesses;
    if (!layout.has_header) guesses.emplace_back("no header");
    for (std::size_t column = 0; column < kColumns.size(); ++column) {
        const auto place = layout.places[column];
        if (!place || (layout.has_header && names[*place] == kColumns[column])) continue;
        guesses.push_back(layout.has_header
                              ? fmt::format("'{}' is taken for {}", names[*place], kColumns[column])
                              : fmt::format("column {} is taken for {}", *place + 1, kColumns[column]));
    }
    if (layout.separator != ',') {
        guesses.push_back(fmt::format("columns end at {}", layout.separator == ';'    ? "semicolons"
                                                           : layout.separator == '\t' ? "tabs"
                                                                                      : "blanks"));
    }
    return fmt::format("{}", fmt::join(guesses, ", "));
}

/// Reads the lines behind the header.
class RowReader {
  public:
    RowReader(std::filesystem::path file, const Layout& layout) : file_(std::move(file)), layout_(layout) {}

    void read(std::size_t line, std::string_view row, ConeTable& table) {
        const Fields fields = fields_of(row, layout_.separator);
        const std::string_view name = field(fields, tag, line);
        const Point position{number(fields, x, line), number(fields, y, line)};
        if (letters_of(name) == "carstart") {
            if (table.car_start) throw InputError(file_, line, "car_start", "is there twice");
            table.car_start = Pose{position, number(fields, direction, line)};
            table.car_start_line = line;
            return;
        }
        const std::optional<ConeColor> color = color_named(name);
        if (!color) {
            ++table.other_tags[std::string(name)];
        } else if (name != to_string(*color) && name != "big_orange" && guessed_.emplace(name).second) {
            table.guess += fmt::format("{}'{}' is taken for {}", table.guess.empty() ? "" : ", ", name,
                                       to_string(*color));
        }
        table.cones.push_back(
            {static_cast<ConeId>(table.cones.size()), position, color.value_or(ConeColor::unknown)});
        table.lines.push_back(line);
    }

  private:
    [[nodiscard]] std::string_view field(const Fields& fields, Column column, std::size_t line) const {
        const std::optional<std::size_t> place = layout_.places[column];
        if (!place) throw InputError(file_, line, kColumns[column], "column missing");
        if (*place >= fields.size() || fields[*place].empty()) {
            throw InputError(file_, line, kColumns[column], "missing");
        }
        return fields[*place];
    }

    [[nodiscard]] double number(const Fields& fields, Column column, std::size_t line) const {
        const std::string_view text = field(fields, column, line);
        const std::optional<double> value = number_of(text, layout_.separator);
        const std::string fault =
            value ? coordinate_fault(*value) : fmt::format("'{}' is not a number", text);
        if (!fault.empty()) throw InputError(file_, line, kColumns[column], fault);
        return *value;
    }

    std::filesystem::path file_;
    Layout layout_;
    std::set<std::string, std::less<>> guessed_;  ///< tags
};

}  // namespace

std::optional<ConeColor> color_named(std::string_view tag) {
    std::string name = letters_of(tag);
    for (const std::string_view part : {"cones", "cone", "big", "small", "large"}) {
        const std::size_t at = name.find(part);
        if (at != std::string::npos) name.erase(at, part.size());
    }
    for (const auto& [known, color] : kColorNames) {
        if (name == known) return color;
    }
    return std::nullopt;
}

ConeTable read_cone_table(const std::filesystem::path& file) {
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    ConeTable table;
    std::optional<RowReader> rows;
    std::istringstream content(text_of(file));
    std::string text;
    for (std::size_t line = 1; std::getline(content, text); ++line) {
        std::string_view row = text;
        if (line == 1 && row.starts_with(kByteOrderMark)) row.remove_prefix(kByteOrderMark.size());
        row = row.substr(std::min(row.size(), row.find_first_not_of(" \t\r")));
        const bool may_name_columns = !rows && named_columns(row, ',').is_whole();
        if (row.empty() || (row.starts_with('#') && !may_name_columns)) continue;
        if (!rows) {
            const Layout layout = layout_of(file, line, row);
            rows.emplace(file, layout);
            table.guess = guess_of(layout, row);
            if (layout.has_header) continue;
        }
        rows->read(line, row, table);
    }
    if (!rows) throw InputError(file, 0, "tag", "column missing");
    return table;
}

}  // namespace conelane
