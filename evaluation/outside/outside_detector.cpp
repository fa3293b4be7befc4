#include "evaluation/outside/outside_detector.hpp"

#include "conelane/invalid_input.hpp"
#include "evaluation/files/input_error.hpp"
#include "evaluation/files/json_node.hpp"

#include <algorithm>
#include <cctype>
#include <iterator>
#include <sstream>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace conelane {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr std::string_view kProgram = "exec:";
constexpr std::string_view kLanes = "lanes:";
constexpr std::size_t kMaxName = 64;

/// It becomes part of a file name.
bool is_name(std::string_view name) {
    return !name.empty() && name.size() <= kMaxName && name.front() != '.' &&
           std::ranges::all_of(name, [](char c) {
               return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
                      std::string_view("._+-").find(c) != std::string_view::npos;
           });
}

bool is_file(const fs::path& file) {
    std::error_code ignored;
    return fs::is_regular_file(file, ignored);
}

/// X.method.json beside X.lanes.jsonl or X.ANYTHING.
fs::path card_beside(const fs::path& file) {
    constexpr std::string_view kLanesEnding = ".lanes.jsonl";
    std::string name = file.filename().string();
    name = name.ends_with(kLanesEnding) ? name.substr(0, name.size() - kLanesEnding.size())
                                        : file.stem().string();
    return file.parent_path() / (name + ".method.json");
}

std::optional<std::string> find_string(const JsonNode& json, std::string_view key) {
    const auto found = json.find(key);
    if (!found) return std::nullopt;
    return found->string();
}

std::optional<bool> find_boolean(const JsonNode& json, std::string_view key) {
    const auto found = json.find(key);
    if (!found) return std::nullopt;
    return found->boolean();
}

DetectorCard read_card(const JsonNode& json) {
    DetectorCard card;
    card.name = find_string(json, "name");
    card.address = find_string(json, "address");
    card.licence = find_string(json, "licence");
    card.color_used = find_boolean(json, "colour_used");
    card.history_used = find_boolean(json, "history_used");
    if (const auto courses = json.find("training_courses")) {
        card.training_courses.emplace();
        const std::size_t size = courses->array_size();
        for (std::size_t i = 0; i < size; ++i) card.training_courses->push_back(courses->element(i).string());
    }
    return card;
}

ordered_json to_json(const DetectorCard& card) {
    ordered_json json = ordered_json::object();
    const auto put_if_said = [&](const char* key, const auto& value) {
        if (value) json[key] = *value;
    };
    put_if_said("name", card.name);
    put_if_said("address", card.address);
    put_if_said("licence", card.licence);
    put_if_said("colour_used", card.color_used);
    put_if_said("history_used", card.history_used);
    put_if_said("training_courses", card.training_courses);
    return json;
}

}  // namespace

std::string DetectorCard::summary() const {
    std::vector<std::string> parts;
    if (name) parts.push_back(*name);
    if (licence) parts.push_back("licence " + *licence);
    if (color_used) parts.emplace_back(*color_used ? "uses colour" : "no colour");
    if (history_used) parts.emplace_back(*history_used ? "uses history" : "no history");
    if (training_courses) {
        parts.push_back(training_courses->empty()
                            ? "no training courses"
                            : fmt::format("trained on {}", fmt::join(*training_courses, ", ")));
    }
    if (address) parts.push_back(*address);
    return fmt::format("{}", fmt::join(parts, "; "));
}

std::optional<OutsideDetector> parse_outside_detector(std::string_view text) {
    OutsideDetector detector;
    if (text.starts_with(kProgram)) {
        text.remove_prefix(kProgram.size());
    } else if (text.starts_with(kLanes)) {
        text.remove_prefix(kLanes.size());
        detector.kind = OutsideDetector::Kind::lanes;
    } else {
        return std::nullopt;
    }
    const std::size_t equals = text.find('=');
    const std::string form = detector.is_program() ? "exec:NAME=COMMAND" : "lanes:NAME=FILE";
    if (equals == std::string_view::npos || equals + 1 == text.size())
        throw InvalidInput("method", fmt::format("'{}' is not of the form {}", text, form));
    detector.name = text.substr(0, equals);
    detector.source = text.substr(equals + 1);
    if (!is_name(detector.name)) {
        throw InvalidInput("method",
                           fmt::format("'{}' is not a name for {}: letters, digits and ._+- only, at most {}",
                                       detector.name, form, kMaxName));
    }
    if (const auto card = card_path(detector)) detector.card = read_detector_card(*card);
    return detector;
}

std::vector<std::string> split_detectors(const std::vector<std::string>& texts) {
    std::vector<std::string> split;
    for (const std::string& text : texts) {
        for (std::size_t begin = 0; begin <= text.size();) {
            const bool takes_the_rest = std::string_view(text).substr(begin).starts_with(kProgram);
            const std::size_t end =
                takes_the_rest ? text.size() : std::min(text.find(',', begin), text.size());
            split.push_back(text.substr(begin, end - begin));
            begin = end + 1;
        }
    }
    return split;
}

std::optional<fs::path> card_path(const OutsideDetector& detector) {
    // A lanes file may lie in a path with blanks; a word of a command is taken without its quotes.
    std::vector<std::string> files{detector.source};
    if (detector.is_program()) {
        std::istringstream words(detector.source);
        files.assign(std::istream_iterator<std::string>(words), {});
    }
    for (std::string& file : files) {
        if (detector.is_program()) std::erase_if(file, [](char c) { return c == '\'' || c == '"'; });
        if (is_file(file) && is_file(card_beside(file))) return card_beside(file);
    }
    return std::nullopt;
}

DetectorCard read_detector_card(const fs::path& file) {
    DetectorCard card;
    with_json_file(file, [&](const JsonNode& json) { card = read_card(json); });
    return card;
}

std::string outside_detector_json(const OutsideDetector& detector) {
    ordered_json json{{"name", detector.name}, {detector.is_program() ? "exec" : "lanes", detector.source}};
    if (detector.card) json["card"] = to_json(*detector.card);
    return to_line(json);
}

std::vector<OutsideDetector> outside_detectors_of_record(const std::string& run_record) {
    std::vector<OutsideDetector> found;
    with_json_text(run_record, "run.json", [&](const JsonNode& json) {
        const auto all = json.find("methods");
        const std::size_t size = all ? all->array_size() : 0;
        for (std::size_t i = 0; i < size; ++i) {
            const JsonNode detector = all->element(i);
            const auto command = detector.find("exec");
            const auto file = detector.find("lanes");
            if (!command && !file) continue;
            OutsideDetector outside{command ? OutsideDetector::Kind::program : OutsideDetector::Kind::lanes,
                                    detector.member("name").string(),
                                    (command ? command : file)->string(),
                                    {}};
            if (const auto card = detector.find("card")) outside.card = read_card(*card);
            // A sweep has the same detector once for each size.
            if (std::ranges::find(found, outside.name, &OutsideDetector::name) == found.end())
                found.push_back(std::move(outside));
        }
    });
    return found;
}

}  // namespace conelane
