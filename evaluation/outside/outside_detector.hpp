#pragma once

#include "conelane/formulation.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace conelane {

/// The description of a method by its author, in a file `*.method.json`. Missing keys are absent.
struct DetectorCard {
    std::optional<std::string> name;
    std::optional<std::string> address;
    std::optional<std::string> licence;
    std::optional<bool> color_used;
    std::optional<bool> history_used;  ///< from scene to scene of a lap
    std::optional<std::vector<std::string>> training_courses;

    /// One line below a table: "ft-fsd-path-planning; MIT; no color; ...".
    [[nodiscard]] std::string summary() const;
};

/// A detector that is not part of this program.
struct OutsideDetector {
    enum class Kind {
        program,  ///< exec:NAME=COMMAND, asked scene by scene
        lanes,    ///< lanes:NAME=FILE, answers of a run elsewhere
        solver,   ///< solver:NAME=COMMAND, RLD by a program that solves MPS or LP files
    };
    Kind kind = Kind::program;
    std::string name;    ///< as tables show it
    std::string source;  ///< the command, or the file
    std::optional<DetectorCard> card;
    /// For a solver, if the text names one.
    std::optional<Formulation> formulation = {};

    [[nodiscard]] bool is_program() const { return kind == Kind::program; }
    [[nodiscard]] bool is_lanes_file() const { return kind == Kind::lanes; }
    [[nodiscard]] bool is_solver() const { return kind == Kind::solver; }
};

/// As texts and records say it: "exec", "lanes" or "solver".
[[nodiscard]] const char* to_string(OutsideDetector::Kind kind);

/// The method that `exec:NAME=COMMAND`, `lanes:NAME=FILE`, `solver:NAME=COMMAND` or
/// `solver:NAME/FORMULATION=COMMAND` names, with its card; nothing for other texts. Throws InvalidInput if
/// the name is missing or has characters that a file name may not have, or if there is no such formulation;
/// InputError if the card is wrong.
[[nodiscard]] std::optional<OutsideDetector> parse_outside_detector(std::string_view text);

/// For lists of solvers only: the solver of `exec:NAME=COMMAND` or `exec:NAME/FORMULATION=COMMAND`; nothing
/// for other texts. Throws like parse_outside_detector.
[[nodiscard]] std::optional<OutsideDetector> parse_outside_solver(std::string_view text);

/// Methods as a user lists them: separated by commas, but `exec:` and `solver:` take the rest of their text,
/// so a command may contain commas.
[[nodiscard]] std::vector<std::string> split_detectors(const std::vector<std::string>& texts);

/// The card of a method: X.method.json beside the lanes file X.lanes.jsonl, or beside the first file
/// X.ANYTHING in the command that has one. Nothing if there is none.
[[nodiscard]] std::optional<std::filesystem::path> card_path(const OutsideDetector& detector);

/// Throws InputError naming file and key.
[[nodiscard]] DetectorCard read_detector_card(const std::filesystem::path& file);

}  // namespace conelane
