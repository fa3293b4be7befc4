#include "evaluation/formats/scene_file.hpp"

#include "tests/support/file_test.hpp"
#include "tests/support/refusal.hpp"

#include <bit>

namespace conelane {
namespace {

namespace fs = std::filesystem;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

class SceneFileTest : public FileTest {
  protected:
    [[nodiscard]] std::string error_in(const std::string& text) const {
        return error_of([&] { static_cast<void>(read_scenes(file_with(text, "s.jsonl"))); });
    }
    /// A scene with the rest of its line after the cones.
    [[nodiscard]] static std::string scene(const std::string& cones, const std::string& rest = "") {
        return R"({"pose": {"x": 0, "y": 0, "yaw": 0}, "cones": [)" + cones + "]" + rest + "}\n";
    }
    [[nodiscard]] static std::string cone(const std::string& id) {
        return R"({"id": )" + id + R"(, "x": 1.5, "y": -2})";
    }
};

TEST_F(SceneFileTest, ReadsTheExampleOfTheFormatDescription) {
    const fs::path file = file_with(
        R"({"id": "fsd_1/pose_0042/fp_0.30/range_30", "pose": {"x": 0.0, "y": 0.5, "yaw": -0.25},)"
        R"( "cones": [{"id": 5, "x": 2.30, "y": -1.86, "color": "yellow", "confidence": 0.75},)"
        R"( {"id": 49, "x": 2.0, "y": 1.9}], "ground_truth": {"left": [49], "right": [5], "closed": false},)"
        R"( "track": "fsd_1", "false_positive_rate": 0.30, "range": 30.0, "seed": 7, "weather": "wet"})");
    const std::vector<AnnotatedScene> scenes = read_scenes(file);
    ASSERT_EQ(scenes.size(), 1u);
    const AnnotatedScene& scene = scenes.front();
    EXPECT_EQ(scene.scene.id, "fsd_1/pose_0042/fp_0.30/range_30");
    EXPECT_EQ(scene.scene.pose.position, Point(0.0, 0.5));
    EXPECT_EQ(scene.scene.pose.yaw_rad, -0.25);
    ASSERT_EQ(scene.scene.cones.size(), 2u);
    EXPECT_EQ(scene.scene.cones[0].id, 5);
    EXPECT_EQ(scene.scene.cones[0].position, Point(2.30, -1.86));
    EXPECT_EQ(scene.scene.cones[0].color, ConeColor::yellow);
    EXPECT_EQ(scene.scene.cones[0].confidence, 0.75);
    EXPECT_EQ(scene.scene.cones[1].color, ConeColor::unknown);
    EXPECT_EQ(scene.scene.cones[1].confidence, 1.0);
    EXPECT_EQ(scene.ground_truth, (Lane{{49}, {5}, false}));
    EXPECT_EQ(scene.track, "fsd_1");
    EXPECT_EQ(scene.false_positive_rate, 0.30);
    EXPECT_EQ(scene.range_m, 30.0);
    EXPECT_EQ(scene.seed, 7u);
}

TEST_F(SceneFileTest, ASceneWithoutIdIsNamedByItsLineAndBlankLinesCount) {
    const std::vector<AnnotatedScene> scenes =
        read_scenes(file_with("\n" + scene(cone("1")) + " \t\r\n" + scene(cone("1"))));
    ASSERT_EQ(scenes.size(), 2u);
    EXPECT_EQ(scenes[0].scene.id, "2");
    EXPECT_EQ(scenes[1].scene.id, "4");
    EXPECT_FALSE(scenes[0].ground_truth.has_value());
    EXPECT_FALSE(scenes[0].seed.has_value());
}

TEST_F(SceneFileTest, WritesTheKeysInTheOrderOfTheFormat) {
    AnnotatedScene scene;
    scene.scene = {"a", {{0.1, -2.0}, 0.5}, {{7, {1e-7, 3.0}, ConeColor::orange, 0.5}, {8, {1, 2}}}};
    scene.ground_truth = Lane{{7}, {8}, true};
    scene.track = "toy";
    scene.false_positive_rate = 0.3;
    scene.range_m = 30.0;
    scene.seed = std::numeric_limits<std::uint64_t>::max();
    write_scenes(path("out"), std::vector{scene});
    EXPECT_EQ(text_of(path("out")), R"({"id":"a","pose":{"x":0.1,"y":-2.0,"yaw":0.5},"cones":[)"
                                    R"({"id":7,"x":1e-07,"y":3.0,"color":"orange","confidence":0.5},)"
                                    R"({"id":8,"x":1.0,"y":2.0,"color":"unknown","confidence":1.0}],)"
                                    R"("ground_truth":{"left":[7],"right":[8],"closed":true},"track":"toy",)"
                                    R"("false_positive_rate":0.3,"range":30.0,"seed":18446744073709551615})"
                                    "\n");
    EXPECT_EQ(read_scenes(path("out")).front().seed, scene.seed);
}

TEST_F(SceneFileTest, ProbabilitiesOfColorsStandBesideTheLabelOrGiveIt) {
    const fs::path file = file_with(scene(
        R"({"id": 1, "x": 1, "y": 2, "color": "yellow", "color_probabilities": [0.25, 0.5, 0.125, 0.125, 0]},)"
        R"({"id": 2, "x": 1, "y": 3, "color_probabilities": [0, 0.1, 0.3, 0.25, 0.35]},)"
        R"({"id": 3, "x": 1, "y": 4, "color_probabilities": [0, 0.5, 0.5, 0, 0]},)"
        R"({"id": 4, "x": 1, "y": 5, "color": "blue"}, {"id": 5, "x": 2, "y": 5, "color": "big_orange"})"));
    const std::vector<AnnotatedScene> read = read_scenes(file);
    const std::vector<Cone>& cones = read.front().scene.cones;
    EXPECT_EQ(cones[0].color, ConeColor::yellow);
    EXPECT_EQ(cones[0].probabilities(), (ColorProbabilities{0.25, 0.5, 0.125, 0.125, 0.0}));
    EXPECT_EQ(cones[1].color, ConeColor::big_orange);
    EXPECT_EQ(cones[2].color, ConeColor::unknown);  // blue and yellow are equally probable
    EXPECT_FALSE(cones[3].color_probabilities.has_value());
    EXPECT_EQ(cones[3].probabilities(), (ColorProbabilities{0.0, 1.0, 0.0, 0.0, 0.0}));
    EXPECT_EQ(cones[4].color, ConeColor::big_orange);
    EXPECT_EQ(cones[4].probabilities(), (ColorProbabilities{0.0, 0.0, 0.0, 0.0, 1.0}));
    write_scenes(path("out"), read);
    EXPECT_EQ(read_scenes(path("out")).front().scene.cones[4].color, ConeColor::big_orange);
    EXPECT_THAT(text_of(path("out")),
                testing::HasSubstr(R"("color":"yellow","confidence":1.0,)"
                                   R"("color_probabilities":[0.25,0.5,0.125,0.125,0.0]})"));
    EXPECT_THAT(text_of(path("out")), testing::HasSubstr(R"("color":"blue","confidence":1.0})"));
    EXPECT_EQ(read_scenes(path("out")).front().scene.cones[1].color_probabilities,
              cones[1].color_probabilities);
}

TEST_F(SceneFileTest, CovariancesOfPositionsAreReadAndWrittenWhereAConeHasOne) {
    const fs::path file = file_with(
        scene(R"({"id": 1, "x": 1, "y": 2, "position_covariance": [[0.25, -0.125], [-0.125, 0.5]]},)"
              R"({"id": 2, "x": 1, "y": 3, "position_covariance": [[0, 0], [0, 0]]},)"
              R"({"id": 3, "x": 1, "y": 4, "position_covariance": [[1, 0.1], [0.10000001, 1]]},)"
              R"({"id": 4, "x": 1, "y": 5})"));
    const std::vector<AnnotatedScene> read = read_scenes(file);
    const std::vector<Cone>& cones = read.front().scene.cones;
    EXPECT_EQ(cones[0].position_covariance, (PositionCovariance{0.25, -0.125, 0.5}));
    EXPECT_EQ(cones[1].position_covariance, PositionCovariance{});
    EXPECT_NEAR(cones[2].position_covariance->xy_m2, 0.1, 1e-7);  // rounding is no asymmetry
    EXPECT_FALSE(cones[3].position_covariance.has_value());
    write_scenes(path("out"), read);
    const std::string written = text_of(path("out"));
    EXPECT_THAT(written, testing::HasSubstr(R"("confidence":1.0,)"
                                            R"("position_covariance":[[0.25,-0.125],[-0.125,0.5]]})"));
    EXPECT_THAT(written, testing::HasSubstr(R"("y":5.0,"color":"unknown","confidence":1.0})"));
    EXPECT_EQ(read_scenes(path("out")).front().scene.cones[0].position_covariance,
              cones[0].position_covariance);
}

TEST_F(SceneFileTest, ConditionAndMissedConesAreWrittenIfPresent) {
    AnnotatedScene made;
    made.scene = {"a", {{0, 0}, 0}, {{7, {1, 2}}}};
    made.condition = "car";
    made.missed = {{9, {3.5, -1.0}}, {4, {5.0, 0.25}}};
    write_scenes(path("out"), std::vector{made});
    EXPECT_THAT(text_of(path("out")),
                testing::EndsWith(R"("condition":"car","missed":[{"id":9,"x":3.5,"y":-1.0},)"
                                  R"({"id":4,"x":5.0,"y":0.25}]})"
                                  "\n"));
    const AnnotatedScene read = read_scenes(path("out")).front();
    EXPECT_EQ(read.condition, "car");
    ASSERT_EQ(read.missed.size(), 2u);
    EXPECT_EQ(read.missed[0].id, 9);
    EXPECT_EQ(read.missed[1].position, Point(5.0, 0.25));
}

TEST_F(SceneFileTest, RandomDoublesAndIdsSurviveARoundTripBitByBit) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        SCOPED_TRACE(seed);
        boost::random::mt19937_64 random(seed);
        const auto any_finite = [&] {
            for (;;) {
                const auto value = std::bit_cast<double>(random());
                if (std::isfinite(value)) return value;
            }
        };
        AnnotatedScene scene;
        scene.scene.id = "\u00e4 \" \\ \n";
        scene.scene.pose = {{any_finite(), any_finite()}, any_finite()};
        for (int i = 0; i < 20; ++i)
            scene.scene.cones.push_back({static_cast<ConeId>(random()), {any_finite(), any_finite()}});
        write_scenes(path("out"), std::vector{scene});
        const Scene read = read_scenes(path("out")).front().scene;
        EXPECT_EQ(read.id, scene.scene.id);
        EXPECT_EQ(read.pose.position, scene.scene.pose.position);
        EXPECT_EQ(read.pose.yaw_rad, scene.scene.pose.yaw_rad);
        ASSERT_EQ(read.cones.size(), scene.scene.cones.size());
        for (std::size_t i = 0; i < read.cones.size(); ++i) {
            EXPECT_EQ(read.cones[i].id, scene.scene.cones[i].id);
            EXPECT_EQ(read.cones[i].position, scene.scene.cones[i].position);
        }
    }
}

