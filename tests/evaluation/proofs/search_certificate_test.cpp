// Certificates of whole searches: a proof that can be followed by hand, proofs of path-pair, and certificates
// that the verifier rejects.

#include "conelane/check.hpp"
#include "evaluation/formats/solution_file.hpp"
#include "evaluation/proofs/certificate_verifier.hpp"
#include "evaluation/proofs/exact_arithmetic.hpp"
#include "solvers/path_pair/path_pair_solver.hpp"
#include "tests/support/cones_at.hpp"
#include "tests/support/file_test.hpp"
#include "tests/support/learned_costs.hpp"
#include "tests/support/random_scenes.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/six_cone_lane.hpp"

namespace conelane {
namespace {

using Kind = SearchVerdict::Kind;
using tests::six_cone_lane;

constexpr std::int64_t kManySteps = 1'000'000;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Four edges of spacing, heading and angle cost 0, each with the benefit 1. Without multipliers the cheapest
/// walks to 2 and to 5 are these two boundaries, so the relaxation alone proves it.
SearchCertificate straight_proof() {
    SearchCertificate certificate;
    certificate.lane_graph = LaneGraph{{{0, 1}, {1, 2}, {3, 4}, {4, 5}}};
    certificate.objective = -4.0;
    certificate.bound = -4.0 - 1e-9;
    certificate.parts.push_back({std::nullopt, {}, {{std::vector<SearchCertificate::Units>(6, 0), {}, 0}}});
    return certificate;
}

SearchVerdict verify(const SearchCertificate& certificate, const Scene& scene,
                     const RldParameters& parameters = {}, std::int64_t max_steps = kManySteps) {
    return verify_search(scene, parameters, certificate, max_steps);
}

TEST(SearchCertificate, OfAStraightLaneCanBeFollowedByHand) {
    const SearchVerdict verdict = verify(straight_proof(), six_cone_lane());
    EXPECT_EQ(verdict.kind, Kind::verified) << verdict.reason;
    EXPECT_TRUE(verdict.is_optimum);
    EXPECT_EQ(verdict.steps, 0);  // nothing is left to enumerate
}

/// Also with learned costs, which are recomputed in 50 digits.
TEST(SearchCertificate, OfLearnedCostsIsVerified) {
    int verified = 0;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        const Scene scene = tests::random_scene(seed, 10);
        RldParameters parameters{.d_gap = 9.0,
                                 .d_clear = 0.5,
                                 .d_side = seed % 4 == 1 ? 2.5 : 0.0,
                                 .nearest_of_edge = static_cast<double>(seed % 4),
                                 .nearest_of_gap = static_cast<double>(seed % 6),
                                 .learned_costs = tests::random_learned_costs(seed, seed % 2 == 0 ? 0 : 5)};
        const SearchCertificate certificate = certify_search(make_problem(scene, parameters));
        if (!certificate.lane_graph) continue;
        const SearchVerdict verdict = verify(certificate, scene, parameters);
        EXPECT_EQ(verdict.kind, Kind::verified) << verdict.reason;
        EXPECT_TRUE(verdict.is_optimum);
        ++verified;
        RldParameters others = parameters;
        others.learned_costs = tests::random_learned_costs(seed + 100, 0);
        EXPECT_NE(verify(certificate, scene, others).kind, Kind::verified);
    }
    EXPECT_GT(verified, 5);
}

/// An edge that joins no nearest cones is in no lane graph, but may face one that is.
TEST(SearchCertificate, OfFacingCostsAmongNearestConesIsVerified) {
    int verified = 0;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        const Scene scene = tests::random_scene(seed, 10);
        RldParameters parameters{.facing_weight = 0.8, .nearest_of_edge = static_cast<double>(1 + seed % 3)};
        const SearchCertificate certificate = certify_search(make_problem(scene, parameters));
        if (!certificate.lane_graph) continue;
        const SearchVerdict verdict = verify(certificate, scene, parameters);
        EXPECT_EQ(verdict.kind, Kind::verified) << verdict.reason;
        ++verified;
    }
    EXPECT_GT(verified, 10);
}

