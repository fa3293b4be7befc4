#include "graph_search/clc/clc_detector.hpp"

#include "tests/support/cones_at.hpp"
#include "tests/support/lane_constraints_reference.hpp"
#include "tests/support/metamorphic.hpp"
#include "tests/support/no_time_limit.hpp"
#include "tests/support/processor_time.hpp"
#include "tests/support/random_scenes.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/straight_lane.hpp"

#include <unordered_map>

#include <boost/random/uniform_01.hpp>

namespace conelane {
namespace {

LaneAnswer detect(const Scene& scene, const ClcOptions& options = {},
                  const DetectionLimits& limits = tests::kNoTimeLimit) {
    return make_clc_detector(options)->detect(scene, limits);
}

/// Left cones have even ids, right ones odd ids, ascending in driving order, `count` a side. The lane winds
/// with the given amplitude of its heading; it is 6 m wide, so that no boundary can cross to the other side,
/// and `random` shifts every cone a little, so that nothing ties.
Scene winding_lane(std::size_t count, double amplitude_rad, unsigned seed) {
    boost::random::mt19937_64 random(seed);
    const auto jitter = [&] { return 0.3 * (boost::random::uniform_01<double>()(random) - 0.5); };
    Scene scene;
    Point centre(1.5, 0.0);
    for (std::size_t i = 0; i < count; ++i) {
        const double heading_rad = amplitude_rad * std::sin(static_cast<double>(i) * 0.4);
        const Point normal(-std::sin(heading_rad), std::cos(heading_rad));
        for (const double offset_m : {3.0, -3.0}) {
            const double dx = jitter();
            const double dy = jitter();
            scene.cones.push_back(
                {static_cast<ConeId>(scene.cones.size()), centre + offset_m * normal + Point(dx, dy)});
        }
        centre += 3.5 * Point(std::cos(heading_rad), std::sin(heading_rad));
    }
    return scene;
}

Scene with_false_positives(Scene scene, std::size_t count, unsigned seed) {
    boost::random::mt19937_64 random(seed);
    for (std::size_t i = 0; i < count; ++i) {
        const double x = 40.0 * boost::random::uniform_01<double>()(random);
        const double y = 40.0 * (boost::random::uniform_01<double>()(random) - 0.5);
        scene.cones.push_back({1000 + static_cast<ConeId>(i), {x, y}});
    }
    return scene;
}

using Lanes = std::set<std::pair<std::vector<ConeId>, std::vector<ConeId>>>;

/// The candidates of an answer, each of which it has once.
Lanes lanes_of(const LaneAnswer& answer) {
    Lanes lanes;
    for (const LaneCandidate& candidate : answer.enumeration->candidates)
        EXPECT_TRUE(lanes.insert({candidate.lane.left, candidate.lane.right}).second) << "met twice";
    return lanes;
}

std::vector<std::pair<std::string, ClcOptions>> variants() {
    ClcOptions warm = extended_clc_options();
    warm.warm_start = true;
    return {{"extended", extended_clc_options()},
            {"paper", paper_clc_options()},
            {"longest", {}},
            {"warm", warm}};
}

/// Adds `cones` cones beside a lane, at one place or, with `spread_m`, around it.
Scene heap(std::size_t cones, double spread_m) {
    Scene scene = tests::straight_lane(6);
    const Scene heaped = tests::strewn_scene(cones, 1.0, 1.0);
    for (const Cone& cone : heaped.cones)
        scene.cones.push_back({1000 + cone.id, spread_m * cone.position + Point(9.0, 2.0)});
    return scene;
}

TEST(ClcDetector, FindsAWindingLaneWhollyWhereverTheCarStands) {
    for (unsigned seed = 0; seed < 40; ++seed) {
        SCOPED_TRACE(seed);
        const Scene turned = tests::rotated(winding_lane(9, 0.5, seed), 0.37 * seed);
        const LaneAnswer answer = detect(tests::moved(turned, {100.0 * seed, -50.0}));
        EXPECT_THAT(answer.lane.left, ElementsAre(0, 2, 4, 6, 8, 10, 12, 14, 16));
        EXPECT_THAT(answer.lane.right, ElementsAre(1, 3, 5, 7, 9, 11, 13, 15, 17));
    }
}

TEST(ClcDetector, CandidatesAreFeasibleDistinctAndHoldTheAnswerAsTheLongest) {
    DetectionLimits limits = tests::kNoTimeLimit;
    limits.keep_candidates = true;
    for (unsigned seed = 0; seed < 20; ++seed) {
        SCOPED_TRACE(seed);
        const Scene scene = with_false_positives(winding_lane(8, 0.4, seed), 12, seed);
        std::unordered_map<ConeId, Point> position_of;
        for (const Cone& cone : scene.cones) position_of[cone.id] = cone.position;
        const auto points = [&](const std::vector<ConeId>& ids) {
            return mapped(ids, [&](const ConeId id) { return position_of.at(id); });
        };
        const auto length_m = [&](const Lane& lane) {
            return (polyline_length_m(points(lane.left), lane.closed) +
                    polyline_length_m(points(lane.right), lane.closed)) /
                   2.0;
        };
        const LaneAnswer answer = detect(scene, {}, limits);
        ASSERT_EQ(answer.status, LaneStatus::found);
        ASSERT_FALSE(answer.enumeration->candidates.empty());
        (void)lanes_of(answer);
        std::int64_t iteration = 0;
        for (const LaneCandidate& candidate : answer.enumeration->candidates) {
            EXPECT_GE(candidate.lane.left.size(), 2u);
            EXPECT_GE(candidate.lane.right.size(), 2u);
            EXPECT_TRUE(satisfies_constraints(points(candidate.lane.left), points(candidate.lane.right), {}));
            EXPECT_LE(iteration, candidate.iteration);
            iteration = candidate.iteration;
            EXPECT_LE(length_m(candidate.lane), length_m(answer.lane) + 1e-9);
        }
        EXPECT_LE(iteration, answer.enumeration->iterations);
        EXPECT_LE(answer.enumeration->iterations, 2500);
    }
}

// The car has missed one cone of a straight lane: that boundary has a gap of 8 m.
TEST(ClcDetector, GoesOnPastAMissedCone) {
    for (std::size_t missed = 1; missed < 7; ++missed) {
        SCOPED_TRACE(missed);
        Scene scene = tests::straight_lane(9);
        scene.cones.erase(scene.cones.begin() + static_cast<std::ptrdiff_t>(2 * missed));
        std::vector<ConeId> left{0, 2, 4, 6, 8, 10, 12, 14, 16};
        left.erase(left.begin() + static_cast<std::ptrdiff_t>(missed));
        const LaneAnswer answer = detect(scene, extended_clc_options());
        EXPECT_EQ(answer.lane.left, left);
        EXPECT_THAT(answer.lane.right, ElementsAre(1, 3, 5, 7, 9, 11, 13, 15, 17));
        // With the 5.5 m of the paper, the lane ends there.
        EXPECT_LE(detect(scene, paper_clc_options()).lane.left.size(), missed);
    }
}

TEST(ClcDetector, AWarmStartFindsTheSameLanesWhereTheSearchIsComplete) {
    ClcOptions options;
    options.iteration_limit = 1'000'000;
    options.starting_pairs = 1;
    options.warm_start = true;
    DetectionLimits limits = tests::kNoTimeLimit;
    limits.keep_candidates = true;
    for (unsigned seed = 0; seed < 15; ++seed) {
        SCOPED_TRACE(seed);
        const Scene scene = with_false_positives(winding_lane(6, 0.4, seed), 6, seed);
        const std::unique_ptr<LaneDetector> detector = make_clc_detector(options);
        const LaneAnswer cold = detector->detect(scene, limits);
        const LaneAnswer warm = detector->detect(scene, limits);
        ASSERT_TRUE(cold.enumeration->complete);
        ASSERT_TRUE(warm.enumeration->complete);
        EXPECT_EQ(lanes_of(cold), lanes_of(warm));
        EXPECT_EQ(cold.lane, warm.lane);
        // The last answer is followed first: one step for each of its cones after the first two.
        const auto steps = static_cast<std::int64_t>(cold.lane.left.size() + cold.lane.right.size() - 2);
        const auto at = std::ranges::find(warm.enumeration->candidates, cold.lane, &LaneCandidate::lane);
        ASSERT_NE(at, warm.enumeration->candidates.end());
        EXPECT_EQ(at->iteration, steps);
    }
}

TEST(ClcDetector, AnExactlySymmetricSceneIsSearchedAlikeFromBothSides) {
    const Scene scene = tests::straight_lane(6, 0.0);
    const LaneAnswer answer = detect(scene);
    const LaneAnswer of_mirrored = detect(tests::mirrored(scene));
    EXPECT_EQ(answer.lane.left, of_mirrored.lane.right);
    EXPECT_EQ(answer.lane.right, of_mirrored.lane.left);
    EXPECT_EQ(answer.enumeration->iterations, of_mirrored.enumeration->iterations);
}

Lanes candidates(const Scene& scene, const ClcOptions& options) {
    DetectionLimits limits = tests::kNoTimeLimit;
    limits.keep_candidates = true;
    const LaneAnswer answer = detect(scene, options, limits);
    EXPECT_LE(answer.enumeration->iterations, options.iteration_limit);
    Lanes lanes;
    for (const LaneCandidate& candidate : answer.enumeration->candidates)
        lanes.emplace(candidate.lane.left, candidate.lane.right);
    return lanes;
}

TEST(ClcDetector, SearchesASecondTimeOnlyWhereTheFirstSearchIsNotComplete) {
    ClcOptions once;
    ClcOptions twice;
    twice.second_search_discrepancies = 3;
    const Scene easy = winding_lane(6, 0.4, 1);
    ASSERT_TRUE(detect(easy, once).enumeration->complete);
    EXPECT_EQ(candidates(easy, twice), candidates(easy, once));
    std::size_t more = 0;
    for (unsigned seed = 0; seed < 10; ++seed) {
        SCOPED_TRACE(seed);
        const Scene hard = with_false_positives(winding_lane(12, 0.4, seed), 40, seed);
        EXPECT_FALSE(detect(hard, twice).enumeration->complete);
        const auto of_one = candidates(hard, once);
        for (const auto& lane : candidates(hard, twice)) more += of_one.contains(lane) ? 0 : 1;
    }
    EXPECT_GT(more, 100u);
}

TEST(ClcDetector, FollowsTheLaneOfTheBeamSearchFirst) {
    // Few more iterations than the lane has vertices.
    std::size_t found = 0;
    std::size_t found_without = 0;
    for (unsigned seed = 0; seed < 30; ++seed) {
        const Scene scene = with_false_positives(winding_lane(9, 0.4, seed), 30, seed);
        ClcOptions options;
        static_cast<CandidateSearchOptions&>(options) = extended_search_options();
        options.second_search_discrepancies = 0;
        options.iteration_limit = 40;
        const auto has_lane = [&] {
            for (const auto& [left, right] : candidates(scene, options)) {
                if (left == std::vector<ConeId>{0, 2, 4, 6, 8, 10, 12, 14, 16} &&
                    right == std::vector<ConeId>{1, 3, 5, 7, 9, 11, 13, 15, 17}) {
                    return true;
                }
            }
            return false;
        };
        found += has_lane() ? 1 : 0;
        options.step_scores = nullptr;
        found_without += has_lane() ? 1 : 0;
    }
    EXPECT_GE(found, 15u);
    EXPECT_GE(found, found_without + 10);
}

TEST(CandidateSearch, EveryCandidateHasTheFeaturesOfItsOwnStart) {
    const Scene scene = with_false_positives(winding_lane(8, 0.3, 5), 12, 5);
    CandidateSearch search(extended_search_options());
    CandidateSearch::Request request;
    request.with_features = true;
    (void)search.run(scene, request);
    const auto names = lane_feature_names();
    const auto feature = [&](std::size_t i, std::string_view name) {
        return search.pairs()
            .features()[i][static_cast<std::size_t>(std::ranges::find(names, name) - names.begin())];
    };
    std::set<std::pair<Vertex, Vertex>> starts;
    for (std::size_t i = 0; i < search.pairs().found().size(); ++i) {
        const PathPairVertices vertices = search.pairs().vertices(search.pairs().found()[i]);
        const StartPair start{vertices[kLeft].front(), vertices[kRight].front()};
        starts.emplace(start.left, start.right);
        const StartPairMeasures measures = start_pair_measures(scene, start);
        ASSERT_EQ(feature(i, "start_asymmetry_m"), measures.asymmetry_m);
        ASSERT_EQ(feature(i, "start_distance_m"), measures.distance_m);
        ASSERT_EQ(feature(i, "start_lead_m"), measures.lead_m);
        ASSERT_EQ(feature(i, "start_shift_m"), measures.shift_m);
        ASSERT_EQ(feature(i, "start_nearest_side_m"), measures.nearest_side_m);
        ASSERT_EQ(feature(i, "start_nearest_ahead_m"), measures.nearest_ahead_m);
        ASSERT_EQ(feature(i, "start_farthest_ahead_m"), measures.farthest_ahead_m);
    }
    EXPECT_GT(starts.size(), 1u);
}

TEST(ClcDetector, ClosesACircuitThatIsSeenWhole) {
    const LaneAnswer answer = detect(tests::circuit_seen_whole());
    EXPECT_TRUE(answer.lane.closed);
    EXPECT_EQ(answer.lane.left.size(), 12u);
    EXPECT_EQ(answer.lane.right.size(), 12u);
}

TEST(ClcDetector, RejectsOptionsOutOfRangeByName) {
    const auto key_of = [](auto change) {
        ClcOptions options;
        change(options);
        return refused_key([&] { (void)make_clc_detector(options); });
    };
    EXPECT_EQ(key_of([](ClcOptions&) {}), "accepted");
    EXPECT_EQ(key_of([](ClcOptions& o) { o.iteration_limit = 0; }), "iteration_limit");
    EXPECT_EQ(key_of([](ClcOptions& o) { o.d_max_m = std::numeric_limits<double>::infinity(); }), "d_max");
    EXPECT_EQ(key_of([](ClcOptions& o) { o.bounds.phi_max_rad = 0.0; }), "phi_max");
    EXPECT_EQ(key_of([](ClcOptions& o) { o.bounds.w_min_m = -1.0; }), "w_min");
    EXPECT_EQ(key_of([](ClcOptions& o) { o.bounds.w_max_m = o.bounds.w_min_m; }), "w_max");
    EXPECT_EQ(key_of([](ClcOptions& o) { o.start.radius_m = 0.0; }), "radius");
    EXPECT_EQ(key_of([](ClcOptions& o) { o.start.radius_growth_m = 0.0; }), "radius_growth");
    EXPECT_EQ(key_of([](ClcOptions& o) { o.start.largest_radius_m = 1.0; }), "largest_radius");
    EXPECT_EQ(key_of([](ClcOptions& o) { o.start.distance_weight = -1.0; }), "distance_weight");
    EXPECT_EQ(key_of([](ClcOptions& o) { o.starting_pairs = 0; }), "starting_pairs");
    EXPECT_EQ(key_of([](ClcOptions& o) { o.beam_width = 0; }), "beam_width");
    EXPECT_EQ(key_of([](ClcOptions& o) { o.step_scores = std::make_shared<StepScores>(); }), "scores");
    EXPECT_EQ(key_of([](ClcOptions& o) { o.next_vertex_distance_weight = -0.1; }),
              "next_vertex_distance_weight");
}

class ThrowingRanking final : public LaneRanking {
  public:
    void score(std::span<const LaneFeatures>, std::span<double>) const override {
        throw std::runtime_error("no scores today");
    }
};

TEST(ClcDetector, ARankingThatThrowsIsAnError) {
    ClcOptions options;
    options.ranking = std::make_shared<ThrowingRanking>();
    const LaneAnswer answer =
        make_clc_detector(options)->detect(tests::straight_lane(5), tests::kNoTimeLimit);
    EXPECT_EQ(answer.status, LaneStatus::error);
    EXPECT_EQ(answer.message, "no scores today");
}

TEST(ClcDetector, NoneOnlyWhereEverythingWasSearched) {
    // The first step goes to a cone that no lane can include; with more steps, a lane is found.
    const Scene scene = tests::straight_lane(4);
    ClcOptions options;
    options.iteration_limit = 1;
    const LaneAnswer one_step = make_clc_detector(options)->detect(scene, tests::kNoTimeLimit);
    EXPECT_EQ(one_step.status, LaneStatus::stopped);
    EXPECT_EQ(one_step.stopped_by, StopReason::iterations);
    EXPECT_FALSE(one_step.enumeration->complete);

    // The nearest pair starts no lane.
    Scene beside = tests::straight_lane(4);
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

    // The nearest cone of each is in the middle of the lane.
    Scene crowded = tests::straight_lane(4);
    for (std::size_t i = 0; i < 4; ++i)
        crowded.cones.push_back({static_cast<ConeId>(2000 + i), {crowded.cones[2 * i].position.x(), 0.0}});
    options = {};
    options.nearest_neighbours = 1;
    options.starting_pairs = 100;
    const LaneAnswer near_only = make_clc_detector(options)->detect(crowded, tests::kNoTimeLimit);
    EXPECT_EQ(near_only.status, LaneStatus::stopped);
    EXPECT_EQ(near_only.stopped_by, StopReason::iterations);
}

TEST(ClcDetector, AFoundLaneTellsWhetherALimitCutTheSearch) {
    ClcOptions options;
    const Scene easy = tests::straight_lane(4);
    EXPECT_FALSE(make_clc_detector(options)->detect(easy, tests::kNoTimeLimit).stopped_by);
    options.iteration_limit = 20;
    const LaneAnswer few = make_clc_detector(options)->detect(easy, tests::kNoTimeLimit);
    EXPECT_EQ(few.status, LaneStatus::found);
    EXPECT_EQ(few.stopped_by, StopReason::iterations);
    options.iteration_limit = std::numeric_limits<std::int64_t>::max();
    const LaneAnswer late =
        make_clc_detector(options)->detect(tests::strewn_scene(300, 30.0, 16.0), {.time_limit_ms = 300.0});
    EXPECT_EQ(late.status, LaneStatus::found);
    EXPECT_EQ(late.stopped_by, StopReason::time);
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

TEST(ClcDetector, TheTimeLimitHoldsInEveryPart) {
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

TEST(ClcDetector, TheMemoryLimitHoldsInGraphAndSearch) {
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
