// Folders of comparisons: written, resumed, merged.

#include "evaluation/formats/atomic_file.hpp"
#include "evaluation/formats/lane_file.hpp"
#include "tests/support/program_on_scenes.hpp"
#include "tests/support/testing.hpp"

#include <nlohmann/json.hpp>

namespace conelane::experiments {
namespace {

using testing::HasSubstr;

constexpr const char* kTwoTracks =
    "compare --tracks generated:circle generated:kidney --every 15 --fp 0,0.3 --time-limit 60000 ";

TEST_F(Program, CompareWritesATableAndItsData) {
    const Outcome outcome = run_well("compare --tracks generated:circle --every 15 --fp 0,0.3 --out results");
    EXPECT_THAT(outcome.output, HasSubstr("rld-cbc n=12"));
    EXPECT_THAT(text_of(path("results") / "table.txt"), HasSubstr("CLC paper"));
    // The output on a terminal: the same methods, within its columns and lines, and where the rest is.
    const std::vector<std::string> lines = lines_of(outcome.output);
    for (const std::string& line : lines) EXPECT_LE(line.size(), 100U) << line;
    EXPECT_LE(lines.size(), 30U) << outcome.output;
    for (const char* words : {"paper", "car", "median", "p99", "wide table: results/table.txt",
                              "results/report.html", "Not usable, in % of the scenes, and why"})
        EXPECT_THAT(outcome.output, HasSubstr(words));
    for (const char* file : {"scenes.scenes.jsonl", "scenes.tracks.json", "rld-cbc.lanes.jsonl",
                             "clc.lanes.jsonl", "results.jsonl", "table.txt"}) {
        EXPECT_TRUE(std::filesystem::exists(path("results") / file)) << file;
    }
    // Scoring the stored lanes again gives the same table, and without --wide the same summary.
    std::string score = "score --scenes results/scenes.scenes.jsonl --lanes";
    for (const char* method :
         {"rld-cbc", "rld-pair", "rld-shape", "front", "clc", "clc-paper", "delaunay-beam", "astar-lane"})
        score += std::string(" results/") + method + ".lanes.jsonl";
    EXPECT_EQ(run(score + " --wide").output, text_of(path("results") / "table.txt"));
    const Outcome summary = run(score);
    EXPECT_EQ(summary.output.substr(0, summary.output.find("all measures: conelane score --wide\n")),
              outcome.output.substr(0, outcome.output.find("wide table: ")));
    expect_refused("report --results results --out page.html --png results/table.txt", {"results/table.txt"});
}

/// If one of the tables cannot be written, those of an earlier run stay unchanged.
TEST_F(Program, ScoresResultsAndTableOfAComparisonArePutInPlaceTogether) {
    const std::string compare =
        "compare --tracks generated:circle --condition paper --every 30 --fp 0 --methods clc --out r";
    run_well(compare);
    file_with("scores of before\n", "r/scores.jsonl");
    file_with("results of before\n", "r/results.jsonl");
    ASSERT_TRUE(std::filesystem::remove(path("r/table.txt")));
    ASSERT_TRUE(std::filesystem::create_directory(path("r/table.txt")));
    expect_refused(compare, {"r/table.txt", "is a folder"});
    EXPECT_EQ(text_of(path("r/scores.jsonl")), "scores of before\n");
    EXPECT_EQ(text_of(path("r/results.jsonl")), "results of before\n");
    ASSERT_TRUE(std::filesystem::remove(path("r/table.txt")));
    run_well(compare);
    EXPECT_THAT(text_of(path("r/table.txt")), HasSubstr("clc"));
    EXPECT_THAT(text_of(path("r/scores.jsonl")), HasSubstr("circle/pose_0000"));
}

// Centre lines are 25 m long, so those of poses 40 m apart cannot be compared.
TEST_F(Program, SteadinessIsKnownIfPosesHaveACommonStretch) {
    for (const auto& [every, is_known] : {std::pair{"20", true}, {"40", false}}) {
        SCOPED_TRACE(every);
        const std::string folder = std::string("every_") + every;
        run_well("compare --tracks generated:straight --methods clc --fp 0 --every " + std::string(every) +
                 " --out " + folder);
        const std::vector<nlohmann::json> rows = results_in(folder);
        ASSERT_FALSE(rows.empty());
        for (const nlohmann::json& row : rows) EXPECT_EQ(row.contains("unsteady_share"), is_known) << row;
    }
}

TEST_F(Program, RldAnswersOfAComparisonAreChecked) {
    run_well("compare --tracks generated:circle --every 15 --fp 0.3 --out results");
    for (const char* detector : {"rld-cbc", "rld-pair", "rld-shape", "clc"}) {
        for (const LaneRecord& record :
             read_lanes(path("results") / (std::string(detector) + ".lanes.jsonl"))) {
            EXPECT_EQ(record.checked,
                      std::string(detector) != "clc" && record.answer.status == LaneStatus::found);
        }
    }
    for (const nlohmann::json& row : results_in("results")) EXPECT_EQ(row.at("errors"), 0);
}

TEST_F(Program, AStoppedComparisonResumes) {
    run_well(std::string(kTwoTracks) + "--out whole");
    // The files of a run that was killed while writing: some lines, the last one incomplete.
    std::filesystem::copy(path("whole"), path("stopped"));
    const std::string lines = text_of(path("whole") / "clc.lanes.jsonl");
    for (const char* file : {"clc.lanes.jsonl", "scores.jsonl", "results.jsonl", "table.txt"}) {
        std::filesystem::remove(path("stopped") / file);
    }
    file_with(lines.substr(0, lines.size() / 2), "stopped/clc.lanes.jsonl.part");
    run_well(std::string(kTwoTracks) + "--out stopped");
    EXPECT_EQ(lanes_in(path("stopped") / "clc.lanes.jsonl"), lanes_in(path("whole") / "clc.lanes.jsonl"));
    EXPECT_FALSE(std::filesystem::exists(path("stopped") / "clc.lanes.jsonl.part"));
    EXPECT_EQ(results_in("stopped"), results_in("whole"));
    EXPECT_EQ(results_in("stopped").size(), 8U * 2U * 2U);  // detectors, conditions, rates
}

TEST_F(Program, OneComparisonAtATimeWritesIntoAFolder) {
    const std::string clc =
        "compare --tracks generated:circle --every 15 --methods clc --fp 0 --out results ";
    std::filesystem::create_directory(path("results"));
    {
        const FolderLock lock(path("results"));
        expect_refused(clc, {"results", "another conelane is writing there"});
        expect_refused(clc + "--overwrite", {"results", "another conelane is writing there"});
    }
    run_well(clc);
}

TEST_F(Program, MergedShardsEqualOneRun) {
    run_well(std::string(kTwoTracks) + "--out whole");
    for (const char* shard : {"0", "1", "2"}) {
        run_well(std::string(kTwoTracks) + "--shard " + shard + "/3 --out part" + shard);
    }
    run_well("merge part2 part0 part1 --out merged");
    EXPECT_EQ(text_of(path("merged") / "scenes.scenes.jsonl"),
              text_of(path("whole") / "scenes.scenes.jsonl"));
    for (const char* detector : {"clc.lanes.jsonl", "rld-cbc.lanes.jsonl"}) {
        EXPECT_EQ(lanes_in(path("merged") / detector), lanes_in(path("whole") / detector));
    }
    EXPECT_EQ(results_in("merged"), results_in("whole"));
    expect_refused("merge part0 part1 --out again", {"2/3 is missing"});
    expect_refused("merge part0 part1 part1 part2 --out again", {"1/3 is there twice"});
    expect_refused("merge part0 whole part2 --out again", {"whole", "shard"});
    run_well("compare --tracks generated:circle --shard 1/3 --every 15 --fp 0,0.3 --out other");
    expect_refused("merge part0 other part2 --out again", {"other", "tracks"});
    const std::string part = text_of(path("part1") / "run.json");
    expect_refused("merge part0 part1 part2 --overwrite --out part1", {"part1", "one of the shards"});
    EXPECT_EQ(text_of(path("part1") / "run.json"), part);
    expect_refused("merge part0 part1 part2 --out other", {"other", "--overwrite"});
}

/// In the second pose of these hairpins, the right boundary continues beside another leg: 12 cones against
/// 75.
TEST_F(Program, DegenerateGroundTruthsAreLeftOutAndCounted) {
    const std::string hairpins = "--tracks generated:tight_hairpins --fp 0,0.3 --every 22 ";
    const std::string degenerate = "tight_hairpins/pose_0001/fp_0.00/range_30";
    expect_end("scenes --range 30 " + hairpins + "--out s.scenes.jsonl", 0,
               {"2 scenes are left out", degenerate});
    const std::string scenes = text_of(path("s.scenes.jsonl"));
    EXPECT_THAT(scenes, testing::Not(HasSubstr("/pose_0001/")));
    EXPECT_THAT(scenes, testing::AllOf(HasSubstr("/pose_0000/"), HasSubstr("/pose_0002/")));
    const nlohmann::json track = nlohmann::json::parse(text_of(path("s.tracks.json"))).at("tight_hairpins");
    EXPECT_EQ(track.at("left_out"),
              (nlohmann::json{degenerate, "tight_hairpins/pose_0001/fp_0.30/range_30"}));

    const std::string compare = "compare --methods clc --condition paper " + hairpins;
    for (const char* shard : {"0", "1"}) {
        expect_end(compare + "--shard " + shard + "/2 --out part" + shard, 0,
                   {"1 scene is left out", "1 scene is left out"});
    }
    const Outcome merged = run_well("merge part0 part1 --out merged");
    EXPECT_THAT(text_of(path("merged") / "table.txt"), HasSubstr("2 scenes are left out"));
    EXPECT_EQ(nlohmann::json::parse(text_of(path("merged") / "scenes.tracks.json"))
                  .at("tight_hairpins")
                  .at("left_out"),
              track.at("left_out"));
    const Outcome scored =
        run("score --wide --scenes merged/scenes.scenes.jsonl --lanes merged/clc.lanes.jsonl");
    EXPECT_EQ(scored.output, text_of(path("merged") / "table.txt"));
}

TEST_F(Program, SweepComparesConeSetSizes) {
    expect_end("sweep --tracks generated:circle --sizes 8,12 --every 30 --out sweep", 0, {"  n=8  n=12"});
    EXPECT_THAT(text_of(path("sweep") / "table.txt"), HasSubstr("clc n=8"));
    for (const LaneRecord& record : read_lanes(path("sweep") / "rld-cbc.n008.lanes.jsonl")) {
        EXPECT_EQ(record.nearest, 8U);
        EXPECT_LE(record.answer.lane.left.size() + record.answer.lane.right.size(), 8U);
    }
}

}  // namespace
}  // namespace conelane::experiments
