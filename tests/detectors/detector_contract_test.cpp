// The contract of a detector (see LaneDetector, LaneAnswer and DetectorOptions), for every detector of the
// library and of comparisons. A new detector is tested here as soon as it is listed.

#include "experiments/methods/method.hpp"
#include "tests/support/detector_names.hpp"
#include "tests/support/metamorphic.hpp"
#include "tests/support/no_time_limit.hpp"
#include "tests/support/processor_time.hpp"
#include "tests/support/random_scenes.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/straight_lane.hpp"

#include <thread>

namespace conelane {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

bool is_in_library(std::string_view name) {
    return std::ranges::count(detectors(), name, &DetectorInfo::name) > 0;
}

std::vector<std::string> names() {
    std::vector<std::string> all = tests::detector_names();
    for (const experiments::Method& method : experiments::known_methods()) {
        if (!is_in_library(method.name)) all.emplace_back(method.name);
    }
    return all;
}

Scene straight(int cones_a_side, const Point& car = {0.0, 0.0}) {
    return tests::moved(tests::straight_lane(cones_a_side, 0.2, 3.2), car);
}

/// Fewer cones for the printed formulation, which takes seconds for twelve.
std::vector<Scene> random_scenes() {
    std::vector<Scene> scenes;
    for (std::uint64_t seed = 0; seed < 24; ++seed) scenes.push_back(tests::random_scene(seed, 7 + seed % 4));
    return scenes;
}

void expect_cones_of(const Scene& scene, const Lane& lane, bool may_be_one_sided = false) {
    std::set<ConeId> ids;
    for (const Cone& cone : scene.cones) ids.insert(cone.id);
    EXPECT_FALSE(lane.left.empty() && lane.right.empty());
    if (!may_be_one_sided) {
        EXPECT_FALSE(lane.left.empty() || lane.right.empty());
    }
    for (const std::vector<ConeId>& side : {lane.left, lane.right}) {
        for (const ConeId id : side) EXPECT_EQ(ids.erase(id), 1U) << "cone " << id << " unknown or twice";
        if (lane.closed) {
            EXPECT_GE(side.size(), 3U);
        }
    }
}

/// What holds for every answer.
void expect_consistent(const Scene& scene, const LaneAnswer& answer, bool may_be_one_sided) {
    SCOPED_TRACE(to_string(answer.status));
    if (answer.status == LaneStatus::found) {
        expect_cones_of(scene, answer.lane, may_be_one_sided);
        EXPECT_FALSE(drivable(answer, scene).points.empty()) << "found, yet it cannot be driven";
        EXPECT_TRUE(answer.trusted_m);
    } else {
        EXPECT_EQ(answer.lane, Lane{});
        EXPECT_FALSE(answer.solved);
        EXPECT_FALSE(answer.trusted_m);
    }
    if (answer.status == LaneStatus::stopped) {
        EXPECT_TRUE(answer.stopped_by);
    }
    if (answer.status == LaneStatus::none) {
        EXPECT_FALSE(answer.stopped_by) << "`none` is proven";
    }
    if (answer.status == LaneStatus::error) {
        EXPECT_FALSE(answer.message.empty());
        EXPECT_FALSE(answer.stopped_by);
    }
    if (answer.optimality) {
        EXPECT_LE(answer.optimality->bound, answer.optimality->objective);
        if (answer.optimality->optimal) {
            EXPECT_FALSE(answer.stopped_by);
        }
    }
    if (answer.confidence) {
        EXPECT_TRUE(*answer.confidence >= 0.0 && *answer.confidence <= 1.0);
    }
    if (answer.trusted_m) {
        EXPECT_GE(*answer.trusted_m, 0.0);
    }
}

void expect_same(const LaneAnswer& a, const LaneAnswer& b) {
    EXPECT_EQ(a.status, b.status) << a.message << b.message;
    EXPECT_EQ(a.lane, b.lane);
    EXPECT_EQ(a.stopped_by, b.stopped_by);
    EXPECT_EQ(a.message, b.message);
    EXPECT_EQ(a.confidence, b.confidence);
    EXPECT_EQ(a.trusted_m, b.trusted_m);
    ASSERT_EQ(a.optimality.has_value(), b.optimality.has_value());
    if (a.optimality) {
        EXPECT_NEAR(a.optimality->objective, b.optimality->objective, 1e-9);
    }
    ASSERT_EQ(a.enumeration.has_value(), b.enumeration.has_value());
    if (a.enumeration) {
        EXPECT_EQ(a.enumeration->iterations, b.enumeration->iterations);
    }
}

class DetectorContract : public testing::TestWithParam<std::string> {
  protected:
    /// Whether the detector answers with a boundary that is seen alone.
    static bool answers_one_boundary() { return GetParam().starts_with("front"); }
    static std::unique_ptr<LaneDetector> make(const DetectorOptions& options = {}) {
        return is_in_library(GetParam())
                   ? make_detector(GetParam(), options)
                   : make_detector(*experiments::find_method(GetParam()).recipe, options);
    }
    static LaneAnswer detect(LaneDetector& detector, const Scene& scene, const DetectionLimits& limits) {
        LaneAnswer answer;
        EXPECT_NO_THROW(answer = detector.detect(scene, limits));
        expect_consistent(scene, answer, answers_one_boundary());
        return answer;
    }
    static LaneAnswer detect(const Scene& scene, const DetectionLimits& limits = tests::kNoTimeLimit) {
        return detect(*make(), scene, limits);
    }
};

TEST_P(DetectorContract, InvalidInputIsAnErrorThatNamesIt) {
    struct Fault {
        std::string key;
        void (*make)(Scene&, DetectionLimits&);
    };
    const std::vector<Fault> faults{
        {"cones[3].x", [](Scene& s, DetectionLimits&) { s.cones[3].position.x() = kNaN; }},
        {"cones[4].y", [](Scene& s, DetectionLimits&) { s.cones[4].position.y() = kInfinity; }},
        {"cones[0].y", [](Scene& s, DetectionLimits&) { s.cones[0].position.y() = -kInfinity; }},
        {"cones[9].confidence", [](Scene& s, DetectionLimits&) { s.cones[9].confidence = kNaN; }},
        {"cones[8].confidence", [](Scene& s, DetectionLimits&) { s.cones[8].confidence = 1.1; }},
        {"cones[7].confidence", [](Scene& s, DetectionLimits&) { s.cones[7].confidence = -0.1; }},
        {"cones[5].position_covariance",
         [](Scene& s, DetectionLimits&) {
             s.cones[5].position_covariance = {kNaN, 0.0, 0.01};
         }},
        {"cones[2].position_covariance",
         [](Scene& s, DetectionLimits&) {
             s.cones[2].position_covariance = {0.01, 0.02, 0.01};
         }},
        {"cones[1].color_probabilities",
         [](Scene& s, DetectionLimits&) { s.cones[1].color_probabilities = ColorProbabilities{}; }},
        {"cones[6].id", [](Scene& s, DetectionLimits&) { s.cones[6].id = s.cones[2].id; }},
        {"pose.yaw", [](Scene& s, DetectionLimits&) { s.pose.yaw_rad = kNaN; }},
        {"pose.x", [](Scene& s, DetectionLimits&) { s.pose.position.x() = -kInfinity; }},
        {"time_limit", [](Scene&, DetectionLimits& l) { l.time_limit_ms = kNaN; }},
    };
    // Errors in cones that the detector does not see are reported too.
    for (const std::optional<std::size_t> nearest :
         {std::optional<std::size_t>(), std::optional<std::size_t>(2)}) {
        const auto detector = make({.nearest = nearest});
        for (const Fault& fault : faults) {
            SCOPED_TRACE(fault.key);
            Scene scene = straight(5);
            DetectionLimits limits = tests::kNoTimeLimit;
            fault.make(scene, limits);
            const LaneAnswer answer = detect(*detector, scene, limits);
            EXPECT_EQ(answer.status, LaneStatus::error);
            EXPECT_THAT(answer.message, HasSubstr(fault.key));
        }
        if (!nearest) expect_same(detect(*detector, straight(5), tests::kNoTimeLimit), detect(straight(5)));
    }
}

TEST_P(DetectorContract, FindsAStraightLane) {
    const LaneAnswer answer = detect(straight(5));
    ASSERT_EQ(answer.status, LaneStatus::found);
    EXPECT_FALSE(detect(straight(3)).stopped_by) << "so few cones are searched to the end";
    // At the far end, detectors differ: the longest lane has one more cone across.
    ASSERT_GE(answer.lane.left.size(), 4U);
    ASSERT_GE(answer.lane.right.size(), 4U);
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(answer.lane.left[i], static_cast<ConeId>(2 * i));
        EXPECT_EQ(answer.lane.right[i], static_cast<ConeId>(2 * i + 1));
    }
}

