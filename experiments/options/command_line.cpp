#include "experiments/options/command_line.hpp"

#include "conelane/rld_parameter_sets.hpp"
#include "evaluation/formats/track_spec.hpp"

#include <charconv>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace conelane::experiments {
namespace {

constexpr std::size_t kIndent = 2;        ///< indentation of a name
constexpr std::size_t kMoreIndent = 6;    ///< indentation of the second line of a name
constexpr std::size_t kDescription = 30;  ///< the column where descriptions begin, as CLI11 has it

/// Place of the break in a line without a space.
std::size_t break_within(std::string_view text, std::size_t width) {
    const std::size_t mark = text.substr(0, width).find_last_of(",|/");
    return mark == std::string_view::npos || mark == 0 ? width : mark + 1;
}

void wrap_line(std::string_view text, std::size_t width, std::vector<std::string>& lines) {
    while (text.size() > width) {
        std::size_t end = text.substr(0, width + 1).find_last_of(' ');
        const bool at_space = end != std::string_view::npos && end > 0;
        if (!at_space) end = break_within(text, width);
        lines.emplace_back(text.substr(0, end));
        text.remove_prefix(at_space ? end + 1 : end);
    }
    lines.emplace_back(text);
}

/// A name on the left and its description on the right, or below a long name.
std::string entry(const std::string& name, const std::string& description) {
    std::string text;
    std::size_t at = 0;  // position in the last line
    std::vector<std::string> names = wrapped(name, kHelpColumns - kIndent);
    if (names.size() > 1) {
        names = wrapped(name, kHelpColumns - kMoreIndent);
    }
    for (std::size_t i = 0; i < names.size(); ++i) {
        const std::size_t indent = i == 0 ? kIndent : kMoreIndent;
        text += (i == 0 ? "" : "\n") + std::string(indent, ' ') + names[i];
        at = indent + names[i].size();
    }
    if (description.empty()) return text + '\n';
    bool is_first = true;
    for (const std::string& line : wrapped(description, kHelpColumns - kDescription)) {
        const bool continues = is_first && at < kDescription;
        text += continues ? std::string(kDescription - at, ' ') : '\n' + std::string(kDescription, ' ');
        text += line;
        is_first = false;
    }
    return text + '\n';
}

std::string in_lines(const std::string& text) {
    std::string all;
    for (const std::string& line : wrapped(text, kHelpColumns)) all += line + '\n';
    if (all.ends_with("\n\n") && text.ends_with('\n')) all.pop_back();
    return text.empty() ? "" : all;
}

bool has_empty_part(std::string_view list, char delimiter) {
    const std::string twice(2, delimiter);
    return list.starts_with(delimiter) || list.ends_with(delimiter) ||
           list.find(twice) != std::string_view::npos;
}

void require_whole_list(const CLI::Option* option, std::string_view text) {
    if (option == nullptr || option->get_delimiter() == '\0') return;
    if (has_empty_part(text, option->get_delimiter()))
        throw CLI::ValidationError(option->get_name(),
                                   fmt::format("'{}' is a list with an empty part", text));
}

/// A program from outside behind a list of other things would be taken for one of these, and a value too many
/// would be "not expected", without the reason. With positionals it may be one of them.
void require_own_value(const CLI::Option* option, int values_before, bool with_positionals,
                       const std::string& word) {
    constexpr std::array<std::string_view, 4> kMethods{"--method", "--methods", "--solver", "--solvers"};
    constexpr std::array<std::string_view, 3> kOutside{"exec:", "solver:", "lanes:"};
    if (option == nullptr) return;
    const int most = option->get_items_expected_max();
    const bool is_outside =
        std::ranges::any_of(kOutside, [&](std::string_view kind) { return word.starts_with(kind); });
    const bool is_foreign =
        most > 1 && is_outside && std::ranges::find(kMethods, option->get_name()) == kMethods.end();
    if ((values_before < most || with_positionals) && !is_foreign) return;
    throw CLI::ValidationError(
        option->get_name(),
        fmt::format("does not take '{}'; write the values of an option directly behind its name", word));
}

/// The sub-command of that name; null if there is none.
CLI::App* find_command(CLI::App& app, const std::string& name) {
    for (CLI::App* command : app.get_subcommands({})) {
        if (!command->get_name().empty() && command->check_name(name)) return command;
    }
    return nullptr;
}

bool takes_positionals(const CLI::App& app) {
    return std::ranges::any_of(app.get_options({}),
                               [](const CLI::Option* option) { return option->get_positional(); });
}

[[noreturn]] void refuse_name(CLI::App& app, const std::string& name) {
    std::vector<std::string> known;
    for (const CLI::App* command : app.get_subcommands({})) known.push_back(command->get_name());
    // The program's own name begins every message.
    const std::string of = app.get_parent() == nullptr ? "" : app.get_name() + ": ";
    throw CLI::ParseError(fmt::format("{}there is no '{}', it has {}", of, name, fmt::join(known, ", ")),
                          CLI::ExitCodes::ExtrasError);
}

/// The message has the option whose name begins like this one, by three letters or more, if there is one.
[[noreturn]] void refuse_option(const CLI::App& app, std::string_view name) {
    std::string nearest;
    std::ptrdiff_t most = 2;
    for (const CLI::Option* option : app.get_options({})) {
        for (const std::string& known : option->get_lnames()) {
            const std::ptrdiff_t shared = std::ranges::mismatch(known, name.substr(2)).in1 - known.begin();
            if (shared <= most) continue;
            most = shared;
            nearest = ", perhaps --" + known;
        }
    }
    throw CLI::ParseError(fmt::format("there is no option '{}'{}", name, nearest),
                          CLI::ExitCodes::ExtrasError);
}

namespace fs = std::filesystem;

/// Marks the options of add_output_option.
constexpr const char* kOutput = "output";
constexpr unsigned kMaxThreads = 1024;

/// Nothing if the text is anything else. Streams would let negative and larger numbers wrap around.
std::optional<std::uint64_t> number_in(const std::string& text) {
    std::uint64_t number = 0;
    const char* const end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data(), end, number);
    if (error != std::errc{} || rest != end) return std::nullopt;
    return number;
}

