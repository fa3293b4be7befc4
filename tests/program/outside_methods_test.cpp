// Detectors from outside through the real program: the answers of programs and files, and that nothing a
// program does harms the run.

#include "evaluation/formats/lane_file.hpp"
#include "evaluation/formats/scene_file.hpp"
#include "tests/support/program_fixture.hpp"

#include <csignal>

namespace conelane::experiments {
namespace {

using nlohmann::json;

/// Two laps of 6 scenes.
constexpr const char* kCompare =
    "compare --tracks generated:circle --condition paper --every 15 --fp 0,0.3 --time-limit 60000 --out ";
constexpr const char* kLaps =
    "compare --tracks generated:circle generated:kidney --every 20 --fp 0,0.3 --out ";

std::string child(const std::string& arguments) {
    return outside_child() + " " + arguments;
}

class OutsideDetectors : public ProgramFixture {
  protected:
    [[nodiscard]] std::vector<LaneRecord> lanes(const std::string& name) const {
        return read_lanes(path(name + ".lanes.jsonl"));
    }
    static std::vector<Lane> only_lanes(const std::vector<LaneRecord>& records) {
        return mapped(records, [](const LaneRecord& record) { return record.answer.lane; });
    }
    /// Whether the process with the number in the file ends. A zombie, which nobody has
    /// waited for (if the container has no init), has ended.
    [[nodiscard]] bool has_ended(const std::string& file) const {
        return wait_until([&] {
            const std::string number = text_of(path(file)).substr(0, text_of(path(file)).find('\n'));
            const std::string state = text_of("/proc/" + number + "/stat");
            return state.empty() || state.find(") Z ") != std::string::npos;
        });
    }
};

TEST_F(OutsideDetectors, ConeIdsScoreAsTheDetectorBehindThemAndTimesAreShown) {
    const std::string summary =
        run_well(std::string(kCompare) + "r --methods clc 'exec:other=" + child("ids") + "'").output;
    const std::string table = text_of(path("r/table.txt"));
    EXPECT_EQ(only_lanes(lanes("r/other")), only_lanes(lanes("r/clc")));
    for (const LaneRecord& record : lanes("r/other")) {
        EXPECT_EQ(record.detector, "other");
        EXPECT_EQ(record.self_timed_ms, 0.25);
        EXPECT_GT(record.latency_ms, 0.0);
    }
    EXPECT_THAT(table, HasSubstr("  other: latency is the round trip"));
    EXPECT_THAT(table, HasSubstr("self-timed 0.25 ms (median)"));
    EXPECT_THAT(summary, HasSubstr("from outside, with notes below the wide table: other\n"));
    std::map<std::string, std::vector<json>> rows;
    for (const json& row : json_lines("r/results.jsonl")) rows[row["method"]].push_back(row);
    ASSERT_EQ(rows["other"].size(), rows["clc"].size());
    for (std::size_t i = 0; i < rows["other"].size(); ++i) {
        const json& row = rows["other"][i];
        EXPECT_EQ(row["usable_share"], rows["clc"][i]["usable_share"]);
        EXPECT_EQ(row["outside"], "exec");
        EXPECT_EQ(row["self_timed_ms"]["median"], 0.25);
        EXPECT_GT(row["latency_ms"]["median"], 0.0);
        EXPECT_FALSE(rows["clc"][i].contains("outside"));
    }
}

/// The child gets only what a detector may know, lap by lap, with ids that reveal nothing.
TEST_F(OutsideDetectors, AProgramSeesScenesWithoutWhatIsForScoring) {
    run_well(std::string(kLaps) + "r --condition car --methods 'exec:other=OUTSIDE_LOG=log " + child("ids") +
             "'");
    const std::vector<AnnotatedScene> scenes = read_scenes(path("r/scenes.scenes.jsonl"));
    std::vector<json> told = json_lines("log");
    ASSERT_GE(told.size(), 3U);
    const json reset{{"reset", true}};
    EXPECT_EQ(told[0], reset);
    EXPECT_EQ(told[1]["cones"], told[3]["cones"]) << "its first answer is not timed";
    EXPECT_EQ(told[2], reset);
    told.erase(told.begin(), told.begin() + 2);
    std::size_t next = 0;
    for (std::size_t i = 0; i < scenes.size(); ++i) {
        const AnnotatedScene& scene = scenes[i];
        if (i == 0 || scenes[i - 1].track != scene.track ||
            scenes[i - 1].false_positive_rate != scene.false_positive_rate) {
            EXPECT_EQ(told.at(next++), reset) << scene.scene.id;
        }
        const json& seen = told.at(next++);
        EXPECT_EQ(seen.size(), 3U) << seen;
        EXPECT_EQ(seen["id"], std::to_string(i + 2));
        EXPECT_EQ(seen["pose"]["x"], scene.scene.pose.position.x());
        ASSERT_EQ(seen["cones"].size(), scene.scene.cones.size());
        EXPECT_EQ(seen["cones"][0]["id"], scene.scene.cones[0].id);
    }
    EXPECT_EQ(next, told.size());
}

TEST_F(OutsideDetectors, PointsAtConesCountAsTheseCones) {
    run_well(std::string(kCompare) + "r --methods clc 'exec:near=" + child("points") +
             "' 'exec:beside=" + child("points-beside") + "'");
    EXPECT_EQ(only_lanes(lanes("r/near")), only_lanes(lanes("r/clc")));
    const std::vector<LaneRecord> clc = lanes("r/clc");
    const std::vector<LaneRecord> beside = lanes("r/beside");
    ASSERT_EQ(beside.size(), clc.size());
    for (std::size_t i = 0; i < beside.size(); ++i) {
        EXPECT_TRUE(beside[i].answer.lane.left.empty());
        ASSERT_TRUE(beside[i].points);
        EXPECT_EQ(beside[i].points->left.size(), clc[i].answer.lane.left.size());
        EXPECT_EQ(beside[i].answer.lane.closed, clc[i].answer.lane.closed);
    }
    for (const json& row : json_lines("r/results.jsonl")) {
        if (row["method"] != "beside") continue;
        EXPECT_EQ(row["usable_share"], 1.0) << "0.4 m aside it can be driven by";
        EXPECT_GT(row["mean_iou"], 0.8);
        EXPECT_LT(row["mean_iou"], 0.99);
        EXPECT_FALSE(row.contains("accurate_share"));
    }
}

TEST_F(OutsideDetectors, ACentreLineIsScoredByWhereItLeads) {
    run_well(std::string(kCompare) + "r --methods clc 'exec:line=" + child("centre-line") + "'");
    for (const LaneRecord& record : lanes("r/line")) EXPECT_GT(record.centre_line.size(), 10U);
    for (const json& row : json_lines("r/results.jsonl")) {
        if (row["method"] != "line") continue;
        EXPECT_EQ(row["usable_share"], 1.0);
        EXPECT_LT(row["lateral_p95_m"], 0.2);
        EXPECT_FALSE(row.contains("mean_iou"));
    }
    const json score = json_lines("r/scores.jsonl").back();
    EXPECT_EQ(score["method"], "line");
    EXPECT_TRUE(score.contains("lateral_median_m"));
}

struct Fault {
    std::string name;
    std::string message;
    /// The index of the error: if the program writes too much, the next answer is the error.
    std::size_t place = 2;
    friend void PrintTo(const Fault& fault, std::ostream* out) { *out << fault.name; }
};
class OutsideFaults : public OutsideDetectors, public testing::WithParamInterface<Fault> {};

/// Its fourth scene is the third of the run, because the first one is asked twice.
TEST_P(OutsideFaults, CostOneAnswerAndTheRunGoesOn) {
    run_well("scenes --tracks generated:kidney --every 20 --fp 0.2 --out s.scenes.jsonl");
    run_well("detect --method clc --time-limit 60000 --scenes s.scenes.jsonl --out clc.lanes.jsonl");
    const auto start = std::chrono::steady_clock::now();
    run_well(
        "detect --scenes s.scenes.jsonl --out bad.lanes.jsonl --method 'exec:bad=exec env OUTSIDE_PID=pid " +
        child("ids " + GetParam().name + " 4 marker") + "'");
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(30));
    ASSERT_TRUE(std::filesystem::exists(path("marker"))) << "the fault was not committed";
    const std::vector<LaneRecord> clc = lanes("clc");
    const std::vector<LaneRecord> bad = lanes("bad");
    ASSERT_GT(clc.size(), 4U);
    ASSERT_EQ(bad.size(), clc.size());
    for (std::size_t i = 0; i < bad.size(); ++i) {
        SCOPED_TRACE(i);
        EXPECT_EQ(bad[i].scene, clc[i].scene);
        if (i == GetParam().place) {
            EXPECT_EQ(bad[i].answer.status, LaneStatus::error);
            EXPECT_THAT(bad[i].answer.message, HasSubstr(GetParam().message));
        } else {
            EXPECT_EQ(bad[i].answer.lane, clc[i].answer.lane) << bad[i].answer.message;
        }
    }
    EXPECT_TRUE(has_ended("pid"));
}

INSTANTIATE_TEST_SUITE_P(
    Each, OutsideFaults,
    testing::Values(Fault{"crash", "signal 6; it said: what went wrong"}, Fault{"exit", "exit code 3"},
                    Fault{"hang", "no answer within 2000 ms"},
                    Fault{"half-a-line", "no answer within 2000 ms"},
                    Fault{"endless-line", "more than 4194304 bytes without a newline"},
                    Fault{"endless-errors", "no answer within 2000 ms"},
                    Fault{"closed-streams", "the program ended"}, Fault{"forked", "no answer within 2000 ms"},
                    Fault{"nonsense", "not valid JSON at column 1"}, Fault{"array", "must be a JSON object"},
                    Fault{"nan", "latency_ms: must be a finite number"},
                    Fault{"wrong-scene", "answers scene \"another\" instead of \"4\""},
                    Fault{"no-scene", "scene: is missing"},
                    Fault{"unknown-id", "left: no cone of the scene has id 987654321"},
                    Fault{"cone-twice", "is there twice"}, Fault{"wrong-type", "left: must be an array"},
                    Fault{"lane-of-none", "left: must be empty if status is none"},
                    Fault{"far-point", "left_points: a point is farther"},
                    Fault{"two-lines", "answers scene \"4\" instead of \"5\"", 3}),
    [](const auto& param) {
        std::string name = param.param.name;
        std::erase(name, '-');
        return name;
    });

TEST_F(OutsideDetectors, ASignalEndsTheProgramToo) {
    const pid_t program = start(std::string(kCompare) + "r --methods 'exec:bad=OUTSIDE_PID=pid " +
                                child("ids hang 3 marker") + "'");
    EXPECT_TRUE(wait_until([&] { return !text_of(path("marker")).empty(); }));
    ::kill(program, SIGINT);  // not to its children
    int status = 0;
    ASSERT_EQ(::waitpid(program, &status, 0), program);
    EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGINT) << "status " << status;
    EXPECT_TRUE(has_ended("pid"));
}

