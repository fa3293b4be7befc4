#include "graph_search/clc/lane_beam.hpp"

#include "graph_search/clc/start_vertices.hpp"
#include "tests/support/cones_at.hpp"
#include "tests/support/metamorphic.hpp"
#include "tests/support/refusal.hpp"

namespace conelane {
namespace {

using tests::cones_at;

StepScores zero_scores() {
    return {std::vector<double>(step_score_count(), 0.0)};
}

double& score_at(StepScores& scores, std::size_t measure, std::size_t place) {
    return scores.values[step_score_count(measure) + place];
}

/// A score for each step, lower for turns and changes of width, and one for pairs near the car.
StepScores sensible_scores() {
    StepScores scores = zero_scores();
    score_at(scores, kStepsMeasure, 0) = 3.0;
    const auto fall = [&](std::size_t measure, double by) {
        for (std::size_t i = 0; i < step_measures()[measure].scores; ++i)
            score_at(scores, measure, i) = -by * static_cast<double>(i);
    };
    fall(kStartDistanceMeasure, 0.5);
    fall(kStartAsymmetryMeasure, 0.3);
    fall(kFirstTurnMeasure, 0.4);
    fall(kTurnMeasure, 0.4);
    fall(kSkewMeasure, 0.2);
    fall(kSegmentMeasure, 0.1);
    return scores;
}

/// Six pairs along a straight, slightly shifted, and false positives.
Scene random_scene(unsigned seed, std::size_t false_positives) {
    boost::random::mt19937_64 random(seed);
    boost::random::uniform_real_distribution<> shake(-0.4, 0.4);
    boost::random::uniform_real_distribution<> ahead(0.0, 22.0);
    boost::random::uniform_real_distribution<> across(-5.0, 5.0);
    std::vector<Point> points;
    for (int i = 0; i < 6; ++i) {
        for (const double side : {1.9, -1.9}) {
            const double x = 1.0 + 3.6 * i + shake(random);
            points.emplace_back(x, side + shake(random));
        }
    }
    for (std::size_t i = 0; i < false_positives; ++i) {
        const double x = ahead(random);
        points.emplace_back(x, across(random));
    }
    return cones_at(points);
}

std::vector<StartPair> all_pairs(const Scene& scene) {
    return start_pairs(scene, std::numeric_limits<std::size_t>::max(), {});
}

struct Search {
    Scene scene;
    StepScores scores;
    SearchGraph graph;
    LaneBeam beam;
    SearchBudget budget;  ///< without a time limit