/// The reason why a file cannot be written, or nothing.
std::string output_fault(const std::string& file) {
    try {
        require_writable(file);
        return {};
    } catch (const InputError& error) {
        return error.what();
    }
}

bool is_output(CLI::Option& option) {
    try {
        return option.get_validator(kOutput) != nullptr;
    } catch (const CLI::OptionNotFound&) {
        return false;
    }
}

/// Options whose values are names, which may also be the names of files.
bool names_no_file(const CLI::Option& option) {
    constexpr std::array<std::string_view, 7> kOptions{"--method", "--methods",     "--solver", "--solvers",
                                                       "--id",     "--formulation", "--pairing"};
    return std::ranges::find(kOptions, option.get_name()) != kOptions.end();
}

void append_files_of(const fs::path& folder, std::span<const std::string_view> endings,
                     std::vector<fs::path>& files) {
    std::error_code no_folder;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, no_folder)) {
        if (std::ranges::find(endings, entry.path().extension()) != endings.end()) files.push_back(entry);
    }
}

/// The files that the value of an option may mean: the file of that name, the one after the kind of a track
/// or after NAME=, the files of a folder of tracks or of results, the companion of scenes.
std::vector<fs::path> files_meant(const std::string& text) {
    constexpr std::array<std::string_view, 3> kTracks{".yaml", ".csv", ".json"};
    constexpr std::array<std::string_view, 3> kResults{".json", ".jsonl", ".txt"};
    std::vector<fs::path> files{text};
    if (text.ends_with(".scenes.jsonl")) files.push_back(track_boundaries_path(text));
    for (const char separator : {':', '='}) {
        const std::size_t at = text.find(separator);
        if (at != std::string::npos) files.emplace_back(text.substr(at + 1));
    }
    const std::size_t kind_end = text.find(':');
    if (kind_end != std::string::npos) {
        const std::size_t from = kind_end + 1;
        append_files_of(text.substr(from, text.find(':', from) - from), kTracks, files);
    }
    append_files_of(text, kResults, files);
    return files;
}

