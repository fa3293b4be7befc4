#include "experiments/comparison/runner.hpp"
#include "tests/support/file_test.hpp"

namespace conelane::experiments {
namespace {

LaneRecord record(const std::string& scene) {
    return {scene, "method", {}, 1.5, {}};
}

class LaneLogTest : public FileTest {
  protected:
    std::filesystem::path file() { return path("m.lanes.jsonl"); }
    std::filesystem::path part() { return path("m.lanes.jsonl.part"); }
};

TEST_F(LaneLogTest, GetsItsNameWhenItIsWhole) {
    LaneLog log(file());
    log.append(std::vector{record("a"), record("b")});
    EXPECT_FALSE(std::filesystem::exists(file()));
    log.finish();
    EXPECT_EQ(read_lanes(file()).size(), 2U);
    EXPECT_FALSE(std::filesystem::exists(part()));
}

TEST_F(LaneLogTest, KeepsTheWholeLinesOfAStoppedRun) {
    file_with(lane_line(record("a")) + "\n" + lane_line(record("b")) + "\n{\"scene\": \"c\", \"meth",
              "m.lanes.jsonl.part");
    LaneLog log(file());
    EXPECT_EQ(log.stored(), 2U);
    log.append(std::vector{record("c")});
    log.finish();
    const std::vector<LaneRecord> records = read_lanes(file());
    ASSERT_EQ(records.size(), 3U);
    EXPECT_EQ(records[2].scene, "c");
}

TEST_F(LaneLogTest, ForgetsLinesOnRequest) {
    file_with(lane_line(record("a")) + "\n" + lane_line(record("b")) + "\n", "m.lanes.jsonl.part");
    LaneLog log(file());
    log.keep(1);
    EXPECT_EQ(log.stored(), 1U);
    log.append(std::vector{record("z")});
    log.finish();
    EXPECT_EQ(read_lanes(file())[1].scene, "z");
}

TEST_F(LaneLogTest, SaysWhereItCannotWrite) {
    EXPECT_EQ(error_of([&] { LaneLog(path("nowhere") / "m.lanes.jsonl"); }),
              "nowhere/m.lanes.jsonl.part: cannot be written: No such file or directory");
}

}  // namespace
}  // namespace conelane::experiments
