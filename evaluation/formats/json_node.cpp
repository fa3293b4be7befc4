#include "evaluation/formats/json_node.hpp"

#include "evaluation/input_error.hpp"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <set>
#include <sstream>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace conelane {
namespace {

using nlohmann::json;

/// Builds the value of a text. If an object has a key twice, nlohmann's own parser silently keeps the last
/// value; here, reading ends at the second one.
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
            open_.back()->get_ref<json::object_t&>().emplace(std::move(name), nullptr);
        member_ = &member->second;
        has_duplicate = !is_new;
        return is_new;
    }
    bool end_object() override { return close(); }
    bool start_array(std::size_t /*size*/) override { return open(json::array()); }
    bool end_array() override { return close(); }
    bool parse_error(std::size_t /*position*/, const std::string& /*token*/,
                     const json::exception& /*error*/) override {
        return false;
    }

    json built;
    bool has_duplicate = false;

  private:
    json& place(json&& part) {
        if (open_.empty()) return built = std::move(part);
        if (!open_.back()->is_array()) return *member_ = std::move(part);
        open_.back()->push_back(std::move(part));
        return open_.back()->back();
    }
    bool put(json part) {
        place(std::move(part));
        return true;
    }
    bool open(json part) {
        open_.push_back(&place(std::move(part)));
        return true;
    }
    bool close() {
        open_.pop_back();
        return true;
    }

    std::vector<json*> open_;  ///< the arrays and objects around the next value
    json* member_ = nullptr;   ///< the innermost one's member, if that is an object
};

/// Reads JSON up to the first key that its object already has.
class DuplicateFinder : public nlohmann::json_sax<json> {
  public:
    explicit DuplicateFinder(std::string_view text) : stream_(std::string(text)) {
        json::sax_parse(stream_, this);
    }
    bool null() override { return next(); }
    bool boolean(bool /*value*/) override { return next(); }
    bool number_integer(number_integer_t /*value*/) override { return next(); }
    bool number_unsigned(number_unsigned_t /*value*/) override { return next(); }
    bool number_float(number_float_t /*value*/, const string_t& /*text*/) override { return next(); }
    bool string(string_t& /*value*/) override { return next(); }
    bool binary(binary_t& /*value*/) override { return next(); }
    bool start_object(std::size_t /*size*/) override {
        open_.push_back({});
        return true;
    }
    bool key(string_t& name) override {
        open_.back().key = name;
        if (open_.back().keys.insert(name).second) return true;
        // The stream was read up to this key.
        position_ = static_cast<std::size_t>(stream_.rdbuf()->pubseekoff(0, std::ios::cur, std::ios::in));
        return false;
    }
    bool end_object() override { return close(); }
    bool start_array(std::size_t /*size*/) override {
        open_.push_back({.is_array = true});
        return true;
    }
    bool end_array() override { return close(); }
    bool parse_error(std::size_t /*position*/, const std::string& /*token*/,
                     const json::exception& /*error*/) override {
        return false;
    }

    [[nodiscard]] std::size_t position() const { return position_; }
    /// Such as "cones[3].x".
    [[nodiscard]] std::string path() const {
        std::string path;
        for (const Level& level : open_) {
            if (level.is_array) {
                path += fmt::format("[{}]", level.index);
            } else {
                path += (path.empty() ? "" : ".") + level.key;
            }
        }
        return path;
    }

  private:
    struct Level {
        bool is_array = false;
        std::size_t index = 0;
        std::string key = {};
        std::set<std::string> keys = {};
    };
    bool next() {
        if (!open_.empty()) ++open_.back().index;
        return true;
    }
    bool close() {
        open_.pop_back();
        return next();
    }

    std::istringstream stream_;
    std::vector<Level> open_;
    std::size_t position_ = 0;
};

