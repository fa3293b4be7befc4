#include "program/commands/command_parts.hpp"

#include "evaluation/formats/file_text.hpp"
#include "experiments/report/report.hpp"

#include <cerrno>
#include <cstdio>
#include <iostream>

namespace conelane::program {
namespace {

namespace fs = std::filesystem;

constexpr int kRefused = 2;  ///< exit code where the package has printed the reason

void write_page(const fs::path& directory) {
    const fs::path page = directory / "report.html";
    try {
        write_report(directory, page);
    } catch (const NoPython& missing) {
        fmt::print("results: {}, without a page: {}\n", directory.string(), missing.what());
        return;
    } catch (const PackageRefused&) {
        fmt::print("results: {}, without a page\n", directory.string());
        throw CLI::RuntimeError(kRefused);
    } catch (const std::exception&) {
        fmt::print("results: {}, without a page\n", directory.string());
        throw;
    }
    fmt::print("results: {}, page: {}\n", directory.string(), page.string());
}

}  // namespace

WeightsBytes read_weights_bytes(const fs::path& file, const std::string& method,
                                const DetectorRecipe* recipe) {
    if (recipe == nullptr || !recipe->takes_weights())
        throw InvalidInput("--weights",
                           method + " does not take them: only front, front-warm and rld-strip do");
    return parsed_file(file, [&](std::string text) {
        (void)make_detector(*recipe, {.weights = WeightsBytes{text}});
        return WeightsBytes{std::move(text)};
    });
}

AnnotatedScene scene_named(const std::string& id, const fs::path& scenes_file) {
    for (AnnotatedScene& scene : read_scenes(scenes_file)) {
        if (scene.scene.id == id) return std::move(scene);
    }
    throw InputError(scenes_file, 0, "--id", "'" + id + "' is not a scene of it");
}

ScenesById::ScenesById(fs::path file) : file_(std::move(file)), scenes_(read_scenes(file_)) {
    for (const AnnotatedScene& scene : scenes_) by_id_.emplace(scene.scene.id, &scene);
}

const AnnotatedScene& ScenesById::of(const std::string& id, const fs::path& file, std::size_t line) const {
    const auto found = by_id_.find(id);
    if (found != by_id_.end()) return *found->second;
    throw InputError(file, line, "scene", "'" + id + "' is not in " + file_.string());
}

CLI::Option* add_number_option(CLI::App& command, const std::string& name, double& value, double low,
                               double high, const std::string& help) {
    return command.add_option(name, value, help)
        ->check(CLI::Range(low, high) & !CLI::IsMember({"nan", "-nan"}, CLI::ignore_case))
        ->capture_default_str();
}

CLI::Option* add_word_option(CLI::App& command, const std::string& name, std::string& value,
                             const std::vector<std::string>& words, const std::string& help) {
    CLI::Option* const option = command.add_option(name, value, help)->check(CLI::IsMember(words));
    return value.empty() ? option : option->capture_default_str();
}

Scene cones_asked_for(const Scene& scene, std::optional<std::size_t> nearest) {
    return nearest ? nearest_ahead(scene, *nearest) : scene;
}

LineOutput::LineOutput(const std::string& out) {
    if (out != kStandardStream) file_.emplace(out);
}

void LineOutput::put(const std::string& line) {
    std::ostream& stream = file_ ? file_->stream() : std::cout;
    errno = 0;
    stream << line << '\n' << std::flush;
    if (!stream)
        throw std::system_error(errno, std::generic_category(), "--out cannot be written to its end");
}

void LineOutput::commit() {
    if (file_) file_->commit();
}

void require_own_page(const fs::path& directory) {
    // The mark that report/page.py writes near the beginning.
    constexpr std::string_view kTitle = "<title>conelane: ";
    constexpr std::size_t kBeginning = 2000;
    const fs::path page = directory / "report.html";
    std::error_code ignored;
    if (!fs::is_regular_file(page, ignored) || fs::file_size(page, ignored) == 0) return;
    std::string beginning(kBeginning, ' ');
    std::ifstream(page, std::ios::binary).read(beginning.data(), kBeginning);
    if (beginning.find(kTitle) != std::string::npos) return;
    throw InputError(page, 0, "",
                     "is not a page of conelane and would be replaced; move it, or name another directory");
}

void finish_comparison(const ComparisonOutcome& outcome, const fs::path& directory, bool with_page) {
    fmt::print("{}wide table: {}\n", outcome.summary, (directory / "table.txt").string());
    if (with_page) write_page(directory);
    report_errors(outcome.errors);
}

void report_errors(const AnswerErrors& errors) {
    constexpr int kNothingAnswered = 1;
    for (const std::string& line : errors.lines()) fmt::print(stderr, "conelane: {}\n", line);
    if (errors.any_answered_nothing()) throw CLI::RuntimeError(kNothingAnswered);
}

void report_errors(std::span<const LaneRecord> answers) {
    AnswerErrors errors;
    for (const LaneRecord& record : answers) add_answer_of(errors, record);
    report_errors(errors);
}

void call_package(const std::function<void()>& call) {
    try {
        call();
    } catch (const PackageRefused&) {
        throw CLI::RuntimeError(kRefused);
    }
}

void add_field_options(CLI::App& command, const OptionFields& fields) {
    for (const OptionField& field : fields) {
        const std::string name = field.option;
        if (name.empty()) continue;
        std::visit(
            [&](const auto& value) {
                using Value = std::decay_t<decltype(value)>;
                if constexpr (std::is_same_v<Value, bool*>) {
                    command.add_flag(name, *value, field.help);
                } else if constexpr (std::is_same_v<Value, std::string*>) {
                    command.add_option(name, *value, field.help);
                } else if constexpr (std::is_same_v<Value, std::vector<std::string>*> ||
                                     std::is_same_v<Value, std::vector<double>*>) {
                    CLI::Option* const list = command.add_option(name, *value, field.help)->delimiter(',');
                    if (!value->empty()) list->capture_default_str();
                } else if constexpr (!std::is_same_v<Value, const char*>) {
                    CLI::Option* const option =
                        command.add_option(name, *value, field.help)->capture_default_str();
                    if constexpr (std::is_integral_v<std::remove_pointer_t<Value>>) {
                        if (std::isfinite(field.range.most))
                            option->check(whole_number(static_cast<std::size_t>(field.range.least),
                                                       static_cast<std::size_t>(field.range.most)));
                    }
                }
            },
            field.value);
    }
}

}  // namespace conelane::program