/// The weight 1/2 on each heading edge beyond the second lowers the relaxation by 1, so the enumeration has
/// to prove the rest: only the frontiers of the two boundaries are left.
TEST(SearchCertificate, IsEnumeratedWhereTheMultipliersAreWeak) {
    SearchCertificate certificate = straight_proof();
    certificate.parts[0].stages[0].heading = SearchCertificate::Units{1}
                                             << (SearchCertificate::kFractionBits - 1);
    const SearchVerdict verdict = verify(certificate, six_cone_lane());
    EXPECT_EQ(verdict.kind, Kind::verified) << verdict.reason;
    EXPECT_GE(verdict.steps, 8) << "four fronts lie on the way, with a label at each";
    EXPECT_EQ(verify(certificate, six_cone_lane(), {}, verdict.steps - 1).kind, Kind::unverified);
}

/// Ahead is a square of cones that costs -1 for each edge and hardly less than 1 for each right angle.
TEST(SearchCertificate, OfACycleThatCostsNothingIsVerified) {
    RldParameters parameters{.w_t = 1.0, .w_p = 0.0, .d_min = 0.0, .s_crit = 100.0, .t_crit = 100.0};
    parameters.theta_t = std::numbers::pi / 2.0 * (1.0 + 1e-15);
    Scene scene = six_cone_lane();
    for (const Point& corner : {Point{13.4, -1.6}, {16.6, -1.6}, {16.6, 1.6}, {13.4, 1.6}})
        scene.cones.push_back({static_cast<ConeId>(scene.cones.size()), corner});
    const SearchVerdict verdict = verify(certify_search(make_problem(scene, parameters)), scene, parameters);
    EXPECT_EQ(verdict.kind, Kind::verified) << verdict.reason;
}

/// Multipliers of 1/2^`bits` on some cones and on the heading; no lane graph, and the bound that they prove.
SearchCertificate priced_proof(std::size_t cones, const std::vector<std::size_t>& priced, int bits,
                               double bound) {
    SearchCertificate certificate{.bound = bound - 1e-9};
    SearchCertificate::Stage stage{std::vector<SearchCertificate::Units>(cones, 0), {}, 0};
    for (const std::size_t cone : priced)
        stage.cone[cone] = SearchCertificate::Units{1} << (SearchCertificate::kFractionBits - bits);
    certificate.parts.push_back({std::nullopt, {}, {stage}});
    return certificate;
}

/// The cheapest walks pass every cone once, and pay for it exactly what the multiplier gives back.
TEST(SearchCertificate, AMultiplierOfAConeThatIsPassedOnceChangesNoBound) {
    for (std::size_t cone = 0; cone < 6; ++cone) {
        SCOPED_TRACE(cone);
        const SearchVerdict verdict = verify(priced_proof(6, {cone}, 2, -4.0), six_cone_lane());
        EXPECT_EQ(verdict.kind, Kind::verified) << verdict.reason;
        EXPECT_EQ(verdict.steps, 0);
    }
}

/// At least two edges along the heading are required. If the cheapest walks have exactly two, a multiplier on
/// them changes nothing.
TEST(SearchCertificate, AMultiplierOfTheHeadingIsForTwoEdges) {
    Scene scene = six_cone_lane();
    std::erase_if(scene.cones, [](const Cone& cone) { return cone.position.x() > 5.0; });
    RldParameters parameters;
    parameters.d_near = 4.0;  // 0 and 3 are near
    SearchCertificate certificate = priced_proof(4, {}, 0, -2.0);
    certificate.parts[0].stages[0].heading = SearchCertificate::Units{1}
                                             << (SearchCertificate::kFractionBits - 1);
    const SearchVerdict verdict = verify(certificate, scene, parameters);
    EXPECT_EQ(verdict.kind, Kind::verified) << verdict.reason;
    EXPECT_EQ(verdict.steps, 0);
}