    Search(Scene of, StepScores by) : scene(std::move(of)), scores(std::move(by)) {
        graph.build(mapped(scene.cones, &Cone::position), 5.5);
    }
    void start(std::size_t width) { beam.start(graph, scene, all_pairs(scene), scores, {}, width); }
    std::optional<std::size_t> best(std::size_t width) {
        start(width);
        const std::size_t number = beam.run(budget);
        return number == LaneBeam::kNone ? std::nullopt : std::optional(number);
    }
};

/// The number of vertices of a lane, each of which it has once.
std::size_t distinct_vertices(const LaneBeam& beam, std::size_t number) {
    const PathPairVertices lane = beam.vertices(number);
    std::set<Vertex> distinct(lane[kLeft].begin(), lane[kLeft].end());
    distinct.insert(lane[kRight].begin(), lane[kRight].end());
    EXPECT_EQ(distinct.size(), lane[kLeft].size() + lane[kRight].size()) << "a vertex twice";
    return distinct.size();
}

TEST(LaneBeam, LeavesOutStepsBeyondTheReach) {
    std::size_t shorter = 0;
    for (unsigned seed = 0; seed < 10; ++seed) {
        SCOPED_TRACE(seed);
        Search search(random_scene(seed, 12), sensible_scores());
        const auto starts = all_pairs(search.scene);
        StepReach reach;
        reach.reset(search.graph, 3);
        search.beam.start(search.graph, search.scene, starts, search.scores, {}, 8, &reach);
        while (search.beam.advance(search.budget)) {
            for (const std::size_t number : search.beam.level()) {
                const LaneBeam::State& state = search.beam.state(number);
                const Vertex from = state.before[state.pushed];
                const Point step =
                    search.graph.position(state.last[state.pushed]) - search.graph.position(from);
                ASSERT_LE(step.squaredNorm(), reach.squared_m2(from));
                ++shorter;
            }
        }
    }
    EXPECT_GT(shorter, 100u) << "steps were looked at";
}

TEST(StepScores, AreInterpolatedAndStayBeyondTheirEnds) {
    StepScores scores = zero_scores();
    score_at(scores, kWidthMeasure, 0) = 1.0;
    score_at(scores, kWidthMeasure, 1) = 3.0;
    score_at(scores, kWidthMeasure, 12) = -2.0;
    score_at(scores, kStepsMeasure, 0) = 10.0;
    const auto score = [&](double width_m) {
        StepMeasures step;
        step.fill(std::numeric_limits<double>::quiet_NaN());
        step[kWidthMeasure] = width_m;
        return scores.score(step);
    };
    EXPECT_DOUBLE_EQ(score(2.5), 1.0) << "the other measures are not there";
    EXPECT_DOUBLE_EQ(score(2.75), 2.0);
    EXPECT_DOUBLE_EQ(score(3.0), 3.0);
    EXPECT_DOUBLE_EQ(score(0.0), 1.0);
    EXPECT_DOUBLE_EQ(score(8.25), -1.0);
    EXPECT_DOUBLE_EQ(score(100.0), -2.0);
}

TEST(StepScores, DerivativesEqualFiniteDifferences) {
    StepScores scores = sensible_scores();
    StepMeasures step;
    step.fill(std::numeric_limits<double>::quiet_NaN());
    step[kStepsMeasure] = 0.0;
    step[kTurnMeasure] = 0.31;
    step[kWidthMeasure] = 4.1;
    step[kBesideMeasure] = 2.0;
    step[kAdvanceMeasure] = -50.0;
    std::vector<double> derivatives(step_score_count(), 0.0);
    add_score_derivatives(step, 2.0, derivatives);
    for (std::size_t i = 0; i < derivatives.size(); ++i) {
        const double before = scores.score(step);
        scores.values[i] += 1.0;
        EXPECT_NEAR(derivatives[i], 2.0 * (scores.score(step) - before), 1e-12) << i;
        scores.values[i] -= 1.0;
    }
}

TEST(StepScores, ErrorsNameTheirEntry) {
    const auto key_of = [](const StepScores& scores) { return refused_key([&] { validate(scores); }); };
    StepScores scores = zero_scores();
    EXPECT_EQ(key_of(scores), "accepted");
    scores.values[3] = std::numeric_limits<double>::infinity();
    EXPECT_EQ(key_of(scores), "scores[3]");
    scores.values.pop_back();
    EXPECT_EQ(key_of(scores), "scores");
}

TEST(LaneBeam, MeasuresStepsByHand) {
    // Left 0, 2, 4, right 1, 3; cone 5 lies 0.5 m beside the segment from 2 to 4 and inside of the lane.
    Search search(cones_at({{0, 2}, {0, -2}, {3, 2}, {4, -2}, {6, 3}, {4.5, 2}}), zero_scores());
    search.start(1);
    std::size_t number = search.beam.add_start({0, 1});
    const StepMeasures start = search.beam.state(number).step;
    EXPECT_DOUBLE_EQ(start[kStartWidthMeasure], 4.0);
    EXPECT_DOUBLE_EQ(start[kStartAsymmetryMeasure], 0.0);
    EXPECT_DOUBLE_EQ(start[kStartDistanceMeasure], 2.0);
    EXPECT_DOUBLE_EQ(start[kStartLeadMeasure], 0.0);
    EXPECT_TRUE(std::isnan(start[kStepsMeasure]));
    EXPECT_EQ(search.beam.next_side(search.beam.state(number)), kLeft) << "a tie: the smaller vertex";
    number = search.beam.extend(number, 2);
    const StepMeasures first = search.beam.state(number).step;
    EXPECT_DOUBLE_EQ(first[kSegmentMeasure], 3.0);
    EXPECT_DOUBLE_EQ(first[kFirstTurnMeasure], 0.0);
    EXPECT_DOUBLE_EQ(first[kWidthMeasure], 5.0) << "to a side of one vertex";
    EXPECT_DOUBLE_EQ(first[kWidthChangeMeasure], 1.0);
    EXPECT_DOUBLE_EQ(first[kAdvanceMeasure], 3.0);
    EXPECT_TRUE(std::isnan(first[kTurnMeasure]));
    EXPECT_TRUE(std::isnan(first[kSkewMeasure]));
    EXPECT_TRUE(std::isnan(first[kStartWidthMeasure]));
    EXPECT_EQ(search.beam.next_side(search.beam.state(number)), kRight);
    number = search.beam.extend(number, 3);
    EXPECT_DOUBLE_EQ(search.beam.state(number).step[kWidthMeasure], std::sqrt(17.0));
    EXPECT_EQ(search.beam.next_side(search.beam.state(number)), kLeft);
    number = search.beam.extend(number, 4);
    const LaneBeam::State& last = search.beam.state(number);
    const double turn_rad = std::atan2(1.0, 3.0);
    EXPECT_DOUBLE_EQ(last.step[kSegmentMeasure], std::sqrt(10.0));
    EXPECT_DOUBLE_EQ(last.step[kTurnMeasure], turn_rad);
    EXPECT_DOUBLE_EQ(last.step[kTurnTimesSegmentMeasure], turn_rad * std::sqrt(10.0));
    EXPECT_NEAR(last.step[kSegmentChangeMeasure], std::sqrt(10.0) - 3.0, 1e-12);
    EXPECT_TRUE(std::isnan(last.step[kTurnChangeMeasure])) << "one turn only";
    EXPECT_DOUBLE_EQ(last.step[kSkewMeasure], turn_rad);
    EXPECT_DOUBLE_EQ(last.step[kWidthMeasure], std::sqrt(29.0));
    EXPECT_EQ(last.step[kBesideMeasure], 1.0);
    EXPECT_EQ(last.step[kCloseMeasure], 1.0);
    EXPECT_EQ(last.step[kInsideMeasure], 1.0);
    EXPECT_EQ(last.vertices, (std::array<std::size_t, 2>{3, 2}));
    const PathPairVertices lane = search.beam.vertices(number);
    EXPECT_THAT(lane[kLeft], ElementsAre(0, 2, 4));
    EXPECT_THAT(lane[kRight], ElementsAre(1, 3));
}

TEST(LaneBeam, RefusesSharpTurnsVerticesNearTheOtherSideAndThoseOnTheLane) {
    Search search(cones_at({{0, 2}, {3, -2}, {3, 2}, {3.1, 4}, {2.9, 5}, {4.5, 0.4}}), zero_scores());
    search.start(1);
    const std::size_t start = search.beam.add_start({0, 1});
    const std::size_t number = search.beam.extend(start, 2);
    ASSERT_NE(number, LaneBeam::kNone);
    EXPECT_EQ(search.beam.extend(start, 1), LaneBeam::kNone) << "on the lane";
    const std::size_t on = search.beam.add_start({2, 1});
    EXPECT_EQ(search.beam.next_side(search.beam.state(on)), kRight);
    EXPECT_EQ(search.beam.extend(on, 5), LaneBeam::kNone) << "2.2 m off the left vertex";
    // From 0 over 2 the boundary would turn by more than a right angle to 4.
    Search turning(cones_at({{0, 2}, {8, -2}, {3, 2}, {2.9, 5}, {3.1, 5}}), zero_scores());
    turning.start(1);
    const std::size_t straight = turning.beam.extend(turning.beam.add_start({0, 1}), 2);
    EXPECT_EQ(turning.beam.extend(straight, 3), LaneBeam::kNone);
    EXPECT_NE(turning.beam.extend(straight, 4), LaneBeam::kNone);
}

TEST(LaneBeam, FindsTheWholeLaneBesideAFalseStart) {
    // False positives 12 and 13 are the nearest pair, 14 stands beside the left boundary.
    Scene scene = random_scene(1, 0);
    scene.cones.push_back({12, {0.2, 3.4}});
    scene.cones.push_back({13, {0.1, -0.3}});
    scene.cones.push_back({14, {10.0, 3.2}});
    Search search(scene, sensible_scores());
    const std::optional<std::size_t> best = search.best(8);
    ASSERT_TRUE(best);
    const PathPairVertices lane = search.beam.vertices(*best);
    EXPECT_THAT(lane[kLeft], ElementsAre(0, 2, 4, 6, 8, 10));
    EXPECT_THAT(lane[kRight], ElementsAre(1, 3, 5, 7, 9, 11));
}

/// Scores that also judge what lies about a step, for better and for worse.
StepScores neighbourhood_scores() {
    StepScores scores = sensible_scores();
    for (const std::size_t measure : {kBesideMeasure, kCloseMeasure, kInsideMeasure}) {
        for (std::size_t i = 0; i < step_measures()[measure].scores; ++i)
            score_at(scores, measure, i) = (i % 2 == 0 ? 0.7 : -0.9) * static_cast<double>(i);
    }
    return scores;
}

/// The neighbourhood of a step is looked at only where its bound may be among the best: no level shows it.
TEST(LaneBeam, TheNextLevelHoldsTheBestOfAllSteps) {
    for (unsigned seed = 0; seed < 20; ++seed) {
        SCOPED_TRACE(seed);
        const std::size_t width = 1 + seed % 6;
        Search search(random_scene(seed, 25), neighbourhood_scores());
        search.start(width);
        double best_lane = -std::numeric_limits<double>::infinity();
        for (bool goes_on = true; goes_on;) {
            const std::vector<std::size_t> level(search.beam.level().begin(), search.beam.level().end());
            std::vector<LaneBeam::State> steps;
            for (const std::size_t number : level) {
                const LaneBeam::State from = search.beam.state(number);
                for (const Vertex vertex : search.graph.neighbours(from.last[search.beam.next_side(from)])) {
                    const std::size_t extended = search.beam.extend(number, vertex);
                    if (extended != LaneBeam::kNone) steps.push_back(search.beam.state(extended));
                }
            }
            for (const LaneBeam::State& step : steps) {
                if (std::ranges::min(step.vertices) > 1) best_lane = std::max(best_lane, step.score);
            }
            std::ranges::sort(steps, std::ranges::greater{}, &LaneBeam::State::score);
            std::vector<LaneBeam::State> best;
            for (const LaneBeam::State& step : steps) {
                const bool known = std::ranges::any_of(best, [&](const LaneBeam::State& better) {
                    return better.last == step.last && better.before == step.before;
                });
                if (!known && best.size() < width) best.push_back(step);
            }
            goes_on = search.beam.advance(search.budget);
            ASSERT_EQ(search.beam.level().size(), best.size());
            for (std::size_t i = 0; i < best.size(); ++i) {
                EXPECT_EQ(search.beam.state(search.beam.level()[i]).score, best[i].score);
                EXPECT_EQ(search.beam.state(search.beam.level()[i]).last, best[i].last);
            }
        }
        // The answer is the best lane of all steps.
        Search again(search.scene, search.scores);
        const std::optional<std::size_t> found = again.best(width);
        ASSERT_TRUE(found);
        EXPECT_EQ(again.beam.state(*found).score, best_lane);
    }
}

/// Neighbourhoods come from a table of fewer places than there are steps: each step has its own.
TEST(LaneBeam, MeasuresTheNeighbourhoodOfEachStepInAWideBeam) {
    Search search(random_scene(3, 60), neighbourhood_scores());
    search.start(400);
    std::size_t steps = 0;
    while (search.beam.advance(search.budget)) {
        for (const std::size_t number : search.beam.level()) {
            const LaneBeam::State& state = search.beam.state(number);
            const Vertex tip = state.before[state.pushed];
            const Neighbourhood cones =
                neighbourhood(search.graph, tip,
                              {.tip = search.graph.position(tip),
                               .point = search.graph.position(state.last[state.pushed]),
                               .facing = search.graph.position(state.last[opposite(state.pushed)]),
                               .leaves_ends_out = true});
            ASSERT_EQ(state.step[kBesideMeasure], cones.beside);
            ASSERT_EQ(state.step[kCloseMeasure], cones.close);
            ASSERT_EQ(state.step[kInsideMeasure], cones.inside);
            ++steps;
        }
    }
    EXPECT_GT(steps, 5000U);
}

/// More vertices than a state has bits.
TEST(LaneBeam, TakesNoVertexTwiceAmongManyHundreds) {
    Search search(random_scene(1, 560), sensible_scores());
    const std::optional<std::size_t> best = search.best(3);
    ASSERT_TRUE(best);
    EXPECT_GT(distinct_vertices(search.beam, *best), 6U);
}

/// The highest score of all lanes below a state, the state included.
double best_below(LaneBeam& beam, const SearchGraph& graph, std::size_t number) {
    const LaneBeam::State state = beam.state(number);
    double best = state.vertices[kLeft] > 1 && state.vertices[kRight] > 1
                      ? state.score
                      : -std::numeric_limits<double>::infinity();
    for (const Vertex vertex : graph.neighbours(state.last[beam.next_side(state)])) {
        const std::size_t extended = beam.extend(number, vertex);
        if (extended != LaneBeam::kNone) best = std::max(best, best_below(beam, graph, extended));
    }
    return best;
}

TEST(LaneBeam, AWideBeamFindsTheBestOfAllLanes) {
    for (unsigned seed = 0; seed < 30; ++seed) {
        SCOPED_TRACE(seed);
        Search wide(random_scene(seed, 3), sensible_scores());
        const std::optional<std::size_t> best = wide.best(100'000);
        Search all(random_scene(seed, 3), sensible_scores());
        all.start(1);
        double highest = -std::numeric_limits<double>::infinity();
        for (const StartPair& pair : all_pairs(all.scene))
            highest = std::max(highest, best_below(all.beam, all.graph, all.beam.add_start(pair)));
        ASSERT_TRUE(best);
        EXPECT_NEAR(wide.beam.state(*best).score, highest, 1e-9);
    }
}

TEST(LaneBeam, AMirroredSceneHasTheMirroredLaneInAnyOrderOfTheCones) {
    for (unsigned seed = 0; seed < 40; ++seed) {
        SCOPED_TRACE(seed);
        const Scene scene = random_scene(seed, 15);
        const auto lane = [](const Scene& of) {
            Search from(of, sensible_scores());
            PathPairVertices vertices = from.beam.vertices(*from.best(8));
            for (std::vector<Vertex>& side : vertices) {
                for (Vertex& vertex : side) vertex = static_cast<Vertex>(from.scene.cones[vertex].id);
            }
            return vertices;
        };
        const PathPairVertices found = lane(scene);
        EXPECT_EQ(lane(tests::mirrored(scene)), (PathPairVertices{found[kRight], found[kLeft]}));
        EXPECT_EQ(lane(tests::shuffled(scene)), found);
    }
}

TEST(LaneBeam, HasNothingWhereThereIsNoStartOrNoSegment) {
    EXPECT_FALSE(Search({}, sensible_scores()).best(8));
    EXPECT_FALSE(Search(cones_at({{1, 1.8}, {1, -1.8}}), sensible_scores()).best(8));
}

}  // namespace
}  // namespace conelane
