// Learned costs in the problem: the values of the networks, of the right features, within their limits.

#include "tests/support/learned_costs.hpp"

#include "model/learned_features.hpp"
#include "solvers/core_entries.hpp"
#include "solvers/path_pair/path_pair_solver.hpp"
#include "tests/support/agreement.hpp"
#include "tests/support/cones_at.hpp"
#include "tests/support/random_scenes.hpp"
#include "tests/support/refusal.hpp"

namespace conelane {
namespace {

using tests::cones_at;

std::size_t place_of(LearnedPart part, std::string_view name) {
    const auto features = learned_features(part);
    return static_cast<std::size_t>(std::ranges::find(features, name, &LearnedFeature::name) -
                                    features.begin());
}

RldParameters with_weight(LearnedPart part, std::string_view name, double weight) {
    LearnedCosts costs = LearnedCosts::zero();
    costs.of(part).linear.at(place_of(part, name)) = weight;
    return RldParameters{.learned_costs = std::make_shared<const LearnedCosts>(costs)};
}

const ProblemEdge& edge_of(const LaneGraphProblem& problem, std::size_t i, std::size_t j) {
    return *std::ranges::find_if(problem.edges,
                                 [&](const ProblemEdge& edge) { return edge.i == i && edge.j == j; });
}

TEST(LearnedCosts, MeasureWhatTheirNamesSay) {
    // Boundaries 3.6 m apart; cone 4 stands 0.6 m off the middle of the edge {0, 1}, inside the lane.
    const Scene scene = cones_at({{2, 1.8}, {6, 1.8}, {2, -1.8}, {6, -1.8}, {4, 1.2}});
    RldParameters parameters;
    parameters.learned_costs = std::make_shared<const LearnedCosts>(LearnedCosts::zero());
    const LaneGraphProblem problem = make_problem(scene, parameters);
    const LearnedFeatures features(scene, problem);
    const auto of_edge = [&](std::size_t i, std::size_t j, std::string_view name) {
        const auto edge = static_cast<std::size_t>(&edge_of(problem, i, j) - problem.edges.data());
        return features.edge(edge)[place_of(LearnedPart::edge, name)];
    };
    EXPECT_EQ(of_edge(0, 1, "one"), 1.0);
    EXPECT_NEAR(of_edge(0, 1, "facing"), 0.0, 1e-12);
    EXPECT_NEAR(of_edge(0, 1, "facing_any_width"), 0.0, 1e-12);
    EXPECT_NEAR(of_edge(0, 1, "stretch"), 0.8 / parameters.d_t, 1e-12);
    EXPECT_NEAR(of_edge(0, 1, "beside"), 1.0 - 0.25, 1e-12);  // half of 1.2 m off, in the middle
    EXPECT_NEAR(of_edge(2, 3, "beside"), 0.0, 1e-12);
    EXPECT_NEAR(of_edge(0, 1, "in_lane"), 0.0, 1e-12) << "the other side is empty";
    EXPECT_NEAR(of_edge(0, 1, "distance"), std::hypot(4.0, 1.8) / 30.0, 1e-12);
    EXPECT_NEAR(of_edge(0, 1, "aside"), 1.8 / (1.0 + std::hypot(4.0, 1.8)), 1e-12);
    EXPECT_EQ(of_edge(0, 1, "color_cost"), 0.0);
    EXPECT_EQ(of_edge(0, 1, "doubt"), 0.0);
    const auto near = features.near_end(0);
    EXPECT_NEAR(near[place_of(LearnedPart::near_end, "fit")], 1.0, 1e-12);
    EXPECT_NEAR(near[place_of(LearnedPart::near_end, "ahead")], 2.0 / 6.0, 1e-12);
    EXPECT_NEAR(near[place_of(LearnedPart::near_end, "behind")], 0.0, 1e-12);
    const auto far = features.far_end(1);
    EXPECT_NEAR(far[place_of(LearnedPart::far_end, "in_view")], 0.0, 1e-12);
}

/// Edge by edge, turn by turn, end by end; a turn never gains, an end never costs.
TEST(LearnedCosts, OfTheProblemAreThoseOfTheNetworks) {
    int clamped = 0;
    int gaps = 0;
    for (std::uint64_t seed = 0; seed < 30; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        const Scene scene = tests::random_scene(seed, 12);
        RldParameters parameters{.near_end_weight = 0.5, .d_gap = 9.0};
        const LaneGraphProblem plain = make_problem(scene, parameters);
        parameters.learned_costs = tests::random_learned_costs(seed, seed % 2 == 0 ? 0 : 7);
        const LearnedCosts& costs = *parameters.learned_costs;
        const LaneGraphProblem problem = make_problem(scene, parameters);
        const LearnedFeatures features(scene, problem);
        ASSERT_EQ(problem.edges.size(), plain.edges.size());
        std::vector<double> end(problem.cone_count);
        for (std::size_t cone = 0; cone < end.size(); ++cone) {
            const double value = problem.near[cone] ? costs.of(LearnedPart::near_end)(features.near_end(cone))
                                                    : costs.of(LearnedPart::far_end)(features.far_end(cone));
            end[cone] = std::min(0.0, value);
            clamped += value > 0.0 ? 1 : 0;
            EXPECT_EQ(problem.learned_end_cost[cone], end[cone]);
        }
        for (std::size_t e = 0; e < problem.edges.size(); ++e) {
            const ProblemEdge& edge = problem.edges[e];
            gaps += edge.gap ? 1 : 0;
            const double own = costs.of(LearnedPart::edge)(features.edge(e));
            EXPECT_EQ(edge.learned_cost, own);
            EXPECT_NEAR(edge.cost, plain.edges[e].cost + own + end[edge.i] + end[edge.j], 1e-12);
        }
        ASSERT_EQ(problem.turns.size(), plain.turns.size());
        for (std::size_t t = 0; t < problem.turns.size(); ++t) {
            const ProblemTurn& turn = problem.turns[t];
            EXPECT_GE(turn.cost, 0.0);
            if (turn.high_cost) continue;
            const double own = costs.of(LearnedPart::turn)(
                features.turn(turn.edge_i, turn.edge_k, turn.middle, turn.angle_cost));
            clamped += own < 0.0 ? 1 : 0;
            EXPECT_EQ(turn.learned_cost, std::max(0.0, own));
            EXPECT_NEAR(turn.cost, plain.turns[t].cost + turn.learned_cost - 2.0 * end[turn.middle], 1e-12);
        }
    }
    EXPECT_GT(clamped, 20);
    EXPECT_GT(gaps, 20);
}

/// The sums of the problem equal those of a checker with other arithmetic, for whole lanes and single edges.
TEST(LearnedCosts, AreThoseOfTheIndependentChecker) {
    int lanes = 0;
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        Scene scene = tests::random_scene(seed, 10);
        for (std::size_t i = 0; i < scene.cones.size(); ++i) {
            scene.cones[i].color = i % 3 == 0 ? ConeColor::blue : ConeColor::yellow;
            scene.cones[i].confidence = 1.0 - 0.05 * static_cast<double>(i % 4);
        }
        RldParameters parameters{.d_gap = 10.0,
                                 .learned_costs = tests::random_learned_costs(seed, seed % 2 == 0 ? 0 : 7)};
        const LaneGraphProblem problem = make_problem(scene, parameters);
        tests::expect_edge_costs_confirmed(problem, scene, parameters);
        for (const ProblemTurn& turn : problem.turns) {
            const auto of = [&](std::size_t e) { return Edge{problem.edges[e].i, problem.edges[e].j}; };
            LaneGraph both{{of(turn.edge_i), of(turn.edge_k)}};
            std::ranges::sort(both.edges);
            const CheckReport report = check(scene, parameters, both);
            EXPECT_EQ(report.is_final, turn.high_cost);
            if (!turn.high_cost) {
                ASSERT_NEAR(*report.objective, objective(problem, both), 1e-9);
            }
        }
        const RldReport best = make_path_pair_solver()->solve(problem, {});
        if (!best.lane_graph) continue;
        ++lanes;
        EXPECT_NEAR(*check(scene, parameters, *best.lane_graph).objective, *best.objective, 1e-9);
    }
    EXPECT_GT(lanes, 30);
}

/// Three cones in line along an axis enclose an area of 0 or of -0, which atan2 distinguishes.
TEST(LearnedCosts, StraightOnIsStraightOnForTheCheckerToo) {
    const RldParameters parameters = with_weight(LearnedPart::turn, "angle", 1.0);
    int turns = 0;
    for (const Point& step : {Point(3, 0), Point(-3, 0), Point(0, 3), Point(0, -3)}) {
        for (const Point& from : {Point(1, 1.5), Point(-1, -1.5)}) {
            Scene scene = cones_at({from, from + step, from + 2.0 * step});
            for (int rotation = 0; rotation < 3; ++rotation) {
                std::ranges::rotate(scene.cones, scene.cones.begin() + 1);
                const LaneGraphProblem problem = make_problem(scene, parameters);
                for (const ProblemTurn& turn : problem.turns) {
                    if (turn.high_cost) continue;
                    ++turns;
                    const ProblemEdge& e = problem.edges[turn.edge_i];
                    const ProblemEdge& f = problem.edges[turn.edge_k];
                    const LaneGraph both{{{e.i, e.j}, {f.i, f.j}}};
                    EXPECT_NEAR(*check(scene, parameters, both).objective, objective(problem, both), 1e-9);
                }
            }
        }
    }
    EXPECT_EQ(turns, 24);
}

/// A missed cone leaves a gap of 6.4 m. The edge over it exists only if one of its ends continues straight.
TEST(Gaps, GoStraightOnAtAnEnd) {
    const auto has_gap = [](const Scene& scene, const RldParameters& parameters, std::size_t i,
                            std::size_t j) {
        const LaneGraphProblem problem = make_problem(scene, parameters);
        const LaneGraphProblem listed = make_problem(scene, parameters, EdgeExtent::all_pairs);
        const auto found = std::ranges::find_if(
            problem.edges, [&](const ProblemEdge& edge) { return edge.i == i && edge.j == j; });
        const bool has = found != problem.edges.end();
        if (has) {
            EXPECT_TRUE(found->gap);
        }
        EXPECT_EQ(!edge_of(listed, i, j).high_cost, has);
        EXPECT_EQ(check(scene, parameters, {{{i, j}}}).is_final, !has);
        return has;
    };
    const Scene straight = cones_at({{1, 1.5}, {4.2, 1.5}, {10.6, 1.5}, {13.8, 1.5}});
    RldParameters parameters;
    EXPECT_FALSE(has_gap(straight, parameters, 1, 2)) << "off by default";
    parameters.d_gap = 6.5;
    EXPECT_TRUE(has_gap(straight, parameters, 1, 2));
    parameters.d_gap = 6.3;
    EXPECT_FALSE(has_gap(straight, parameters, 1, 2));
    parameters.d_gap = 9.0;
    const Scene bent = cones_at({{2, -0.5}, {4.2, 1.5}, {10.6, 1.5}, {13.0, 3.5}});
    EXPECT_FALSE(has_gap(bent, parameters, 1, 2));
    parameters.theta_gap = 0.8;
    EXPECT_TRUE(has_gap(bent, parameters, 1, 2));
    EXPECT_TRUE(has_gap(cones_at({{4.2, 1.5}, {10.6, 1.5}, {13.8, 1.5}}), parameters, 0, 1))
        << "the first edge in view";
    EXPECT_FALSE(has_gap(cones_at({{4.2, 1.5}, {10.6, 1.5}}), parameters, 0, 1)) << "nothing around it";
    // A cone that stands on it forbids it; one beside it, or near its end, does not.
    parameters.d_clear = 0.5;
    const auto with_cone = [](double x, double y) {
        return cones_at({{1, 1.5}, {4.2, 1.5}, {10.6, 1.5}, {13.8, 1.5}, {x, y}});
    };
    EXPECT_FALSE(has_gap(with_cone(7.0, 1.9), parameters, 1, 2));
    EXPECT_TRUE(has_gap(with_cone(7.0, 2.1), parameters, 1, 2));
    EXPECT_TRUE(has_gap(with_cone(4.6, 1.6), parameters, 1, 2));
    EXPECT_TRUE(has_gap(with_cone(10.2, 1.4), parameters, 1, 2));
    EXPECT_FALSE(has_gap(with_cone(10.0, 1.4), parameters, 1, 2));
    parameters.d_clear = 0.3;
    EXPECT_TRUE(has_gap(with_cone(7.0, 1.9), parameters, 1, 2));
    parameters.d_clear = 0.0;
    // A turn at its end may not exceed theta_gap, even if t_crit allows more.
    parameters.theta_gap = 0.4;
    const Scene forked = cones_at({{1, 1.5}, {4.2, 1.5}, {10.6, 1.5}, {13.8, 1.5}, {13.0, 3.5}});
    const LaneGraphProblem problem = make_problem(forked, parameters);
    int turns = 0;
    for (const ProblemTurn& turn : problem.turns) {
        if (turn.middle != 2) continue;
        const ProblemEdge& e = problem.edges[turn.edge_i];
        const ProblemEdge& f = problem.edges[turn.edge_k];
        if (!e.gap && !f.gap) continue;
        ++turns;
        const bool to_the_side = e.j == 4 || f.j == 4;
        EXPECT_EQ(turn.high_cost, to_the_side);
        const LaneGraph both{{{1, 2}, {2, to_the_side ? 4U : 3U}}};
        EXPECT_EQ(check(forked, parameters, both).is_final, to_the_side);
    }
    EXPECT_EQ(turns, 2);
}

TEST(LearnedCosts, AreCheckedBeforeTheyAreUsed) {
    const auto fault = [](const auto& change) {
        LearnedCosts costs = LearnedCosts::zero(3);
        change(costs);
        return refusal([&] { validate(costs); });
    };
    EXPECT_EQ(fault([](LearnedCosts&) {}), "accepted");
    EXPECT_EQ(fault([](LearnedCosts& c) { c.of(LearnedPart::edge).linear.pop_back(); }),
              "edge.linear: must have 15 numbers, not 14");
    EXPECT_EQ(fault([](LearnedCosts& c) { c.of(LearnedPart::turn).hidden.pop_back(); }),
              "turn.hidden: must have 42 numbers, not 41");
    EXPECT_EQ(fault([](LearnedCosts& c) { c.of(LearnedPart::far_end).output[1] = std::nan(""); }),
              "far_end.output: must hold numbers between -1e6 and 1e6");
    RldParameters parameters{.learned_costs = std::make_shared<const LearnedCosts>()};
    EXPECT_THROW((void)make_problem(tests::random_scene(1, 6), parameters), InvalidInput);
}

}  // namespace
}  // namespace conelane
