#include "evaluation/formats/json_node.hpp"

#include "evaluation/input_error.hpp"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <numeric>
#include <sstream>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace conelane {
namespace {

using nlohmann::json;

/// Builds the value of a text, and finds its first error. If an object has a key twice, nlohmann's own parser
/// silently keeps the last value; here, reading ends at the second one.
class ValueBuilder : public nlohmann::json_sax<json> {
  public:
    bool null() override { return put(nullptr); }
    bool boolean(bool value) override { return put(value); }
    bool number_integer(number_integer_t value) override { return put(value); }
    bool number_unsigned(number_unsigned_t value) override { return put(value); }
    bool number_float(number_float_t value, const string_t& /*text*/) override { return put(value); }
    bool string(string_t& value) override { return put(std::move(value)); }
    bool binary(binary_t& /*value*/) override { return false; }
    bool start_object(std::size_t /*size*/) override { return open(json::object()); }
    bool key(string_t& name) override {
        const auto [member, is_new] =
            open_.back().value->get_ref<json::object_t&>().emplace(std::move(name), nullptr);
        member_ = &member->second;
        last_key = open_.back().key = &member->first;
        has_duplicate = !is_new;
        return is_new;
    }
    bool end_object() override { return close(); }
    bool start_array(std::size_t /*size*/) override { return open(json::array()); }
    bool end_array() override { return close(); }
    bool parse_error(std::size_t position, const std::string& /*token*/,
                     const json::exception& error) override {
        characters_read = position;
        overflow = dynamic_cast<const json::out_of_range*>(&error) != nullptr;
        return false;
    }

    /// The place of the last key, such as "cones[3].x".
    [[nodiscard]] std::string path() const {
        std::string path;
        for (const Level& level : open_) {
            if (level.value->is_array()) {
                path += fmt::format("[{}]", level.value->size() - 1);
            } else {
                path += (path.empty() ? "" : ".") + *level.key;
            }
        }
        return path;
    }

    json built;
    bool has_duplicate = false;
    const std::string* last_key = nullptr;
    std::size_t characters_read = 0;  ///< with the first that does not fit; beyond the end if none
    bool overflow = false;            ///< a number beyond the range of double

  private:
    struct Level {
        json* value;
        const std::string* key;  ///< the last one of an object
    };
    json& place(json&& part) {
        if (open_.empty()) return built = std::move(part);
        json& around = *open_.back().value;
        if (!around.is_array()) return *member_ = std::move(part);
        around.push_back(std::move(part));
        return around.back();
    }
    bool put(json part) {
        place(std::move(part));
        return true;
    }
    bool open(json part) {
        json& placed = place(std::move(part));
        open_.push_back({&placed, nullptr});
        return true;
    }
    bool close() {
        open_.pop_back();
        return true;
    }