/// refused_files_test has the faults of texts that a line can hold.
TEST_F(SceneFileTest, ReadsShortLanesAndTheLeastIdAndRefusesWhatIsNoText) {
    const std::vector<AnnotatedScene> scenes = read_scenes(file_with(scene(
        cone("-9223372036854775808"), R"(, "ground_truth": {"left": [-9223372036854775808], "right": []})")));
    EXPECT_EQ(scenes.front().scene.cones[0].id, std::numeric_limits<ConeId>::min());
    EXPECT_EQ(scenes.front().ground_truth, (Lane{{std::numeric_limits<ConeId>::min()}, {}, false}));
    EXPECT_EQ(error_in("{\"id\": \"\xff\"}"), "s.jsonl:1: id: not valid JSON at column 9");
    EXPECT_EQ(error_in(std::string(100000, '[')), "s.jsonl:1: the JSON ends too early");
}

TEST_F(SceneFileTest, NamesFilesThatCannotBeRead) {
    EXPECT_EQ(error_of([&] { static_cast<void>(read_scenes(path("absent"))); }),
              "absent: cannot be read: No such file or directory");
    fs::create_directory(path("folder"));
    EXPECT_EQ(error_of([&] { static_cast<void>(read_scenes(path("folder"))); }),
              "folder: is a folder, not a file");
}