TEST_F(OutsideDetectors, AStoppedComparisonResumesAndAChangedCommandIsAnother) {
    const std::string detectors = " --methods 'exec:other=OUTSIDE_LOG=log " + child("ids") + "'";
    run_well(kLaps + std::string("whole") + detectors);
    std::filesystem::copy(path("whole"), path("stopped"));
    const std::string all = text_of(path("whole/other.lanes.jsonl"));
    for (const char* file : {"other.lanes.jsonl", "scores.jsonl", "results.jsonl", "table.txt"})
        std::filesystem::remove(path("stopped") / file);
    file_with(all.substr(0, all.size() / 2), "stopped/other.lanes.jsonl.part");
    const auto asked = [&] { return json_lines("log").size(); };
    const std::size_t asked_for_all = asked();
    std::filesystem::remove(path("log"));
    run_well(kLaps + std::string("stopped") + detectors);
    EXPECT_EQ(only_lanes(lanes("stopped/other")), only_lanes(lanes("whole/other")));
    EXPECT_LT(asked(), asked_for_all);
    EXPECT_TRUE(text_of(path("stopped/other.lanes.jsonl")).starts_with(all.substr(0, 200)))
        << "kept with its times";
    expect_refused(kLaps + std::string("stopped --methods 'exec:other=") + child("points") + "'",
                   {"differs in methods", "--overwrite"});
}

