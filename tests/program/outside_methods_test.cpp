// Detectors from outside through the real program: the answers of programs and files, and that nothing a
// program does harms the run.

#include "evaluation/formats/lane_file.hpp"
#include "evaluation/formats/scene_file.hpp"
#include "tests/support/program_fixture.hpp"
#include "tests/support/test_paths.hpp"
#include "tests/support/testing.hpp"

#include <chrono>
#include <csignal>

#include <nlohmann/json.hpp>
#include <sys/wait.h>

namespace conelane::experiments {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

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
        std::vector<Lane> all;
        for (const LaneRecord& record : records) all.push_back(record.answer.lane);
        return all;
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
    run_well("detect --method clc --scenes s.scenes.jsonl --out clc.lanes.jsonl");
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

TEST_F(OutsideDetectors, AMissingProgramGivesErrorsAtOnce) {
    const auto start = std::chrono::steady_clock::now();
    const Outcome outcome = run(std::string(kCompare) + "r --methods 'exec:none=nowhere --to be, found'");
    EXPECT_EQ(outcome.exit_code, 1) << "nothing was answered";
    const std::string table = text_of(path("r/table.txt"));
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(20));
    for (const LaneRecord& record : lanes("r/none")) EXPECT_EQ(record.answer.status, LaneStatus::error);
    const std::string count = std::to_string(lanes("r/none").size());
    EXPECT_THAT(table,
                HasSubstr(count + " of " + count + " answers are errors, the first to circle/pose_0000"));
    EXPECT_THAT(table, HasSubstr("nowhere: not found"));
}

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
    run_well(kLaps + std::string("first --methods clc"));
    std::filesystem::copy(path("first/clc.lanes.jsonl"), path("theirs.lanes.jsonl"));
    file_with(card, "theirs.method.json");
    const std::string detectors =
        " --methods 'lanes:file=theirs.lanes.jsonl,exec:other=" + child("ids") + "'";
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

/// Answers of a run elsewhere, to some of the scenes and to others.
class FinishedLanes : public OutsideDetectors {
  protected:
    void SetUp() override {
        OutsideDetectors::SetUp();
        run_well("scenes --tracks generated:kidney --every 20 --fp 0.2 --seed 3 --out s.scenes.jsonl");
        run_well("detect --method clc --scenes s.scenes.jsonl --out clc.lanes.jsonl");
        clc_ = json_lines("clc.lanes.jsonl");
    }
    void write_theirs(const std::vector<json>& lines) const {
        std::string text;
        for (const json& line : lines) text += line.dump() + "\n";
        file_with(text, "theirs.lanes.jsonl");
    }
    /// Rows of `score` for the lanes of `clc` and these.
    std::vector<json> rows() {
        table_ = run_well(
                     "score --scenes s.scenes.jsonl --lanes clc.lanes.jsonl --methods "
                     "lanes:them=theirs.lanes.jsonl "
                     "--json rows --wide")
                     .output;
        return json_lines("rows");
    }

    std::vector<json> clc_;
    std::string table_;
};

TEST_F(FinishedLanes, AreScoredUnderTheirNameWithTheirTimes) {
    std::vector<json> theirs(clc_.rbegin(), clc_.rend());
    for (json& line : theirs) {
        line["latency_ms"] = 7.5;
        line.erase("method");
    }
    theirs.push_back({{"scene", "of another set"}, {"status", "none"}, {"latency_ms", 1}});
    write_theirs(theirs);
    const std::vector<json> both = rows();
    ASSERT_EQ(both.size(), 2U);
    EXPECT_EQ(both[1]["method"], "them");
    EXPECT_EQ(both[1]["outside"], "lanes");
    EXPECT_EQ(both[1]["usable_share"], both[0]["usable_share"]);
    EXPECT_EQ(both[1]["mean_iou"], both[0]["mean_iou"]);
    EXPECT_EQ(both[1]["latency_ms"]["max"], 7.5);
    EXPECT_THAT(table_, HasSubstr("them: latency is self-timed, as the lanes file says"));
}

TEST_F(FinishedLanes, ThatMissAnAnswerCountItAsAnError) {
    write_theirs({clc_.begin() + 1, clc_.end()});
    EXPECT_EQ(rows()[1]["errors"], 1);
    EXPECT_THAT(table_, HasSubstr("the lanes file has no answer to this scene"));
}

