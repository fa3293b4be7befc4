#include "evaluation/outside/solver_program.hpp"

#include "evaluation/formats/json_node.hpp"
#include "evaluation/formats/program_files.hpp"
#include "evaluation/input_error.hpp"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <system_error>

#include <fmt/format.h>
#include <unistd.h>

namespace conelane {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMaxSolutionBytes = std::uintmax_t{64} << 20U;
constexpr double kNoCutoff = 1e300;
constexpr double kNoLimit_ms = 1e9;  ///< a number, because not every program reads "inf"

/// A new folder that no other process writes to.
fs::path make_folder() {
    std::string name = (fs::temp_directory_path() / "conelane_solver_XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr)
        throw fs::filesystem_error("no folder for a solver's files", name,
                                   std::error_code(errno, std::generic_category()));
    return name;
}

/// The text becomes a word of a shell command.
bool is_plain(const std::string& path) {
    return std::ranges::all_of(path, [](char c) {
        return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
               std::string_view("/._-+").find(c) != std::string_view::npos;
    });
}

using Placeholder = std::pair<std::string_view, std::string>;

std::vector<Placeholder> placeholders(const SolverQuestion& question, const std::string& program,
                                      const std::string& solution) {
    const double limit_ms = std::min(question.time_limit_ms, kNoLimit_ms);
    constexpr double kMsPerS = 1000.0;
    return {{"{mps}", program},
            {"{lp}", program},
            {"{sol}", solution},
            {"{limit_s}", fmt::format("{:.3f}", limit_ms / kMsPerS)},
            {"{limit_whole_s}", fmt::format("{:.0f}", std::ceil(limit_ms / kMsPerS))},
            {"{limit_ms}", fmt::format("{:.0f}", limit_ms)},
            {"{gap}", fmt::format("{:g}", question.absolute_gap)},
            {"{threads}", std::to_string(question.threads)},
            {"{seed}", std::to_string(question.seed)},
            {"{cutoff}", fmt::format("{:.12g}", question.cutoff.value_or(kNoCutoff))}};
}

std::string filled(std::string text, const std::vector<Placeholder>& values) {
    for (const auto& [name, value] : values) {
        for (std::size_t at = text.find(name); at != std::string::npos;
             at = text.find(name, at + value.size()))
            text.replace(at, name.size(), value);
    }
    return text;
}

/// Rejects a word in braces, of letters and underscores only, that is not a placeholder: probably a misprint.
/// `${NAME}` belongs to the shell.
void require_known_placeholders(std::string_view command) {
    const std::vector<Placeholder> known = placeholders({}, "", "");
    for (std::size_t open = command.find('{'); open != std::string::npos;
         open = command.find('{', open + 1)) {
        const std::size_t close = command.find('}', open);
        if (close == std::string::npos) return;
        if (open > 0 && command[open - 1] == '$') continue;
        const std::string_view word = command.substr(open, close + 1 - open);
        const bool is_word =
            word.size() > 2 && std::all_of(word.begin() + 1, word.end() - 1,
                                           [](unsigned char c) { return std::islower(c) != 0 || c == '_'; });
        if (!is_word || std::ranges::find(known, word, &Placeholder::first) != known.end()) continue;
        std::string names;
        for (const auto& [name, value] : known) names += (names.empty() ? "" : " ") + std::string(name);
        throw InvalidInput("solver",
                           fmt::format("{} is not a placeholder of a command; there are {}", word, names));
    }
}

nlohmann::ordered_json question_json(const SolverQuestion& question, const std::string& program,
                                     const std::string& solution) {
    nlohmann::ordered_json json{{"program", program},
                                {"solution", solution},
                                {"time_limit_ms", std::min(question.time_limit_ms, kNoLimit_ms)},
                                {"absolute_gap", question.absolute_gap},
                                {"threads", question.threads},
                                {"seed", question.seed}};
    if (question.cutoff) json["cutoff"] = *question.cutoff;
    return json;
}

/// Values in a line of a conversation, which come before those of the solution file.
struct Told {
    std::optional<SolutionFile::Status> status;
    std::string error;  ///< if its status is error
};

Told read_line(const std::string& line, SolutionFile& told) {
    using Status = SolutionFile::Status;
    constexpr std::array<std::string_view, 5> kStatuses{"optimal", "feasible", "infeasible", "unknown",
                                                        "error"};
    constexpr std::array kMeant{Status::optimal, Status::feasible, Status::infeasible, Status::unknown};
    Told said;
    with_json_line(line, "its answer", 1, [&](const JsonNode& json) {
        if (const auto bound = json.find("bound")) told.bound = bound->number();
        if (const auto nodes = json.find("nodes")) told.nodes = nodes->non_negative_integer();
        if (const auto ms = json.find("ms")) told.engine_ms = ms->non_negative_number();
        if (const auto solver = json.find("solver")) told.solver = solver->string();
        const auto status = json.find("status");
        if (!status) return;
        const std::size_t index = status->index_in(kStatuses);
        if (index < kMeant.size()) {
            said.status = kMeant[index];
            return;
        }
        const auto message = json.find("message");
        said.error = message ? message->string() : "it gives no message with 'error'";
    });
    return said;
}

}  // namespace

void SolverProgram::require_valid_command(std::string_view command) {
    require_known_placeholders(command);
    if (command.find("{mps}") != std::string_view::npos && command.find("{lp}") != std::string_view::npos)
        throw InvalidInput("solver", "a command has {mps} or {lp}, not both");
}

SolverProgram::SolverProgram(std::string command, const SolverPatience& patience)
    : command_(std::move(command)),
      patience_(patience),
      is_conversation_(command_.find("{mps}") == std::string::npos &&
                       command_.find("{lp}") == std::string::npos),
      writes_lp_(command_.find("{lp}") != std::string::npos) {
    require_valid_command(command_);
    const auto held = hold_interruption();
    folder_ = make_folder();
    clearing_.emplace([folder = folder_] {
        std::error_code ignored;
        fs::remove_all(folder, ignored);
    });
    if (!is_plain(folder_.string())) {
        std::error_code ignored;
        fs::remove_all(folder_, ignored);
        throw InvalidInput("solver", "the folder of temporary files, " + folder_.string() +
                                         ", has characters that a shell would read; set TMPDIR");
    }
}

SolverProgram::~SolverProgram() {
    end();
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
}

std::string SolverProgram::file(const char* ending) const {
    return (folder_ / "program").string() + ending;
}

void SolverProgram::end() {
    if (!child_) return;
    child_->end(patience_.end_ms);
    forget_child();
}

/// Precondition: it has ended.
void SolverProgram::forget_child() {
    peak_bytes_ = std::max(peak_bytes_, child_->peak_bytes());
    child_.reset();
}

/// Runs the command to its end and drops its output. Returns the failure in words, or nothing.
std::string SolverProgram::run_once(const SolverQuestion& question) {
    child_ = std::make_unique<ChildProcess>(
        filled(command_, placeholders(question, file(writes_lp_ ? ".lp" : ".mps"), file(".sol"))));
    const double wait_ms = question.time_limit_ms + patience_.late_ms;
    const Deadline deadline(wait_ms);
    std::string fault;
    while (true) {
        const ChildProcess::Reply reply = child_->ask("", deadline.remaining_ms());
        // A program that prints without end always has another line.
        const bool prints_on = reply.outcome == ChildProcess::Outcome::line;
        if (prints_on && !deadline.passed()) continue;
        if (reply.outcome != ChildProcess::Outcome::closed_output)
            fault = fault_of(prints_on ? ChildProcess::Outcome::late : reply.outcome, wait_ms);
        break;
    }
    // Its output may be closed shortly before it ends.
    const double patience_ms = fault.empty() ? std::max(0.0, deadline.remaining_ms()) : 0.0;
    const std::string how = child_->end(std::min(patience_ms, kNoLimit_ms));
    if (fault.empty() && how != "exit code 0")
        fault = how.empty() ? "the program closed its output and did not end" : "the program ended, " + how;
    if (const std::string words = child_->last_words(); !fault.empty() && !words.empty())
        fault += "; it said: " + words;
    forget_child();
    return fault;
}

std::string SolverProgram::converse(const SolverQuestion& question, SolutionFile& told, bool& needs_no_file) {
    double wait_ms = question.time_limit_ms + patience_.late_ms;
    if (!child_) {
        child_ = std::make_unique<ChildProcess>(command_);
        wait_ms += patience_.start_ms;
    }
    const ChildProcess::Reply reply =
        child_->ask(to_line(question_json(question, file(".mps"), file(".sol"))) + '\n', wait_ms);
    std::string fault = fault_of(reply.outcome, wait_ms);
    if (fault.empty()) {
        try {
            const Told said = read_line(reply.line, told);
            if (!said.error.empty()) return said.error;  // the conversation continues
            if (said.status) {
                told.status = *said.status;
                needs_no_file = told.status == SolutionFile::Status::infeasible ||
                                told.status == SolutionFile::Status::unknown;
            }
            return "";
        } catch (const InputError& wrong) {
            fault = wrong.what();
        }
    }
    child_->end_failed(reply.outcome, fault);
    forget_child();
    return fault;
}

SolverProgram::Answer SolverProgram::solve(const BinaryProgram& program, const SolverQuestion& question) {
    Answer answer;
    if (failures_ >= patience_.failures || lost_ms_ >= patience_.lost_ms) {
        answer.fault = "not asked after failures in a row, the last: " + last_fault_;
        return answer;
    }
    const Stopwatch watch;
    using Status = SolutionFile::Status;
    SolutionFile told;
    bool needs_no_file = false;
    bool says_status = false;
    try {
        std::error_code ignored;
        fs::remove(file(".sol"), ignored);
        {
            std::ofstream out(file(writes_lp_ ? ".lp" : ".mps"), std::ios::trunc);
            writes_lp_ ? write_lp(out, program, "conelane") : write_mps(out, program, "conelane");
            out.close();
            if (!out) throw InvalidInput(file(".mps"), "cannot be written");
        }
        answer.fault = is_conversation_ ? converse(question, told, needs_no_file) : run_once(question);
        says_status = needs_no_file || told.status != Status::unknown;
        if (answer.fault.empty() && !needs_no_file) {
            const auto size = fs::file_size(file(".sol"), ignored);
            if (ignored) {
                answer.fault = "it wrote no solution file";
            } else if (size > kMaxSolutionBytes) {
                answer.fault = fmt::format("its solution file has {} bytes", size);
            } else {
                std::ifstream in(file(".sol"));
                answer.solution = read_solution_file(in, program);
            }
        }
    } catch (const InvalidInput& wrong) {
        answer.fault = std::string("its solution file is wrong: ") + wrong.what();
    } catch (const std::system_error& failure) {
        answer.fault = failure.what();
    }
    SolutionFile& solution = answer.solution;
    if (told.status == Status::optimal && solution.states_status && solution.status != Status::optimal &&
        answer.fault.empty())
        answer.fault = "it says optimal, its solution file does not";
    if (says_status) solution.status = told.status;
    if (told.bound) solution.bound = told.bound;
    if (told.nodes) solution.nodes = told.nodes;
    if (told.engine_ms) solution.engine_ms = told.engine_ms;
    if (!told.solver.empty()) solution.solver = told.solver;
    if (answer.fault.empty()) answer.fault = fault_of(solution, program);
    if (!answer.fault.empty()) {
        solution = {};
        ++failures_;
        lost_ms_ += watch.elapsed_ms();
        last_fault_ = answer.fault;
        return answer;
    }
    failures_ = 0;
    lost_ms_ = 0.0;
    return answer;
}

}  // namespace conelane
