#include "evaluation/outside/outside_detector.hpp"

#include "conelane/invalid_input.hpp"
#include "evaluation/input_error.hpp"
#include "evaluation/outside/detector_card_fields.hpp"
#include "evaluation/outside/solver_program.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <iterator>
#include <sstream>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace conelane {
namespace {

namespace fs = std::filesystem;

using Kind = OutsideDetector::Kind;

constexpr std::string_view kProgram = "exec:";
constexpr std::string_view kSolver = "solver:";
constexpr std::array kKinds{Kind::program, Kind::lanes, Kind::solver};
constexpr std::size_t kMaxName = 64;

/// The name becomes part of a file name.
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

Formulation formulation_of(std::string_view name) {
    for (const Formulation formulation : {Formulation::tight, Formulation::paper}) {
        if (to_string(formulation) == name) return formulation;
    }
    throw InvalidInput("solver", fmt::format("there is no formulation '{}': tight or paper", name));
}

/// NAME=SOURCE, for a solver also NAME/FORMULATION=SOURCE. `prefix` is for error messages.
OutsideDetector parse_named_source(std::string_view text, Kind kind, std::string_view prefix) {
    OutsideDetector detector;
    detector.kind = kind;
    const std::string form = fmt::format("{}NAME={}", prefix, detector.is_lanes_file() ? "FILE" : "COMMAND");
    const std::size_t equals = text.find('=');
    if (equals == std::string_view::npos || equals + 1 == text.size())
        throw InvalidInput("method", fmt::format("'{}' is not of the form {}", text, form));
    detector.name = text.substr(0, equals);
    detector.source = text.substr(equals + 1);
    const std::size_t slash = detector.name.find('/');
    if (detector.is_solver() && slash != std::string::npos) {
        detector.formulation = formulation_of(std::string_view(detector.name).substr(slash + 1));
        detector.name.resize(slash);
    }
    if (!is_name(detector.name)) {
        throw InvalidInput("method",
                           fmt::format("'{}' is not a name for {}: letters, digits and ._+- only, at most {}",
                                       detector.name, form, kMaxName));
    }
    if (detector.is_solver()) SolverProgram::require_valid_command(detector.source);
    return detector;
}

}  // namespace

const char* to_string(OutsideDetector::Kind kind) {
    return kind == Kind::program ? "exec" : kind == Kind::lanes ? "lanes" : "solver";
}

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
    for (const Kind kind : kKinds) {
        const std::string prefix = std::string(to_string(kind)) + ":";
        if (!text.starts_with(prefix)) continue;
        OutsideDetector detector = parse_named_source(text.substr(prefix.size()), kind, prefix);
        if (const auto card = card_path(detector)) detector.card = read_detector_card(*card);
        return detector;
    }
    return std::nullopt;
}

std::optional<OutsideDetector> parse_outside_solver(std::string_view text) {
    if (!text.starts_with(kProgram)) return std::nullopt;
    return parse_named_source(text.substr(kProgram.size()), Kind::solver, kProgram);
}

std::vector<std::string> split_detectors(const std::vector<std::string>& texts) {
    std::vector<std::string> split;
    for (const std::string& text : texts) {
        for (std::size_t begin = 0; begin <= text.size();) {
            const std::string_view rest = std::string_view(text).substr(begin);
            const bool takes_the_rest = rest.starts_with(kProgram) || rest.starts_with(kSolver);
            const std::size_t end =
                takes_the_rest ? text.size() : std::min(text.find(',', begin), text.size());
            split.push_back(text.substr(begin, end - begin));
            begin = end + 1;
        }
    }
    return split;
}

std::optional<fs::path> card_path(const OutsideDetector& detector) {
    // The path of a lanes file may contain blanks; a word of a command is taken without its quotes.
    std::vector<std::string> files{detector.source};
    if (!detector.is_lanes_file()) {
        std::istringstream words(detector.source);
        files.assign(std::istream_iterator<std::string>(words), {});
    }
    for (std::string& file : files) {
        if (!detector.is_lanes_file()) std::erase_if(file, [](char c) { return c == '\'' || c == '"'; });
        if (is_file(file) && is_file(card_beside(file))) return card_beside(file);
    }
    return std::nullopt;
}

DetectorCard read_detector_card(const fs::path& file) {
    DetectorCard card;
    with_json_file(file, [&](const JsonNode& json) { read_value(json, card); });
    return card;
}

}  // namespace conelane
