// Outputs of the program: it tries them before the work, never overwrites its input, and keeps an old result
// until a new one is complete.

#include "tests/support/program_on_scenes.hpp"
#include "tests/support/test_paths.hpp"
#include "tests/support/testing.hpp"

#include <sys/wait.h>

namespace conelane::experiments {
namespace {

using testing::HasSubstr;
using testing::Not;

/// A file that was tried but not written stays; a pipe is not tried, because that would end it.
TEST_F(Program, TryingAnOutputLeavesItAsItWas) {
    file_with("old\n", "x.lanes.jsonl");
    expect_refused("detect --method clc --scenes nowhere.scenes.jsonl --out x.lanes.jsonl", {"nowhere"});
    EXPECT_EQ(text_of(path("x.lanes.jsonl")), "old\n");
    file_with(std::string(kScene) + "\n", "a.scenes.jsonl");
    const std::string pipe = path("pipe").string();
    ASSERT_EQ(
        std::system(("mkfifo " + pipe + " && (timeout 60 cat " + pipe + " >" + path("read").string() + " &)")
                        .c_str()),
        0);
    run_well("detect --method clc --scenes a.scenes.jsonl --out pipe");
    EXPECT_TRUE(
        wait_until([&] { return text_of(path("read")).find("\"scene\":\"a\"") != std::string::npos; }));
}

TEST_F(Program, AnOutputThatIsNotWrittenIsAFailure) {
    make_scenes("--fp 0.2");
    run_well("detect --method clc --scenes s.scenes.jsonl --out l.lanes.jsonl");
    const auto exit_code = [&](const std::string& arguments) {
        const std::string command = "cd " + path("").string() + " && " + conelane_program() + " " +
                                    arguments + " 2>" + path("stderr").string();
        return WEXITSTATUS(std::system(command.c_str()));
    };
    for (const char* command :
         {"methods", "--version", "--help", "score --scenes s.scenes.jsonl --lanes l.lanes.jsonl"}) {
        for (const auto& [stream, reason] : {std::pair{" >/dev/full", "No space left on device"},
                                             std::pair{" >&-", "Bad file descriptor"}}) {
            EXPECT_EQ(exit_code(std::string(command) + stream), 2) << command << stream;
            EXPECT_EQ(text_of(path("stderr")),
                      std::string("conelane: standard output cannot be written to its end: ") + reason + "\n")
                << command << stream;
        }
    }
    EXPECT_EQ(exit_code("detect --method clc --scenes s.scenes.jsonl --out - >/dev/full"), 2);
    EXPECT_EQ(text_of(path("stderr")),
              "conelane: standard output cannot be written to its end: No space left on device\n");
    // The number of a closed output is not given to the next file that is opened.
    EXPECT_EQ(exit_code("scenes --tracks generated:circle --every 40 --out c.scenes.jsonl >&-"), 2);
    EXPECT_THAT(text_of(path("c.scenes.jsonl")), Not(HasSubstr("boundaries in")));
    EXPECT_EQ(exit_code("detect --method clc --scenes s.scenes.jsonl --out m.lanes.jsonl >&-"), 0)
        << "it has nothing to say";
}

}  // namespace
}  // namespace conelane::experiments