TEST_P(DetectorContract, FewConesHaveNoLaneByProof) {
    Scene scene;
    for (const Cone& cone : straight(2).cones) {
        EXPECT_EQ(detect(scene).status, LaneStatus::none) << scene.cones.size() << " cones";
        scene.cones.push_back(cone);
    }
}

TEST_P(DetectorContract, ABoundarySeenAloneIsAnsweredAsOneOrNotAtAll) {
    const Scene both = straight(7);
    for (const int seen : {0, 1}) {
        Scene scene = both;
        std::erase_if(scene.cones, [&](const Cone& cone) { return cone.id % 2 != seen; });
        const LaneAnswer answer = detect(scene);
        if (!answers_one_boundary()) {
            EXPECT_NE(answer.status, LaneStatus::found);
            continue;
        }
        ASSERT_EQ(answer.status, LaneStatus::found);
        const std::vector<ConeId>& known = seen == 0 ? answer.lane.left : answer.lane.right;
        EXPECT_EQ(known.size(), scene.cones.size());
        EXPECT_TRUE(std::ranges::is_sorted(known));
        const DrivableLane lane = drivable(answer, scene);
        EXPECT_EQ(lane.left_inferred, seen == 1);
        EXPECT_EQ(lane.right_inferred, seen == 0);
        EXPECT_GT(lane.length_m, 15.0);
        for (const DrivablePoint& point : lane.points) EXPECT_NEAR(point.position.y(), 0.0, 0.1);
    }
}