/// Whether writing the output would replace the file, or both mean the same file that does not exist yet.
bool are_the_same(const fs::path& output, const fs::path& file) {
    std::error_code ignored;
    if (fs::exists(output, ignored)) {
        return fs::is_regular_file(output, ignored) && fs::equivalent(output, file, ignored);
    }
    return !fs::exists(file, ignored) &&
           fs::weakly_canonical(output, ignored) == fs::weakly_canonical(file, ignored);
}

void refuse_to_replace(const CLI::Option& output, std::span<const fs::path> written, const CLI::Option& input,
                       const fs::path& file) {
    for (const fs::path& place : written) {
        if (place == "-" || !are_the_same(place, file)) continue;
        throw CLI::ValidationError(output.get_name(), fmt::format("'{}' would replace the file that {} names",
                                                                  place.string(), input.get_name()));
    }
}

/// The options that were given, including those of groups.
void collect_options(CLI::App& app, std::vector<CLI::Option*>& options) {
    for (CLI::Option* option : app.get_options(nullptr)) {
        if (option->count() > 0) options.push_back(option);
    }
    for (CLI::App* group : app.get_subcommands(nullptr)) {
        collect_options(*group, options);
    }
}

/// The fault of the text of a time limit, or nothing.
std::string time_limit_fault(const std::string& text) {
    double limit_ms = 0.0;
    if (CLI::detail::lexical_cast(text, limit_ms) && limit_ms > 0.0) return {};
    return fmt::format("'{}' is not a number above 0", text);
}

}  // namespace

std::vector<std::string> wrapped(std::string_view text, std::size_t width) {
    std::vector<std::string> lines;
    for (std::size_t begin = 0;;) {
        const std::size_t end = std::min(text.find('\n', begin), text.size());  // npos is larger
        wrap_line(text.substr(begin, end - begin), width, lines);
        if (end == text.size()) return lines;
        begin = end + 1;
    }
}

std::string HelpFormatter::make_option(const CLI::Option* option, bool is_positional) const {
    return entry(make_option_name(option, is_positional) + make_option_opts(option),
                 make_option_desc(option));
}

std::string HelpFormatter::make_subcommand(const CLI::App* command) const {
    const std::string& description = command->get_description();
    const std::size_t end = std::min(description.find(". "), description.find('\n'));
    return entry(command->get_display_name(true), description.substr(0, end));
}

std::string HelpFormatter::make_description(const CLI::App* command) const {
    return in_lines(Formatter::make_description(command));
}

std::string HelpFormatter::make_usage(const CLI::App* command, std::string name) const {
    return in_lines(Formatter::make_usage(command, std::move(name)));
}

std::string HelpFormatter::make_expanded(const CLI::App* command) const {
    std::string text;
    for (std::string line : wrapped(Formatter::make_expanded(command), kHelpColumns)) {
        line.erase(line.find_last_not_of(' ') + 1);
        if (!line.empty()) text += line + '\n';  // CLI11 indents empty lines
    }
    return text;
}

std::string HelpFormatter::make_footer(const CLI::App* command) const {
    return in_lines(Formatter::make_footer(command));
}

void refuse_misread_words(CLI::App& program, std::span<const char* const> arguments) {
    CLI::App* app = &program;
    const CLI::Option* option = nullptr;  // the option that was named last
    int values = 0;                       // number of its values so far
    bool names_a_command = true;          // whether the next word, directly behind a command, names a command
    for (const std::string word : arguments) {
        if (word.starts_with("-") && word.size() > 1) {
            const std::size_t equals = word.find('=');
            option = app->get_option_no_throw(word.substr(0, equals));
            if (option == nullptr && word.starts_with("--") && word.size() > 2)
                refuse_option(*app, word.substr(0, equals));
            values = equals != std::string::npos ? 1 : 0;
            if (values == 1) require_whole_list(option, word.substr(equals + 1));
            names_a_command = false;
            continue;
        }
        if (CLI::App* const command = find_command(*app, word)) {
            app = command;
            option = nullptr;
            names_a_command = true;
            continue;
        }
        const bool with_positionals = takes_positionals(*app);
        if (names_a_command && !app->get_subcommands({}).empty() && !with_positionals)
            refuse_name(*app, word);
        require_own_value(option, values++, with_positionals, word);
        names_a_command = false;
        require_whole_list(option, word);
    }
}

