#pragma once

#include "conelane/detectors.hpp"
#include "evaluation/formats/scene_set.hpp"

#include <CLI/CLI.hpp>

/// Options that several commands have, declared once.
namespace conelane::experiments {

/// Columns of every line of help.
inline constexpr std::size_t kHelpColumns = 100;

/// The text in lines of at most `width` characters, broken at spaces; a longer word is broken after a comma,
/// bar or slash, else at the end of the line. A newline in the text stays. Returns at least one line.
/// Precondition: `width` > 0.
[[nodiscard]] std::vector<std::string> wrapped(std::string_view text, std::size_t width);

/// CLI11's help with lines of at most kHelpColumns columns. A list of commands has the first sentence of each
/// description.
class HelpFormatter : public CLI::Formatter {
  public:
    std::string make_option(const CLI::Option* option, bool is_positional) const override;
    std::string make_subcommand(const CLI::App* command) const override;
    std::string make_description(const CLI::App* command) const override;
    std::string make_usage(const CLI::App* command, std::string name) const override;
    std::string make_expanded(const CLI::App* command) const override;
    std::string make_footer(const CLI::App* command) const override;
};

/// Checks the words of the command line before they are parsed, for errors that CLI11 would ignore or report
/// in a misleading way: an empty part in a list, such as "," or "0,,0.3", a name that is not a sub-command or
/// option, and a value behind an option that does not take it. `arguments`: those after the program's name.
/// Throws CLI::ParseError.
void refuse_misread_words(CLI::App& program, std::span<const char* const> arguments);

/// Largest size of a cone set.
inline constexpr std::size_t kMaxCones = 100'000;

/// Accepts the texts of whole numbers in a range. CLI::Range would report any other text as out of range.
[[nodiscard]] CLI::Validator whole_number(std::size_t least, std::size_t most);

/// Accepts the texts of seeds. CLI11 would let negative numbers wrap around.
[[nodiscard]] CLI::Validator seed_number();

/// Sizes of cone sets as an option gives them: a number of cones, or `all` for all visible ones (absent).
/// Throws InvalidInput if a text is neither, or a size is there twice.
[[nodiscard]] std::vector<std::optional<std::size_t>> cone_set_sizes(const std::string& option,
                                                                     std::span<const std::string> texts);

/// --sizes N,..., texts for cone_set_sizes; their values are the default
CLI::Option* add_sizes_option(CLI::App& command, std::vector<std::string>& sizes,
                              const std::string& description);

/// At most `limit` of them, evenly spread.
template <typename Value>
[[nodiscard]] std::vector<Value> spread(const std::vector<Value>& all, std::optional<std::size_t> limit) {
    if (!limit || all.size() <= *limit) return all;
    std::vector<Value> some;
    for (std::size_t i = 0; i < *limit; ++i) some.push_back(all[i * all.size() / *limit]);
    return some;
}

/// --tracks SPEC...; `more` is added to the help.
CLI::Option* add_tracks_option(CLI::App& command, std::vector<std::string>& tracks,
                               const std::string& more = "");

/// The options of scene making without --tracks, --out and --nearest. Lists not given keep their values.
void add_scene_options(CLI::App& command, SceneOptions& options);

/// --params and --pairing.
struct ParameterSource {
    std::string name;     ///< of a shipped set, else a file; empty: the command's default
    std::string pairing;  ///< empty: as in the parameters
    /// The parameters that were asked for; RldParameters{} if none were.
    [[nodiscard]] RldParameters load() const;
    /// Passes them to a detector's options if they were given; detectors have parameters of their own.
    void apply_to(DetectorOptions& options) const;
    /// Throws InvalidInput naming the option that was given, because `who` has no RLD parameters.
    void require_not_given(const std::string& who) const;
};
/// `without`: the help text for a missing --params.
void add_parameter_options(CLI::App& command, ParameterSource& source, const std::string& without);

/// --nearest N
void add_nearest_option(CLI::App& command, std::optional<std::size_t>& nearest,
                        const std::string& description);
/// For detectors that are compared in real time, as in the RLD paper.
inline constexpr double kRealTimeLimit_ms = 400.0;
/// --time-limit MS; the value of `time_limit_ms` is the default
void add_time_limit_option(CLI::App& command, double& time_limit_ms);
/// A file to write, or standard output by the name "-" if that is allowed. Whether it can be written is
/// checked before the work.
CLI::Option* add_output_option(CLI::App& command, const std::string& name, std::string& file,
                               const std::string& description, bool or_standard_output = false);
/// Rejects the options of a command that is about to run if a file of add_output_option would replace an
/// input or another output: the same file, also through another name, a symbolic or a hard link. Every other
/// option that names a file counts as an input, a track by its SPEC, a scenes file with its companion. Throws
/// CLI::ValidationError naming both.
void refuse_lost_inputs(CLI::App& command);
/// --shard I/N; throws CLI::ValidationError for anything else
void add_shard_option(CLI::App& command, Shard& shard, const std::string& description);
/// --threads T
void add_threads_option(CLI::App& command, unsigned& threads, const std::string& description);

}  // namespace conelane::experiments