TEST_P(DetectorContract, ConesAtOnePlaceHaveNoLaneByProof) {
    for (const std::size_t count : {2U, 8U, 24U}) {
        Scene scene;
        for (std::size_t i = 0; i < count; ++i) scene.cones.push_back({static_cast<ConeId>(i), {5.0, 1.0}});
        EXPECT_EQ(detect(scene).status, LaneStatus::none) << count << " cones";
    }
}

TEST_P(DetectorContract, AConeTwiceAtOnePlaceIsNoObstacle) {
    Scene scene = straight(4);
    scene.cones.push_back({100, scene.cones[2].position});
    EXPECT_EQ(detect(scene).status, LaneStatus::found);
}

/// See Cone::position_covariance.
TEST_P(DetectorContract, ACovarianceOfZeroChangesNothingAndALargeOneIsNoError) {
    const std::unique_ptr<LaneDetector> detector = make();
    const auto with = [](Scene scene, const PositionCovariance& covariance) {
        for (Cone& cone : scene.cones) cone.position_covariance = covariance;
        return scene;
    };
    for (const Scene& scene : random_scenes()) {
        detector->reset();
        const LaneAnswer unknown = detect(*detector, scene, tests::kNoTimeLimit);
        detector->reset();
        expect_same(detect(*detector, with(scene, {}), tests::kNoTimeLimit), unknown);
        detector->reset();
        const LaneAnswer uncertain = detect(*detector, with(scene, {4.0, 1.0, 1.0}), tests::kNoTimeLimit);
        EXPECT_NE(uncertain.status, LaneStatus::error) << uncertain.message;
        if (!GetParam().starts_with("front")) expect_same(uncertain, unknown);
    }
}