/// Reads JSON only to find its first error.
class ErrorFinder : public nlohmann::json_sax<json> {
  public:
    bool null() override { return true; }
    bool boolean(bool /*value*/) override { return true; }
    bool number_integer(number_integer_t /*value*/) override { return true; }
    bool number_unsigned(number_unsigned_t /*value*/) override { return true; }
    bool number_float(number_float_t /*value*/, const string_t& /*text*/) override { return true; }
    bool string(string_t& /*value*/) override { return true; }
    bool binary(binary_t& /*value*/) override { return true; }
    bool start_object(std::size_t /*size*/) override { return true; }
    bool key(string_t& value) override {
        last_key = value;
        return true;
    }
    bool end_object() override { return true; }
    bool start_array(std::size_t /*size*/) override { return true; }
    bool end_array() override { return true; }
    bool parse_error(std::size_t position, const std::string& /*token*/,
                     const json::exception& error) override {
        characters_read = position;
        overflow = dynamic_cast<const json::out_of_range*>(&error) != nullptr;
        return false;
    }

    std::string last_key;
    std::size_t characters_read = 0;  ///< with the first that does not fit; beyond the end if none
    bool overflow = false;            ///< a number beyond the range of double
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
                                       std::size_t first_line) {
    ErrorFinder finder;
    json::sax_parse(text, &finder);
    const bool at_end = finder.characters_read > text.size();
    const std::size_t position = finder.characters_read > 0 ? finder.characters_read - 1 : 0;
    const std::string_view before = text.substr(0, position);
    const std::size_t line =
        first_line + static_cast<std::size_t>(std::ranges::count(at_end ? text : before, '\n'));
    std::string reason;
    if (finder.overflow || spells_no_finite_number(text, position)) {
        reason = "must be a finite number";
    } else if (at_end) {
        reason = "the JSON ends too early";
    } else {
        const std::size_t line_start = before.rfind('\n') + 1;  // npos + 1 is 0
        reason = fmt::format("not valid JSON at column {}", position - line_start + 1);
    }
    throw InputError(file, line, finder.last_key, reason);
}

[[noreturn]] void fail_on_duplicate(std::string_view text, const std::filesystem::path& file,
                                    std::size_t first_line) {
    const DuplicateFinder finder(text);
    const auto lines_before = std::ranges::count(text.substr(0, finder.position()), '\n');
    throw InputError(file, first_line + static_cast<std::size_t>(lines_before), finder.path(),
                     "is there twice");
}

/// Throws InputError if the text is not one JSON value, or if an object in it has a key twice.
json parse(std::string_view text, const std::filesystem::path& file, std::size_t first_line) {
    ValueBuilder builder;
    if (json::sax_parse(text, &builder)) return std::move(builder.built);
    if (builder.has_duplicate) fail_on_duplicate(text, file, first_line);
    fail_on_invalid_json(text, file, first_line);
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

}  // namespace

JsonNode JsonNode::member(std::string_view key) const {
    if (std::optional<JsonNode> found = find(key)) return *std::move(found);
    throw InputError(origin_->file, origin_->line, member_key(key), "is missing");
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

std::string JsonNode::member_key(std::string_view key) const {
    return key_.empty() ? std::string(key) : key_ + "." + std::string(key);
}

std::size_t JsonNode::index_in(std::span<const std::string_view> names) const {
    const auto found =
        value_->is_string() ? std::ranges::find(names, std::string_view(string())) : names.end();
    if (found == names.end()) fail(fmt::format("must be one of {}", fmt::join(names, ", ")));
    return static_cast<std::size_t>(found - names.begin());
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

void with_json_list_file(const std::filesystem::path& file,
                         const std::function<void(const JsonNode&)>& read) {
    const json value = parse(text_of(file), file, 1);
    const JsonOrigin origin{file, 0};
    const JsonNode node(value, origin);
    (void)node.array_size();
    read(node);
}

void with_json_text(std::string_view text, const std::filesystem::path& file,
                    const std::function<void(const JsonNode&)>& read) {
    const json value = parse(text, file, 1);
    const JsonOrigin origin{file, 0};
    const JsonNode node(value, origin);
    node.require_object();
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
