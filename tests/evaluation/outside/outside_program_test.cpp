// The parts that detectors from outside use, without the program `conelane`: how long they wait, when they
// give up, and which cone a point represents.

#include "evaluation/outside/outside_program.hpp"

#include "evaluation/outside/point_snapping.hpp"
#include "evaluation/seeded_random.hpp"
#include "experiments/comparison/results.hpp"
#include "tests/support/file_test.hpp"
#include "tests/support/random_scenes.hpp"

#include <csignal>

namespace conelane {
namespace {

using experiments::RecordScorer;
using experiments::ScoredMethod;

/// Three pairs of cones 4 m apart; ids 1, 2, 3 are left, 11, 12, 13 right.
Scene three_pairs() {
    Scene scene{"three pairs", {{-1.0, 0.0}, 0.0}, {}};
    for (int i = 0; i < 3; ++i) {
        scene.cones.push_back({1 + i, {4.0 * i, 1.75}});
        scene.cones.push_back({11 + i, {4.0 * i, -1.75}});
    }
    return scene;
}

LaneRecord record_of(std::vector<Point> left, std::vector<Point> right) {
    LaneRecord record;
    record.answer.status = LaneStatus::found;
    record.points = {std::move(left), std::move(right)};
    return record;
}

TEST(PointSnapping, APointStandsForTheConeWithinReach) {
    LaneRecord record = record_of({{0.2, 1.75}, {4.0, 1.95}, {8.0, 1.75}}, {{0.0, -1.75}, {3.9, -1.75}});
    snap_to_cones(record, three_pairs());
    EXPECT_FALSE(record.points);
    EXPECT_THAT(record.answer.lane.left, ElementsAre(1, 2, 3));
    EXPECT_THAT(record.answer.lane.right, ElementsAre(11, 12));
}

TEST(PointSnapping, OnePointAtNoConeKeepsAllPoints) {
    LaneRecord record = record_of({{0.0, 1.75}, {4.0, 1.75}}, {{0.0, -1.75}, {4.31, -1.75}});
    snap_to_cones(record, three_pairs());
    ASSERT_TRUE(record.points);
    EXPECT_EQ(record.points->right.size(), 2U);
    EXPECT_THAT(record.answer.lane.left, IsEmpty());
}

TEST(PointSnapping, AConeIsTakenOnceAndOrderIsKept) {
    LaneRecord record = record_of({{8.0, 1.75}, {7.9, 1.75}, {0.0, 1.75}, {8.1, 1.75}}, {});
    snap_to_cones(record, three_pairs());
    EXPECT_THAT(record.answer.lane.left, ElementsAre(3, 1));
}

TEST(PointSnapping, OfTwoConesTheNearerOneIsMeant) {
    Scene scene = three_pairs();
    scene.cones.push_back({5, {0.25, 1.75}});
    LaneRecord record = record_of({{0.13, 1.75}}, {{0.0, -1.75}});
    snap_to_cones(record, scene);
    EXPECT_THAT(record.answer.lane.left, ElementsAre(5));
}

/// Answers to any scene: points on cones become these cones, and every id in the result is one of the scene.
TEST(PointSnapping, OfRandomScenesEveryConeIsFoundAgain) {
    for (std::uint64_t seed = 0; seed < 50; ++seed) {
        SCOPED_TRACE(seed);
        const Scene scene = tests::random_scene(seed, 20);
        LaneRecord record = record_of({}, {});
        std::vector<ConeId> ids;
        for (const Cone& cone : scene.cones) {
            record.points->left.push_back(cone.position);
            ids.push_back(cone.id);
        }
        snap_to_cones(record, scene);
        EXPECT_EQ(record.answer.lane.left, ids);
        EXPECT_EQ(fault_of(record, scene), "");
    }
}

/// A spiral is only long, but a star through its own middle is a tangle.
TEST(Tangles, AreDistinguishedFromLongLanes) {
    std::vector<Point> spiral;
    std::vector<Point> star;
    for (int i = 0; i < 100; ++i) {
        spiral.emplace_back((10.0 + 0.1 * i) * std::cos(0.5 * i), (10.0 + 0.1 * i) * std::sin(0.5 * i));
        star.emplace_back(10.0 * std::cos(3.0 * i), 10.0 * std::sin(3.0 * i));
    }
    EXPECT_EQ(tangle_of(record_of(spiral, {{0.0, 0.0}, {0.0, 0.0}, {1.0, 0.0}}), three_pairs()), "");
    EXPECT_THAT(tangle_of(record_of(spiral, star), three_pairs()), HasSubstr("cross more than 500 times"));
}

/// Every answer of a program that is not refused can be scored, even if it makes no sense.
TEST(ForeignLanes, EveryAcceptedAnswerCanBeScored) {
    SceneOptions options{.false_positive_rates = {0.3}, .ranges_m = {30.0}, .every_m = 25.0};
    const SceneSet set = make_scene_set({"generated:circle", "generated:kidney"}, options);
    for (std::uint64_t seed = 0; seed < 30; ++seed) {
        SCOPED_TRACE(seed);
        boost::random::mt19937_64 random = generator_of("foreign lanes", seed);
        const auto below = [&](std::size_t bound) {
            return boost::random::uniform_int_distribution<std::size_t>(0, bound - 1)(random);
        };
        std::vector<LaneRecord> records;
        for (const AnnotatedScene& annotated : set.scenes) {
            const Scene& scene = annotated.scene;
            const auto ids = [&] {
                std::vector<ConeId> all = mapped(scene.cones, &Cone::id);
                shuffle(all, random);
                all.resize(below(all.size() + 1));
                return all;
            };
            const auto points = [&] {
                const std::array scales{1e-9, 1.0, 30.0, kMaxCoordinate_m};
                const double scale_m = scales[below(scales.size())];
                boost::random::uniform_real_distribution<double> along(-scale_m, scale_m);
                std::vector<Point> all(below(40));
                for (Point& point : all) point = Point(along(random), along(random));
                if (all.size() > 3) all[1] = all[2];
                return all;
            };
            LaneRecord record = record_of(points(), points());
            record.scene = scene.id;
            record.detector = "stranger";
            record.answer.lane.closed = below(2) == 0;
            const std::size_t shape = below(3);
            if (shape != 1) record.points.reset();
            if (shape == 0) {
                record.answer.lane.left = ids();
                record.answer.lane.right = ids();
            }
            if (shape == 2) record.centre_line = points();
            snap_to_cones(record, scene);
            ASSERT_EQ(fault_of(record, scene), "");
            if (!tangle_of(record, scene).empty()) record.points.reset();
            records.push_back(std::move(record));
        }
        const ScoredMethod scored =
            RecordScorer(set.scenes, set.tracks).score({.name = "stranger"}, records, "theirs.lanes.jsonl");
        ASSERT_EQ(scored.scores.size(), set.scenes.size());
        for (const ScoreRow& row : scored.rows()) EXPECT_GE(row.summary.usable_share.value(), 0.0);
    }
}

class OutsideProgramTest : public FileTest {
  protected:
    /// A shell program that answers each scene with the text; $id in it is the scene's id.
    [[nodiscard]] std::string shell(const std::string& on_scene) const {
        file_with(
            "while read -r line; do\n  case $line in *reset*) continue;; esac\n"
            "  id=${line#'{\"id\":\"'}; id=${id%%'\"'*}\n" +
                on_scene + "\ndone\n",
            "program.sh");
        return "sh " + path("program.sh").string();
    }
    static constexpr const char* kNone = R"(echo '{"scene":"'$id'","status":"none"}')";
    static constexpr OutsideLimits kShort{
        .answer_ms = 400.0, .start_ms = 10000.0, .end_ms = 400.0, .failures = 3, .lost_ms = 20000.0};
    /// The number of times that the program was started.
    [[nodiscard]] std::size_t starts() const {
        const std::string text = text_of(path("starts"));
        return static_cast<std::size_t>(std::ranges::count(text, '\n'));
    }
    [[nodiscard]] std::string counting(const std::string& command) const {
        return "echo >>" + path("starts").string() + "; " + command;
    }
};

TEST_F(OutsideProgramTest, AnswersAndEndsWithItsInput) {
    OutsideProgram program("shell", shell(kNone), kShort);
    for (int i = 0; i < 3; ++i) {
        const LaneRecord record = program.answer(three_pairs());
        EXPECT_EQ(record.answer.status, LaneStatus::none) << record.answer.message;
        EXPECT_EQ(record.scene, "three pairs");
        EXPECT_EQ(record.detector, "shell");
        EXPECT_GT(record.latency_ms, 0.0);
        EXPECT_LT(record.latency_ms, 400.0);
    }
}

TEST_F(OutsideProgramTest, OneThatNeverAnswersIsNotAskedForEver) {
    OutsideProgram program("gone", counting("exit 7"), kShort);
    for (int lap = 0; lap < 5; ++lap) {
        program.reset();
        for (int i = 0; i < 10; ++i) {
            const LaneRecord record = program.answer(three_pairs());
            EXPECT_EQ(record.answer.status, LaneStatus::error);
            EXPECT_THAT(record.answer.message, HasSubstr("exit code 7"));
        }
    }
    EXPECT_EQ(starts(), 3U);
}

/// After each start it answers once (this answer is not counted), then hangs.
TEST_F(OutsideProgramTest, OneThatFailsAgainAndAgainIsTriedOnEverFewerLaps) {
    const std::string once = std::string(kNone) + "; exec sleep 1000";
    OutsideProgram program("hanging", counting(shell(once)), kShort);
    std::vector<std::size_t> starts_by_lap;
    for (int lap = 0; lap < 9; ++lap) {
        program.reset();
        for (int i = 0; i < 5; ++i) EXPECT_EQ(program.answer(three_pairs()).answer.status, LaneStatus::error);
        starts_by_lap.push_back(starts());
    }
    EXPECT_THAT(starts_by_lap, ElementsAre(3, 4, 4, 5, 5, 5, 5, 6, 6));
}

TEST_F(OutsideProgramTest, OneThatRecoversIsAskedAsBefore) {
    const std::string twice = "if [ -e " + path("well").string() + " ]; then " + kNone + "; continue; fi\n" +
                              kNone + "; exec sleep 1000";
    OutsideProgram program("recovering", shell(twice), kShort);
    for (int i = 0; i < 5; ++i) EXPECT_EQ(program.answer(three_pairs()).answer.status, LaneStatus::error);
    file_with("", "well");
    EXPECT_EQ(program.answer(three_pairs()).answer.status, LaneStatus::error)
        << "in this lap it is not asked";
    program.reset();
    for (int i = 0; i < 5; ++i) EXPECT_EQ(program.answer(three_pairs()).answer.status, LaneStatus::none);
}

/// More data than a pipe holds, in both directions.
TEST_F(OutsideProgramTest, LargeScenesAndAnswersPass) {
    Scene large{"large", {{0.0, 0.0}, 0.0}, {}};
    for (int i = 0; i < 4000; ++i) large.cones.push_back({i, {0.01 * i, 1.0}});
    OutsideProgram program("long",
                           shell(R"(printf '{"scene":"%s","status":"none","message":"%0500000d"}\n' $id 0)"),
                           OutsideLimits{});
    const LaneRecord record = program.answer(large);
    EXPECT_EQ(record.answer.status, LaneStatus::none) << record.answer.message.substr(0, 300);
    EXPECT_EQ(record.answer.message.size(), 500000U);
}

/// Writing to a program that no longer reads must not end this one, whatever SIGPIPE does here.
TEST_F(OutsideProgramTest, OneThatReadsNoMoreDoesNoHarm) {
    ASSERT_EQ(std::signal(SIGPIPE, SIG_DFL), SIG_DFL);
    Scene large{"large", {{0.0, 0.0}, 0.0}, {}};
    for (int i = 0; i < 4000; ++i) large.cones.push_back({i, {0.01 * i, 1.0}});
    OutsideProgram program("deaf", "exec <&-; exec sleep 1000", kShort);
    EXPECT_THAT(program.answer(large).answer.message, HasSubstr("the program does not read its input"));
    EXPECT_THAT(program.answer(large).answer.message, HasSubstr("the program does not read its input"));
}

TEST(OutsideDetectorText, CommasBelongToTheCommand) {
    EXPECT_THAT(split_detectors({"clc,rld-pair"}), ElementsAre("clc", "rld-pair"));
    EXPECT_THAT(split_detectors({"clc,exec:a=run --with b,c", "lanes:d=e.lanes.jsonl,clc"}),
                ElementsAre("clc", "exec:a=run --with b,c", "lanes:d=e.lanes.jsonl", "clc"));
    EXPECT_THAT(split_detectors({"clc,"}), ElementsAre("clc", ""));
}

class OutsideDetectorFiles : public FileTest {};

TEST_F(OutsideDetectorFiles, TheCardLiesBesideAFileThatTheCommandNames) {
    const std::string script = file_with("", "planner.py").string();
    const std::string settings = file_with("", "settings.yaml").string();
    const std::string lanes = file_with("", "x.y.lanes.jsonl").string();
    const auto place = [&](const std::string& command) {
        return card_path({OutsideDetector::Kind::program, "a", command, {}});
    };
    EXPECT_EQ(place("python3 " + script), std::nullopt);
    file_with("{}", "planner.method.json");
    file_with("{}", "x.y.method.json");
    EXPECT_EQ(place("/bin/sh -u '" + script + "' --settings " + settings), path("planner.method.json"));
    EXPECT_EQ(place("planner-on-the-path " + settings), std::nullopt);
    file_with("{}", "settings.method.json");
    EXPECT_EQ(place("planner-on-the-path " + settings), path("settings.method.json"));
    EXPECT_EQ(place(script + " " + settings), path("planner.method.json"));
    EXPECT_EQ(card_path({OutsideDetector::Kind::lanes, "a", lanes, {}}), path("x.y.method.json"));
    file_with(R"({"name": "P", "training_courses": "fsg"})", "planner.method.json");
    EXPECT_THAT(error_of([&] { (void)parse_outside_detector("exec:a=" + script); }),
                HasSubstr("planner.method.json: training_courses: must be an array"));
}

}  // namespace
}  // namespace conelane
