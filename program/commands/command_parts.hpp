#pragma once

#include "experiments/comparison/comparison.hpp"
#include "learning/training/training_loop.hpp"
#include "program/commands/commands.hpp"

/// What several commands do.
namespace conelane::program {

/// Stands for standard input and standard output.
inline constexpr const char* kStandardStream = "-";

/// The weights that `conelane train` wrote for a method. They are checked at once: before the work. Throws
/// InputError, and InvalidInput naming --weights if the method, null for one from outside, takes none.
[[nodiscard]] WeightsBytes read_weights_bytes(const std::filesystem::path& file, const std::string& method,
                                              const DetectorRecipe* recipe);

/// The scene of that id in a file. Throws InputError naming --id if there is none.
[[nodiscard]] AnnotatedScene scene_named(const std::string& id, const std::filesystem::path& scenes_file);

/// The scenes of a file, also by their ids.
class ScenesById {
  public:
    explicit ScenesById(std::filesystem::path file);
    [[nodiscard]] const std::vector<AnnotatedScene>& all() const { return scenes_; }
    /// The scene that a line of another file is about. Throws InputError if there is none.
    [[nodiscard]] const AnnotatedScene& of(const std::string& id, const std::filesystem::path& file,
                                           std::size_t line) const;

  private:
    std::filesystem::path file_;
    std::vector<AnnotatedScene> scenes_;
    std::unordered_map<std::string, const AnnotatedScene*> by_id_;
};

/// Declares the fields that have an option. The values must outlive the command.
void add_field_options(CLI::App& command, const OptionFields& fields);
/// Declares a number in a range, with its default. CLI::Range alone would accept NaN.
CLI::Option* add_number_option(CLI::App& command, const std::string& name, double& value, double low,
                               double high, const std::string& help);
/// Declares one of some words, with its default if it has one.
CLI::Option* add_word_option(CLI::App& command, const std::string& name, std::string& value,
                             const std::vector<std::string>& words, const std::string& help);

/// The scene with only its `nearest` cones ahead; the whole scene if that is absent.
[[nodiscard]] Scene cones_asked_for(const Scene& scene, std::optional<std::size_t> nearest);

/// Output line by line: a file that appears when it is complete, or standard output at once.
class LineOutput {
  public:
    explicit LineOutput(const std::string& out);
    /// Throws std::system_error if the line cannot be written.
    void put(const std::string& line);
    void commit();

  private:
    std::optional<AtomicFile> file_;
};

/// Throws InputError if the directory holds a report.html that is not a page of this program, which would
/// be overwritten.
void require_own_page(const std::filesystem::path& directory);

/// The end of a comparison: prints its summary and where its files are. With `with_page` it writes
/// report.html beside them; if Python or matplotlib is missing, it says so, and the results are complete
/// without the page. Throws if another failure prevents the page, such as a full disk, and like
/// report_errors.
void finish_comparison(const ComparisonOutcome& outcome, const std::filesystem::path& directory,
                       bool with_page = true);

/// The end of every command that answers scenes: a line on stderr for each method with errors among its
/// answers. Throws CLI::RuntimeError of exit code 1 if a method answered nothing at all. What the command
/// writes is in place by then.
void report_errors(const AnswerErrors& errors);
void report_errors(std::span<const LaneRecord> answers);

/// Runs a call of the Python package. Throws CLI::RuntimeError if it refused, which has printed the reason.
void call_package(const std::function<void()>& call);

}  // namespace conelane::program
