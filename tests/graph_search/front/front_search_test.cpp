// The search of `front`: how a lane is built, and that the beam finds the best of all lanes.

#include "graph_search/front/front_detector.hpp"
#include "tests/support/front_fixture.hpp"
#include "tests/support/no_time_limit.hpp"
#include "tests/support/random_scenes.hpp"
#include "tests/support/refusal.hpp"

namespace conelane {
namespace {

using tests::random_front_weights;
using tests::straight_front_scene;
using Cones = std::array<std::vector<Vertex>, 2>;

/// All states are kept.
FrontSearchOptions exhaustive() {
    return FrontSearchOptions{.beam_width = std::numeric_limits<std::size_t>::max(),
                              .drop = std::numeric_limits<double>::infinity(),
                              .finished_drop = std::numeric_limits<double>::infinity(),
                              .merge = false};
}

/// A search of the scene, run to its end unless told otherwise.
struct Searched {
    FrontCost cost;
    FrontSearch search;
    SearchBudget unlimited;

    Searched(const Scene& scene, const FrontWeights& weights, const FrontSearchOptions& options,
             bool to_the_end = true)
        : cost(weights) {
        search.begin(scene, cost, options);
        if (to_the_end) search.run(unlimited);
    }
};

/// Every lane of a scene with its score, by plain recursion. The rules about the whole lane are tested again,
/// segment by segment.
class Enumeration {
  public:
    Enumeration(const Scene& scene, const FrontWeights& weights, const FrontRules& rules)
        : cost_(weights), rules_(rules) {
        map_.build(scene);
        FrontStarts starts;
        starts.list(map_, rules_);
        const auto scores = cost_.score_starts(map_, starts);
        const std::vector<float> of_starts(scores.begin(), scores.end());
        for (std::size_t i = 0; i < starts.pairs.size(); ++i) {
            const Vertex left = starts.cones[kLeft][starts.pairs[i].left];
            const Vertex right = starts.cones[kRight][starts.pairs[i].right];
            cones_ = {std::vector{left}, std::vector{right}};
            go_on(start_state(map_, left, right), of_starts[i]);
        }
    }

    std::map<Cones, double> lanes;
    std::size_t met = 0;  ///< number of lanes, each counted as often as it was reached

  private:
    bool is_free(Side side, Vertex to) const {
        for (const std::vector<Vertex>& boundary : cones_) {
            if (std::ranges::count(boundary, to) > 0) return false;
        }
        const Segment added{map_.position(cones_[side].back()), map_.position(to)};
        const std::vector<Vertex>& own = cones_[side];
        for (std::size_t i = 2; i < own.size(); ++i) {
            if (segments_intersect(added, {map_.position(own[i - 2]), map_.position(own[i - 1])}))
                return false;
        }
        const std::vector<Vertex>& other = cones_[opposite(side)];
        for (std::size_t i = 0; i < other.size(); ++i) {
            const Segment facing{map_.position(other[i]), map_.position(other[i == 0 ? 0 : i - 1])};
            if (segment_distance(added, facing).distance_m < rules_.narrowest_m) return false;
        }
        return true;
    }

    void go_on(const FrontState& state, double score) {
        if (state.finished()) {
            ++met;
            lanes.emplace(cones_, score);
            return;
        }
        const Side side = moving_side(map_, state);
        FrontMoves moves;
        moves.list(map_, state, side, rules_);
        const auto scores = cost_.score_moves(map_, state, side, moves);
        const std::vector<float> of_moves(scores.begin(), scores.end());
        for (std::size_t i = 0; i < moves.extensions.size(); ++i) {
            if (!is_free(side, moves.extensions[i].to)) continue;
            cones_[side].push_back(moves.extensions[i].to);
            go_on(moved(map_, state, side, moves.extensions[i]), score + of_moves[i]);
            cones_[side].pop_back();
        }
        if (moves.stops) go_on(moved(map_, state, side, {}), score + of_moves.back());
    }

