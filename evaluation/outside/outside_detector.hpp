#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace conelane {

/// What the author of a detector says of it in a file `*.method.json`. What is not said is absent.
struct DetectorCard {
    std::optional<std::string> name;
    std::optional<std::string> address;
    std::optional<std::string> licence;
    std::optional<bool> color_used;
    std::optional<bool> history_used;  ///< from scene to scene of a lap
    std::optional<std::vector<std::string>> training_courses;

    /// One line for a table's foot: "ft-fsd-path-planning; MIT; no color; ...".
    [[nodiscard]] std::string summary() const;
};

/// A detector that is not part of this program.
struct OutsideDetector {
    enum class Kind {
        program,  ///< exec:NAME=COMMAND, asked scene by scene
        lanes,    ///< lanes:NAME=FILE, answers of a run elsewhere
    };
    Kind kind = Kind::program;
    std::string name;    ///< as tables show it
    std::string source;  ///< the command, or the file
    std::optional<DetectorCard> card;

    [[nodiscard]] bool is_program() const { return kind == Kind::program; }
};

/// What `exec:NAME=COMMAND` or `lanes:NAME=FILE` names, with its card; nothing where the text is neither.
/// Throws InvalidInput where the name is missing or has other letters than a file name may have; InputError
/// where the card is wrong.
[[nodiscard]] std::optional<OutsideDetector> parse_outside_detector(std::string_view text);

/// Detectors as a user lists them: split at commas, but `exec:` takes the rest of its text, so that a command
/// may hold commas.
[[nodiscard]] std::vector<std::string> split_detectors(const std::vector<std::string>& texts);

/// The card of a detector: X.method.json beside the lanes file X.lanes.jsonl, or beside a file X.ANYTHING
/// that a word of the command names, the first where there is one. Nothing where there is none.
[[nodiscard]] std::optional<std::filesystem::path> card_path(const OutsideDetector& detector);

/// Throws InputError naming file and key.
[[nodiscard]] DetectorCard read_detector_card(const std::filesystem::path& file);

/// For the record of a run: one detector, or the array of detectors that a record holds under "methods", of
/// which those from outside are returned.
[[nodiscard]] std::string outside_detector_json(const OutsideDetector& detector);
[[nodiscard]] std::vector<OutsideDetector> outside_detectors_of_record(const std::string& run_record);

}  // namespace conelane
