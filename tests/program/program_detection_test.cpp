// Scenes in, lanes out, scores of lanes.

#include "evaluation/formats/lane_file.hpp"
#include "evaluation/formats/scene_file.hpp"
#include "tests/support/program_on_scenes.hpp"
#include "tests/support/test_paths.hpp"
#include "tests/support/testing.hpp"

#include <chrono>
#include <thread>

#include <nlohmann/json.hpp>

namespace conelane::experiments {
namespace {

using testing::HasSubstr;

TEST_F(Program, SameSeedSameBytesWithAnyNumberOfThreads) {
    const std::string options = "--fp 0,0.3 --noise 0.1 --miss 0.05 --pose-noise 0.2,0.05 --color ";
    make_scenes(options + "--threads 1", "one");
    make_scenes(options + "--threads 4", "four");
    make_scenes(options, "again");
    EXPECT_EQ(text_of(path("one.scenes.jsonl")), text_of(path("four.scenes.jsonl")));
    EXPECT_EQ(text_of(path("one.scenes.jsonl")), text_of(path("again.scenes.jsonl")));
    EXPECT_GT(read_scenes(path("one.scenes.jsonl")).size(), 10U);
}

TEST_F(Program, LanesDoNotDependOnThreads) {
    make_scenes("--fp 0,0.3");
    const auto lanes = [&](const std::string& detector, const std::string& threads) {
        run_well("detect --method " + detector + " --scenes s.scenes.jsonl --threads " + threads + " --out " +
                 threads + ".lanes.jsonl");
        std::vector<Lane> found;
        for (const LaneRecord& record : read_lanes(path(threads + ".lanes.jsonl")))
            found.push_back(record.answer.lane);
        return found;
    };
    EXPECT_EQ(lanes("clc", "1"), lanes("clc", "3"));
    EXPECT_EQ(lanes("rld-cbc", "1"), lanes("rld-cbc", "3"));
}

/// An option that a detector does not use is refused before the work, and nothing is written.
TEST_F(Program, OptionsThatADetectorDoesNotUseAreRefused) {
    make_scenes("--fp 0");
    const auto refuse = [&](const std::string& detector, const std::string& options, const std::string& why) {
        const std::string out = " --scenes s.scenes.jsonl --out l.lanes.jsonl";
        expect_refused("detect --method " + detector + " " + options + out,
                       {options.substr(0, options.find(' ')), why});
        EXPECT_FALSE(std::filesystem::exists(path("l.lanes.jsonl")));
    };
    refuse("front", "--params shape", "'front' has no RLD parameters");
    refuse("clc", "--pairing paper", "'clc' has no RLD parameters");
    refuse("exec:mine=cat", "--params shape", "the program 'mine' has no RLD parameters");
    refuse("front", "--nearest 0", "0");
    refuse("clc", "--weights s.scenes.jsonl", "'clc' does not take them");
    refuse("exec:mine=cat", "--weights s.scenes.jsonl", "the program 'mine' does not take them");
    expect_refused("compare --tracks generated:circle --methods front,clc --params shape --out results",
                   {"--params", "these methods have no RLD parameters"});
    EXPECT_FALSE(std::filesystem::exists(path("results")));
    EXPECT_EQ(run("compare --tracks generated:circle --methods clc,rld-pair --fp 0 --range 30 --every 60 "
                  "--condition paper --params shape --shard 0/2 --out results")
                  .exit_code,
              0)
        << "one of the methods has RLD parameters";
}

TEST_F(Program, DetectsWithOwnWeights) {
    make_scenes("--fp 0");
    const std::string shipped = (source_directory() / "graph_search/weights/front.json").string();
    const auto lanes = [&](const std::string& options) {
        const std::string out = " --time-limit inf --scenes s.scenes.jsonl --out l.lanes.jsonl";
        run_well("detect --method front " + options + out);
        std::vector<LaneAnswer> answers;
        for (const LaneRecord& record : read_lanes(path("l.lanes.jsonl"))) answers.push_back(record.answer);
        return answers;
    };
    const std::vector<LaneAnswer> by_default = lanes("");
    const std::vector<LaneAnswer> by_file = lanes("--weights " + shipped);
    ASSERT_EQ(by_file.size(), by_default.size());
    for (std::size_t i = 0; i < by_file.size(); ++i) {
        EXPECT_EQ(by_file[i].lane, by_default[i].lane);
        EXPECT_EQ(by_file[i].confidence, by_default[i].confidence);
    }
    const std::string whole = text_of(shipped);
    file_with(whole.substr(0, whole.find(',', 9000)), "cut.json");
    expect_refused("detect --method front --weights cut.json --scenes s.scenes.jsonl --out x.lanes.jsonl",
                   {"cut.json", "the file ends in the middle"});
    EXPECT_FALSE(std::filesystem::exists(path("x.lanes.jsonl")));
}

/// 132 cones with most edges allowed keep an exact search busy for hours.
TEST_F(Program, DetectionEndsInRealTimeUnlessToldOtherwise) {
    nlohmann::json scene{{"id", "lattice"}, {"pose", {{"x", 0}, {"y", 0}, {"yaw", 0}}}};
    for (int id = 0; id < 132; ++id) {
        const int row = id / 11;
        const int column = id % 11;
        scene["cones"].push_back({{"id", id},
                                  {"x", 1.0 + 2.6 * row + 0.06 * (id * 37 % 11)},
                                  {"y", -13.0 + 2.6 * column + 0.05 * (id * 53 % 13)}});
    }
    file_with(scene.dump() + "\n", "lattice.scenes.jsonl");
    const auto answer = [&](const std::string& options) {
        run_well("detect --method rld-pair --scenes lattice.scenes.jsonl --out l.lanes.jsonl " + options);
        return read_lanes(path("l.lanes.jsonl")).at(0).answer;
    };
    EXPECT_EQ(answer("").stopped_by, StopReason::time);
    EXPECT_TRUE(answer("--nearest 12 --time-limit inf").optimality.value().optimal);
    EXPECT_THAT(run("detect --help").output, HasSubstr("--time-limit FLOAT:POSITIVE=400"));
    EXPECT_THAT(run("solve --help").output, HasSubstr("--time-limit FLOAT:POSITIVE=inf"));
}

/// Each line is answered before the next one is sent.
TEST_F(Program, AStreamIsAnsweredLineByLine) {
    make_scenes("--fp 0.2");
    const std::vector<Lane> expected = [&] {
        run_well("detect --method clc --scenes s.scenes.jsonl --out l.lanes.jsonl");
        return lanes_in(path("l.lanes.jsonl"));
    }();
    const std::string in = path("in").string();
    const std::string out = path("out").string();
    ASSERT_EQ(std::system(("mkfifo " + in + " " + out).c_str()), 0);
    ASSERT_EQ(std::system(("(timeout 60 " + conelane_program() + " detect --method clc --scenes - --out - <" +
                           in + " >" + out + "; echo $? >" + path("code").string() + ") &")
                              .c_str()),
              0);
    std::ofstream scenes(in);
    std::ifstream lanes(out);
    std::ifstream file(path("s.scenes.jsonl"));
    std::size_t count = 0;
    for (std::string scene, lane; std::getline(file, scene); ++count) {
        scenes << "{\"reset\": true}\n" << scene << std::endl;
        ASSERT_TRUE(std::getline(lanes, lane));
        const nlohmann::json answer = nlohmann::json::parse(lane);
        EXPECT_EQ(answer["scene"], nlohmann::json::parse(scene)["id"]);
        EXPECT_EQ(answer["left"].get<std::vector<ConeId>>(), expected.at(count).left);
        EXPECT_EQ(answer["right"].get<std::vector<ConeId>>(), expected.at(count).right);
    }
    scenes << "{\"id\": 3}" << std::endl;
    std::string lane;
    ASSERT_TRUE(std::getline(lanes, lane));
    const nlohmann::json wrong = nlohmann::json::parse(lane);
    EXPECT_EQ(wrong["status"], "error");
    EXPECT_EQ(wrong["scene"], std::to_string(2 * count + 1));
    EXPECT_THAT(wrong["message"].get<std::string>(), HasSubstr("id"));
    scenes.close();
    EXPECT_FALSE(std::getline(lanes, lane)) << "it ends with its input";
    for (int wait = 0; wait < 200 && text_of(path("code")).empty(); ++wait) {
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    EXPECT_EQ(text_of(path("code")), "0\n");
    const Outcome whole = run("detect --method clc --scenes s.scenes.jsonl --out -");
    EXPECT_EQ(static_cast<std::size_t>(std::ranges::count(whole.output, '\n')), expected.size());
    expect_refused("detect --method clc --scenes - --out - --threads 2", {"--threads", "stream"});
}

/// The ground truth as a detector's lanes has the best possible scores.
TEST_F(Program, GroundTruthAsLanesScoresFull) {
    make_scenes("--fp 0,0.3,0.5 --range 30,50");
    const std::vector<AnnotatedScene> scenes = read_scenes(path("s.scenes.jsonl"));
    std::vector<LaneRecord> records;
    for (const AnnotatedScene& scene : scenes) {
        LaneRecord record{scene.scene.id, "truth", {}, 1.0, {}};
        record.answer.status = LaneStatus::found;
        record.answer.lane = *scene.ground_truth;
        records.push_back(record);
    }
    write_lanes(path("truth.lanes.jsonl"), records);
    run_well("score --scenes s.scenes.jsonl --lanes truth.lanes.jsonl --json truth.json");
    std::ifstream lines(path("truth.json"));
    std::size_t rows = 0;
    for (std::string line; std::getline(lines, line); ++rows) {
        const auto row = nlohmann::json::parse(line);
        EXPECT_EQ(row.at("mean_iou"), 1.0);
        EXPECT_EQ(row.at("success_share"), 1.0);
        EXPECT_EQ(row.at("usable_share"), 1.0);
        EXPECT_LT(row.at("lateral_p95_m").get<double>(), 1e-6);
        EXPECT_LT(row.at("heading_p95_rad").get<double>(), 1e-6);
        EXPECT_EQ(row.at("share").at("ground_truth"), 1.0) << line;
        for (const char* key : {"commit", "compiler", "machine", "run"})
            EXPECT_TRUE(row.contains(key)) << key;
    }
    EXPECT_EQ(rows, 6U);
}

/// A proof that there is no lane counts like a proven optimum, if it is in time and the detector optimises.
TEST_F(Program, AProofThatThereIsNoLaneCountsAsSolved) {
    make_scenes("--fp 0");
    const std::vector<AnnotatedScene> scenes = read_scenes(path("s.scenes.jsonl"));
    ASSERT_GT(scenes.size(), 4U);
    std::vector<LaneRecord> records;
    for (const AnnotatedScene& scene : scenes) {
        records.push_back({scene.scene.id, "exact", {}, 1.0, {}});
        records.back().answer.status = LaneStatus::none;
    }
    records[0].answer.status = LaneStatus::found;
    records[0].answer.lane = *scenes[0].ground_truth;
    records[0].answer.optimality = Optimality{-1.0, -1.0, true};
    records[1].answer.status = LaneStatus::stopped;
    records[2].latency_ms = 401.0;
    const std::size_t answers = records.size();
    // A detector without an objective has solved nothing, whatever it finds.
    for (const AnnotatedScene& scene : scenes) {
        records.push_back({scene.scene.id, "search", {}, 1.0, {}});
        records.back().answer.status = LaneStatus::none;
    }
    write_lanes(path("l.lanes.jsonl"), records);
    run_well("score --scenes s.scenes.jsonl --lanes l.lanes.jsonl --json rows");
    std::ifstream lines(path("rows"));
    std::string line;
    ASSERT_TRUE(std::getline(lines, line));
    EXPECT_DOUBLE_EQ(nlohmann::json::parse(line).value("solved_share", 0.0),
                     static_cast<double>(answers - 2) / static_cast<double>(answers));
    ASSERT_TRUE(std::getline(lines, line));
    EXPECT_FALSE(nlohmann::json::parse(line).contains("solved_share")) << line;
}

}  // namespace
}  // namespace conelane::experiments
