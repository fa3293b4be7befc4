// Outputs of several files: all are written, or all stay unchanged, whether the disk is full or a signal ends
// the program. Files that the program did not write are not replaced without a request.

#include "evaluation/formats/atomic_file.hpp"
#include "tests/support/program_on_scenes.hpp"
#include "tests/support/small_disk.hpp"

#include <csignal>

namespace conelane::experiments {
namespace {

namespace fs = std::filesystem;

class WholeOutputs : public Program {
  protected:
    /// Starts the program and sends the signal once the folder has a file whose name contains `part`.
    void interrupt(const std::string& arguments, int signal, const std::string& folder,
                   const std::string& part) {
        const pid_t child = start(arguments);
        (void)wait_until(child, [&] {
            return std::ranges::any_of(contents(folder), [&](const auto& file) {
                return file.first.find(part) != std::string::npos;
            });
        });
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
    EXPECT_EQ(before.size(), 6U);
    interrupt(kMoreInstances, SIGINT, "made", "curvy");
    EXPECT_EQ(contents("made"), before) << "the old library";
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

}  // namespace
}  // namespace conelane::experiments
