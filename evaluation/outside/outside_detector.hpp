#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace conelane {

/// What the author of a method says of it in a file `*.method.json`. What is not said is absent.
struct MethodCard {
    std::optional<std::string> name;
    std::optional<std::string> address;
    std::optional<std::string> licence;
    std::optional<bool> color_used;
    std::optional<bool> history_used;  ///< from scene to scene of a lap
    std::optional<std::vector<std::string>> training_courses;

    /// One line for a table's foot: "ft-fsd-path-planning; MIT; no color; ...".
    [[nodiscard]] std::string summary() const;
};

/// A method that is not part of this program.
struct OutsideMethod {
    enum class Kind {
        program,  ///< exec:NAME=COMMAND, asked scene by scene
        lanes,    ///< lanes:NAME=FILE, answers of a run elsewhere
    };
    Kind kind = Kind::program;
    std::string name;    ///< as tables show it
    std::string source;  ///< the command, or the file
    std::optional<MethodCard> card;

    [[nodiscard]] bool is_program() const { return kind == Kind::program; }
};

/// What `exec:NAME=COMMAND` or `lanes:NAME=FILE` names, with its card; nothing where the text is neither.
/// Throws InvalidInput where the name is missing or has other letters than a file name may have; InputError
/// where the card is wrong.
[[nodiscard]] std::optional<OutsideMethod> parse_outside_method(std::string_view text);

/// Methods as a user lists them: split at commas, but `exec:` takes the rest of its text, so that a command
/// may hold commas.
[[nodiscard]] std::vector<std::string> split_methods(const std::vector<std::string>& texts);

/// The card of a method: X.method.json beside the lanes file X.lanes.jsonl, or beside a file X.ANYTHING that
/// a word of the command names, the first where there is one. Nothing where there is none.
[[nodiscard]] std::optional<std::filesystem::path> card_path(const OutsideMethod& method);

/// Throws InputError naming file and key.
[[nodiscard]] MethodCard read_method_card(const std::filesystem::path& file);

/// For the record of a run: one method, or the array of methods that a record holds under "methods", of which
/// those from outside are returned.
[[nodiscard]] std::string outside_method_json(const OutsideMethod& method);
[[nodiscard]] std::vector<OutsideMethod> outside_methods_of_record(const std::string& run_record);

}  // namespace conelane
