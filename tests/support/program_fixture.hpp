#pragma once

#include "tests/support/file_test.hpp"
#include "tests/support/test_paths.hpp"

#include <chrono>
#include <thread>

#include <nlohmann/json.hpp>
#include <sys/wait.h>

namespace conelane {

/// Runs the program `conelane` in the folder of a test. conelane_program() is its path.
class ProgramFixture : public FileTest {
  protected:
    struct Outcome {
        int exit_code;
        std::string output;
        std::string errors;
    };

    /// Runs `conelane ARGUMENTS` in the test's folder.
    Outcome run(const std::string& arguments) {
        const std::string command = "cd " + path("").string() + " && " + conelane_program() + " " +
                                    arguments + " >" + path("stdout").string() + " 2>" +
                                    path("stderr").string();
        const int status = std::system(command.c_str());
        Outcome outcome{WIFEXITED(status) ? WEXITSTATUS(status) : -1, text_of(path("stdout")),
                        text_of(path("stderr"))};
        std::filesystem::remove(path("stdout"));
        std::filesystem::remove(path("stderr"));
        return outcome;
    }

    /// Runs `conelane ARGUMENTS`, which has to succeed: a failure ends the test.
    Outcome run_well(const std::string& arguments) {
        Outcome outcome = run(arguments);
        if (outcome.exit_code == 0) return outcome;
        throw std::runtime_error("conelane " + arguments + " ends by " + std::to_string(outcome.exit_code) +
                                 ": " + outcome.errors);
    }

    /// Starts `conelane ARGUMENTS` in a process group of its own, with its output in files.
    [[nodiscard]] pid_t start(const std::string& arguments) const {
        const std::string command = "cd " + path("").string() + " && exec " + conelane_program() + " " +
                                    arguments + " >stdout 2>stderr";
        const pid_t child = ::fork();
        if (child == 0) {
            ::setpgid(0, 0);
            ::execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
            ::_exit(127);
        }
        ::setpgid(child, child);
        return child;
    }

    /// Sends the signal. Whether the program was still running when the signal came.
    static bool end_by(pid_t started, int signal) {
        ::kill(-started, signal);
        int status = 0;
        EXPECT_EQ(::waitpid(started, &status, 0), started);
        return WIFSIGNALED(status) && WTERMSIG(status) == signal;
    }

    /// Waits for a minute at most. Whether the condition holds.
    static bool wait_until(const std::function<bool()>& holds) {
        for (int wait = 0; wait < 60'000 && !holds(); ++wait)
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        return holds();
    }

    /// Waits until the condition holds or the program ends. Whether the condition held: a file may come and
    /// go.
    static bool wait_until(pid_t started, const std::function<bool()>& holds) {
        siginfo_t state{};
        bool held = false;
        (void)wait_until([&] {
            held = held || holds();
            return held ||
                   ::waitid(P_PID, static_cast<id_t>(started), &state, WEXITED | WNOHANG | WNOWAIT) != 0 ||
                   state.si_pid != 0;
        });
        return held;
    }

    [[nodiscard]] static std::vector<std::string> lines_of(const std::string& text) {
        std::vector<std::string> lines;
        std::istringstream stream(text);
        for (std::string line; std::getline(stream, line);) lines.push_back(line);
        return lines;
    }
    /// The JSON lines of a file.
    [[nodiscard]] std::vector<nlohmann::json> json_lines(const std::filesystem::path& name) const {
        return mapped(lines_of(text_of(path(name))),
                      [](const std::string& line) { return nlohmann::json::parse(line); });
    }
    /// The rows of results.jsonl without everything that depends on the clock, and without the record of the
    /// run, because that of a merged run names no shard.
    [[nodiscard]] std::vector<nlohmann::json> results_in(const std::string& folder) const {
        std::vector<nlohmann::json> rows = json_lines(folder + "/results.jsonl");
        for (nlohmann::json& row : rows) {
            for (const char* key :
                 {"latency_ms", "within_budget_share", "solved_share", "self_timed_ms", "run"})
                row.erase(key);
        }
        return rows;
    }
    /// Every file below a folder by its name, except the lock.
    [[nodiscard]] std::map<std::string, std::string> contents(const std::string& folder) const {
        std::map<std::string, std::string> files;
        if (!std::filesystem::exists(path(folder))) return files;
        for (const auto& entry : std::filesystem::recursive_directory_iterator(path(folder))) {
            const std::string name = entry.path().filename().string();
            if (entry.is_regular_file() && name != ".lock") files[name] = text_of(entry.path());
        }
        return files;
    }

    /// The program ends by this exit code, and its output or stderr has every one of the words.
    void expect_end(const std::string& arguments, int exit_code, const std::vector<std::string>& words) {
        const Outcome outcome = run(arguments);
        EXPECT_EQ(outcome.exit_code, exit_code) << "conelane " << arguments << ": " << outcome.errors;
        for (const std::string& word : words)
            EXPECT_THAT(outcome.output + outcome.errors, testing::HasSubstr(word))
                << "conelane " << arguments;
    }

    /// Bad input: exit code 2, one line on stderr that holds every one of `names`, and no new file.
    void expect_refused(const std::string& arguments, const std::vector<std::string>& names) {
        SCOPED_TRACE("conelane " + arguments);
        const std::size_t files_before = files_in_folder();
        const Outcome outcome = run(arguments);
        EXPECT_EQ(outcome.exit_code, 2);
        EXPECT_EQ(std::ranges::count(outcome.errors, '\n'), 1) << outcome.errors;
        for (const std::string& name : names) EXPECT_THAT(outcome.errors, testing::HasSubstr(name));
        EXPECT_EQ(files_in_folder(), files_before);
    }
};

}  // namespace conelane