TEST_F(OutsideDetectors, ShardsAndThreadsGiveTheAnswersOfOneRun) {
    const std::string card = R"({"name": "A stranger", "licence": "MIT", "colour_used": false})";
    const std::string never_stopped = " --time-limit 60000";
    run_well(kLaps + std::string("first --methods clc") + never_stopped);
    std::filesystem::copy(path("first/clc.lanes.jsonl"), path("theirs.lanes.jsonl"));
    file_with(card, "theirs.method.json");
    const std::string detectors =
        never_stopped + " --methods 'lanes:file=theirs.lanes.jsonl,exec:other=" + child("ids") + "'";
    run_well(kLaps + std::string("whole") + detectors);
    for (const char* shard : {"0", "1"})
        run_well(kLaps + std::string("part") + shard + detectors + " --shard " + shard + "/2");
    run_well("merge part1 part0 --out merged");
    const std::string table = text_of(path("merged/table.txt"));
    EXPECT_THAT(table, HasSubstr("A stranger; licence MIT; no colour"));
    run_well(kLaps + std::string("threads --threads 4") + detectors);
    for (const char* run : {"merged", "threads"}) {
        for (const char* detector : {"file", "other"}) {
            EXPECT_EQ(only_lanes(lanes(std::string(run) + "/" + detector)), only_lanes(lanes("first/clc")))
                << run << " " << detector;
        }
    }
}

