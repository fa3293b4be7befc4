#include "graph_search/clc/clc_detector.hpp"

#include "conelane/invalid_input.hpp"
#include "graph_search/clc/lane_features.hpp"
#include "graph_search/clc/start_vertices.hpp"
#include "tests/support/lane_constraints_reference.hpp"
#include "tests/support/no_time_limit.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/testing.hpp"

#include <unordered_map>

#include <boost/random/uniform_01.hpp>

namespace conelane {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

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

Scene mirrored(Scene scene) {
    for (Cone& cone : scene.cones) cone.position.y() = -cone.position.y();
    return scene;
}

TEST(ClcDetector, FindsAStraightLaneAmongNothingElse) {
    Scene scene;
    for (const double x : {1.0, 5.0, 9.0}) {
        scene.cones.push_back({static_cast<ConeId>(10 * x), {x, 1.8}});
        scene.cones.push_back({static_cast<ConeId>(10 * x + 1), {x, -1.8}});
    }
    const LaneAnswer answer = detect(scene);
    EXPECT_EQ(answer.status, LaneStatus::found);
    EXPECT_THAT(answer.lane.left, ElementsAre(10, 50, 90));
    EXPECT_THAT(answer.lane.right, ElementsAre(11, 51, 91));
    EXPECT_FALSE(answer.lane.closed);
    ASSERT_TRUE(answer.enumeration);
    EXPECT_TRUE(answer.enumeration->complete);
    EXPECT_THAT(answer.enumeration->candidates, IsEmpty());
}

TEST(ClcDetector, FindsAWindingLaneWhollyWhereverTheCarStands) {
    for (unsigned seed = 0; seed < 40; ++seed) {
        SCOPED_TRACE(seed);
        Scene scene = winding_lane(9, 0.5, seed);
        const double yaw_rad = 0.37 * seed;
        const Point position(100.0 * seed, -50.0);
        scene.pose = {position, yaw_rad};
        for (Cone& cone : scene.cones) {
            const Point p = cone.position;
            cone.position = position + Point(std::cos(yaw_rad) * p.x() - std::sin(yaw_rad) * p.y(),
                                             std::sin(yaw_rad) * p.x() + std::cos(yaw_rad) * p.y());
        }
        const LaneAnswer answer = detect(scene);
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
            std::vector<Point> boundary;
            for (const ConeId id : ids) boundary.push_back(position_of.at(id));
            return boundary;
        };
        const auto length_m = [&](const Lane& lane) {
            return (polyline_length_m(points(lane.left), lane.closed) +
                    polyline_length_m(points(lane.right), lane.closed)) /
                   2.0;
        };
        const LaneAnswer answer = detect(scene, {}, limits);
        ASSERT_EQ(answer.status, LaneStatus::found);
        ASSERT_FALSE(answer.enumeration->candidates.empty());
        std::set<std::pair<std::vector<ConeId>, std::vector<ConeId>>> distinct;
        std::int64_t iteration = 0;
        for (const LaneCandidate& candidate : answer.enumeration->candidates) {
            EXPECT_GE(candidate.lane.left.size(), 2u);
            EXPECT_GE(candidate.lane.right.size(), 2u);
            EXPECT_TRUE(satisfies_constraints(points(candidate.lane.left), points(candidate.lane.right), {}));
            EXPECT_TRUE(distinct.insert({candidate.lane.left, candidate.lane.right}).second);
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
        Scene scene;
        for (int i = 0; i < 9; ++i) {
            const double x = 1.0 + 4.0 * i;
            scene.cones.push_back({2 * i, {x, 1.8}});
            scene.cones.push_back({2 * i + 1, {x + 0.2, -1.8}});
        }
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

TEST(ClcDetector, AMirroredSceneHasTheMirroredLane) {
    for (unsigned seed = 0; seed < 60; ++seed) {
        SCOPED_TRACE(seed);
        const Scene scene = with_false_positives(winding_lane(8, 0.4, seed), seed % 20, seed);
        const LaneAnswer answer = detect(scene);
        const LaneAnswer of_mirrored = detect(mirrored(scene));
        EXPECT_EQ(answer.lane.left, of_mirrored.lane.right);
        EXPECT_EQ(answer.lane.right, of_mirrored.lane.left);
        EXPECT_EQ(answer.enumeration->iterations, of_mirrored.enumeration->iterations);
    }
}

TEST(ClcDetector, TheRankingOfAMirroredSceneIsTheSame) {
    for (const ClcOptions& options : {paper_clc_options(), extended_clc_options()}) {
        for (unsigned seed = 0; seed < 40; ++seed) {
            SCOPED_TRACE(seed);
            const Scene scene = with_false_positives(winding_lane(8, 0.4, seed), seed % 20, seed);
            const LaneAnswer answer = detect(scene, options);
            const LaneAnswer of_mirrored = detect(mirrored(scene), options);
            EXPECT_EQ(answer.lane.left, of_mirrored.lane.right);
            EXPECT_EQ(answer.lane.right, of_mirrored.lane.left);
        }
    }
}

TEST(ClcDetector, AWarmStartFindsTheSameLanesWhereTheSearchIsComplete) {
    ClcOptions options;
    options.iteration_limit = 1'000'000;
    options.starting_pairs = 1;
    options.warm_start = true;
    DetectionLimits limits = tests::kNoTimeLimit;
    limits.keep_candidates = true;
    const auto candidates = [](const LaneAnswer& answer) {
        std::set<std::pair<std::vector<ConeId>, std::vector<ConeId>>> lanes;
        for (const LaneCandidate& candidate : answer.enumeration->candidates) {
            EXPECT_TRUE(lanes.insert({candidate.lane.left, candidate.lane.right}).second) << "met twice";
        }
        return lanes;
    };
    for (unsigned seed = 0; seed < 15; ++seed) {
        SCOPED_TRACE(seed);
        const Scene scene = with_false_positives(winding_lane(6, 0.4, seed), 6, seed);
        const std::unique_ptr<LaneDetector> detector = make_clc_detector(options);
        const LaneAnswer cold = detector->detect(scene, limits);
        const LaneAnswer warm = detector->detect(scene, limits);
        ASSERT_TRUE(cold.enumeration->complete);
        ASSERT_TRUE(warm.enumeration->complete);
        EXPECT_EQ(candidates(cold), candidates(warm));
        EXPECT_EQ(cold.lane, warm.lane);
        // The last answer is followed first: one step for each of its cones after the first two.
        const auto steps = static_cast<std::int64_t>(cold.lane.left.size() + cold.lane.right.size() - 2);
        const auto at = std::ranges::find(warm.enumeration->candidates, cold.lane, &LaneCandidate::lane);
        ASSERT_NE(at, warm.enumeration->candidates.end());
        EXPECT_EQ(at->iteration, steps);
    }
}

TEST(ClcDetector, ResetForgetsTheLastLane) {
    ClcOptions options;
    options.warm_start = true;
    const std::unique_ptr<LaneDetector> detector = make_clc_detector(options);
    DetectionLimits limits = tests::kNoTimeLimit;
    limits.keep_candidates = true;
    const Scene scene = with_false_positives(winding_lane(10, 0.4, 2), 20, 2);
    const auto order = [&] {
        const LaneAnswer answer = detector->detect(scene, limits);
        std::vector<Lane> lanes;
        for (const LaneCandidate& candidate : answer.enumeration->candidates) lanes.push_back(candidate.lane);
        return lanes;
    };
    const std::vector<Lane> cold = order();
    detector->reset();
    EXPECT_EQ(order(), cold);
}

TEST(ClcDetector, AnExactlySymmetricSceneIsSearchedAlikeFromBothSides) {
    Scene scene;
    for (int i = 0; i < 6; ++i) {
        scene.cones.push_back({2 * i, {1.0 + 4.0 * i, 1.8}});
        scene.cones.push_back({2 * i + 1, {1.0 + 4.0 * i, -1.8}});
    }
    const LaneAnswer answer = detect(scene);
    const LaneAnswer of_mirrored = detect(mirrored(scene));
    EXPECT_EQ(answer.lane.left, of_mirrored.lane.right);
    EXPECT_EQ(answer.lane.right, of_mirrored.lane.left);
    EXPECT_EQ(answer.enumeration->iterations, of_mirrored.enumeration->iterations);
}

TEST(ClcDetector, AnswersTheSameOnEachCallAndInAnyOrderOfTheCones) {
    for (const ClcOptions& options : {ClcOptions{}, extended_clc_options()}) {
        const std::unique_ptr<LaneDetector> detector = make_clc_detector(options);
        for (unsigned seed = 0; seed < 20; ++seed) {
            SCOPED_TRACE(seed);
            Scene scene = with_false_positives(winding_lane(8, 0.4, seed), 15, seed);
            const LaneAnswer first = detector->detect(scene, tests::kNoTimeLimit);
            EXPECT_EQ(detector->detect(scene, tests::kNoTimeLimit).lane, first.lane);
            std::ranges::reverse(scene.cones);
            const LaneAnswer reversed = detector->detect(scene, tests::kNoTimeLimit);
            EXPECT_EQ(reversed.lane, first.lane);
            EXPECT_EQ(reversed.enumeration->iterations, first.enumeration->iterations);
        }
    }
}

TEST(ClcDetector, TriesOtherStartsWhereFalsePositivesStandAtTheCar) {
    Scene scene;
    for (const double x : {3.0, 7.0, 11.0, 15.0}) {
        scene.cones.push_back({static_cast<ConeId>(10 * x), {x, 1.8}});
        scene.cones.push_back({static_cast<ConeId>(10 * x + 1), {x, -1.8}});
    }
    // Too far from everything else, but the most symmetric and the nearest pair.
    scene.cones.push_back({1000, {-2.7, 1.4}});
    scene.cones.push_back({1001, {-2.7, -1.4}});
    ClcOptions one;
    one.starting_pairs = 1;
    EXPECT_EQ(detect(scene, one).status, LaneStatus::stopped);
    EXPECT_THAT(detect(scene).lane.left, ElementsAre(30, 70, 110, 150));
}

std::set<std::pair<std::vector<ConeId>, std::vector<ConeId>>> candidates(const Scene& scene,
                                                                         const ClcOptions& options) {
    const LaneAnswer answer = detect(scene, options, {.keep_candidates = true});
    EXPECT_LE(answer.enumeration->iterations, options.iteration_limit);
    std::set<std::pair<std::vector<ConeId>, std::vector<ConeId>>> lanes;
    for (const LaneCandidate& candidate : answer.enumeration->candidates) {
        lanes.emplace(candidate.lane.left, candidate.lane.right);
    }
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
    Scene scene;
    for (int i = 0; i < 12; ++i) {
        const double angle = 2.0 * 3.14159265358979 * (i + 0.3) / 12.0;
        for (const double radius_m : {6.0, 9.5}) {
            scene.cones.push_back({static_cast<ConeId>(scene.cones.size()),
                                   {radius_m * std::sin(angle), 7.75 - radius_m * std::cos(angle)}});
        }
    }
    const LaneAnswer answer = detect(scene);
    EXPECT_TRUE(answer.lane.closed);
    EXPECT_EQ(answer.lane.left.size(), 12u);
    EXPECT_EQ(answer.lane.right.size(), 12u);
}

TEST(ClcDetector, SaysWhyThereIsNoLane) {
    EXPECT_EQ(detect({}).status, LaneStatus::none);
    EXPECT_TRUE(detect({}).enumeration->complete);
    Scene one_cone_a_side;
    one_cone_a_side.cones = {{0, {1, 1.8}}, {1, {1, -1.8}}};
    EXPECT_EQ(detect(one_cone_a_side).status, LaneStatus::none);
    Scene heap;
    for (int i = 0; i < 30; ++i) heap.cones.push_back({i, {1.0, 1.5}});
    EXPECT_EQ(detect(heap).status, LaneStatus::none);
    DetectionLimits no_time;
    no_time.time_limit_ms = 0.0;
    const LaneAnswer late = detect(winding_lane(8, 0.4, 1), {}, no_time);
    EXPECT_EQ(late.status, LaneStatus::stopped);
    EXPECT_THAT(late.lane.left, IsEmpty());
    EXPECT_FALSE(late.enumeration->complete);
}

TEST(ClcDetector, WhatWasFoundInTimeIsAnAnswer) {
    ClcOptions endless;
    endless.iteration_limit = std::numeric_limits<std::int64_t>::max();
    DetectionLimits limits = tests::kNoTimeLimit;
    limits.time_limit_ms = 20.0;
    const LaneAnswer answer = detect(with_false_positives(winding_lane(20, 0.3, 3), 60, 3), endless, limits);
    EXPECT_EQ(answer.status, LaneStatus::found);
    EXPECT_FALSE(answer.enumeration->complete);
    EXPECT_GT(answer.enumeration->iterations, 32);
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

}  // namespace
}  // namespace conelane
