// Cones that a map holds twice are merged before any detector sees them (see LaneDetector and DoubledCones).

#include "model/doubled_cones.hpp"

#include "graph_search/clc/clc_detector.hpp"
#include "graph_search/front/front_detector.hpp"
#include "tests/support/counted_allocations.hpp"
#include "tests/support/detector_names.hpp"
#include "tests/support/front_fixture.hpp"
#include "tests/support/no_time_limit.hpp"
#include "tests/support/random_scenes.hpp"

namespace conelane {
namespace {

constexpr ConeId kDouble = 1000;  ///< difference between the id of a cone's double and the cone's id

/// Adds a double of every cone of the scene, in another direction each time and first in the list.
/// `distance_m`: how much farther from the car at the origin it is, roughly; negative for nearer.
Scene doubled(const Scene& scene, double distance_m) {
    Scene twice = scene;
    twice.cones.clear();
    for (std::size_t i = 0; i < scene.cones.size(); ++i) {
        Cone cone = scene.cones[i];
        const double direction_rad =
            std::atan2(cone.position.y(), cone.position.x()) + std::sin(2.4 * static_cast<double>(i));
        cone.id += kDouble;
        cone.position += distance_m * Point(std::cos(direction_rad), std::sin(direction_rad));
        twice.cones.push_back(cone);
    }
    twice.cones.insert(twice.cones.end(), scene.cones.begin(), scene.cones.end());
    return twice;
}

std::vector<ConeId> ids(const Scene& scene) {
    return mapped(scene.cones, &Cone::id);
}

class DoubledConesOf : public testing::TestWithParam<std::string> {
  protected:
    static LaneAnswer detect(const Scene& scene) {
        return make_detector(GetParam())->detect(scene, tests::kNoTimeLimit);
    }
};

TEST_P(DoubledConesOf, UpToTenCentimetresAreOneCone) {
    const Scene once = tests::straight_front_scene(5);
    const LaneAnswer expected = detect(once);
    ASSERT_EQ(expected.status, LaneStatus::found);
    ASSERT_GT(expected.trusted_m.value_or(0.0), 0.0);
    EXPECT_TRUE(expected.merged.empty());
    for (const double distance_m : {0.0, 0.01, 0.05, 0.1}) {
        SCOPED_TRACE(distance_m);
        const LaneAnswer answer = detect(doubled(once, distance_m));
        EXPECT_EQ(answer.status, LaneStatus::found) << answer.message;
        EXPECT_EQ(answer.lane, expected.lane) << "by the nearer cones";
        EXPECT_EQ(answer.confidence, expected.confidence);
        EXPECT_EQ(answer.trusted_m, expected.trusted_m);
        ASSERT_EQ(answer.merged.size(), once.cones.size());
        EXPECT_TRUE(std::ranges::is_sorted(answer.merged, {}, &MergedCone::cone));
        for (const MergedCone& merged : answer.merged) EXPECT_EQ(merged.cone, merged.into + kDouble);
    }
}

TEST_P(DoubledConesOf, FartherApartTheyAreCones) {
    const Scene once = tests::straight_front_scene(5);
    const double radius_m = make_detector(GetParam())->doubled_cone_m();
    for (const double distance_m : {0.2, 0.3, 0.4}) {
        if (distance_m <= radius_m) continue;
        SCOPED_TRACE(distance_m);
        const LaneAnswer answer = detect(doubled(once, distance_m));
        EXPECT_NE(answer.status, LaneStatus::error) << answer.message;
        EXPECT_TRUE(answer.merged.empty());
    }
}

/// Each detector has its own radius, also inside a wrapper.
TEST_P(DoubledConesOf, TheNearestConesAreCountedOnce) {
    const Scene once = tests::straight_front_scene(5);
    const std::unique_ptr<LaneDetector> nearest = make_detector(GetParam(), {.nearest = 8});
    EXPECT_EQ(nearest->doubled_cone_m(), make_detector(GetParam())->doubled_cone_m());
    const LaneAnswer expected = nearest->detect(once, tests::kNoTimeLimit);
    nearest->reset();
    const LaneAnswer answer =
        nearest->detect(doubled(once, 0.99 * nearest->doubled_cone_m()), tests::kNoTimeLimit);
    EXPECT_EQ(answer.status, expected.status);
    EXPECT_EQ(answer.lane, expected.lane);
    EXPECT_EQ(answer.merged.size(), once.cones.size());
}

class DoublesOfFront : public testing::TestWithParam<std::string> {};

/// At 1, 5, 10, 20 and 30 cm, with all cones or every third one doubled, and either of the two nearer.
TEST_P(DoublesOfFront, TakeNoTrustAway) {
    const auto detect = [&](const Scene& scene) {
        return make_detector(GetParam())->detect(scene, tests::kNoTimeLimit);
    };
    EXPECT_EQ(make_detector(GetParam())->doubled_cone_m(), kFrontDoubledCone_m);
    const Scene once = tests::straight_front_scene(7);
    const LaneAnswer expected = detect(once);
    ASSERT_EQ(expected.status, LaneStatus::found);
    ASSERT_GT(expected.trusted_m.value_or(0.0), 15.0);
    for (const double distance_m : {0.01, 0.05, 0.1, 0.2, 0.3}) {
        for (const std::size_t every : {std::size_t{1}, std::size_t{3}}) {
            SCOPED_TRACE(testing::Message() << distance_m << " m, every " << every);
            const std::size_t count = once.cones.size();
            const auto doubled_at = [&](double farther_m) {
                Scene twice = doubled(once, farther_m);
                for (std::size_t i = count; i-- > 0;) {
                    if (i % every != 0)
                        twice.cones.erase(twice.cones.begin() + static_cast<std::ptrdiff_t>(i));
                }
                return twice;
            };
            const std::size_t doubles = (count + every - 1) / every;
            const LaneAnswer first_kept = detect(doubled_at(distance_m));
            EXPECT_EQ(first_kept.lane, expected.lane);
            EXPECT_EQ(first_kept.trusted_m, expected.trusted_m);
            EXPECT_EQ(first_kept.confidence, expected.confidence);
            EXPECT_EQ(first_kept.merged.size(), doubles);
            // The double is nearer, so it represents the cone, at its own distance.
            const LaneAnswer double_kept = detect(doubled_at(-distance_m));
            ASSERT_EQ(double_kept.merged.size(), doubles);
            for (const MergedCone& merged : double_kept.merged) EXPECT_EQ(merged.into, merged.cone + kDouble);
            Lane lane = double_kept.lane;
            for (std::vector<ConeId>* side : {&lane.left, &lane.right}) {
                for (ConeId& id : *side) id -= id >= kDouble ? kDouble : 0;
            }
            EXPECT_EQ(lane, expected.lane);
            EXPECT_GT(double_kept.trusted_m.value_or(0.0), *expected.trusted_m - 1.0);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Front, DoublesOfFront, testing::Values("front", "front-warm"),
                         [](const auto& detector) { return case_name(detector.param); });

INSTANTIATE_TEST_SUITE_P(All, DoubledConesOf, testing::ValuesIn(tests::detector_names()),
                         [](const auto& detector) { return case_name(detector.param); });

TEST(DoubledCones, ASceneWithoutThemStaysUnchanged) {
    DoubledCones doubles(kDoubledCone_m);
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const Scene scene = tests::straight_front_scene(10);
        EXPECT_EQ(&doubles.merge(scene), &scene);
        EXPECT_TRUE(doubles.merged().empty());
    }
    const Scene none;
    EXPECT_EQ(&doubles.merge(none), &none);
}

TEST(DoubledCones, WhatIsMergedStandsNearAKeptConeAndKeptOnesStandApart) {
    std::size_t merged = 0;
    std::size_t crowds = 0;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        const double radius_m = seed % 4 < 2 ? kDoubledCone_m : DoubledCones::kMaxRadius_m;
        DoubledCones doubles(radius_m);
        SCOPED_TRACE(seed);
        boost::random::mt19937_64 random(seed);
        // From many doubles to few; around the origin, and where cells have large numbers.
        boost::random::uniform_real_distribution<double> along(0.0, 0.2 * static_cast<double>(1 + seed));
        const Point origin = seed % 2 == 0 ? Point(-0.5, -0.5) : Point(-1e6, 1e6);
        Scene scene;
        for (ConeId id = 0; id < 60; ++id) {
            const double x = along(random);
            // 37 and 60 have no common divisor, so each id occurs once, unsorted.
            scene.cones.push_back({(id * 37) % 60, origin + Point(x, along(random))});
        }
        const Scene& once = doubles.merge(scene);
        const std::vector<ConeId> kept = ids(once);
        merged += doubles.merged().size();
        EXPECT_EQ(kept.size() + doubles.merged().size(), scene.cones.size());
        const auto at = [&](ConeId id) { return std::ranges::find(scene.cones, id, &Cone::id)->position; };
        const bool has_far_doubles = std::ranges::any_of(doubles.merged(), [&](const MergedCone& cone) {
            return (at(cone.cone) - at(cone.into)).norm() > kDoubledCone_m;
        });
        const double apart_m = has_far_doubles ? radius_m : kDoubledCone_m;
        crowds += has_far_doubles ? 1 : 0;
        for (const Cone& a : once.cones) {
            for (const Cone& b : once.cones) {
                if (a.id == b.id) continue;
                EXPECT_GT((a.position - b.position).norm(), apart_m);
            }
        }
        for (const MergedCone& cone : doubles.merged()) {
            EXPECT_EQ(std::ranges::count(kept, cone.cone), 0);
            EXPECT_EQ(std::ranges::count(kept, cone.into), 1);
            EXPECT_LE(at(cone.into).norm(), at(cone.cone).norm());
            EXPECT_LE((at(cone.cone) - at(cone.into)).norm(), radius_m);
        }
        // Neither the order of the list nor the ids matter.
        std::vector<MergedCone> before = doubles.merged();
        std::ranges::reverse(scene.cones);
        std::vector<ConeId> reversed = ids(doubles.merge(scene));
        const std::vector<ConeId> reversed_in_list_order = reversed;
        std::ranges::reverse(reversed);
        EXPECT_EQ(reversed, kept);
        EXPECT_EQ(doubles.merged(), before);
        for (Cone& cone : scene.cones) cone.id = 100 - cone.id;
        std::vector<ConeId> renumbered = ids(doubles.merge(scene));
        for (ConeId& id : renumbered) id = 100 - id;
        EXPECT_EQ(renumbered, reversed_in_list_order);
    }
    EXPECT_GT(merged, 200U) << "scenes without doubles show little";
    EXPECT_GT(crowds, 5U);
}

/// False cones are near true ones by chance: one pair says nothing about the map.
TEST(DoubledCones, FewFarDoublesAreChance) {
    const auto merged_of = [](std::size_t cones, std::size_t pairs, double distance_m) {
        Scene scene;
        for (std::size_t i = 0; i < cones; ++i) {
            const Point position(3.0 * static_cast<double>(i), 1.5);
            scene.cones.push_back({static_cast<ConeId>(i), position});
            if (i < pairs)
                scene.cones.push_back({static_cast<ConeId>(1000 + i), position + Point(distance_m, 0.0)});
        }
        DoubledCones doubles(0.35);
        (void)doubles.merge(scene);
        return doubles.merged().size();
    };
    EXPECT_EQ(merged_of(10, 2, 0.3), 0U) << "fewer than three";
    EXPECT_EQ(merged_of(10, 3, 0.3), 3U);
    EXPECT_EQ(merged_of(40, 3, 0.3), 0U) << "fewer than one for each ten cones";
    EXPECT_EQ(merged_of(40, 4, 0.3), 4U);
    EXPECT_EQ(merged_of(40, 1, 0.1), 1U) << "so near they are one cone, however few";
    EXPECT_EQ(merged_of(10, 10, 0.36), 0U);
}

TEST(DoubledCones, ARowOfConesDoesNotCollapse) {
    Scene scene;
    for (ConeId id = 0; id < 10; ++id) scene.cones.push_back({id, {0.08 * static_cast<double>(id), 2.0}});
    DoubledCones doubles(kDoubledCone_m);
    EXPECT_EQ(ids(doubles.merge(scene)), (std::vector<ConeId>{0, 2, 4, 6, 8}));
}

TEST(DoubledCones, FarthestPositionsAreNoTrouble) {
    const double most = std::numeric_limits<double>::max();
    Scene scene;
    scene.cones = {{0, {most, -most}}, {1, {-most, most}}, {2, {1e300, 0.0}}, {3, {1e300, 0.0}}};
    DoubledCones doubles(kDoubledCone_m);
    EXPECT_EQ(ids(doubles.merge(scene)), (std::vector<ConeId>{0, 1, 2}));
}

TEST(DoubledCones, ManyAtOnePlaceTakeNoLongerThanManyApart) {
    Scene scene;
    boost::random::mt19937_64 random(1);
    boost::random::uniform_real_distribution<double> near(0.0, 0.05);
    for (ConeId id = 0; id < 200'000; ++id) {
        const double x = near(random);
        scene.cones.push_back({id, {x, near(random)}});
    }
    DoubledCones doubles(
        kDoubledCone_m);  // comparing each with each would be 2e10 distances, and the test would not end
    EXPECT_EQ(doubles.merge(scene).cones.size(), 1U);
}

TEST(DoubledCones, NothingIsAllocatedButTheAnswerOnceMemoryIsWarm) {
    const Scene once = tests::straight_front_scene(10);
    const Scene twice = doubled(once, 0.05);
    std::vector<std::unique_ptr<LaneDetector>> all;
    all.push_back(make_front_detector(shipped_front_options()));
    all.push_back(make_clc_detector(extended_clc_options()));
    for (const std::unique_ptr<LaneDetector>& detector : all) {
        for (int warm = 0; warm < 2; ++warm) {
            (void)detector->detect(once, tests::kNoTimeLimit);
            (void)detector->detect(twice, tests::kNoTimeLimit);
        }
        const auto allocated = [&](const Scene& scene) {
            const std::size_t before = allocations;
            const LaneAnswer answer = detector->detect(scene, tests::kNoTimeLimit);
            const std::size_t count = allocations - before;
            EXPECT_EQ(answer.status, LaneStatus::found);
            return count;
        };
        EXPECT_EQ(allocated(once), 2U) << "the boundaries";
        EXPECT_EQ(allocated(twice), 3U) << "the boundaries and the list of what was merged";
    }
}

}  // namespace
}  // namespace conelane