TEST_F(OutsideDetectors, TheirCardsAreInTheRecordAndTheRows) {
    file_with("cat >/dev/null\n", "silent.sh");
    file_with(
        R"({"name": "Silence", "address": "https://example.org", "licence": "MIT", "colour_used": true,)"
        R"( "history_used": false, "training_courses": ["fsd_1", "fsg"]})",
        "silent.method.json");
    const Outcome outcome =
        run(std::string(kCompare) + "r --methods 'exec:silent=sh ./silent.sh </dev/null'");
    EXPECT_EQ(outcome.exit_code, 1) << "it answers nothing";
    EXPECT_THAT(text_of(path("r/table.txt")),
                HasSubstr("Silence; licence MIT; uses colour; no history; trained on fsd_1, fsg; "
                          "https://example.org"));
    const json card = json::parse(text_of(path("silent.method.json")));
    const json record = json::parse(text_of(path("r/run.json")));
    EXPECT_EQ(record["methods"][0]["exec"], "sh ./silent.sh </dev/null");
    EXPECT_EQ(record["methods"][0]["card"], card);
    for (const json& row : json_lines("r/results.jsonl")) EXPECT_EQ(row["card"], card);
}

TEST_F(OutsideDetectors, DetectAndSweepTakeThemToo) {
    run_well("scenes --tracks generated:kidney --every 20 --fp 0.2 --out s.scenes.jsonl");
    const std::string detector = " --method 'exec:other=" + child("ids") + "' ";
    run_well("detect --method clc --scenes s.scenes.jsonl --out clc.lanes.jsonl");
    run_well("detect" + detector + "--scenes s.scenes.jsonl --out other.lanes.jsonl");
    EXPECT_EQ(only_lanes(lanes("other")), only_lanes(lanes("clc")));
    file_with(run_well("detect" + detector + "--scenes - --out - <s.scenes.jsonl").output,
              "stream.lanes.jsonl");
    EXPECT_EQ(only_lanes(lanes("stream")), only_lanes(lanes("clc")));
    run_well(
        "sweep --tracks generated:circle --sizes 8 --every 30 --out r --methods "
        "'exec:other=OUTSIDE_LOG=log " +
        child("ids") + "'");
    for (const LaneRecord& record : lanes("r/other.n008")) EXPECT_EQ(record.nearest, 8U);
    for (const json& told : json_lines("log")) {
        if (told.contains("cones")) {
            EXPECT_LE(told["cones"].size(), 8U);
        }
    }
}

std::vector<double> objectives(const std::vector<LaneRecord>& records) {
    std::vector<double> all;
    for (const LaneRecord& record : records)
        all.push_back(record.answer.optimality ? record.answer.optimality->objective : 0.0);
    return all;
}

