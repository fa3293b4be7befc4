#pragma once

#include "tests/support/file_test.hpp"
#include "tests/support/test_paths.hpp"
#include "tests/support/testing.hpp"

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