/// The left boundary continues to cone 6, which is 4.4 m from the far end of the right boundary.
TEST(SearchCertificate, TheBoundIsOfWalksWhoseEndsMayGoTogether) {
    Scene scene = six_cone_lane(0.0, 1.5);
    scene.cones.push_back({6, {10.6, 1.5}});
    RldParameters parameters;
    parameters.d_max = 3.1;  // 2 and 5 only
    const SearchVerdict verdict = verify(priced_proof(7, {}, 0, -4.0), scene, parameters);
    EXPECT_EQ(verdict.kind, Kind::verified) << verdict.reason;
    EXPECT_EQ(verdict.steps, 0);
    parameters.d_max = 5.0;
    EXPECT_THAT(verify(priced_proof(7, {}, 0, -4.0), scene, parameters).reason, HasSubstr("costs less"));
    EXPECT_EQ(verify(priced_proof(7, {}, 0, -5.0), scene, parameters).kind, Kind::verified);
}

/// Twelve cones on a circle that the car drives along. Each edge gains nearly 1, so a walk gains with each
/// round: there is no bound. With the multiplier 2 on each cone no round gains.
TEST(SearchCertificate, AWalkThatGainsWithEachRoundProvesNothing) {
    Scene scene;
    for (int i = 0; i < 12; ++i) {
        const double angle_rad = (0.5 + i) * std::numbers::pi / 6.0;
        scene.cones.push_back({i, Point(0.0, 6.2) + 6.2 * Point(std::sin(angle_rad), -std::cos(angle_rad))});
    }
    const std::vector<std::size_t> all{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
    const SearchVerdict free = verify(priced_proof(12, {}, 0, -1000.0), scene);
    EXPECT_EQ(free.kind, Kind::refused);
    EXPECT_THAT(free.reason, HasSubstr("cycle"));
    const SearchVerdict priced = verify(priced_proof(12, all, -1, -1000.0), scene);
    EXPECT_EQ(priced.kind, Kind::verified) << priced.reason;
}

/// Both ways ahead lead through cone 2, which only one leg may use.
///      0       3
/// car >    2
///      1       4
TEST(SearchCertificate, LegsDoNotMeetAtACone) {
    const Scene scene = tests::cones_at({{1.2, 2.3}, {1.2, -2.3}, {3.5, 0.0}, {5.8, 2.3}, {5.8, -2.3}});
    RldParameters parameters;
    parameters.s_crit = 0.1;   // only the edges of 3.25 m to and from the cone 2
    parameters.t_crit = 10.0;  // and turns by a right angle
    ASSERT_EQ(make_exact_scene(scene, parameters).edges.size(), 4U);
    const SearchVerdict verdict = verify(priced_proof(5, {}, 0, kInfinity), scene, parameters);
    EXPECT_EQ(verdict.kind, Kind::verified) << verdict.reason;
}

/// One leg joins the near cones 2 and 3, the other one the far cones 0 and 1. All multipliers are 0, so the
/// enumeration of the second part has to prove everything.
///     2 ----- 3
/// car >                        0 ----- 1
TEST(SearchCertificate, WithThePairingOfThePaperALegMayJoinFarCones) {
    Scene scene = tests::cones_at({{11.0, -1.75}, {14.2, -1.75}, {1.0, 1.75}, {4.2, 1.75}});
    RldParameters parameters;
    parameters.d_h = 20.0;  // so all edges are along the heading
    parameters.pairing = Pairing::paper;
    SearchCertificate certificate = priced_proof(4, {}, 0, -2.0);
    certificate.parts.push_back(certificate.parts.front());
    certificate.parts.back().far_start = 0;
    EXPECT_EQ(verify(certificate, scene, parameters).kind, Kind::verified);
    certificate.bound = -1.9;
    EXPECT_THAT(verify(certificate, scene, parameters).reason, HasSubstr("far leg from cone 0"));
    certificate.parts.pop_back();
    EXPECT_THAT(verify(certificate, scene, parameters).reason, HasSubstr("missing"));
}

/// Costs are multiples of 2^-60, at most two units too low.
TEST(SearchCertificate, RestsOnCostsThatAreRoundedDown) {
    const ExactScene exact = make_exact_scene(six_cone_lane(), {});
    const auto edge = exact.find({0, 1});
    ASSERT_TRUE(edge);
    EXPECT_LE(exact.edge_cost[*edge], exact_below(-1.0));
    EXPECT_GE(exact.edge_cost[*edge], exact_below(-1.0) - 2);
    EXPECT_FALSE(exact.find({0, 2}));  // 6.4 m: beyond s_crit
    EXPECT_EQ(exact_below(-0.25), -(Exact(1) << 58));
}

struct Forgery {
    const char* what;
    std::function<void(SearchCertificate&)> forge;
    const char* reason;
};

std::function<void(SearchCertificate&)> without_graph(double bound) {
    return [=](SearchCertificate& certificate) {
        certificate.lane_graph.reset();
        certificate.bound = bound;
    };
}

/// A clique in the first part, unless it is empty, and its multiplier.
std::function<void(SearchCertificate&)> with_clique(const std::vector<Edge>& clique,
                                                    SearchCertificate::Units units) {
    return [=](SearchCertificate& certificate) {
        if (!clique.empty()) certificate.parts[0].cliques = {clique};
        certificate.parts[0].stages[0].clique = {{0, units}};
    };
}

TEST(SearchCertificate, CannotBeForged) {
    const LaneGraph half{{{0, 1}, {1, 2}}};
    const LaneGraph across{{{0, 1}, {1, 5}, {3, 4}, {2, 4}}};
    const std::vector<Forgery> forgeries{
        {"a higher bound", [](auto& c) { c.bound = -3.9; }, "above"},
        {"a bound that is not a number", [](auto& c) { c.bound = std::nan(""); }, "number"},
        {"no bound", [](auto& c) { c.bound = -kInfinity; }, "nothing is claimed"},
        {"a huge bound", without_graph(1e300), "out of range"},
        {"another objective", [](auto& c) { c.objective = -4.0 + 1e-6; }, "does not cost"},
        {"no objective", [](auto& c) { c.objective.reset(); }, "no objective"},
        {"a lower objective with its bound", [](auto& c) { c.objective = c.bound = -5.0; }, "does not cost"},
        {"half of a lane", [&](auto& c) { c.lane_graph = half; }, "endpoints"},
        {"a lane across", [&](auto& c) { c.lane_graph = across; }, "none"},
        {"an unknown cone", [](auto& c) { c.lane_graph->edges.back().j = 6; },
         "a cone that the scene does not have"},
        {"no lane graph at all", without_graph(kInfinity), "costs less"},
        {"a bound without its graph", without_graph(-3.0), "costs less"},
        {"a multiplier below 0", [](auto& c) { c.parts[0].stages[0].cone[2] = -1; }, "negative"},
        {"a heading's below 0", [](auto& c) { c.parts[0].stages[0].heading = -1; }, "negative"},
        {"a multiplier that overflows",
         [](auto& c) { c.parts[0].stages[0].cone[2] = std::numeric_limits<SearchCertificate::Units>::max(); },
         "out of range"},
        {"too few multipliers", [](auto& c) { c.parts[0].stages[0].cone.pop_back(); },
         "number of multipliers"},
        {"no multipliers", [](auto& c) { c.parts[0].stages.clear(); }, "missing"},
        {"no part", [](auto& c) { c.parts.clear(); }, "missing"},
        {"another part", [](auto& c) { c.parts[0].far_start = 2; }, "missing"},
        {"a clique of edges that go together", with_clique({{0, 1}, {1, 2}}, 0), "may go together"},
        {"a clique of one edge twice", with_clique({{0, 1}, {0, 1}}, 0), "go together"},
        {"a clique of no edge", with_clique({{0, 2}}, 0), "an invalid edge"},
        {"a multiplier of no clique", with_clique({}, 1), "no clique"},
        {"a clique's below 0", with_clique({{0, 1}}, -1), "negative"},
    };
    for (const Forgery& forgery : forgeries) {
        SCOPED_TRACE(forgery.what);
        SearchCertificate certificate = straight_proof();
        forgery.forge(certificate);
        const SearchVerdict verdict = verify(certificate, six_cone_lane());
        EXPECT_EQ(verdict.kind, Kind::refused);
        EXPECT_THAT(verdict.reason, HasSubstr(forgery.reason));
    }
}

/// A proof holds for one scene and one set of parameters only.
TEST(SearchCertificate, IsOfItsSceneAndParameters) {
    Scene moved = six_cone_lane();
    moved.cones[1].position.y() += 0.3;
    EXPECT_EQ(verify(straight_proof(), moved).kind, Kind::refused);
    RldParameters parameters{.w_b = 1.1};
    EXPECT_EQ(verify(straight_proof(), six_cone_lane(), parameters).kind, Kind::refused);
    parameters = {};
    parameters.pairing = Pairing::paper;
    EXPECT_THAT(verify(straight_proof(), six_cone_lane(), parameters).reason, HasSubstr("missing"));
}

std::vector<RldParameters> models() {
    RldParameters paper;
    paper.pairing = Pairing::paper;
    RldParameters extras = with_shape_costs({});
    extras.w_color = 0.5;
    extras.use_confidence = true;
    extras.forbid_crossing = true;
    RldParameters both = extras;
    both.pairing = Pairing::paper;
    return {RldParameters{}, paper, extras, both};
}

Scene colored(Scene scene, std::uint64_t seed) {
    boost::random::mt19937_64 random(seed);
    for (Cone& cone : scene.cones) {
        const int draw = boost::random::uniform_int_distribution<int>(0, 3)(random);
        cone.color = draw == 0 ? ConeColor::blue : draw == 1 ? ConeColor::yellow : ConeColor::unknown;
        cone.confidence = 0.4 + 0.15 * draw;
        if (draw == 3) cone.color_probabilities = {.unknown = 0.3, .blue = 0.6, .yellow = 0.1};
    }
    return scene;
}

/// Whatever is changed in the multipliers, a verified bound is true. A lane graph that is not the best, or a
/// claim of no lane graph where there is one, is never verified.
TEST(SearchCertificate, OnlyTrueClaimsAreVerified) {
    int optima = 0;
    int infeasible = 0;
    int worse = 0;
    for (const RldParameters& parameters : models()) {
        for (std::uint64_t seed = 0; seed < 25; ++seed) {
            SCOPED_TRACE(testing::Message()
                         << "seed " << seed << ", paper: " << (parameters.pairing == Pairing::paper)
                         << ", extras: " << parameters.forbid_crossing);
            const Scene scene = colored(tests::random_scene(seed, seed % 3 == 0 ? 7 : 18), seed);
            const SearchCertificate certificate = certify_search(make_problem(scene, parameters));
            const SearchVerdict verdict = verify(certificate, scene, parameters);
            ASSERT_EQ(verdict.kind, Kind::verified) << verdict.reason;
            EXPECT_EQ(verdict.is_optimum, certificate.lane_graph.has_value());
            ++(verdict.is_optimum ? optima : infeasible);

            SearchCertificate weaker = certificate;
            for (SearchCertificate::Part& part : weaker.parts) {
                for (SearchCertificate::Stage& stage : part.stages) {
                    for (auto& [clique, units] : stage.clique) units /= 2;
                }
            }
            const SearchVerdict weak = verify(weaker, scene, parameters);
            EXPECT_TRUE(weak.kind != Kind::refused || weak.reason.find("cycle") != std::string::npos)
                << weak.reason;
            if (!verdict.is_optimum) continue;

            SearchCertificate none = certificate;
            none.lane_graph.reset();
            none.bound = kInfinity;
            EXPECT_EQ(verify(none, scene, parameters).kind, Kind::refused);
            for (const Edge& edge : certificate.lane_graph->edges) {
                SearchCertificate shorter = certificate;
                std::erase(shorter.lane_graph->edges, edge);
                const CheckReport report = check(scene, parameters, *shorter.lane_graph);
                if (!report.violations.empty() || *report.objective < *certificate.objective + 1e-6) continue;
                shorter.objective = *report.objective;
                shorter.bound = *report.objective - 1e-9;
                EXPECT_EQ(verify(shorter, scene, parameters).kind, Kind::refused);
                ++worse;
            }
        }
    }
    EXPECT_GT(optima, 50);
    EXPECT_GT(infeasible, 3);
    EXPECT_GT(worse, 20);
}

/// With the multiplier 1/2 on each cone, the enumeration has to do most of the proof. It finds the best lane
/// graph below any bound that is too high, and no lane graph below a valid bound.
TEST(SearchCertificate, TheEnumerationProvesWhatWeakMultipliersDoNot) {
    int enumerated = 0;
    for (std::uint64_t seed = 0; seed < 300; ++seed) {
        SCOPED_TRACE(seed);
        const Scene scene = tests::random_scene(seed, 10);
        const SearchCertificate best = certify_search(make_problem(scene, {}));
        if (!best.lane_graph) continue;
        SearchCertificate weak = priced_proof(10, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9}, 1, *best.objective);
        const SearchVerdict right = verify(weak, scene);
        if (right.reason.find("cycle") != std::string::npos) continue;
        EXPECT_EQ(right.kind, Kind::verified) << right.reason;
        if (right.steps > 0) ++enumerated;
        weak.bound = *best.objective + 1e-6;
        EXPECT_THAT(verify(weak, scene).reason, HasSubstr("costs less"));
    }
    EXPECT_GT(enumerated, 50);
}