/// The child solves its programs with CBC, so its optima are those of rld-pair.
TEST_F(OutsideDetectors, ASolverFromOutsideIsRldAtEachConeSetSize) {
    run_well(
        "sweep --tracks generated:circle --condition paper --sizes 6,8 --every 30 --fp 0.2 --out r "
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

/// Its lanes are checked: a lane that violates rows of the program becomes an answer of status error.
TEST_F(OutsideDetectors, AWrongSolverIsAnErrorAndNeverALane) {
    const Outcome outcome = run(
        "compare --tracks generated:circle --condition paper --every 30 --fp 0 --nearest 8 --out r --methods "
        "'solver:liar=" +
        solver_child() + " half-a-point 2 marker'");
    EXPECT_THAT(outcome.errors, HasSubstr("liar n=8: "));
    bool any_error = false;
    for (const LaneRecord& record : lanes("r/liar.n008"))
        any_error = any_error || record.answer.status == LaneStatus::error;
    EXPECT_TRUE(any_error);
}

/// The two programs in docs/from-outside.md.
TEST_F(OutsideDetectors, TheExampleInCppAnswersAsClc) {
    run_well(std::string(kCompare) + "r --methods clc exec:clc-stream=" + clc_stream());
    EXPECT_EQ(only_lanes(lanes("r/clc-stream")), only_lanes(lanes("r/clc")));
}

TEST_F(OutsideDetectors, TheExampleInPythonFindsStraightLanes) {
    if (std::system("python3 -c '' 2>/dev/null") != 0) GTEST_SKIP() << "no python3";
    run_well(
        "compare --tracks generated:straight --condition paper --every 15 --fp 0 --out r --methods "
        "'exec:pairs=python3 " +
        source_directory().string() + "/experiments/examples/nearest_pairs.py'");
    EXPECT_THAT(text_of(path("r/table.txt")), HasSubstr("nearest pairs, an example; "));
    for (const json& row : json_lines("r/results.jsonl")) {
        EXPECT_EQ(row["errors"], 0);
        EXPECT_EQ(row["usable_share"], 1.0);
    }
}

/// A replacement for the interface of ft-fsd-path-planning that the adapter uses; it finds straight lanes.
/// The test is about the adapter, not the package.
constexpr const char* kStandIn = R"(import enum
import sys
import types
import numpy as np
ConeTypes = enum.IntEnum('ConeTypes', 'UNKNOWN RIGHT LEFT START_FINISH_AREA START_FINISH_LINE', start=0)
MissionTypes = enum.Enum('MissionTypes', 'trackdrive')
class ConeSortingInput:
    def __init__(self, cones, position, direction):
        self.cones, self.position, self.direction = cones, position, direction
class ConeSorting:
    def set_new_input(self, given):
        self.given = given
    def run_cone_sorting(self):
        cones, (x, y) = self.given.cones[ConeTypes.UNKNOWN], self.given.direction
        ahead = (cones - self.given.position) @ np.array([[x, -y], [y, x]])
        sides = []
        for is_side in (ahead[:, 1] > 0, ahead[:, 1] <= 0):
            sides.append(cones[is_side][np.argsort(ahead[is_side, 0])])
        return sides
class PathPlanner:
    def __init__(self, mission):
        self.cone_sorting = ConeSorting()
    def calculate_path_in_global_frame(self, cones, position, direction):
        return np.array([[s, *(position + s * direction), 0.0] for s in range(30)])
core = types.ModuleType('fsd_path_planning.sorting_cones.core_cone_sorting')
core.ConeSortingInput = ConeSortingInput
sys.modules['fsd_path_planning.sorting_cones'] = types.ModuleType('fsd_path_planning.sorting_cones')
sys.modules['fsd_path_planning.sorting_cones.core_cone_sorting'] = core
)";

TEST_F(OutsideDetectors, TheAdapterOfFtFsdSpeaksForAPlannerOfThatInterface) {
    std::string python;
    for (const char* candidate : {"python3", "/usr/bin/python3"}) {
        if (std::system((std::string(candidate) + " -c 'import numpy' 2>/dev/null").c_str()) == 0)
            python = candidate;
    }
    if (python.empty()) GTEST_SKIP() << "no python3 with numpy";
    std::filesystem::create_directory(path("fsd_path_planning"));
    file_with(kStandIn, "fsd_path_planning/__init__.py");
    const std::string adapter = "PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=. " + python + " " +
                                source_directory().string() + "/experiments/examples/ft_fsd_adapter.py";
    run_well(
        "compare --tracks generated:straight --condition paper --every 15 --fp 0 --out r --methods "
        "'exec:ft-fsd=" +
        adapter + "' 'exec:ft-fsd-path=" + adapter + " --path'");
    EXPECT_THAT(text_of(path("r/table.txt")),
                HasSubstr("ft-fsd-path-planning, cone sorting; licence MIT; no history"));
    for (const json& row : json_lines("r/results.jsonl")) {
        EXPECT_EQ(row["errors"], 0);
        EXPECT_EQ(row["usable_share"], 1.0);
        EXPECT_EQ(row["self_timed_ms"].size(), 2U);
    }
    for (const LaneRecord& record : lanes("r/ft-fsd")) EXPECT_GE(record.answer.lane.left.size(), 2U);
    for (const LaneRecord& record : lanes("r/ft-fsd-path")) EXPECT_EQ(record.centre_line.size(), 30U);
    EXPECT_EQ(std::system(("cd " + path("").string() + " && " + adapter + " --warm-up >warm").c_str()), 0);
    EXPECT_EQ(json::parse(text_of(path("warm")))[0]["left_points"].size(), 8U);
    // The stand-in sorts cones of unknown colour alone, so with colours it finds those that are left without.
    run_well(
        "scenes --tracks generated:straight --condition paper --every 60 --fp 0 --color --color-unknown 0.5 "
        "--out s.scenes.jsonl");
    run_well("detect --scenes s.scenes.jsonl --out all.lanes.jsonl --method 'exec:ft-fsd=" + adapter + "'");
    run_well("detect --scenes s.scenes.jsonl --out some.lanes.jsonl --method 'exec:ft-fsd=" + adapter +
             " --colors'");
    std::size_t unknown = 0;
    std::size_t cones = 0;
    for (const AnnotatedScene& scene : read_scenes(path("s.scenes.jsonl"))) {
        cones += scene.scene.cones.size();
        unknown +=
            static_cast<std::size_t>(std::ranges::count(scene.scene.cones, ConeColor::unknown, &Cone::color));
    }
    const auto answered = [&](const char* file) {
        std::size_t count = 0;
        for (const LaneRecord& record : read_lanes(path(file)))
            count += record.answer.lane.left.size() + record.answer.lane.right.size();
        return count;
    };
    EXPECT_EQ(answered("all.lanes.jsonl"), cones);
    EXPECT_EQ(answered("some.lanes.jsonl"), unknown);
    EXPECT_LT(unknown, cones);
}

}  // namespace
}  // namespace conelane::experiments
