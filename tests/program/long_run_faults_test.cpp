// Faults that a long run must survive: being killed at any time, another run in its folder, a full disk, a
// folder that cannot be written, truncated files, detectors that die. Nothing written before is lost, errors
// name the file, and the next run gives the same as an undisturbed run.

#include "evaluation/formats/lane_file.hpp"
#include "tests/support/program_fixture.hpp"
#include "tests/support/small_disk.hpp"

#include <csignal>

#include <fcntl.h>
#include <sys/file.h>

namespace conelane::experiments {
namespace {

namespace fs = std::filesystem;

class LongRun : public ProgramFixture {
  protected:
    void SetUp() override {
        ProgramFixture::SetUp();
        // Pages would take most of the time here. With this Python they fail at once, and the run goes on.
        ::setenv("PYTHONHOME", "nowhere", 1);
    }

    /// Its exit code; -1 if a signal ended it.
    static int wait_for(pid_t started) {
        int status = 0;
        EXPECT_EQ(::waitpid(started, &status, 0), started);
        return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    }

    /// Answers without their times, and the status of each.
    [[nodiscard]] std::vector<std::pair<Lane, LaneStatus>> answers(const std::string& file) const {
        return mapped(read_lanes(path(file)), [](const LaneRecord& record) {
            return std::pair(record.answer.lane, record.answer.status);
        });
    }

