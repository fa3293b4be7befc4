// `front-warm` uses the last lane of a lap as evidence: it makes the answers steadier, and does not keep the
// car on a wrong lane.

#include "conelane/detectors.hpp"
#include "evaluation/formats/scene_set.hpp"
#include "evaluation/scoring/score.hpp"
#include "graph_search/front/front_detector.hpp"
#include "tests/support/front_fixture.hpp"
#include "tests/support/no_time_limit.hpp"

namespace conelane::experiments {
namespace {

using tests::straight_front_scene;

TEST(FrontEvidence, ConesOfTheLastLaneEarnABonusOnTheirSideUntilForgotten) {
    Scene scene = straight_front_scene(3);
    FrontMap map;
    map.build(scene);
    FrontEvidence evidence(0.25);
    const auto bonuses = [&](Side side) {
        std::vector<ConeId> earning;
        evidence.find_again(scene, map);
        for (Vertex cone = 0; cone < map.size(); ++cone) {
            const double bonus = evidence.bonus(side, cone);
            EXPECT_TRUE(bonus == 0.0 || bonus == 0.25);
            if (bonus > 0.0) earning.push_back(scene.cones[map.scene_index(cone)].id);
        }
        std::ranges::sort(earning);
        return earning;
    };
    EXPECT_EQ(bonuses(kLeft), std::vector<ConeId>{});
    evidence.remember({{0, 1, 77}, {100, 102}});
    EXPECT_EQ(bonuses(kLeft), (std::vector<ConeId>{0, 1})) << "77 is gone, 2 was not on the lane";
    EXPECT_EQ(bonuses(kRight), (std::vector<ConeId>{100, 102}));
    evidence.remember({{2}, {101}});
    EXPECT_EQ(bonuses(kLeft), std::vector<ConeId>{2}) << "one lane is remembered, the last";
    evidence.forget();
    EXPECT_EQ(bonuses(kRight), std::vector<ConeId>{});
    EXPECT_THROW(FrontEvidence(-0.1), InvalidInput);
}

// If only the bonus counts, the best lane has as many remembered cones as it can.
TEST(FrontEvidence, IsAddedToTheScoresOfStartsAndMoves) {
    const Scene scene = straight_front_scene(4);
    FrontCost cost(FrontWeights::zero());
    FrontEvidence evidence(0.25);
    evidence.remember({{0, 1, 2}, {100, 101, 2}});
    FrontSearch search;
    search.begin(scene, cost, {}, &evidence);
    SearchBudget unlimited;
    search.run(unlimited);
    search.sort_finished(1);
    ASSERT_FALSE(search.finished().empty());
    EXPECT_DOUBLE_EQ(search.finished().front().score, 5 * 0.25) << "cone 2 stands on the left only";
    search.begin(scene, cost, {});
    search.run(unlimited);
    search.sort_finished(1);
    EXPECT_EQ(search.finished().front().score, 0.0);
}

LaneAnswer detect(LaneDetector& detector, const Scene& scene) {
    return detector.detect(scene, tests::kNoTimeLimit);
}

/// A lap, and the answers of `front` on it.
struct Lap {
    SceneSet set;
    std::vector<Lane> cold;