/// Two boundaries of a kilometre across the car's way, 10 m apart: the only lane. The midpoint of the one is
/// hypot(ahead_m, 1 m) from the car, so it costs 1.2 * (1000 / that)^4.
SearchCertificate of_a_dear_lane(double ahead_m, Scene& scene, RldParameters& parameters) {
    const double far_m = ahead_m + 10.0;
    scene = tests::cones_at({{ahead_m, 499.0}, {ahead_m, -501.0}, {far_m, 499.0}, {far_m, -501.0}});
    parameters.d_e = parameters.d_t = parameters.d_h = parameters.d_max = 1000.0;
    parameters.d_near = 500.0;
    parameters.theta_heading = std::numbers::pi / 2.0;
    return certify_search(make_problem(scene, parameters));
}

/// Found by cross-check at a cost of 2e9.
TEST(SearchCertificate, OfCostsUpToTheLargestBound) {
    Scene scene;
    RldParameters parameters;
    for (const double ahead_m : {0.75, 5.0, 20.0}) {
        SCOPED_TRACE(ahead_m);
        const SearchCertificate certificate = of_a_dear_lane(ahead_m, scene, parameters);
        const double dear = 1.2 * std::pow(1000.0 / std::hypot(ahead_m, 1.0), 4);
        EXPECT_GT(certificate.objective.value_or(0.0), dear - 2.0);
        const SearchVerdict verdict = verify(certificate, scene, parameters);
        EXPECT_EQ(verdict.kind, Kind::verified) << verdict.reason;
        EXPECT_TRUE(verdict.is_optimum);
        // There is no lane graph at all: the bound to prove is the cost of every pair of edges.
        scene.cones.pop_back();
        const SearchCertificate none = certify_search(make_problem(scene, parameters));
        EXPECT_EQ(none.bound, kInfinity);
        const SearchVerdict no_lane = verify(none, scene, parameters);
        EXPECT_EQ(no_lane.kind, Kind::verified) << no_lane.reason;
    }
}