    FrontCost cost_;
    FrontRules rules_;
    FrontMap map_;
    Cones cones_;
};

TEST(FrontSearch, MeetsEveryLaneOnceAndFindsTheBest) {
    std::size_t lanes = 0;
    for (std::uint64_t seed = 0; seed < 30; ++seed) {
        SCOPED_TRACE(seed);
        const Scene scene = tests::random_scene(seed, 7 + seed % 3);
        const FrontWeights weights = random_front_weights(seed);
        const Enumeration all(scene, weights, {});
        EXPECT_EQ(all.met, all.lanes.size()) << "a lane has one derivation";

        const Searched run(scene, weights, exhaustive());
        const FrontSearch& search = run.search;
        EXPECT_FALSE(search.left_out());
        ASSERT_EQ(search.finished().size(), all.lanes.size());
        std::set<Cones> met;
        for (const FrontSearch::Finished& lane : search.finished()) {
            Cones cones;
            search.cones(lane.parent, cones);
            const auto known = all.lanes.find(cones);
            ASSERT_NE(known, all.lanes.end());
            EXPECT_NEAR(lane.score, known->second, 1e-4);
            EXPECT_TRUE(met.insert(cones).second);
        }
        lanes += met.size();
    }
    EXPECT_GT(lanes, 1000U) << "scenes without lanes show little";
}

TEST(FrontSearch, ALevelHoldsNoMoreThanTheBeam) {
    FrontSearchOptions options = exhaustive();
    options.beam_width = 2;
    Searched run(straight_front_scene(4), random_front_weights(3), options, false);
    FrontSearch& search = run.search;
    std::size_t full = 0;
    while (search.advance(run.unlimited)) {
        EXPECT_LE(search.level().size(), 2U);
        if (search.level().size() == 2) ++full;
    }
    EXPECT_GT(full, 3U);
    EXPECT_TRUE(search.left_out());
}

// Far along the lane, only a third of the beam is kept. Both boundaries together advance 2.5 m a level, so 5
// m along the lane are four levels.
TEST(FrontSearch, AThirdOfTheBeamGoesOnFarAlongTheLane) {
    FrontSearchOptions options = exhaustive();
    options.beam_width = 4;
    options.far_m = 5.0;
    Searched run(straight_front_scene(5), random_front_weights(3), options, false);
    std::size_t near = 0;
    std::size_t far = 0;
    while (run.search.advance(run.unlimited)) {
        std::size_t& widest = run.search.level_number() < 4 ? near : far;
        widest = std::max(widest, run.search.level().size());
    }
    EXPECT_EQ(near, 4U);
    EXPECT_EQ(far, 2U);
}

/// The margin of the best move is its lead over the second one; that of any other is its lag behind the best.
TEST(FrontSearch, OneMoveOfAStateHasAMargin) {
    const Searched run(straight_front_scene(3), random_front_weights(3), exhaustive());
    const FrontSearch& search = run.search;
    std::map<std::size_t, int> best_moves;
    for (std::size_t n = 0; n < search.nodes(); ++n) {
        const FrontSearch::Node& node = search.node(n);
        if (node.parent != FrontSearch::kNone && node.margin > 0.0F) ++best_moves[node.parent];
    }
    EXPECT_GT(best_moves.size(), 10U);
    for (const auto& [state, moves] : best_moves) EXPECT_EQ(moves, 1) << state;
}

// States with the same front are merged although their pasts differ, and a beam drops the worst states: so it
// may miss the best lane, but it never finds a better one.
TEST(FrontSearch, TheBeamIsNeverBetterAndMostlyAsGood) {
    std::size_t as_good = 0;
    std::size_t scenes = 0;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        const Scene scene = tests::random_scene(seed, 10);
        const FrontOptions shipped = shipped_front_options();
        const auto best = [&](const FrontSearchOptions& options) {
            Searched run(scene, shipped.weights, options);
            run.search.sort_finished(1);
            return run.search.finished().empty() ? -1e9 : run.search.finished().front().score;
        };
        const double of_all = best(exhaustive());
        if (of_all == -1e9) continue;
        const double of_beam = best(shipped.search);
        EXPECT_LE(of_beam, of_all + 1e-9);
        ++scenes;
        if (of_beam > of_all - 1e-9) ++as_good;
    }
    EXPECT_GT(scenes, 20U);
    EXPECT_GT(10 * as_good, 8 * scenes);
}

TEST(FrontState, TheSideThatLiesBehindMoves) {
    FrontMap map;
    map.build(straight_front_scene(3));  // the left cones are 0.2 m behind the right ones
    ASSERT_EQ(map.position(0).y(), 1.8);
    FrontState state = start_state(map, 0, 1);
    EXPECT_EQ(moving_side(map, state), kLeft);
    FrontMoves moves;
    moves.list(map, state, kLeft, {});
    EXPECT_FALSE(moves.stops) << "a lane has two cones a side";
    const auto next = std::ranges::find(moves.extensions, Vertex{2}, &FrontMove::to);
    ASSERT_NE(next, moves.extensions.end());
    state = moved(map, state, kLeft, *next);
    EXPECT_EQ(moving_side(map, state), kRight);
    EXPECT_THAT(state.ends[kLeft].cones, ElementsAre(2, 0, kNoCone));
    EXPECT_NEAR(state.ends[kLeft].length_m, 6.0, 1e-6) << "2 m ahead, 4 m on";
    state = moved(map, moved(map, state, kLeft, {}), kRight, {});
    EXPECT_TRUE(state.finished());
}

TEST(FrontState, AStoppedSideLetsTheOtherGoOn) {
    FrontMap map;
    map.build(straight_front_scene(3));
    FrontState state = start_state(map, 0, 1);
    state.ends[kLeft].stopped = true;
    EXPECT_EQ(moving_side(map, state), kRight);
    state.ends[kLeft].stopped = false;
    state.ends[kRight].stopped = true;
    EXPECT_EQ(moving_side(map, state), kLeft);
}

/// Both cones are near enough to the heading to begin either boundary, but one is to the left of the other. A
/// third cone, on the right, is too far away to be the partner of the left one.
TEST(FrontStarts, PairsStandOnTheirSidesAndNotTooFarApart) {
    Scene scene;
    scene.cones = {{0, {2.0, 1.5}}, {1, {2.0, -1.5}}, {2, {2.0, -8.9}}};
    FrontMap map;
    map.build(scene);
    FrontStarts starts;
    starts.list(map, {});
    EXPECT_EQ(starts.cones[kLeft].size(), 2U);
    EXPECT_EQ(starts.cones[kRight].size(), 3U);
    std::set<std::pair<std::size_t, std::size_t>> pairs;
    for (const auto& [left, right] : starts.pairs) {
        pairs.emplace(map.scene_index(starts.cones[kLeft][left]),
                      map.scene_index(starts.cones[kRight][right]));
    }
    EXPECT_THAT(pairs, ElementsAre(std::pair(0U, 1U), std::pair(1U, 2U)));
}

/// The left cone 0 and the right cone 1 begin a lane; a test adds the others, with ids from 2 on.
class Front {
  public:
    explicit Front(const std::vector<Point>& others) {
        scene_.cones = {{0, {2.0, 1.8}}, {1, {2.1, -1.8}}};
        for (const Point& other : others)
            scene_.cones.push_back({static_cast<ConeId>(scene_.cones.size()), other});
        map_.build(scene_);
        state = start_state(map_, 0, 1);
    }