std::vector<double> objectives(const std::vector<LaneRecord>& records) {
    return mapped(records, [](const LaneRecord& record) {
        return record.answer.optimality ? record.answer.optimality->objective : 0.0;
    });
}

/// The child solves its programs with CBC, so its optima are those of rld-pair.
TEST_F(OutsideDetectors, ASolverFromOutsideIsRldAtEachConeSetSize) {
    run_well(
        "sweep --tracks generated:circle --condition paper --sizes 6,8 --every 30 --fp 0.2 --time-limit "
        "60000 --out r "
        "--methods rld-pair 'solver:child=" +
        solver_child() + "' 'solver:printed/paper=" + solver_child() + " once {mps} {sol}'");
    for (const std::string size : {".n006", ".n008"}) {
        const std::vector<LaneRecord> expected = lanes("r/rld-pair" + size);
        for (const std::string solver : {"child", "printed"}) {
            const std::vector<LaneRecord> found = lanes("r/" + solver + size);
            ASSERT_EQ(found.size(), expected.size());
            EXPECT_THAT(objectives(found),
                        testing::Pointwise(testing::DoubleNear(1e-5), objectives(expected)));
            for (std::size_t i = 0; i < found.size(); ++i) {
                EXPECT_EQ(found[i].answer.status, expected[i].answer.status) << found[i].answer.message;
                EXPECT_EQ(found[i].nearest, expected[i].nearest);
            }
        }
    }
    EXPECT_THAT(
        text_of(path("r/table.txt")),
        HasSubstr("  printed: RLD by a solver from outside, paper formulation; latency includes files"));
    const json record = json::parse(text_of(path("r/run.json")));
    EXPECT_EQ(record["methods"][4]["formulation"], "paper");
    EXPECT_EQ(record["methods"][4]["rld_parameters"], record["methods"][0]["rld_parameters"]);
    EXPECT_EQ(record["methods"][2]["solver"], solver_child());
    for (const json& row : json_lines("r/results.jsonl")) EXPECT_EQ(row["errors"], 0) << row;
}

}  // namespace
}  // namespace conelane::experiments