    explicit Lap(const std::string& track, SceneOptions options) {
        options.every_m = 1.1;
        set = make_scene_set({track}, options);
        const auto front = make_detector("front");
        for (const AnnotatedScene& scene : set.scenes) cold.push_back(detect(*front, scene.scene).lane);
    }
    [[nodiscard]] const Scene& scene(std::size_t i) const { return set.scenes[i].scene; }
    [[nodiscard]] std::size_t size() const { return set.scenes.size(); }
};

/// `rate`: share of false cones, which persist along the lap.
Lap lap_of(const std::string& track, double rate) {
    SceneOptions options{.false_positive_rates = {rate}, .ranges_m = {30.0}, .persistent = true};
    return Lap(track, options);
}

/// The scene seen from another pose: the lane found is another one of the same cones.
Scene seen_from(const Scene& scene, double left_m, double turned_rad) {
    Scene other = scene;
    const Point heading = scene.pose.heading();
    other.pose.position += left_m * Point(-heading.y(), heading.x());
    other.pose.yaw_rad += turned_rad;
    return other;
}

/// A scene with the same ids, which bound a completely different lane than before: the nearest ones ahead are
/// along a straight, in the order of their ids.
Scene decoy_of(const Scene& scene) {
    Scene decoy = nearest_ahead(scene, 20);
    decoy.pose = {};
    std::ranges::sort(decoy.cones, {}, &Cone::id);
    for (std::size_t i = 0; i < decoy.cones.size(); ++i)
        decoy.cones[i].position = {2.0 + 4.0 * static_cast<double>(i / 2), i % 2 == 0 ? 1.8 : -1.8};
    return decoy;
}

/// Whether two lanes are the same for a driver: over the first 15 m their centre lines agree.
bool drives_alike(const Lane& a, const Lane& b, const Scene& scene) {
    return is_steady(centre_line_of(outline_of(a, scene), scene.pose),
                     centre_line_of(outline_of(b, scene), scene.pose));
}

/// Makes the detector answer a wrong lane before every seventh scene of a lap. Expects that from the third
/// scene after it, the car drives as with `front`, or as with a `front-warm` that was never wrong. Returns
/// how many lanes were wrong on both sides.
template <typename Decoy>
std::size_t expect_recovery(const Lap& lap, const Decoy& decoy) {
    constexpr std::size_t kEvery = 7;
    constexpr std::size_t kRecovered = 2;
    const auto misled = make_detector("front-warm");
    const auto undisturbed = make_detector("front-warm");
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < lap.size(); ++i) {
        const Scene& scene = lap.scene(i);
        if (i % kEvery == 0) {
            const Lane held = detect(*misled, decoy(scene, i / kEvery)).lane;
            if (held.left != lap.cold[i].left && held.right != lap.cold[i].right) ++wrong;
        }
        const Lane lane = detect(*misled, scene).lane;
        const Lane never_wrong = detect(*undisturbed, scene).lane;
        if (i % kEvery < kRecovered) continue;
        EXPECT_TRUE(drives_alike(lap.cold[i], lane, scene) || drives_alike(never_wrong, lane, scene))
            << scene.id;
    }
    return wrong;
}

TEST(FrontWarm, AnswersAsFrontAgainTwoScenesAfterAWrongLane) {
    const Lap lap = lap_of("generated:kidney@5", 0.0);
    ASSERT_GT(lap.size(), 100U);
    const auto warm = make_detector("front-warm");
    for (std::size_t i = 0; i < lap.size(); ++i) {
        if (i % 5 == 0) {
            const Lane held = detect(*warm, decoy_of(lap.scene(i))).lane;
            EXPECT_NE(held.left, lap.cold[i].left);
            EXPECT_NE(held.right, lap.cold[i].right);
        }
        const Lane lane = detect(*warm, lap.scene(i)).lane;
        if (i % 5 < 2) continue;
        EXPECT_EQ(lane, lap.cold[i]) << lap.scene(i).id;
    }
}

TEST(FrontWarm, RecoversFromAWrongLaneAmongFalseConesWithinThreeScenes) {
    for (const char* const track : {"generated:kidney@5", "generated:hairpins@7"}) {
        SCOPED_TRACE(track);
        const Lap lap = lap_of(track, 0.3);
        ASSERT_GT(lap.size(), 70U);
        const std::size_t decoys = (lap.size() + 6) / 7;
        EXPECT_EQ(expect_recovery(lap, [](const Scene& scene, std::size_t) { return decoy_of(scene); }),
                  decoys);
        // A wrong lane in the same scene, as it would be right for a car with another pose.
        const auto elsewhere = [](const Scene& scene, std::size_t number) {
            const double sign = number % 2 == 0 ? 1.0 : -1.0;
            return seen_from(scene, 3.0 * sign, number % 4 < 2 ? 0.6 : -0.6);
        };
        EXPECT_GE(expect_recovery(lap, elsewhere), decoys / 5);
    }
}

TEST(FrontWarm, SwappedSidesAreNoTrap) {
    const Lap lap = lap_of("generated:kidney@5", 0.3);
    // Mirrored: each boundary's ids are on the other side.
    const auto mirrored = [](Scene scene, std::size_t) {
        const Point heading = scene.pose.heading();
        for (Cone& cone : scene.cones) {
            const Point from_car = cone.position - scene.pose.position;
            cone.position -= 2.0 * cross(heading, from_car) * Point(-heading.y(), heading.x());
        }
        return scene;
    };
    EXPECT_EQ(expect_recovery(lap, mirrored), (lap.size() + 6) / 7);
}

TEST(FrontWarm, ForgetsOnReset) {
    const Lap lap = lap_of("generated:kidney@5", 0.3);
    const auto warm = make_detector("front-warm");
    for (std::size_t i = 0; i < lap.size(); i += 5) {
        (void)detect(*warm, decoy_of(lap.scene(i)));
        warm->reset();
        EXPECT_EQ(detect(*warm, lap.scene(i)).lane, lap.cold[i]) << lap.scene(i).id;
    }
}

TEST(FrontWarm, IdsThatVanishLeaveNothingBehind) {
    const Lap lap = lap_of("generated:kidney@5", 0.3);
    const auto warm = make_detector("front-warm");
    for (std::size_t i = 0; i < lap.size(); i += 5) {
        (void)detect(*warm, decoy_of(lap.scene(i)));
        // As after a new map has begun.
        Scene renamed = lap.scene(i);
        Lane expected = lap.cold[i];
        const auto rename = [](ConeId& id) { id += 10'000'000; };
        for (Cone& cone : renamed.cones) rename(cone.id);
        for (std::vector<ConeId>* side : {&expected.left, &expected.right})
            std::ranges::for_each(*side, rename);
        EXPECT_EQ(detect(*warm, renamed).lane, expected) << renamed.id;
        warm->reset();
    }
}

TEST(FrontWarm, APoseThatJumpsDoesNoHarm) {
    const Lap lap = lap_of("generated:kidney@5", 0.3);
    const auto warm = make_detector("front-warm");
    // Jumps between places of the lap, and turns round between them, so that the sides are swapped.
    for (std::size_t i = 0; i < lap.size(); ++i) {
        const std::size_t at = (37 * i) % lap.size();
        EXPECT_EQ(detect(*warm, lap.scene(at)).lane, lap.cold[at]) << lap.scene(at).id;
        (void)detect(*warm, seen_from(lap.scene(at), 0.0, std::numbers::pi));
    }
}

struct Driven {
    std::size_t usable = 0;
    std::size_t unsteady = 0;
    double iou_sum = 0.0;
};
Driven drive(const char* name, const SceneSet& set) {
    Driven driven;
    const auto detector = make_detector(name);
    CentreLine before;
    for (std::size_t i = 0; i < set.scenes.size(); ++i) {
        const AnnotatedScene& scene = set.scenes[i];
        const bool is_new_lap = i == 0 || set.scenes[i - 1].track != scene.track;
        if (is_new_lap) detector->reset();
        const LaneAnswer answer = detect(*detector, scene.scene);
        const SceneScore scored = score(scene, answer, 0.0, std::nullopt, &set.tracks.at(scene.track));
        if (scored.usable().value()) ++driven.usable;
        driven.iou_sum += scored.iou.value();
        CentreLine line = centre_line_of(outline_of(answer.lane, scene.scene), scene.scene.pose);
        if (!is_new_lap && !is_steady(before, line)) ++driven.unsteady;
        before = std::move(line);
    }
    return driven;
}

TEST(FrontWarm, IsSteadierThanFrontAndNoWorseAmongFalseConesThatStay) {
    SceneOptions options{.false_positive_rates = {0.5},
                         .ranges_m = {30.0},
                         .every_m = 1.1,
                         .conditions = {"harsh"},
                         .seed = 3};
    const SceneSet set =
        make_scene_set({"generated:hairpins@7", "generated:slalom@7", "generated:infield@7"}, options);
    ASSERT_GT(set.scenes.size(), 500U);
    const Driven cold = drive("front", set);
    const Driven warm = drive("front-warm", set);
    EXPECT_LT(warm.unsteady, cold.unsteady);
    EXPECT_GE(warm.usable, cold.usable);
    EXPECT_GE(warm.iou_sum, cold.iou_sum);
    RecordProperty("unsteady", std::to_string(cold.unsteady) + " -> " + std::to_string(warm.unsteady));
}

}  // namespace
}  // namespace conelane::experiments
