// What a detector promises, on CLC: see LaneDetector and make_clc_detector.

#include "graph_search/clc/clc_detector.hpp"
#include "tests/support/no_time_limit.hpp"
#include "tests/support/processor_time.hpp"
#include "tests/support/random_scenes.hpp"
#include "tests/support/testing.hpp"

namespace conelane {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::vector<std::pair<std::string, ClcOptions>> variants() {
    ClcOptions warm = extended_clc_options();
    warm.warm_start = true;
    return {{"extended", extended_clc_options()},
            {"paper", paper_clc_options()},
            {"longest", {}},
            {"warm", warm}};
}

Scene straight(int cones_a_side) {
    Scene scene;
    for (int i = 0; i < cones_a_side; ++i) {
        scene.cones.push_back({2 * i, {1.0 + 4.0 * i, 1.8}});
        scene.cones.push_back({2 * i + 1, {1.2 + 4.0 * i, -1.8}});
    }
    return scene;
}

/// Adds `cones` cones beside a lane, at one place or, with `spread_m`, around it.
Scene heap(std::size_t cones, double spread_m) {
    Scene scene = straight(6);
    const Scene heaped = tests::strewn_scene(cones, 1.0, 1.0);
    for (const Cone& cone : heaped.cones) {
        scene.cones.push_back({1000 + cone.id, spread_m * cone.position + Point(9.0, 2.0)});
    }
    return scene;
}

bool same_answer(const LaneAnswer& a, const LaneAnswer& b) {
    return a.status == b.status && a.lane == b.lane && a.stopped_by == b.stopped_by &&
           a.enumeration.has_value() == b.enumeration.has_value() &&
           (!a.enumeration || (a.enumeration->iterations == b.enumeration->iterations &&
                               a.enumeration->complete == b.enumeration->complete));
}

TEST(ClcContract, ScenesAndLimitsThatAreNotValidAreErrorsThatNameTheCone) {
    for (const auto& [name, options] : variants()) {
        SCOPED_TRACE(name);
        const std::unique_ptr<LaneDetector> detector = make_clc_detector(options);
        const auto message = [&](auto change) {
            Scene scene = straight(5);
            DetectionLimits limits = tests::kNoTimeLimit;
            change(scene, limits);
            const LaneAnswer answer = detector->detect(scene, limits);
            EXPECT_EQ(answer.status, LaneStatus::error);
            EXPECT_THAT(answer.lane.left, IsEmpty());
            EXPECT_FALSE(answer.stopped_by);
            return answer.message;
        };
        EXPECT_THAT(message([](Scene& s, auto&) { s.cones[3].position.x() = kNaN; }),
                    HasSubstr("cones[3].x"));
        EXPECT_THAT(message([](Scene& s, auto&) { s.cones[4].position.y() = kInfinity; }),
                    HasSubstr("cones[4].y"));
        EXPECT_THAT(message([](Scene& s, auto&) { s.cones[9].confidence = kNaN; }),
                    HasSubstr("cones[9].confidence"));
        EXPECT_THAT(message([](Scene& s, auto&) { s.cones[6].id = s.cones[2].id; }),
                    HasSubstr("cones[6].id"));
        EXPECT_THAT(message([](Scene& s, auto&) { s.pose.yaw_rad = kNaN; }), HasSubstr("pose.yaw"));
        EXPECT_THAT(message([](Scene& s, auto&) { s.pose.position.x() = -kInfinity; }), HasSubstr("pose.x"));
        EXPECT_THAT(message([](Scene&, auto& l) { l.time_limit_ms = kNaN; }), HasSubstr("time_limit"));
        EXPECT_EQ(detector->detect(straight(5), tests::kNoTimeLimit).status, LaneStatus::found)
            << "what was not valid leaves nothing behind";
    }
}

class ThrowingRanking final : public LaneRanking {
  public:
    void score(std::span<const LaneFeatures>, std::span<double>) const override {
        throw std::runtime_error("no scores today");
    }
};

TEST(ClcContract, ARankingThatThrowsIsAnError) {
    ClcOptions options;
    options.ranking = std::make_shared<ThrowingRanking>();
    const LaneAnswer answer = make_clc_detector(options)->detect(straight(5), tests::kNoTimeLimit);
    EXPECT_EQ(answer.status, LaneStatus::error);
    EXPECT_EQ(answer.message, "no scores today");
}

TEST(ClcContract, FewConesHaveNoLaneByProof) {
    for (const auto& [name, options] : variants()) {
        SCOPED_TRACE(name);
        const std::unique_ptr<LaneDetector> detector = make_clc_detector(options);
        Scene scene;
        for (const Cone& cone : {Cone{1, {1.0, 1.8}}, Cone{2, {1.0, -1.8}}, Cone{3, {5.0, 1.8}}}) {
            const LaneAnswer answer = detector->detect(scene, tests::kNoTimeLimit);
            EXPECT_EQ(answer.status, LaneStatus::none);
            EXPECT_FALSE(answer.stopped_by);
            scene.cones.push_back(cone);
        }
        EXPECT_EQ(detector->detect(scene, tests::kNoTimeLimit).status, LaneStatus::none);
        scene.cones.push_back({4, {5.0, -1.8}});
        EXPECT_EQ(detector->detect(scene, tests::kNoTimeLimit).status, LaneStatus::found);
    }
}

TEST(ClcContract, NoneOnlyWhereEverythingWasSearched) {
    // The first step goes to a cone that no lane can include; with more steps, a lane is found.
    const Scene scene = straight(4);
    ClcOptions options;
    options.iteration_limit = 1;
    const LaneAnswer one_step = make_clc_detector(options)->detect(scene, tests::kNoTimeLimit);
    EXPECT_EQ(one_step.status, LaneStatus::stopped);
    EXPECT_EQ(one_step.stopped_by, StopReason::iterations);
    EXPECT_FALSE(one_step.enumeration->complete);

    // The nearest pair starts no lane.
    Scene beside = straight(4);
    for (Cone& cone : beside.cones) cone.position.x() += 2.0;
    beside.cones.push_back({1000, {-2.7, 1.4}});
    beside.cones.push_back({1001, {-2.7, -1.4}});
    options = {};
    options.starting_pairs = 1;
    const LaneAnswer one_pair = make_clc_detector(options)->detect(beside, tests::kNoTimeLimit);
    EXPECT_EQ(one_pair.status, LaneStatus::stopped);
    EXPECT_EQ(one_pair.stopped_by, StopReason::iterations);
    EXPECT_TRUE(one_pair.enumeration->complete) << "of the pair that was tried";
    EXPECT_EQ(make_clc_detector({})->detect(beside, tests::kNoTimeLimit).status, LaneStatus::found);
}

TEST(ClcContract, AFoundLaneTellsWhetherALimitCutTheSearch) {
    ClcOptions options;
    const Scene easy = straight(4);
    EXPECT_FALSE(make_clc_detector(options)->detect(easy, tests::kNoTimeLimit).stopped_by);
    options.iteration_limit = 20;
    const LaneAnswer few = make_clc_detector(options)->detect(easy, tests::kNoTimeLimit);
    EXPECT_EQ(few.status, LaneStatus::found);
    EXPECT_EQ(few.stopped_by, StopReason::iterations);
    options.iteration_limit = std::numeric_limits<std::int64_t>::max();
    const LaneAnswer late =
        make_clc_detector(options)->detect(tests::strewn_scene(300, 30.0, 16.0), {.time_limit_ms = 30.0});
    EXPECT_EQ(late.status, LaneStatus::found);
    EXPECT_EQ(late.stopped_by, StopReason::time);
}

TEST(ClcContract, HugeLimitsNeverExpireAndNegativeOnesHaveExpired) {
    const Scene scene = tests::random_scene(3, 30);
    for (const auto& [name, options] : variants()) {
        SCOPED_TRACE(name);
        const LaneAnswer expected = make_clc_detector(options)->detect(scene, tests::kNoTimeLimit);
        for (const double limit_ms : {1e12, 1e18, 1e300, std::numeric_limits<double>::max()}) {
            EXPECT_TRUE(
                same_answer(make_clc_detector(options)->detect(scene, {.time_limit_ms = limit_ms}), expected))
                << limit_ms;
        }
        for (const double limit_ms : {0.0, -1.0, -kInfinity}) {
            const LaneAnswer answer =
                make_clc_detector(options)->detect(straight(5), {.time_limit_ms = limit_ms});
            EXPECT_EQ(answer.status, LaneStatus::stopped);
            EXPECT_EQ(answer.stopped_by, StopReason::time);
        }
    }
}

TEST(ClcContract, AnAnswerDependsOnTheSceneAlone) {
    for (const auto& [name, options] : variants()) {
        SCOPED_TRACE(name);
        const std::unique_ptr<LaneDetector> used = make_clc_detector(options);
        for (std::uint64_t seed = 0; seed < 40; ++seed) {
            SCOPED_TRACE(seed);
            const Scene scene = tests::random_scene(seed, 8 + 2 * seed);
            // Earlier calls: a search that reached its time limit, an error, a scene of another size.
            (void)used->detect(tests::strewn_scene(200 + 10 * seed, 30.0, 16.0), {.time_limit_ms = 1.0});
            Scene broken = scene;
            broken.cones.front().position.x() = kNaN;
            (void)used->detect(broken, tests::kNoTimeLimit);
            used->reset();
            const LaneAnswer answer = used->detect(scene, tests::kNoTimeLimit);
            EXPECT_TRUE(same_answer(answer, make_clc_detector(options)->detect(scene, tests::kNoTimeLimit)));
        }
    }
}

struct Crowd {
    std::string name;
    Scene scene;
};

std::vector<Crowd> crowds() {
    return {
        {"800 in 50 m x 50 m", tests::strewn_scene(800, 50.0, 50.0)},
        {"2000 in 50 m x 50 m", tests::strewn_scene(2000, 50.0, 50.0)},
        {"5000 in 50 m x 50 m", tests::strewn_scene(5000, 50.0, 50.0)},
        {"5000 in 10 m x 10 m", tests::strewn_scene(5000, 10.0, 10.0)},
        {"5000 at one place beside a lane", heap(5000, 0.0)},
        {"5000 nearly at one place beside a lane", heap(5000, 1e-3)},
        {"2000 in 50 m x 50 m, 1e6 m from the origin", tests::strewn_scene(2000, 50.0, 50.0, 7, {1e6, -1e6})},
        {"500 in a strip", tests::strewn_scene(500, 300.0, 7.0)},
        {"5000 over 1e6 m", tests::strewn_scene(5000, 1e6, 1e6)}};
}

TEST(ClcContract, TheTimeLimitHoldsInEveryPart) {
    for (const auto& [name, options] : variants()) {
        const std::unique_ptr<LaneDetector> detector = make_clc_detector(options);
        for (const Crowd& crowd : crowds()) {
            for (const double limit_ms : {5.0, 50.0}) {
                LaneAnswer answer;
                EXPECT_LT(tests::overrun_ms(
                              limit_ms, 100.0,
                              [&] { answer = detector->detect(crowd.scene, {.time_limit_ms = limit_ms}); }),
                          100.0)
                    << name << ", " << crowd.name;
                EXPECT_NE(answer.status, LaneStatus::error);
            }
        }
    }
}

TEST(ClcContract, TheMemoryLimitHoldsInGraphAndSearch) {
    for (const auto& [name, base] : variants()) {
        SCOPED_TRACE(name);
        ClcOptions options = base;
        options.memory_limit_bytes = 1U << 20U;
        options.iteration_limit = std::numeric_limits<std::int64_t>::max();
        const std::unique_ptr<LaneDetector> detector = make_clc_detector(options);
        const LaneAnswer crowded = detector->detect(heap(2000, 12.0), tests::kNoTimeLimit);
        EXPECT_EQ(crowded.status, LaneStatus::stopped) << "the graph alone is larger";
        EXPECT_EQ(crowded.stopped_by, StopReason::memory);
        const LaneAnswer endless =
            detector->detect(tests::strewn_scene(120, 30.0, 16.0), tests::kNoTimeLimit);
        EXPECT_EQ(endless.status, LaneStatus::found);
        EXPECT_EQ(endless.stopped_by, StopReason::memory);
    }
}

}  // namespace
}  // namespace conelane