TEST_P(DetectorContract, LanesAreTheSameFarFromTheOrigin) {
    const LaneAnswer here = detect(straight(4));
    for (const Point& car : {Point(1e6, -1e6), Point(-1e6, 3.0)}) {
        const LaneAnswer there = detect(straight(4, car));
        EXPECT_EQ(there.status, here.status);
        EXPECT_EQ(there.lane, here.lane);
    }
    EXPECT_NE(detect(tests::strewn_scene(10, 1e6, 1e6)).status, LaneStatus::error);
}

TEST_P(DetectorContract, HugeLimitsNeverExpireAndNegativeOnesHaveExpired) {
    const Scene scene = tests::random_scene(3, 8);
    const LaneAnswer expected = detect(scene);
    for (const double limit_ms : {1e12, 1e18, 1e300, std::numeric_limits<double>::max()}) {
        SCOPED_TRACE(limit_ms);
        expect_same(detect(scene, {.time_limit_ms = limit_ms}), expected);
    }
    for (const double limit_ms : {0.0, -1.0, -1e300, -kInfinity}) {
        const LaneAnswer answer = detect(scene, {.time_limit_ms = limit_ms});
        EXPECT_EQ(answer.status, LaneStatus::stopped);
        EXPECT_EQ(answer.stopped_by, StopReason::time);
    }
}

TEST_P(DetectorContract, ALimitNeverMakesAnAnswerWrong) {
    const auto detector = make();
    int stopped = 0;
    for (const Scene& scene : random_scenes()) {
        SCOPED_TRACE(scene.id);
        const LaneAnswer complete = detect(scene);
        ASSERT_NE(complete.status, LaneStatus::error) << complete.message;
        for (const double limit_ms : {1e-6, 0.05, 0.3, 2.0}) {
            SCOPED_TRACE(limit_ms);
            detector->reset();
            const LaneAnswer answer = detect(*detector, scene, {.time_limit_ms = limit_ms});
            ASSERT_NE(answer.status, LaneStatus::error) << answer.message;
            if (answer.stopped_by == StopReason::time) {
                ++stopped;
            } else {
                EXPECT_EQ(answer.stopped_by, complete.stopped_by) << "a limit of its own";
                EXPECT_EQ(answer.status, complete.status);
                EXPECT_EQ(answer.lane, complete.lane);
            }
            if (answer.optimality && complete.optimality) {
                EXPECT_LE(answer.optimality->bound, complete.optimality->objective + 1e-6);
            }
        }
    }
    EXPECT_GE(stopped, 24) << "the shortest limit stops every scene";
}

TEST_P(DetectorContract, AnAnswerDependsOnTheSceneAlone) {
    const auto used = make();
    const Scene large = tests::strewn_scene(300, 30.0, 30.0);
    int found = 0;
    for (const Scene& scene : random_scenes()) {
        SCOPED_TRACE(scene.id);
        // Earlier calls: a search that reached its time limit, an error, a scene of another size.
        (void)detect(*used, large, {.time_limit_ms = 1.0});
        Scene broken = scene;
        broken.cones.front().position.x() = kNaN;
        (void)detect(*used, broken, tests::kNoTimeLimit);
        (void)detect(*used, straight(4), tests::kNoTimeLimit);
        used->reset();
        const LaneAnswer answer = detect(*used, scene, tests::kNoTimeLimit);
        expect_same(answer, detect(scene));
        if (answer.status == LaneStatus::found) ++found;
    }
    EXPECT_GE(found, 4) << "scenes without a lane show little";
}

