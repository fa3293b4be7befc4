// Outputs of several files: all are written, or all stay unchanged, whether the disk is full or a signal ends
// the program. Files that the program did not write are not replaced without a request.

#include "evaluation/formats/atomic_file.hpp"
#include "tests/support/program_on_scenes.hpp"
#include "tests/support/small_disk.hpp"
#include "tests/support/test_paths.hpp"
#include "tests/support/testing.hpp"

#include <chrono>
#include <csignal>
#include <thread>

#include <sys/wait.h>
#include <unistd.h>

namespace conelane::experiments {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class WholeOutputs : public Program {
  protected:
    /// Every file of a folder by its name, except the lock.
    [[nodiscard]] std::map<std::string, std::string> contents(const std::string& folder) const {
        std::map<std::string, std::string> files;
        if (!fs::exists(path(folder))) return files;
        for (const auto& entry : fs::directory_iterator(path(folder))) {
            const std::string name = entry.path().filename().string();
            if (name != ".lock") files[name] = text_of(entry.path());
        }
        return files;
    }

    /// Starts the program and sends the signal once the folder has a file whose name contains `part`.
    void interrupt(const std::string& arguments, int signal, const std::string& folder,
                   const std::string& part) {
        const pid_t child = start(arguments);
        const auto begun = [&] {
            return std::ranges::any_of(contents(folder), [&](const auto& file) {
                return file.first.find(part) != std::string::npos;
            });
        };
        int status = 0;
        for (int wait = 0; wait < 12000 && !begun(); ++wait) {
            ASSERT_EQ(::waitpid(child, &status, WNOHANG), 0) << text_of(path("stderr"));
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
        EXPECT_TRUE(end_by(child, signal)) << "it was done too early";
        fs::remove(path("stdout"));
        fs::remove(path("stderr"));
    }
};

TEST_F(WholeOutputs, StayUnchangedIfOneNameCannotBeGiven) {
    file_with("old a", "a");
    AtomicFile a(path("a"));
    AtomicFile b(path("b"));
    AtomicFile c(path("c"));
    for (AtomicFile* file : {&a, &b, &c}) file->stream() << "new";
    fs::create_directory(path("c"));  // no file can get this name now
    EXPECT_THAT(error_of([&] {
                    commit_together(std::array{&a, &b, &c});
                }),
                HasSubstr("c: cannot be written"));
    EXPECT_EQ(text_of(path("a")), "old a");
    EXPECT_FALSE(fs::exists(path("b")));
    fs::remove(path("c"));
    EXPECT_EQ(std::ranges::count_if(
                  fs::directory_iterator(path("")),
                  [](const auto& entry) { return entry.path().filename().string().starts_with("a.tmp"); }),
              0)
        << "what was kept aside is left";
}

TEST_F(WholeOutputs, OfScenesOnAFullDiskAreNotWritten) {
    const SmallDisk disk(path("disk"), "200k");
    if (!disk.is_mounted()) GTEST_SKIP() << "no disk can be mounted here";
    const std::string scenes = "scenes --tracks generated:kidney --out disk/s.scenes.jsonl --every ";
    const Outcome full = run(scenes + "1.1");
    EXPECT_EQ(full.exit_code, 2);
    EXPECT_EQ(full.errors,
              "conelane: disk/s.scenes.jsonl: cannot be written to its end: No space left on device\n");
    EXPECT_THAT(contents("disk"), testing::IsEmpty()) << "a companion alone";
    run_well(scenes + "40");
    const auto before = contents("disk");
    EXPECT_EQ(before.size(), 2U);
    EXPECT_EQ(run(scenes + "1.1 --fp 0.4").exit_code, 2);
    EXPECT_EQ(contents("disk"), before) << "the old pair";
}

/// Few programs at first, then more with other names.
constexpr const char* kInstances =
    "instances --tracks generated:circle --fp 0.5 --every 1000 --nearest 12 --seed 3 --out made";
constexpr const char* kMoreInstances =
    "instances --tracks generated:curvy --fp 0.5 --every 30 --nearest 12,16 --seed 3 --out made";

TEST_F(WholeOutputs, OfInterruptedInstancesAreNotWritten) {
    for (const int signal : {SIGINT, SIGTERM}) {
        interrupt(kMoreInstances, signal, "made", ".mps.gz");
        EXPECT_THAT(contents("made"), testing::IsEmpty());
    }
    run_well(kInstances);
    const auto before = contents("made");
    EXPECT_EQ(before.size(), 5U);
    interrupt(kMoreInstances, SIGINT, "made", "curvy");
    EXPECT_EQ(contents("made"), before) << "the old library";
}

TEST_F(WholeOutputs, OfInstancesHoldOneLibrary) {
    run_well(kInstances);
    file_with("mine", "made/notes.txt");
    run_well("instances --tracks generated:straight --fp 0.5 --every 1000 --nearest 12 --out made");
    const auto files = contents("made");
    EXPECT_EQ(files.at("notes.txt"), "mine");
    std::size_t programs = 0;
    for (const auto& [name, text] : files) {
        if (!name.ends_with(".mps.gz")) continue;
        ++programs;
        EXPECT_TRUE(name.starts_with("straight")) << name << " is of the library before";
        EXPECT_THAT(files.at("conelane.test"), HasSubstr(name));
    }
    EXPECT_EQ(programs, 2U);
    // A program that no list names may belong to any library.
    file_with("x", "made/stray.tight.mps.gz");
    expect_refused(kInstances, {"made", "stray.tight.mps.gz", "conelane.test"});
    fs::remove(path("made/conelane.test"));
    fs::remove(path("made/stray.tight.mps.gz"));
    expect_refused(kInstances, {"made", "straight"});
}

TEST_F(WholeOutputs, OfInstancesOnAFullDiskAreNotWritten) {
    const SmallDisk disk(path("made"), "24k");
    if (!disk.is_mounted()) GTEST_SKIP() << "no disk can be mounted here";
    const Outcome full = run(kMoreInstances);
    EXPECT_EQ(full.exit_code, 2);
    EXPECT_THAT(full.errors, HasSubstr("No space left on device"));
    EXPECT_THAT(contents("made"), testing::IsEmpty());
}

constexpr const char* kCompare =
    "compare --tracks generated:circle --condition paper --fp 0 --every 30 --methods clc --out ";

TEST_F(WholeOutputs, AComparisonDoesNotReplaceAPageOfAnother) {
    fs::create_directory(path("r"));
    file_with("<html>my thesis</html>\n", "r/report.html");
    expect_refused(kCompare + std::string("r"), {"r/report.html", "is not a page of conelane"});
    expect_refused(kCompare + std::string("r --overwrite"), {"r/report.html"});
    EXPECT_EQ(contents("r").size(), 1U) << "refused before the work";
    EXPECT_EQ(text_of(path("r/report.html")), "<html>my thesis</html>\n");
}

TEST_F(WholeOutputs, AComparisonWithoutRoomForItsPageFails) {
    run_well(kCompare + std::string("r"));
    if (!fs::exists(path("r/report.html"))) GTEST_SKIP() << "no Python with matplotlib";
    std::uintmax_t results = 0;
    for (const auto& [name, text] : contents("r")) {
        if (name != "report.html") results += text.size();
    }
    const SmallDisk disk(path("disk"), std::to_string(results + fs::file_size(path("r/report.html")) / 2));
    if (!disk.is_mounted()) GTEST_SKIP() << "no disk can be mounted here";
    const Outcome full = run(kCompare + std::string("disk/r"));
    EXPECT_EQ(full.exit_code, 2) << full.output;
    EXPECT_THAT(full.errors,
                HasSubstr("disk/r/report.html: cannot be written to its end: No space left on device"));
    EXPECT_THAT(full.output, HasSubstr("results: disk/r, without a page"));
    EXPECT_FALSE(fs::exists(path("disk/r/report.html")));
    disk.grow("64m");
    run_well(kCompare + std::string("disk/r"));
    EXPECT_TRUE(fs::exists(path("disk/r/report.html")));
    EXPECT_EQ(run(kCompare + std::string("disk/r")).exit_code, 0) << "its own page is replaced";
}

TEST_F(WholeOutputs, OfAReportOnAFullDiskAreNotWritten) {
    run_well(kCompare + std::string("r"));
    if (!fs::exists(path("r/report.html"))) GTEST_SKIP() << "no Python with matplotlib";
    const SmallDisk disk(path("disk"), "64k");
    if (!disk.is_mounted()) GTEST_SKIP() << "no disk can be mounted here";
    EXPECT_EQ(run("report --results r --out page.html --png disk").exit_code, 2);
    EXPECT_THAT(contents("disk"), testing::IsEmpty()) << "some pictures";
    EXPECT_FALSE(fs::exists(path("page.html")));
}

/// /dev/full rejects every write.
TEST_F(WholeOutputs, AFailureSaysWhy) {
    make_scenes("");
    for (const char* command : {"detect --method clc", "solve --solver path-pair", "certify",
                                "export --id kidney/pose_0000/fp_0.00/range_30"}) {
        const std::string full = std::string(command) == "export --id kidney/pose_0000/fp_0.00/range_30"
                                     ? "full.mps"
                                     : "/dev/full";
        if (full == "full.mps") fs::create_symlink("/dev/full", path("full.mps"));
        const Outcome outcome = run(std::string(command) + " --scenes s.scenes.jsonl --out " + full);
        EXPECT_EQ(outcome.exit_code, 2) << command;
        EXPECT_THAT(outcome.errors, HasSubstr(": No space left on device\n")) << command;
    }
}

}  // namespace
}  // namespace conelane::experiments
