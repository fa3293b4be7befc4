// The scenes that `front` learns from.

#include "learning/training/front_scenes.hpp"

#include "evaluation/scoring/score.hpp"
#include "evaluation/world/generated_tracks.hpp"
#include "tests/support/testing.hpp"

namespace conelane::learning {
namespace {

std::vector<Track> courses() {
    return {generate_track("hairpins", 1), generate_track("kidney", 2)};
}

/// Half of the draws have colors, with every kind of fault; their geometry is the same as without.
TEST(FrontScenes, HalfOfTheDrawsShowColorsThatMayBeWrongOrMissing) {
    const FrontScenes colored(courses(), {}, 3);
    FrontSceneOptions without{.colored_share = 0.0};
    const FrontScenes plain(courses(), without, 3);
    std::size_t draws = 0;
    std::size_t with_color = 0;
    double own = 0.0;
    double wrong = 0.0;
    double unseen = 0.0;
    double soft = 0.0;
    for (std::uint64_t number = 0; number < 200; ++number) {
        const FrontScenes::Drawn drawn = colored.draw(number);
        const FrontScenes::Drawn bare = plain.draw(number);
        ASSERT_EQ(drawn.scenes.size(), bare.scenes.size());
        if (drawn.scenes.empty()) continue;
        ++draws;
        bool any = false;
        for (std::size_t i = 0; i < drawn.scenes.size(); ++i) {
            const std::vector<Cone>& cones = drawn.scenes[i].scene.cones;
            ASSERT_NO_THROW(validate(drawn.scenes[i].scene));
            const Lane& truth = *drawn.scenes[i].ground_truth;
            for (std::size_t k = 0; k < cones.size(); ++k) {
                ASSERT_EQ(cones[k].position, bare.scenes[i].scene.cones[k].position);
                ASSERT_EQ(bare.scenes[i].scene.cones[k].color, ConeColor::unknown);
                any = any || cones[k].color != ConeColor::unknown;
                const bool on_left = std::ranges::find(truth.left, cones[k].id) != truth.left.end();
                if (!on_left) continue;
                own += cones[k].color == ConeColor::blue ? 1.0 : 0.0;
                wrong += cones[k].color == ConeColor::yellow ? 1.0 : 0.0;
                unseen += cones[k].color == ConeColor::unknown ? 1.0 : 0.0;
                soft += cones[k].color_probabilities ? 1.0 : 0.0;
            }
        }
        with_color += any ? 1 : 0;
    }
    EXPECT_NEAR(static_cast<double>(with_color) / static_cast<double>(draws), 0.5, 0.12);
    const double seen = own + wrong;
    EXPECT_NEAR(wrong / seen, 0.75 * 0.35 / 2.0, 0.06);
    EXPECT_GT(unseen, seen);  // half of the draws, and a fifth of the others
    EXPECT_NEAR(soft / seen, 0.3, 0.12);
}

TEST(FrontScenes, ScenesOfFalseConesHaveTheShareCountsAndRangesThatAreGiven) {
    FrontSceneOptions options{
        .scenes_per_draw = 1, .noise_share = 0.7, .noise_cones = {8, 12}, .noise_ranges_m = {15.0, 20.0}};
    const FrontScenes scenes(courses(), options, 3);
    std::set<std::size_t> counts;
    double farthest_m = 0.0;
    std::size_t noisy = 0;
    for (std::uint64_t number = 0; number < 200; ++number) {
        for (const Scene& scene : scenes.draw(number).noise) {
            EXPECT_NO_THROW(validate(scene));
            ++noisy;
            counts.insert(scene.cones.size());
            for (const Cone& cone : scene.cones) farthest_m = std::max(farthest_m, cone.position.norm());
        }
    }
    EXPECT_NEAR(static_cast<double>(noisy) / 200.0, 0.7, 0.1);
    EXPECT_THAT(counts, testing::ElementsAre(8U, 9U, 10U, 11U, 12U));
    EXPECT_LE(farthest_m, 20.0);
    EXPECT_GT(farthest_m, 19.0);
    options.noise_ranges_m = {17.0, 17.0};
    const FrontScenes of_one_range(courses(), options, 3);
    for (std::uint64_t number = 0; number < 20; ++number) {
        for (const Scene& scene : of_one_range.draw(number).noise) {
            for (const Cone& cone : scene.cones) EXPECT_LE(cone.position.norm(), 17.0);
        }
    }
    options.noise_share = 0.0;
    const FrontScenes without(courses(), options, 3);
    for (std::uint64_t number = 0; number < 50; ++number) EXPECT_TRUE(without.draw(number).noise.empty());
}

// Whatever changes are made to a course, its ground truth is still a lane with the best score.
TEST(FrontScenes, DrawTheSameForTheSameNumberWithUsableGroundTruths) {
    const FrontScenes scenes(courses(), {}, 2);
    std::size_t all = 0;
    for (std::uint64_t number = 0; number < 40; ++number) {
        const FrontScenes::Drawn first = scenes.draw(number);
        const FrontScenes::Drawn again = scenes.draw(number);
        ASSERT_EQ(first.scenes.size(), again.scenes.size());
        for (std::size_t i = 0; i < first.scenes.size(); ++i) {
            const AnnotatedScene& a = first.scenes[i];
            const AnnotatedScene& b = again.scenes[i];
            EXPECT_NO_THROW(validate(a.scene));
            EXPECT_EQ(a.ground_truth, b.ground_truth);
            ASSERT_EQ(a.scene.cones.size(), b.scene.cones.size());
            for (std::size_t k = 0; k < a.scene.cones.size(); ++k)
                EXPECT_EQ(a.scene.cones[k].position, b.scene.cones[k].position);
            LaneAnswer answer{.status = LaneStatus::found, .lane = *a.ground_truth};
            const SceneScore scored = score(a, answer, 0.0, std::nullopt, &first.boundaries);
            EXPECT_GT(scored.iou.value_or(0.0), 0.999);
            EXPECT_TRUE(scored.usable().value_or(false)) << a.scene.id;
            ++all;
        }
    }
    EXPECT_GT(all, 100U);
}

}  // namespace
}  // namespace conelane::learning
