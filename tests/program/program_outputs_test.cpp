// Outputs of the program: it tries them before the work, never overwrites its input, and keeps an old result
// until a new one is complete.

#include "evaluation/formats/parameter_file.hpp"
#include "tests/support/program_on_scenes.hpp"
#include "tests/support/test_paths.hpp"
#include "tests/support/testing.hpp"

#include <chrono>
#include <thread>

#include <sys/wait.h>

namespace conelane::experiments {
namespace {

using testing::HasSubstr;
using testing::Not;

/// The work does not begin if its result cannot be written: the invalid scenes would be reported first.
TEST_F(Program, OutputsAreTriedBeforeTheWork) {
    file_with("{", "bad.scenes.jsonl");
    std::filesystem::create_directory(path("folder"));
    for (const char* command :
         {"detect --method clc", "solve", "certify", "study formulations", "study backends",
          "study optimality", "study relaxations", "export --id a", "import-solution --id a --sol a.sol"}) {
        const std::string begun = std::string(command) + " --scenes bad.scenes.jsonl --out ";
        expect_refused(begun + "nowhere/x.lp", {"--out", "nowhere/x.lp"});
        expect_refused(begun + "folder", {"--out", "folder"});
    }
    expect_refused("score --scenes bad.scenes.jsonl --lanes x.lanes.jsonl --json nowhere/x",
                   {"--json", "nowhere/x"});
    expect_refused("tune --tracks generated:nowhere --out nowhere/p.json", {"--out", "nowhere/p.json"});
    expect_refused("scenes --tracks generated:circle --every 60 --out folder", {"--out", "folder"});
}

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
    for (int wait = 0; wait < 100 && text_of(path("read")).empty(); ++wait) {
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    EXPECT_THAT(text_of(path("read")), HasSubstr("\"scene\":\"a\""));
}

TEST_F(Program, AFileThatCannotBeReadLeavesTheOldResult) {
    file_with("old\n", "x.lanes.jsonl");
    file_with("{", "bad.scenes.jsonl");
    EXPECT_EQ(run("detect --method clc --scenes bad.scenes.jsonl --out x.lanes.jsonl").exit_code, 2);
    EXPECT_EQ(text_of(path("x.lanes.jsonl")), "old\n");
}

/// Through another name, links or the companion: no input is overwritten.
TEST_F(Program, AnOutputMustNotBeAnInput) {
    make_scenes("--fp 0.2");
    const std::string scenes = text_of(path("s.scenes.jsonl"));
    std::filesystem::create_symlink(path("s.scenes.jsonl"), path("link"));
    std::filesystem::create_hard_link(path("s.scenes.jsonl"), path("hard"));
    std::filesystem::create_directory(path("sub"));
    for (const char* command : {"detect --method clc", "solve", "certify", "export --id a"}) {
        for (const char* out :
             {"s.scenes.jsonl", "./sub/../s.scenes.jsonl", "link", "hard", "s.tracks.json"}) {
            expect_refused(std::string(command) + " --scenes s.scenes.jsonl --out " + out,
                           {"--out", out, "--scenes"});
        }
        expect_refused(std::string(command) + " --scenes link --out s.scenes.jsonl", {"--out", "--scenes"});
    }
    run_well("detect --method clc --scenes s.scenes.jsonl --out l.lanes.jsonl");
    expect_refused("score --scenes s.scenes.jsonl --lanes l.lanes.jsonl --json l.lanes.jsonl",
                   {"--json", "l.lanes.jsonl", "--lanes"});
    run_well("certify --scenes s.scenes.jsonl --out c.certificates.jsonl");
    write_rld_parameters(path("p.json"), RldParameters{});
    expect_refused("solve --scenes s.scenes.jsonl --params p.json --out p.json", {"--out", "--params"});
    file_with("tag,x,y,direction,x_variance,y_variance,xy_covariance\n", "t.csv");
    expect_refused("scenes --tracks eufs:t.csv --out t.csv", {"--out", "--tracks"});
    std::filesystem::create_directory(path("r"));
    file_with("", "r/results.jsonl");
    expect_refused("report --results r --out r/results.jsonl", {"--out", "--results"});
    EXPECT_EQ(text_of(path("s.scenes.jsonl")), scenes);
    // A value that is not a file may be the name of a file.
    run_well("detect --method clc --scenes s.scenes.jsonl --out clc");
    run_well("detect --method clc --scenes s.scenes.jsonl --out clc");
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