    /// Ids of the cones to which the left side may continue.
    std::vector<ConeId> list(const FrontRules& rules) {
        moves.list(map_, state, kLeft, rules);
        return mapped(moves.extensions,
                      [&](const FrontMove& move) { return scene_.cones[map_.scene_index(move.to)].id; });
    }

    FrontState state;
    FrontMoves moves;

  private:
    Scene scene_;
    FrontMap map_;
};

TEST(FrontMoves, LongSegmentsBridgeAMissedConeButNotOneThatIsThere) {
    EXPECT_THAT(Front({{6.0, 1.8}, {10.0, 1.8}}).list({}), ElementsAre(2)) << "3 stands behind 2";
    EXPECT_THAT(Front({{10.0, 1.8}, {14.0, 1.8}}).list({}), ElementsAre(2)) << "12 m are too far";
}

TEST(FrontMoves, TheOtherBoundaryKeepsItsRoom) {
    Scene scene = straight_front_scene(3);
    scene.cones.push_back({7, {6.0, 0.1}});   // 1.9 m off the right boundary
    scene.cones.push_back({8, {6.0, 0.35}});  // 2.15 m
    FrontMap map;
    map.build(scene);
    FrontState state = start_state(map, 0, 1);
    state.ends[kRight].cones = {map.ahead_between(6.1, 6.3).first, 1, kNoCone};
    state.ends[kRight].count = 2;
    FrontMoves moves;
    moves.list(map, state, kLeft, {});
    std::set<ConeId> to;
    for (const FrontMove& move : moves.extensions) to.insert(scene.cones[map.scene_index(move.to)].id);
    EXPECT_TRUE(to.contains(8));
    EXPECT_FALSE(to.contains(7));
}

/// The cone 3 is 8.1 m from the only cone of the right side.
TEST(FrontMoves, ASideThatGoesOnAloneStaysNearTheOtherOne) {
    Front front({{6.0, 1.8}, {6.5, 5.0}});
    EXPECT_THAT(front.list({}), UnorderedElementsAre(2, 3));
    front.state.ends[kRight].stopped = true;
    EXPECT_THAT(front.list({}), ElementsAre(2));
}

TEST(FrontMoves, OfTheShortSegmentsTheShortestAreListedAndTheRestIsMentioned) {
    Front front({{6.5, 2.2}, {6.0, 1.8}});
    FrontRules rules{.short_segments = 1};
    EXPECT_THAT(front.list(rules), ElementsAre(3));
    EXPECT_TRUE(front.moves.left_out);
    rules.short_segments = 2;
    EXPECT_THAT(front.list(rules), ElementsAre(3, 2));
    EXPECT_FALSE(front.moves.left_out);
}

TEST(FrontMoves, OfTheLongSegmentsTheStraightestAreListed) {
    Front front({{9.5, 4.0}, {10.0, 1.8}, {9.0, -0.2}});
    FrontRules rules{.long_segments = 1};
    EXPECT_THAT(front.list(rules), ElementsAre(3));
    rules.long_segments = 2;
    EXPECT_THAT(front.list(rules), ElementsAre(3, 4));
}

TEST(FrontMap, AnglesAreExactToTwentyMillionths) {
    for (int i = -1800; i <= 1800; ++i) {
        const double angle_rad = i / 10.0 * std::numbers::pi / 180.0;
        EXPECT_NEAR(std::remainder(front_angle(std::sin(angle_rad), std::cos(angle_rad)) - angle_rad,
                                   2.0 * std::numbers::pi),
                    0.0, 2e-5);
    }
    EXPECT_EQ(front_angle(0.0, 0.0), 0.0);
}

TEST(FrontMap, ComputesWhatIsAroundAWay) {
    Scene scene;
    scene.cones = {{0, {0.0, 0.0}}, {1, {4.0, 0.0}}, {2, {2.0, 0.5}}, {3, {2.0, -1.0}}, {4, {8.0, 0.0}}};
    FrontMap map;
    map.build(scene);
    const auto edges = map.edges(0);
    const auto to =
        std::ranges::find_if(edges, [&](const FrontEdge& edge) { return map.position(edge.to).x() == 4.0; });
    ASSERT_NE(to, edges.end());
    const EdgeNeighbourhood about = map.neighbourhood(0, static_cast<std::size_t>(to - edges.begin()));
    EXPECT_FLOAT_EQ(about.nearest_beside[kLeft], 0.75F);
    EXPECT_FLOAT_EQ(about.nearest_beside[kRight], 0.5F);
    EXPECT_FLOAT_EQ(about.beside, 1.25F);
    EXPECT_EQ(about.within_disc, 2.0F);
    EXPECT_FALSE(about.blocked);
    EXPECT_NEAR(about.continuation, 0.0, 1e-5) << "4 m straight on";
}

TEST(FrontMap, WhereConesAreFewWaysGoFarther) {
    Scene scene;
    scene.cones = {{0, {0.0, 0.0}}, {1, {14.0, 0.0}}, {2, {15.0, 0.0}}, {3, {15.6, 0.0}}};
    const auto farthest_m = [&] {
        FrontMap map;
        map.build(scene);
        return map.edges(0).back().length_m;  // of the cone at the origin, which is the first one
    };
    EXPECT_FLOAT_EQ(farthest_m(), 15.0F);
    // Ten near ones, and two beyond: twelve ways in all.
    for (ConeId id = 4; id < 14; ++id) scene.cones.push_back({id, {static_cast<double>(id - 3), 1.0}});
    EXPECT_FLOAT_EQ(farthest_m(), 15.0F);
    scene.cones.push_back({14, {5.0, -1.0}});
    EXPECT_FLOAT_EQ(farthest_m(), 14.0F);
    // Twelve are within 11.5 m now; a thirteenth there counts too.
    scene.cones.push_back({15, {6.0, -1.0}});
    EXPECT_LT(farthest_m(), 11.5F);
    scene.cones.push_back({16, {11.4, 0.0}});
    EXPECT_FLOAT_EQ(farthest_m(), 11.4F);
}

/// Of several rows with the same first inputs; the test after this one has the formula.
TEST(FrontNetwork, ScoresRowsAsItScoresAllTheirInputs) {
    const FrontNetworkWeights w = random_front_weights(3).stop;
    const FrontNetwork network(w);
    boost::random::mt19937_64 random(5);
    boost::random::uniform_real_distribution<float> any(-1.0F, 1.0F);
    for (const std::size_t count : {1U, 2U, 5U}) {
        std::vector<float> first(7);
        std::vector<float> rest(count * (w.inputs - 7));
        for (float& x : first) x = any(random);
        for (float& x : rest) x = any(random);
        FrontSums sums{};
        network.begin(first, sums);
        std::vector<float> scores(count);
        network.score(sums, 7, rest, scores);
        for (std::size_t row = 0; row < count; ++row) {
            std::vector<float> inputs = first;
            const auto from = rest.begin() + static_cast<std::ptrdiff_t>(row * (w.inputs - 7));
            inputs.insert(inputs.end(), from, from + static_cast<std::ptrdiff_t>(w.inputs - 7));
            EXPECT_NEAR(network.score(inputs), scores[row], 1e-4);
        }
    }
}

/// The same sums one at a time, in the order that the network states: every processor gets this result.
TEST(FrontNetwork, IsPlainArithmeticToTheLastBit) {
    const FrontNetworkWeights w = random_front_weights(3).extend;
    const FrontNetwork network(w);
    boost::random::mt19937_64 random(6);
    boost::random::uniform_real_distribution<float> any(-3.0F, 3.0F);
    constexpr std::size_t kUnitsAtOnce = 8;
    for (int round = 0; round < 200; ++round) {
        std::vector<float> inputs(w.inputs);
        for (float& x : inputs) x = any(random);
        float linear = 0.0F;
        for (std::size_t i = 0; i < w.inputs; ++i) linear += w.linear[i] * inputs[i];
        std::vector<float> parts(kUnitsAtOnce, 0.0F);
        for (std::size_t unit = 0; unit < kFrontUnits; ++unit) {
            float sum = w.hidden_bias[unit];
            for (std::size_t i = 0; i < w.inputs; ++i) sum += inputs[i] * w.hidden[i * kFrontUnits + unit];
            parts[unit % kUnitsAtOnce] += w.output[unit] * (sum > 0.0F ? sum : 0.0F);
        }
        float expected = w.output_bias + linear;
        for (const float part : parts) expected += part;
        EXPECT_EQ(network.score(inputs), expected);
    }
}

LaneAnswer detect(const Scene& scene, const DetectionLimits& limits = tests::kNoTimeLimit) {
    return make_front_detector(shipped_front_options())->detect(scene, limits);
}

/// The lane of a straight of six cones a side, without or with other cones.
TEST(FrontDetector, FollowsAStraightOverAMissedConeAndPastFalseOnes) {
    const Lane whole{{0, 1, 2, 3, 4, 5}, {100, 101, 102, 103, 104, 105}};
    const Scene scene = straight_front_scene(6);
    EXPECT_EQ(detect(scene).lane, whole);
    Scene without = scene;
    std::erase_if(without.cones, [](const Cone& cone) { return cone.id == 3; });
    EXPECT_EQ(detect(without).lane, (Lane{{0, 1, 2, 4, 5}, whole.right}));
    Scene with = scene;
    with.cones.push_back({50, {12.0, 3.4}});
    with.cones.push_back({51, {8.0, -0.2}});
    EXPECT_EQ(detect(with).lane, whole);
}

/// A hairpin to the left: 8 m straight, then half a circle of the radius to the centre line, then back.
Scene hairpin(double radius_m) {
    Scene scene;
    const auto add = [&](ConeId id, double offset_m, double spacing_m) {
        // offset_m: of the boundary from the centre line, positive to the right
        const double r = radius_m + offset_m;
        for (double back_m = spacing_m * std::floor(7.5 / spacing_m); back_m > 0.1; back_m -= spacing_m)
            scene.cones.push_back({id++, {8.0 - back_m, -offset_m}});
        const int steps = std::max(2, static_cast<int>(r * std::numbers::pi / spacing_m));
        for (int i = 0; i <= steps; ++i) {
            const double angle_rad = std::numbers::pi * i / steps;
            scene.cones.push_back(
                {id++, {8.0 + r * std::sin(angle_rad), radius_m - r * std::cos(angle_rad)}});
        }
        for (double x = 8.0 - spacing_m; x > 0.5; x -= spacing_m)
            scene.cones.push_back({id++, {x, 2.0 * radius_m + offset_m}});
    };
    add(0, -1.7, 2.5);
    add(100, 1.7, 3.0);
    return scene;
}

/// A lane stores its cones as bits by number, which repeat from 256 on. Cones beside the lane raise numbers.
TEST(FrontDetector, FollowsAStraightOfManyCones) {
    Scene scene = straight_front_scene(70);
    for (int k = 0; k < 200; ++k) scene.cones.insert(scene.cones.begin() + 70, {1000 + k, {1.5 * k, 30.0}});
    const LaneAnswer answer = detect(scene);
    EXPECT_EQ(answer.lane.left.size(), 70U);
    EXPECT_EQ(answer.lane.right.size(), 70U);
}

TEST(FrontDetector, DrivesAHairpin) {
    const Scene scene = hairpin(5.0);
    const LaneAnswer answer = detect(scene);
    ASSERT_EQ(answer.status, LaneStatus::found);
    for (const auto& [side, first] : {std::pair(answer.lane.left, 0), std::pair(answer.lane.right, 100)}) {
        ASSERT_GE(side.size(), 8U) << "past the apex";
        for (std::size_t i = 0; i < side.size(); ++i) EXPECT_EQ(side[i], first + static_cast<int>(i));
    }
}

// Far ends are dropped if the other side is more than 6.5 m away; a lane that is wide everywhere would be
// lost completely.
TEST(FrontDetector, AWideLaneIsALane) {
    Scene scene = straight_front_scene(6);
    for (Cone& cone : scene.cones) cone.position.y() *= 2.0;  // 7.2 m
    FrontMap map;
    map.build(scene);
    std::array<std::vector<Vertex>, 2> cones;
    for (Vertex cone = 0; cone < map.size(); ++cone)
        cones[map.position(cone).y() > 0.0 ? kLeft : kRight].push_back(cone);
    even_far_ends(map, cones);
    EXPECT_THAT(cones[kLeft], testing::SizeIs(6));
    EXPECT_THAT(cones[kRight], testing::SizeIs(6));

    scene.cones.back().position.y() -= 4.0;  // 11 m off: more than a quarter
    map.build(scene);
    even_far_ends(map, cones);
    EXPECT_THAT(cones[kLeft], testing::SizeIs(6));
    EXPECT_THAT(cones[kRight], testing::SizeIs(5));
}

TEST(FrontDetector, ADeadlineGivesTheBestLaneSoFar) {
    Scene scene = straight_front_scene(14);
    for (const Cone& cone : tests::strewn_scene(300, 50.0, 50.0).cones)
        scene.cones.push_back({1000 + cone.id, cone.position});
    const auto detector = make_front_detector(shipped_front_options());
    bool cut_off = false;
    for (double limit_ms = 0.1; limit_ms < 400.0; limit_ms *= 1.3) {
        const LaneAnswer answer = detector->detect(scene, {.time_limit_ms = limit_ms});
        if (!answer.stopped_by) continue;
        EXPECT_EQ(answer.stopped_by, StopReason::time);
        if (answer.status != LaneStatus::found) continue;
        cut_off = true;
        EXPECT_GE(answer.lane.left.size(), 2U);
        EXPECT_GE(answer.lane.right.size(), 2U);
    }
    EXPECT_TRUE(cut_off);
}

/// Found by fuzzing: as float, such a segment has no length, so its direction was not a number.
TEST(FrontDetector, TwoConesAlmostAtOnePlaceAreNoSegment) {
    Scene scene{.id = "nearly one place", .pose = {{0.0, 0.0}, 0.6}, .cones = {}};
    scene.cones = {{1, {0.0, 0.0}},
                   {2, {6.291347651660108, 2.476074458886653}},
                   {3, {7.484855347926502e-63, -1.807003929336495e-62}},
                   {4, {6.199503627892487, 2.697805546689361}}};
    for (const double yaw : {0.0, 0.6, 1.2, -2.5}) {
        scene.pose.yaw_rad = yaw;
        const LaneAnswer answer =
            make_front_detector(shipped_front_options())->detect(scene, tests::kNoTimeLimit);
        ASSERT_NE(answer.status, LaneStatus::error) << answer.message;
        EXPECT_TRUE(std::isfinite(answer.confidence.value_or(0.0))) << yaw;
    }
}

TEST(FrontDetector, OptionsOutOfRangeAreNamed) {
    const auto key_of = [](auto change) -> std::string {
        FrontOptions options{FrontWeights::zero(), {}};
        change(options);
        return refused_key([&] { (void)make_front_detector(options); });
    };
    EXPECT_EQ(key_of([](auto&) {}), "accepted");
    EXPECT_EQ(key_of([](auto& o) { o.search.beam_width = 0; }), "beam_width");
    EXPECT_EQ(key_of([](auto& o) { o.search.drop = 0.0; }), "drop");
    EXPECT_EQ(key_of([](auto& o) { o.search.finished_drop = -1.0; }), "finished_drop");
    EXPECT_EQ(key_of([](auto& o) { o.search.level_m = 0.0; }), "level_m");
    EXPECT_EQ(key_of([](auto& o) { o.search.far_m = -1.0; }), "far_m");
    EXPECT_EQ(key_of([](auto& o) { o.search.far_m = std::nan(""); }), "far_m");
    EXPECT_EQ(key_of([](auto& o) { o.weights.extend.inputs = 3; }), "extend.inputs");
    EXPECT_EQ(key_of([](auto& o) { o.weights.stop.hidden.pop_back(); }), "stop.hidden");
    EXPECT_EQ(key_of([](auto& o) { o.weights.start.linear[2] = std::nanf(""); }), "start.linear");
}

}  // namespace
}  // namespace conelane