TEST_P(DetectorContract, CandidatesAreKeptOnRequestOnly) {
    const Scene scene = straight(4);
    DetectionLimits limits = tests::kNoTimeLimit;
    const LaneAnswer plain = detect(scene, limits);
    limits.keep_candidates = true;
    const LaneAnswer asked = detect(scene, limits);
    expect_same(asked, plain);
    if (!asked.enumeration) return;
    EXPECT_TRUE(plain.enumeration->candidates.empty());
    EXPECT_FALSE(asked.enumeration->candidates.empty());
    for (const LaneCandidate& candidate : asked.enumeration->candidates)
        expect_cones_of(scene, candidate.lane);
}

TEST_P(DetectorContract, AnswersForTheNearestConesOnRequest) {
    DetectorOptions options{.nearest = 6};
    const auto detector = make(options);
    for (const Scene& scene : {straight(6), tests::random_scene(1, 20), tests::random_scene(2, 20)}) {
        const LaneAnswer answer = detect(*detector, scene, tests::kNoTimeLimit);
        ASSERT_NE(answer.status, LaneStatus::error) << answer.message;
        if (answer.status == LaneStatus::found)
            expect_cones_of(nearest_ahead(scene, 6), answer.lane, answers_one_boundary());
    }
}

TEST_P(DetectorContract, TheTimeLimitHoldsInACrowd) {
    const auto detector = make();
    for (const double side_m : {50.0, 10.0}) {
        SCOPED_TRACE(side_m);
        const Scene crowd = tests::strewn_scene(2000, side_m, side_m);
        for (const double limit_ms : {5.0, 50.0}) {
            LaneAnswer answer;
            EXPECT_LT(
                tests::overrun_ms(limit_ms, 150.0,
                                  [&] { answer = detect(*detector, crowd, {.time_limit_ms = limit_ms}); }),
                150.0);
            EXPECT_NE(answer.status, LaneStatus::error) << answer.message;
        }
    }
}

TEST_P(DetectorContract, InstancesServeAThreadEach) {
    const std::vector<Scene> scenes = random_scenes();
    const auto all = [&scenes] {
        const auto detector = make();
        return mapped(scenes,
                      [&](const Scene& scene) { return detector->detect(scene, tests::kNoTimeLimit); });
    };
    const std::vector<LaneAnswer> alone = all();
    std::vector<std::vector<LaneAnswer>> together(3);
    {
        std::vector<std::jthread> threads;
        for (std::vector<LaneAnswer>& of_thread : together) threads.emplace_back([&] { of_thread = all(); });
    }
    for (const std::vector<LaneAnswer>& of_thread : together) {
        ASSERT_EQ(of_thread.size(), alone.size());
        for (std::size_t i = 0; i < alone.size(); ++i) expect_same(of_thread[i], alone[i]);
    }
}

INSTANTIATE_TEST_SUITE_P(Detectors, DetectorContract, testing::ValuesIn(names()),
                         [](const auto& test) { return case_name(test.param); });

TEST(Detectors, AreKnownByNamesOfTheirOwnThatAnErrorLists) {
    const std::vector<std::string> all = names();
    EXPECT_EQ(std::set(all.begin(), all.end()).size(), all.size());
    const std::string message = refusal([] { (void)make_detector("magic"); });
    for (const DetectorInfo& detector : detectors()) {
        EXPECT_THAT(message, HasSubstr(std::string(detector.name)));
        EXPECT_FALSE(detector.description.empty());
    }
}

TEST(Detectors, AreAllDetectors) {
    for (const DetectorInfo& detector : detectors())
        EXPECT_NO_THROW((void)experiments::find_method(detector.name)) << detector.name;
}

}  // namespace
}  // namespace conelane