    /// No file under a temporary name.
    void expect_no_temporary_file() const {
        for (const auto& entry : fs::recursive_directory_iterator(path("")))
            EXPECT_THAT(entry.path().string(), testing::Not(HasSubstr(".tmp")));
    }
};

/// Four laps of a few scenes each, with a limit that no solve reaches: answers depend only on the scenes.
std::string compare(const std::string& detector, const std::string& folder, int every_m = 12) {
    return "compare --tracks generated:circle generated:kidney --condition paper --fp 0,0.3 "
           "--nearest 14 --time-limit 60000 --every " +
           std::to_string(every_m) + " --methods " + detector + " --out " + folder;
}

/// The first lines of a lanes file, with complete laps only. `whole`: the same file of a complete run.
std::string whole_laps(const std::string& lanes, const std::string& whole) {
    const auto lap_at = [&](std::size_t line) {
        const std::size_t track = whole.find("\"scene\":\"", line);
        const std::size_t pose = whole.find("/pose_", line);
        return whole.substr(track, pose - track) + whole.substr(whole.find('/', pose + 1), 8);
    };
    std::size_t laps_end = 0;
    std::size_t line_of_whole = 0;
    for (std::size_t line = 0; line < lanes.size();) {
        const std::size_t end = lanes.find('\n', line);
        if (end == std::string::npos) break;
        const std::size_t next = whole.find('\n', line_of_whole) + 1;
        if (next >= whole.size() || lap_at(next) != lap_at(line_of_whole)) laps_end = end + 1;
        line_of_whole = next;
        line = end + 1;
    }
    return lanes.substr(0, laps_end);
}

class KilledRun : public LongRun, public testing::WithParamInterface<const char*> {};

// Killed repeatedly during each solver, by a signal that cannot be caught and by Ctrl-C; each run resumes
// where the one before stopped. In the end, the result is that of an undisturbed run.
TEST_P(KilledRun, ResumesToTheResultOfAnUndisturbedRun) {
    const std::string detector = GetParam();
    constexpr int kEvery_m = 3;
    run_well(compare(detector, "whole", kEvery_m));
    const std::string lanes = detector + ".n014.lanes.jsonl";
    const fs::path part = path("killed") / (lanes + ".part");
    int killed = 0;
    for (std::size_t attempt = 0; attempt < 6; ++attempt) {
        const std::string before = whole_laps(text_of(part), text_of(path("whole") / lanes));
        const pid_t started = start(compare(detector, "killed", kEvery_m));
        // Some milliseconds after the answers of another lap: in the middle of the next one.
        wait_until(started, [&] {
            return whole_laps(text_of(part), text_of(path("whole") / lanes)).size() > before.size() ||
                   fs::exists(path("killed") / lanes);
        });
        std::this_thread::sleep_for(std::chrono::milliseconds(3 * attempt));
        if (end_by(started, attempt % 2 == 0 ? SIGKILL : SIGINT)) ++killed;
        if (fs::exists(part)) {
            EXPECT_TRUE(text_of(part).starts_with(before)) << "answers of before are lost";
        } else {
            break;
        }
    }
    EXPECT_GT(killed, 0) << "it was always done too early";
    // The line that was being written when the signal came.
    std::ofstream(path("killed/scores.jsonl.tmp4711_0")) << "half of a";
    run_well(compare(detector, "killed", kEvery_m));
    EXPECT_EQ(answers("killed/" + lanes), answers("whole/" + lanes));
    EXPECT_EQ(results_in("killed"), results_in("whole"));
    EXPECT_EQ(text_of(path("killed/scenes.scenes.jsonl")), text_of(path("whole/scenes.scenes.jsonl")));
    EXPECT_FALSE(fs::exists(part));
    expect_no_temporary_file();
}
INSTANTIATE_TEST_SUITE_P(Detectors, KilledRun,
                         testing::Values("rld-cbc", "rld-pair", "rld-shape", "clc", "front"),
                         [](const auto& tested) { return case_name(tested.param); });

class KilledSolve : public LongRun, public testing::WithParamInterface<const char*> {};

// During a solver, the old solutions stay until the new ones are complete.
TEST_P(KilledSolve, LeavesTheOldSolutions) {
    // So many scenes that even the fastest solver runs longer than a program takes to start.
    const std::string every_m = GetParam() == std::string("path-pair") ? "0.2" : "2";
    run_well("scenes --tracks generated:kidney --fp 0.3 --out s.scenes.jsonl --every " + every_m);
    const std::string solve = "solve --scenes s.scenes.jsonl --nearest 24 --time-limit 60000 --solver " +
                              std::string(GetParam()) + " --out s.solutions.jsonl";
    const auto begin = std::chrono::steady_clock::now();
    run_well(solve);
    const auto whole = std::chrono::steady_clock::now() - begin;
    const std::size_t scenes = lines_of(text_of(path("s.solutions.jsonl"))).size();
    int kept = 0;
    for (const int signal : {SIGKILL, SIGINT}) {
        for (const int part : {1, 3, 5}) {
            file_with("old\n", "s.solutions.jsonl");
            const pid_t started = start(solve);
            std::this_thread::sleep_for(whole * part / 10);
            (void)end_by(started, signal);
            const std::string left = text_of(path("s.solutions.jsonl"));
            if (left == "old\n") {
                ++kept;
            } else {
                EXPECT_EQ(lines_of(left).size(), scenes) << "neither the old ones nor all of the new ones";
            }
        }
    }
    EXPECT_GT(kept, 0) << "it was always done too early";
    run_well("solve --scenes s.scenes.jsonl --nearest 10 --solver " + std::string(GetParam()) +
             " --out s.solutions.jsonl");
    run_well("check --scenes s.scenes.jsonl --solutions s.solutions.jsonl");
}
INSTANTIATE_TEST_SUITE_P(Solvers, KilledSolve, testing::Values("path-pair", "cbc", "cbc-main", "clp-bb"),
                         [](const auto& tested) { return case_name(tested.param); });

// Killed at different times: while scenes, answers, scores and tables are written.
TEST_F(LongRun, KilledAtAnyMomentItLeavesNothingThatStopsTheNextOne) {
    run_well(compare("clc", "whole"));
    for (int after_ms = 1; after_ms < 200; after_ms += 13) {
        const pid_t started = start(compare("clc", "killed"));
        std::this_thread::sleep_for(std::chrono::milliseconds(after_ms));
        (void)end_by(started, after_ms % 2 == 0 ? SIGINT : SIGKILL);
    }
    run_well(compare("clc", "killed"));
    EXPECT_EQ(answers("killed/clc.n014.lanes.jsonl"), answers("whole/clc.n014.lanes.jsonl"));
    EXPECT_EQ(results_in("killed"), results_in("whole"));
}

TEST_F(LongRun, ASecondRunInAFolderIsRefusedAndTheFirstIsComplete) {
    run_well(compare("rld-cbc", "whole"));
    const fs::path part = path("shared/rld-cbc.n014.lanes.jsonl.part");
    // The first run is stopped in the middle of its work; if it ended too early, another one is started.
    pid_t first = -1;
    siginfo_t state{};
    for (int attempt = 0; attempt < 20 && state.si_code != CLD_STOPPED; ++attempt) {
        if (attempt > 0) (void)wait_for(first);
        first = start(compare("rld-cbc", "shared") + " --overwrite");
        wait_until(first, [&] { return fs::exists(part); });
        ::kill(-first, SIGSTOP);
        const auto process = static_cast<id_t>(first);
        ASSERT_EQ(::waitid(P_PID, process, &state, WSTOPPED | WEXITED | WNOWAIT), 0);
    }
    ASSERT_EQ(state.si_code, CLD_STOPPED) << "it was always done too early";
    const Outcome second = run(compare("clc", "shared") + " --overwrite");
    EXPECT_EQ(second.exit_code, 2);
    EXPECT_EQ(second.errors, "conelane: shared: another conelane is writing there\n");
    ::kill(-first, SIGCONT);
    EXPECT_EQ(wait_for(first), 0) << text_of(path("stderr"));
    EXPECT_EQ(answers("shared/rld-cbc.n014.lanes.jsonl"), answers("whole/rld-cbc.n014.lanes.jsonl"));
    EXPECT_EQ(results_in("shared"), results_in("whole"));
}

// The disk is full after the scenes, after half of the answers, or in the scores. The files that fit stay,
// and with enough space the run resumes.
TEST_F(LongRun, AFullDiskIsNamedAndNothingIsLost) {
    run_well(compare("clc", "whole"));
    std::uintmax_t scenes = 0;
    for (const auto& [name, text] : contents("whole"))
        if (name.starts_with("scenes.")) scenes += text.size();
    int full = 0;
    for (const std::uintmax_t more : {0, 4096, 8192, 16384, 32768, 65536}) {
        const SmallDisk disk(path("disk"), std::to_string(scenes + 8192 + more));
        if (!disk.is_mounted()) GTEST_SKIP() << "no disk can be mounted here";
        const Outcome outcome = run(compare("clc", "disk/results"));
        if (outcome.exit_code == 0) break;
        ++full;
        EXPECT_EQ(outcome.exit_code, 2);
        EXPECT_EQ(std::ranges::count(outcome.errors, '\n'), 1) << outcome.errors;
        EXPECT_THAT(outcome.errors, HasSubstr("disk/results/"));
        EXPECT_THAT(outcome.errors, HasSubstr("cannot be written"));
        const std::map<std::string, std::string> kept = contents("disk/results");
        for (const auto& [name, text] : kept) EXPECT_THAT(name, testing::Not(HasSubstr(".tmp")));
        disk.grow("64m");
        run_well(compare("clc", "disk/results"));
        EXPECT_EQ(answers("disk/results/clc.n014.lanes.jsonl"), answers("whole/clc.n014.lanes.jsonl"));
        EXPECT_EQ(results_in("disk/results"), results_in("whole"));
        // Complete laps of the earlier run are kept with their times.
        for (const char* lanes : {"clc.n014.lanes.jsonl", "clc.n014.lanes.jsonl.part"}) {
            const auto before = kept.find(lanes);
            if (before == kept.end() || before->second.empty()) continue;
            const std::string now = text_of(path("disk/results/clc.n014.lanes.jsonl"));
            EXPECT_EQ(now.substr(0, 100), before->second.substr(0, 100));
        }
    }
    EXPECT_GE(full, 2);
}

TEST_F(LongRun, AFolderThatCannotBeWrittenIsNamed) {
    file_with("mine\n", "file");
    expect_refused(compare("clc", "file"), {"file"});
    expect_refused(compare("clc", "file/below"), {"file/below"});
    expect_refused(compare("clc", "/proc/results"), {"/proc/results"});
    EXPECT_EQ(text_of(path("file")), "mine\n");
    const SmallDisk disk(path("disk"), "16m");
    if (!disk.is_mounted()) GTEST_SKIP() << "no disk can be mounted here";
    run_well(compare("clc", "disk/results"));
    const auto before = contents("disk/results");
    disk.make_read_only(true);
    for (const char* folder : {"disk/results", "disk/others"}) {
        const Outcome outcome = run(compare("clc", folder) + " --overwrite");
        EXPECT_EQ(outcome.exit_code, 2);
        EXPECT_THAT(outcome.errors, HasSubstr(folder));
        EXPECT_EQ(std::ranges::count(outcome.errors, '\n'), 1) << outcome.errors;
    }
    EXPECT_EQ(contents("disk/results"), before);
    disk.make_read_only(false);
}

/// Each file of a finished comparison, truncated in the middle of a line, as after a power failure.
TEST_F(LongRun, TruncatedFilesAreReplacedOrNamed) {
    run_well(compare("clc", "whole"));
    const auto cut = [&](const std::string& name, std::size_t length) {
        fs::remove_all(path("cut"));
        fs::copy(path("whole"), path("cut"), fs::copy_options::recursive);
        fs::resize_file(path("cut/" + name), length);
    };
    // They are made again from the existing files.
    for (const char* name :
         {"results.jsonl", "scores.jsonl", "table.txt", "scenes.scenes.jsonl", "scenes.tracks.json"}) {
        SCOPED_TRACE(name);
        cut(name, text_of(path("whole") / name).size() / 2);
        run_well(compare("clc", "cut"));
        EXPECT_EQ(text_of(path("cut") / name), text_of(path("whole") / name));
    }
    // Answers under their final name are trusted, so a truncated line is an error that names it.
    const std::string lanes = text_of(path("whole/clc.n014.lanes.jsonl"));
    cut("clc.n014.lanes.jsonl", lanes.size() / 2);
    const std::string left = text_of(path("cut/clc.n014.lanes.jsonl"));
    const auto lines = std::ranges::count(left, '\n');
    expect_refused(compare("clc", "cut"), {"cut/clc.n014.lanes.jsonl:" + std::to_string(lines + 1)});
    EXPECT_EQ(text_of(path("cut/clc.n014.lanes.jsonl")), left);
    // Complete lines, but too few.
    cut("clc.n014.lanes.jsonl", left.rfind('\n') + 1);
    expect_refused(compare("clc", "cut"), {"cut/clc.n014.lanes.jsonl"});
    // Without its record, nobody knows which options the answers belong to.
    for (const std::size_t length : {std::size_t{0}, std::size_t{20}}) {
        cut("run.json", length);
        const auto before = contents("cut");
        expect_refused(compare("clc", "cut"), {"cut/run.json"});
        EXPECT_EQ(contents("cut"), before);
        run_well(compare("clc", "cut") + " --overwrite");
        EXPECT_EQ(answers("cut/clc.n014.lanes.jsonl"), answers("whole/clc.n014.lanes.jsonl"));
    }
    for (const char* text : {"5\n", "[1]\n", "null\n", "\"run\"\n"}) {
        cut("run.json", 0);
        file_with(text, "cut/run.json");
        expect_refused(compare("clc", "cut"), {"cut"});
    }
}

/// A detector from outside that dies, hangs, or prints an invalid answer; it is killed together with the run.
TEST_F(LongRun, DetectorsFromOutsideThatFailCostTheirAnswersAndNoOthers) {
    const std::string child = outside_child();
    run_well(compare("clc", "whole"));
    for (const char* fault : {"crash", "hang", "nonsense", "half-a-line", "endless-line"}) {
        SCOPED_TRACE(fault);
        const std::string folder = std::string("with_") + fault;
        const std::string detector =
            "'exec:other=" + child + " ids " + fault + " 5 " + fault + ".marker' clc";
        const Outcome outcome = run_well(compare(detector, folder));
        EXPECT_THAT(text_of(path(folder + "/table.txt")), HasSubstr("answers are errors"));
        EXPECT_THAT(outcome.errors, HasSubstr("other"));
        const auto others = answers(folder + "/other.n014.lanes.jsonl");
        const auto expected = answers("whole/clc.n014.lanes.jsonl");
        ASSERT_EQ(others.size(), expected.size());
        const auto is_error = [](const auto& other) { return other.second == LaneStatus::error; };
        EXPECT_EQ(std::ranges::count_if(others, is_error), 1) << "one fault, one scene";
        EXPECT_EQ(answers(folder + "/clc.n014.lanes.jsonl"), expected);
    }
}

}  // namespace
}  // namespace conelane::experiments