    std::vector<Level> open_;  ///< the arrays and objects around the next value
    json* member_ = nullptr;   ///< the innermost one's member, if that is an object
};

/// Whether the word around `position` is a number that JSON does not have, such as NaN.
bool spells_no_finite_number(std::string_view text, std::size_t position) {
    const auto is_letter = [](char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; };
    std::size_t begin = position;
    while (begin > 0 && is_letter(text[begin - 1])) --begin;
    std::string word;
    for (std::size_t i = begin; i < text.size() && is_letter(text[i]); ++i) {
        word += static_cast<char>(std::tolower(static_cast<unsigned char>(text[i])));
    }
    return word == "nan" || word == "inf" || word == "infinity";
}

/// `first_line`: the number of the text's first line in the file.
[[noreturn]] void fail_on_invalid_json(std::string_view text, const std::filesystem::path& file,
                                       std::size_t first_line, const ValueBuilder& read) {
    const bool at_end = read.characters_read > text.size();
    const std::size_t position = read.characters_read > 0 ? read.characters_read - 1 : 0;
    const std::string_view before = text.substr(0, position);
    const std::size_t line =
        first_line + static_cast<std::size_t>(std::ranges::count(at_end ? text : before, '\n'));
    std::string reason;
    if (read.overflow || spells_no_finite_number(text, position)) {
        reason = "must be a finite number";
    } else if (at_end) {
        reason = "the JSON ends too early";
    } else {
        const std::size_t line_start = before.rfind('\n') + 1;  // npos + 1 is 0
        reason = fmt::format("not valid JSON at column {}", position - line_start + 1);
    }
    throw InputError(file, line, read.last_key == nullptr ? "" : *read.last_key, reason);
}

[[noreturn]] void fail_on_duplicate(std::string_view text, const std::filesystem::path& file,
                                    std::size_t first_line, const ValueBuilder& read) {
    std::istringstream stream{std::string(text)};
    ValueBuilder again;
    json::sax_parse(stream, &again);  // reads the stream up to the second key
    const auto position =
        static_cast<std::size_t>(stream.rdbuf()->pubseekoff(0, std::ios::cur, std::ios::in));
    const auto lines_before = std::ranges::count(text.substr(0, position), '\n');
    throw InputError(file, first_line + static_cast<std::size_t>(lines_before), read.path(),
                     "is there twice");
}

/// Throws InputError if the text is not one JSON value, or if an object in it has a key twice.
json parse(std::string_view text, const std::filesystem::path& file, std::size_t first_line) {
    ValueBuilder builder;
    if (json::sax_parse(text, &builder)) return std::move(builder.built);
    if (builder.has_duplicate) fail_on_duplicate(text, file, first_line, builder);
    fail_on_invalid_json(text, file, first_line, builder);
}

std::ifstream open(const std::filesystem::path& file) {
    std::error_code ignored;
    if (std::filesystem::is_directory(file, ignored)) {
        throw InputError(file, 0, "", "is a folder, not a file");
    }
    errno = 0;
    std::ifstream stream(file, std::ios::binary);
    if (!stream) throw InputError(file, 0, "", "cannot be read: " + std::generic_category().message(errno));
    return stream;
}

void require_read_to_end(const std::ifstream& stream, const std::filesystem::path& file) {
    if (stream.bad()) throw InputError(file, 0, "", "cannot be read to its end");
}

std::string text_of(const std::filesystem::path& file) {
    std::ifstream stream = open(file);
    std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
    require_read_to_end(stream, file);
    return text;
}

constexpr std::size_t kMaxDistance = 2;

/// Levenshtein distance without case: the number of letters to change, insert or leave out.
std::size_t distance(std::string_view a, std::string_view b) {
    const auto lower = [](char c) { return std::tolower(static_cast<unsigned char>(c)); };
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 0; i < a.size(); ++i) {
        std::size_t diagonal = std::exchange(row[0], i + 1);
        for (std::size_t j = 0; j < b.size(); ++j) {
            const std::size_t changed = diagonal + (lower(a[i]) == lower(b[j]) ? 0 : 1);
            diagonal = row[j + 1];
            row[j + 1] = std::min({changed, diagonal + 1, row[j] + 1});
        }
    }
    return row.back();
}

}  // namespace

JsonNode JsonNode::member(std::string_view key) const {
    if (std::optional<JsonNode> found = find(key)) return *std::move(found);
    fail_in(key, "is missing");
}

std::optional<JsonNode> JsonNode::find(std::string_view key) const {
    require_object();
    const auto found = value_->find(key);
    if (found == value_->end()) return std::nullopt;
    return JsonNode(*found, *origin_, member_key(key));
}

std::size_t JsonNode::array_size() const {
    if (!value_->is_array()) fail("must be an array");
    return value_->size();
}

JsonNode JsonNode::element(std::size_t index) const {
    return JsonNode((*value_)[index], *origin_, key_ + "[" + std::to_string(index) + "]");
}

double JsonNode::number() const {
    if (!value_->is_number()) fail("must be a number");
    return value_->get<double>();
}

double JsonNode::number_in(double lowest, double highest) const {
    const double value = number();
    if (value < lowest || value > highest) fail(fmt::format("must be in [{}, {}]", lowest, highest));
    return value;
}

double JsonNode::non_negative_number() const {
    const double value = number();
    if (value < 0.0) fail("must not be negative");
    return value;
}

std::int64_t JsonNode::integer() const {
    const bool too_large =
        value_->is_number_unsigned() &&
        value_->get<std::uint64_t>() > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
    if (!value_->is_number_integer() || too_large) fail("must be an integer of 64 bits");
    return value_->get<std::int64_t>();
}

std::uint64_t JsonNode::unsigned_integer() const {
    if (!value_->is_number_unsigned()) fail("must be a non-negative integer of 64 bits");
    return value_->get<std::uint64_t>();
}

std::int64_t JsonNode::non_negative_integer() const {
    const std::int64_t value = integer();
    if (value < 0) fail("must not be negative");
    return value;
}

bool JsonNode::boolean() const {
    if (!value_->is_boolean()) fail("must be true or false");
    return value_->get<bool>();
}