TEST_F(SceneFileTest, RefusesToWriteScenesThatItCouldNotRead) {
    const fs::path file = file_with("old");
    AnnotatedScene scene;
    scene.scene = {"a", {}, {{1, {0.0, kInfinity}}}};
    EXPECT_EQ(refusal([&] { write_scenes(file, std::vector{scene}); }),
              "scenes[0].cones[0].y: must be a finite number");
    EXPECT_EQ(text_of(file), "old");
    EXPECT_EQ(files_in_folder(), 1u);
}

TEST_F(SceneFileTest, TrackBoundariesLieBesideTheScenes) {
    EXPECT_EQ(track_boundaries_path("out/all.scenes.jsonl"), "out/all.tracks.json");
    EXPECT_EQ(track_boundaries_path("all.jsonl"), "all.tracks.json");
    const TrackBoundariesByName tracks{{"b", {{{0.5, 1}, {2, 1}}, {{0, -1}}, false}},
                                       {"a", {{{0, 1}}, {{0, -1}}, true}}};
    write_track_boundaries(path("t"), tracks);
    EXPECT_EQ(text_of(path("t")), R"({"a":{"left":[[0.0,1.0]],"right":[[0.0,-1.0]],"closed":true},)"
                                  R"("b":{"left":[[0.5,1.0],[2.0,1.0]],"right":[[0.0,-1.0]],"closed":false}})"
                                  "\n");
    write_track_boundaries(path("run"), {{"r", {{}, {}, false, {{0, 0}, {1, 0.5}}}}});
    EXPECT_EQ(text_of(path("run")),
              R"({"r":{"left":[],"right":[],"closed":false,"driven":[[0.0,0.0],[1.0,0.5]]}})"
              "\n");
    EXPECT_EQ(read_track_boundaries(path("run")).at("r").driven, (std::vector<Point>{{0, 0}, {1, 0.5}}));
    const TrackBoundariesByName read = read_track_boundaries(path("t"));
    ASSERT_EQ(read.size(), 2u);
    EXPECT_EQ(read.at("b").left, tracks.at("b").left);
    EXPECT_EQ(read.at("b").right, tracks.at("b").right);
    EXPECT_FALSE(read.at("b").closed);
    EXPECT_TRUE(read.at("a").closed);
}

}  // namespace
}  // namespace conelane
