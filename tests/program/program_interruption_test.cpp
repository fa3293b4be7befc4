// Signals that end the program while it works.

#include "tests/support/program_on_scenes.hpp"

#include <csignal>

#include <fcntl.h>

namespace conelane::experiments {
namespace {

/// Whether the program already waits for the signal; it blocks the signal to do so.
bool waits_for(pid_t program, int signal) {
    std::ifstream status("/proc/" + std::to_string(program) + "/status");
    for (std::string line; std::getline(status, line);) {
        constexpr std::string_view kBlocked = "SigBlk:";
        if (line.starts_with(kBlocked))
            return (std::stoull(line.substr(kBlocked.size()), nullptr, 16) >> (signal - 1) & 1U) != 0;
    }
    return false;
}

/// Work that has begun, and a signal to the whole process group, as Ctrl-C sends it.
class Interruption : public Program {
  protected:
    /// Runs the program until `begun` says so, then ends it by the signal. Its temporary files go to `tmp`.
    void interrupt(const std::string& arguments, int signal, const std::function<bool()>& begun) {
        std::filesystem::create_directories(path("tmp"));
        ::setenv("TMPDIR", "tmp", 1);
        const pid_t child = start(arguments);
        ::unsetenv("TMPDIR");
        EXPECT_TRUE(wait_until(child, [&] { return begun() && waits_for(child, signal); }))
            << text_of(path("stderr"));
        EXPECT_TRUE(end_by(child, signal));
        EXPECT_EQ(text_of(path("stderr")), "conelane: interrupted\n");
        EXPECT_EQ(text_of(path("stdout")), "");
        EXPECT_TRUE(std::filesystem::is_empty(path("tmp")));
        for (const auto& entry : std::filesystem::recursive_directory_iterator(path("")))
            EXPECT_THAT(entry.path().string(), Not(HasSubstr(".tmp")));
    }
    /// Work that takes seconds.
    void make_dense_scenes() {
        run_well(
            "scenes --tracks generated:kidney --every 1.1 --fp 0,0.1,0.2,0.3,0.4,0.5 --out "
            "s.scenes.jsonl");
    }
};

TEST_F(Interruption, OfADetectionLeavesTheOldAnswers) {
    make_dense_scenes();
    file_with("old\n", "l.lanes.jsonl");
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
        const auto start = std::chrono::steady_clock::now();
        interrupt("detect --method rld-cbc --nearest 30 --scenes s.scenes.jsonl --out l.lanes.jsonl", signal,
                  [&] { return std::chrono::steady_clock::now() - start > std::chrono::milliseconds(400); });
        EXPECT_EQ(text_of(path("l.lanes.jsonl")), "old\n");
    }
}

TEST_F(Interruption, OfAComparisonLeavesWhatItAnsweredAndTheNextOneGoesOn) {
    const std::string compare =
        "compare --tracks generated:circle generated:kidney --every 4 --fp 0,0.1,0.2,0.3 --methods "
        "clc,rld-cbc "
        "--nearest 20 --out results";
    const auto part = path("results") / "rld-cbc.n020.lanes.jsonl.part";
    interrupt(compare, SIGINT, [&] { return !text_of(part).empty(); });
    const std::string answered = text_of(part);
    const std::string whole_laps = answered.substr(0, answered.rfind('\n') + 1);
    const std::string clc = text_of(path("results") / "clc.n020.lanes.jsonl");
    ASSERT_FALSE(std::filesystem::exists(path("results") / "rld-cbc.n020.lanes.jsonl"))
        << "it was done too early";
    run_well(compare);
    EXPECT_EQ(text_of(path("results") / "clc.n020.lanes.jsonl"), clc);
    EXPECT_TRUE(text_of(path("results") / "rld-cbc.n020.lanes.jsonl").starts_with(whole_laps.substr(0, 200)));
}

TEST_F(Interruption, OfAReportLeavesNoPage) {
    run_well("compare --tracks generated:circle --every 15 --methods clc --out results");
    if (!std::filesystem::exists(path("results") / "report.html"))
        GTEST_SKIP() << "no Python with matplotlib";
    for (const int signal : {SIGINT, SIGTERM}) {
        interrupt("report --results results --out page.html --png pictures", signal, [&] {
            for (const auto& entry : std::filesystem::recursive_directory_iterator(path("tmp"))) {
                if (entry.path().filename() == "report.zip") return true;
            }
            return false;
        });
        EXPECT_FALSE(std::filesystem::exists(path("page.html")));
        EXPECT_FALSE(std::filesystem::exists(path("pictures")));
    }
}

/// A file that is open for a long time: a stream of scenes that has not ended.
TEST_F(Interruption, OfAStreamLeavesNoTemporaryFile) {
    ASSERT_EQ(std::system(("mkfifo " + path("scenes").string()).c_str()), 0);
    const int held_open = ::open(path("scenes").c_str(), O_RDWR);
    interrupt("detect --method clc --scenes - --out l.lanes.jsonl <scenes", SIGINT, [&] {
        return std::ranges::any_of(std::filesystem::directory_iterator(path("")), [](const auto& entry) {
            return entry.path().filename().string().starts_with("l.lanes.jsonl.tmp");
        });
    });
    ::close(held_open);
    EXPECT_FALSE(std::filesystem::exists(path("l.lanes.jsonl")));
}

}  // namespace
}  // namespace conelane::experiments
