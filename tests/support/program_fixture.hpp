#pragma once

#include "tests/support/file_test.hpp"
#include "tests/support/test_paths.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
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