CLI::Validator whole_number(std::size_t least, std::size_t most) {
    const auto fault = [least, most](const std::string& text) -> std::string {
        const auto number = number_in(text);
        if (number && *number >= least && *number <= most) return {};
        return fmt::format("'{}' is not a whole number from {} to {}", text, least, most);
    };
    return {fault, fmt::format("in [{} - {}]", least, most)};
}

CLI::Validator seed_number() {
    const auto fault = [](const std::string& text) -> std::string {
        return number_in(text) ? "" : fmt::format("'{}' is not a non-negative integer of 64 bits", text);
    };
    return {fault, ""};
}

std::vector<std::optional<std::size_t>> cone_set_sizes(const std::string& option,
                                                       std::span<const std::string> texts) {
    std::vector<std::optional<std::size_t>> sizes;
    for (const std::string& text : texts) {
        const std::optional<std::size_t> size = number_in(text);
        if (text != "all" && size.value_or(0) == 0)
            throw InvalidInput(option, "'" + text + "' is neither a number of cones nor all");
        if (std::ranges::find(sizes, size) != sizes.end())
            throw InvalidInput(option, "'" + text + "' is there twice");
        sizes.push_back(size);
    }
    return sizes;
}

CLI::Option* add_tracks_option(CLI::App& command, std::vector<std::string>& tracks, const std::string& more) {
    return command.add_option("--tracks", tracks, track_grammar() + more);
}

void add_scene_options(CLI::App& command, SceneOptions& options) {
    command
        .add_option("--fp", options.false_positive_rates,
                    "share of false positives among all points of a scene")
        ->delimiter(',')
        ->capture_default_str();
    command.add_option("--range", options.ranges_m, "radius of the visible half disc [m]")
        ->delimiter(',')
        ->capture_default_str();
    command.add_option("--every", options.every_m, "travel between poses [m]")->capture_default_str();
    command
        .add_option("--condition", options.conditions,
                    "paper, car, harsh and slam, separated by commas: a lap in each. paper: nothing "
                    "disturbed; car: --noise 0.1, --pose-noise 0.3 m and 5 degrees, --miss 0.05, --persist; "
                    "harsh: 0.2, 0.5 m and 8 degrees, 0.1, --persist; slam: car with a pose noise of 0.1 m "
                    "and 1 degree. If one of these options is given too, it replaces "
                    "its part in every condition, and the names say so, such as car+no_persist")
        ->delimiter(',')
        ->capture_default_str();
    command.add_option_function<double>(
        "--noise", [&options](double sigma_m) { options.noise_sigma_m = sigma_m; },
        "standard deviation of the seen positions [m]");
    command.add_option_function<double>(
        "--noise-by-range", [&options](double share) { options.noise_by_range = share; },
        "standard deviation of the seen positions for each metre between cone and car, beside --noise; "
        "the cones of the scenes carry their covariance");
    command
        .add_option_function<std::vector<double>>(
            "--pose-noise",
            [&options](const std::vector<double>& values) {
                options.pose_noise_lateral_m = values[0];
                options.pose_noise_yaw_rad = values[1];
            },
            "standard deviations of the pose: LATERAL [m], YAW [rad]")
        ->delimiter(',')
        ->expected(2);
    command.add_option_function<double>(
        "--miss", [&options](double rate) { options.miss_rate = rate; }, "share of the cones not seen");
    command.add_flag_function(
        "--persist,!--no-persist", [&options](std::int64_t count) { options.persistent = count > 0; },
        "false positives keep id and place along a lap; without it they are drawn at each pose");
    command.add_flag("--color", options.with_color, "scenes carry the colours of their cones");
    command.add_option(
        "--color-wrong,--color-error", options.color_error_rate,
        "with --color: share of the cones whose colour is seen that show the other boundary's");
    command.add_option(
        "--color-unknown", options.color_unknown_rate,
        "with --color: share of the course's cones whose colour is not seen; of false positives "
        "it is a third");
    command.add_flag("--confidence", options.with_confidence,
                     "scenes carry simulated confidences, lower ones for false positives");
    command.add_option("--seed", options.seed, "base seed")->check(seed_number())->capture_default_str();
}

RldParameters ParameterSource::load() const {
    DetectorOptions options;
    apply_to(options);
    RldParameters parameters = options.rld_parameters.value_or(RldParameters{});
    if (options.pairing) parameters.pairing = *options.pairing;
    return parameters;
}