TEST(SearchCertificate, ClaimsNothingOfCostsBeyondTheLargestBound) {
    Scene scene;
    RldParameters parameters;
    const SearchCertificate certificate = of_a_dear_lane(0.0, scene, parameters);
    EXPECT_GT(certificate.objective.value_or(0.0), 1e12);
    EXPECT_EQ(certificate.bound, -kInfinity);
    EXPECT_EQ(verify(certificate, scene, parameters).reason, "nothing is claimed");
}

/// A search that is stopped has proven a bound, and its certificate claims exactly this bound.
TEST(SearchCertificate, OfAStoppedSearchProvesItsBound) {
    const SearchCertificate nothing = certify_search(make_problem(six_cone_lane(), {}), 0.0);
    EXPECT_EQ(verify(nothing, six_cone_lane()).kind, Kind::refused);
    SearchCertificate certificate = straight_proof();
    certificate.bound = -4.5;
    const SearchVerdict verdict = verify(certificate, six_cone_lane());
    EXPECT_EQ(verdict.kind, Kind::verified);
    EXPECT_FALSE(verdict.is_optimum);
}

using SearchCertificateFile = FileTest;

TEST_F(SearchCertificateFile, IsReadAsItWasWritten) {
    RldParameters parameters{.pairing = Pairing::paper};
    std::vector<Scene> scenes;
    std::vector<SearchCertificateRecord> records;
    for (const std::uint64_t seed : {1U, 2U, 3U}) {
        scenes.push_back(tests::random_scene(seed, 14));
        records.push_back(
            to_search_record(scenes.back(), certify_search(make_problem(scenes.back(), parameters))));
    }
    const std::filesystem::path file = path("a.jsonl");
    write_search_certificates(file, records);
    const std::vector<SearchCertificateRecord> read = read_search_certificates(file);
    ASSERT_EQ(read.size(), records.size());
    for (std::size_t k = 0; k < read.size(); ++k) {
        ConeId missing{};
        const auto certificate = from_search_record(scenes[k], read[k], missing);
        ASSERT_TRUE(certificate);
        EXPECT_EQ(verify(*certificate, scenes[k], parameters).kind, Kind::verified);
        EXPECT_EQ(read[k].line, k + 1);
    }
    SearchCertificateRecord strange = read.front();
    strange.parts.back().stages.back().cones.emplace_back(4711, 1);
    ConeId missing{};
    EXPECT_FALSE(from_search_record(scenes.front(), strange, missing));
    EXPECT_EQ(missing, 4711);
}

TEST_F(SearchCertificateFile, NamesTheLineAndKeyOfAnError) {
    const auto refusal = [&](const std::string& line) {
        const std::filesystem::path file = file_with("\n" + line + "\n", "bad.jsonl");
        return conelane::refusal<InputError>([&] { (void)read_search_certificates(file); });
    };
    EXPECT_THAT(refusal(R"({"scene": "a"})"), testing::AllOf(HasSubstr("bad.jsonl:2"), HasSubstr("parts")));
    EXPECT_THAT(refusal(R"({"scene": "a", "parts": [{"cliques": []}]})"), HasSubstr("parts[0].stages"));
    EXPECT_THAT(refusal(R"({"scene": "a", "edges": [[1]], "parts": []})"), HasSubstr("pair of numbers"));
    EXPECT_THAT(refusal(R"({"scene": "a", "bound": 1, "infeasible": true, "parts": []})"),
                HasSubstr("bound"));
    EXPECT_THAT(
        refusal(
            R"({"scene": "a", "bound": -1, "parts": [{"cliques": [], "stages": [{"heading": 0.5, "cones": [], "cliques": []}]}]})"),
        testing::Not(testing::Eq("accepted")));
}

}  // namespace
}  // namespace conelane