const std::string& JsonNode::string() const {
    if (!value_->is_string()) fail("must be a string");
    return value_->get_ref<const std::string&>();
}

void JsonNode::require_object() const {
    if (!value_->is_object()) fail("must be a JSON object");
}

std::vector<std::string> JsonNode::keys() const {
    require_object();
    std::vector<std::string> keys;
    for (const auto& item : value_->items()) keys.push_back(item.key());
    return keys;
}

void JsonNode::require_valid(const std::function<void()>& check) const {
    try {
        check();
    } catch (const InvalidInput& error) {
        throw InputError(origin_->file, origin_->line, error.key(), reason_of(error));
    }
}

void JsonNode::fail(const std::string& reason) const {
    throw InputError(origin_->file, origin_->line, key_, reason);
}

void JsonNode::fail_in(std::string_view key, const std::string& reason) const {
    throw InputError(origin_->file, origin_->line, member_key(key), reason);
}

std::string JsonNode::member_key(std::string_view key) const {
    return key_.empty() ? std::string(key) : key_ + "." + std::string(key);
}

std::size_t JsonNode::index_in(std::span<const std::string_view> names) const {
    const auto found =
        value_->is_string() ? std::ranges::find(names, std::string_view(string())) : names.end();
    if (found == names.end()) fail(fmt::format("must be one of {}", fmt::join(names, ", ")));
    return static_cast<std::size_t>(found - names.begin());
}

std::string_view closest_name(std::string_view misspelt, std::span<const std::string_view> names) {
    std::string_view closest;
    // A short name has no similar one: every other short name is two letters away.
    std::size_t least = std::min(kMaxDistance, misspelt.size() / 2) + 1;
    for (const std::string_view name : names) {
        if (misspelt.size() > name.size() + kMaxDistance) continue;
        const std::size_t letters = distance(misspelt, name);
        if (letters >= least) continue;
        least = letters;
        closest = name;
    }
    return closest;
}

void require_known_keys(const JsonNode& object, std::span<const std::string_view> keys) {
    for (const std::string& key : object.keys()) {
        if (std::ranges::find(keys, key) != keys.end()) continue;
        const std::string_view meant = closest_name(key, keys);
        object.member(key).fail(meant.empty()
                                    ? fmt::format("is not a key here, only {}", fmt::join(keys, ", "))
                                    : fmt::format("is not a key here; {} is", meant));
    }
}

void for_each_json_line(const std::filesystem::path& file, const std::function<void(const JsonNode&)>& read) {
    std::ifstream stream = open(file);
    std::size_t number = 0;
    for (std::string line; std::getline(stream, line);) {
        ++number;
        if (!is_blank(line)) with_json_line(line, file, number, read);
    }
    require_read_to_end(stream, file);
}

void with_json_line(std::string_view text, const std::filesystem::path& file, std::size_t line,
                    const std::function<void(const JsonNode&)>& read) {
    const json value = parse(text, file, line);
    const JsonOrigin origin{file, line};
    const JsonNode node(value, origin);
    node.require_object();
    read(node);
}

bool is_blank(std::string_view line) {
    return line.find_first_not_of(" \t\r") == std::string_view::npos;
}

void with_json_file(const std::filesystem::path& file, const std::function<void(const JsonNode&)>& read) {
    with_json_text(text_of(file), file, read);
}

void with_json_text(std::string_view text, const std::filesystem::path& file,
                    const std::function<void(const JsonNode&)>& read) {
    const json value = parse(text, file, 1);
    const JsonOrigin origin{file, 0};
    const JsonNode node(value, origin);
    node.require_object();
    read(node);
}

void with_json_list_file(const std::filesystem::path& file,
                         const std::function<void(const JsonNode&)>& read) {
    const json value = parse(text_of(file), file, 1);
    const JsonOrigin origin{file, 0};
    const JsonNode node(value, origin);
    (void)node.array_size();
    read(node);
}

std::string to_line(const nlohmann::ordered_json& json) {
    return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

std::string reason_of(const InvalidInput& error) {
    return std::string(error.what()).substr(error.key().size() + 2);
}

double require_finite(double value, const std::string& key) {
    if (!std::isfinite(value)) throw InvalidInput(key, "must be a finite number");
    return value;
}

void put_bound(nlohmann::ordered_json& json, double bound, const std::string& key) {
    if (bound != -std::numeric_limits<double>::infinity()) json["bound"] = require_finite(bound, key);
}

}  // namespace conelane