void ParameterSource::apply_to(DetectorOptions& options) const {
    if (!name.empty()) {
        const auto shipped = rld_parameter_set(name);
        options.rld_parameters = shipped ? *shipped : read_rld_parameters(name);
    }
    if (!pairing.empty()) options.pairing = pairing == "paper" ? Pairing::paper : Pairing::near_far;
}

void ParameterSource::require_not_given(const std::string& who) const {
    if (name.empty() && pairing.empty()) return;
    throw InvalidInput(name.empty() ? "--pairing" : "--params",
                       fmt::format("{} no RLD parameters: only the methods rld-... take them", who));
}

void add_parameter_options(CLI::App& command, ParameterSource& source, const std::string& without) {
    command.add_option("--params", source.name,
                       fmt::format("RLD parameters: {} or a file (JSON); without it {}",
                                   fmt::join(rld_parameter_set_names(), ", "), without));
    command.add_option("--pairing", source.pairing, "overrides the pairing of the parameters")
        ->check(CLI::IsMember({"paper", "near_far"}));
}

void add_nearest_option(CLI::App& command, std::optional<std::size_t>& nearest,
                        const std::string& description) {
    command
        .add_option_function<std::size_t>(
            "--nearest", [&nearest](std::size_t count) { nearest = count; }, description)
        ->check(whole_number(1, kMaxCones));
}

void add_time_limit_option(CLI::App& command, double& time_limit_ms) {
    command.add_option("--time-limit", time_limit_ms, "per scene, wall clock [ms]; inf for none")
        ->check(CLI::Validator(time_limit_fault, "POSITIVE"))
        ->capture_default_str();
}

CLI::Option* add_output_option(CLI::App& command, const std::string& name, std::string& file,
                               const std::string& description, bool or_standard_output) {
    if (or_standard_output) {
        const auto fault = [](const std::string& text) { return text == "-" ? "" : output_fault(text); };
        return command.add_option(name, file, description)->check(CLI::Validator(fault, "", kOutput));
    }
    return command.add_option(name, file, description)->check(CLI::Validator(output_fault, "", kOutput));
}

void refuse_lost_inputs(CLI::App& command) {
    std::vector<CLI::Option*> options;
    collect_options(command, options);
    for (CLI::Option* output : options) {
        if (!is_output(*output)) continue;
        std::vector<fs::path> written{output->results().front()};
        if (command.get_name() == "scenes") written.push_back(track_boundaries_path(written.front()));
        for (const CLI::Option* input : options) {
            if (input == output) continue;
            for (const std::string& text : input->results()) {
                if (names_no_file(*input) && !text.starts_with("lanes:")) continue;
                for (const fs::path& file : files_meant(text))
                    refuse_to_replace(*output, written, *input, file);
            }
        }
    }
}

void add_threads_option(CLI::App& command, unsigned& threads, const std::string& description) {
    command.add_option("--threads", threads, description)
        ->check(whole_number(1, kMaxThreads))
        ->capture_default_str();
}

CLI::Option* add_sizes_option(CLI::App& command, std::vector<std::string>& sizes,
                              const std::string& description) {
    return command.add_option("--sizes", sizes, description)
        ->delimiter(',')
        ->check([](const std::string& size) {
            return size == "all" ? std::string() : whole_number(1, kMaxCones)(size);
        })
        ->capture_default_str();
}

void add_shard_option(CLI::App& command, Shard& shard, const std::string& description) {
    const auto parse = [&shard](const std::string& text) {
        const std::size_t slash = text.find('/');
        const char* const end = text.data() + text.size();
        const auto index = std::from_chars(text.data(), end, shard.index);
        if (slash != std::string::npos && index.ec == std::errc{} && index.ptr == text.data() + slash) {
            const auto count = std::from_chars(text.data() + slash + 1, end, shard.count);
            if (count.ec == std::errc{} && count.ptr == end && shard.index < shard.count) return;
        }
        throw CLI::ValidationError("--shard", "'" + text + "' is not I/N with 0 <= I < N");
    };
    command.add_option_function<std::string>("--shard", parse, "I/N: " + description);
}

}  // namespace conelane::experiments
