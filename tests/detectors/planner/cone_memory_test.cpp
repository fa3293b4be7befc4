// The memory of cones, on small examples that can be followed by hand.

#include "detectors/planner/cone_memory.hpp"

#include "tests/support/testing.hpp"

#include <random>

namespace conelane {
namespace {

Cone cone(ConeId id, double x_m, double y_m, ConeColor color = ConeColor::unknown) {
    return {id, {x_m, y_m}, color, 1.0};
}

Frame frame(std::vector<Cone> cones, const Point& car = {0.0, 0.0}) {
    return {0.0, {car, 0.0}, std::move(cones)};
}

/// Four cones a side, 4 m apart, the first pair 4 m ahead of the origin; ids 1 to 4 left, 11 to 14 right.
std::vector<Cone> lane(const Point& moved = {0.0, 0.0}) {
    std::vector<Cone> cones;
    for (int i = 1; i <= 4; ++i) {
        cones.push_back(cone(i, 4.0 * i + moved.x(), 1.75 + moved.y()));
        cones.push_back(cone(10 + i, 4.0 * i + moved.x(), -1.75 + moved.y()));
    }
    return cones;
}

std::vector<Cone> without_ids(std::vector<Cone> cones) {
    for (Cone& c : cones) c.id = kNoId;
    return cones;
}

const ConeMemory::RememberedCone* near(const ConeMemory& memory, const Point& place, double within_m = 0.3) {
    const auto found = std::ranges::find_if(memory.cones(), [&](const ConeMemory::RememberedCone& c) {
        return (c.position - place).norm() <= within_m;
    });
    return found == memory.cones().end() ? nullptr : &*found;
}

TEST(ConeMemory, AveragesWhatItSawOfAnIdAndOfAPlace) {
    for (const bool with_ids : {true, false}) {
        SCOPED_TRACE(with_ids);
        ConeMemory memory;
        for (const double off_m : {0.0, 0.2}) {
            std::vector<Cone> cones = lane();
            if (!with_ids) cones = without_ids(cones);
            cones[0].position.y() += off_m;
            EXPECT_FALSE(memory.observe(frame(cones)));
        }
        EXPECT_EQ(memory.cones().size(), 8U);
        const auto* const first = near(memory, {4.0, 1.85}, 1e-9);
        ASSERT_NE(first, nullptr) << "the mean of 1.75 and 1.95";
        EXPECT_EQ(first->sightings, 2);
        EXPECT_EQ(first->given, with_ids ? 1 : kNoId);
    }
}

TEST(ConeMemory, ItsOwnIdsStayAndTheCarsAreGivenBack) {
    ConeMemory memory;
    std::set<ConeId> before;
    for (int i = 0; i < 5; ++i) {
        (void)memory.observe(frame(lane()));
        std::set<ConeId> own;
        std::set<ConeId> given;
        for (const Cone& c : memory.scene({}).cones) {
            own.insert(c.id);
            given.insert(memory.given_id(c.id));
        }
        EXPECT_EQ(given, (std::set<ConeId>{1, 2, 3, 4, 11, 12, 13, 14}));
        if (i > 0) {
            EXPECT_EQ(own, before);
        }
        before = own;
    }
    EXPECT_EQ(memory.given_id(77), 77) << "none of its own";
}

TEST(ConeMemory, ANewIdAtARememberedPlaceIsTheSameCone) {
    ConeMemory memory;
    (void)memory.observe(frame(lane()));
    std::vector<Cone> renamed = lane();
    for (Cone& c : renamed) c.id += 500;
    (void)memory.observe(frame(renamed));
    EXPECT_EQ(memory.cones().size(), 8U);
    EXPECT_EQ(memory.given_id(near(memory, {4.0, 1.75})->id), 501);
}

TEST(ConeMemory, AnIdThatIsSeenFarAwayIsAnotherCone) {
    ConeMemory memory;
    (void)memory.observe(frame(lane()));
    (void)memory.observe(frame(lane()));
    std::vector<Cone> exchanged = lane();
    std::swap(exchanged[0].id, exchanged[7].id);  // 12 m apart
    (void)memory.observe(frame(exchanged));
    for (const Cone& c : lane()) EXPECT_NE(near(memory, c.position, 1e-6), nullptr) << "its place stays";
}

TEST(ConeMemory, WhatIsBehindTheCarIsInTheSceneALittleWhile) {
    ConeMemory memory;
    (void)memory.observe(frame(lane()));
    (void)memory.observe(frame(lane()));
    const auto has = [&](const Point& place, const Point& car) {
        const Scene scene = memory.scene({car, 0.0});
        return std::ranges::any_of(scene.cones,
                                   [&](const Cone& c) { return (c.position - place).norm() < 0.1; });
    };
    std::vector<Cone> ahead = lane();
    std::erase_if(ahead, [](const Cone& c) { return c.position.x() < 6.0; });
    (void)memory.observe(frame(ahead, {6.0, 0.0}));
    EXPECT_TRUE(has({4.0, 1.75}, {6.0, 0.0})) << "2.7 m away, behind the half disc of the sensor";
    EXPECT_FALSE(has({4.0, 1.75}, {14.0, 0.0})) << "10 m behind";
}

TEST(ConeMemory, AConeThatIsSeenOnceIsInTheSceneOfThatFrameAlone) {
    ConeMemory memory;
    (void)memory.observe(frame(lane()));
    std::vector<Cone> with_flash = lane();
    with_flash.push_back(cone(99, 8.0, 0.0));
    (void)memory.observe(frame(with_flash));
    EXPECT_EQ(memory.scene({}).cones.size(), 9U);
    (void)memory.observe(frame(lane()));
    EXPECT_EQ(memory.scene({}).cones.size(), 8U);
}

TEST(ConeMemory, AConeThatVanishesInViewIsForgottenAndOneOutOfViewIsNot) {
    ConeMemory memory;
    for (int i = 0; i < 6; ++i) (void)memory.observe(frame(lane()));
    std::vector<Cone> knocked_over = lane();
    std::erase_if(knocked_over, [](const Cone& c) { return c.id == 2; });
    for (int i = 0; i < 30; ++i) (void)memory.observe(frame(knocked_over));
    EXPECT_EQ(near(memory, {8.0, 1.75}), nullptr);
    EXPECT_EQ(memory.cones().size(), 7U);
    // The car has passed all of them, and sees others.
    std::vector<Cone> others = lane({40.0, 0.0});
    for (Cone& c : others) c.id += 100;
    for (int i = 0; i < 30; ++i) (void)memory.observe(frame(others, {40.0, 0.0}));
    EXPECT_EQ(memory.cones().size(), 15U) << "a cone behind the car was not missed";
}

TEST(ConeMemory, OfConesAtOnePlaceOneIsInTheScene) {
    ConeMemory memory;
    std::vector<Cone> doubled = lane();
    for (const double off_m : {0.01, 0.3}) {
        for (const Cone& c : lane()) {
            doubled.push_back(c);
            doubled.back().id += off_m < 0.1 ? 1000 : 2000;
            doubled.back().position.x() += off_m;
        }
    }
    for (int i = 0; i < 3; ++i) (void)memory.observe(frame(doubled));
    EXPECT_EQ(memory.scene({}).cones.size(), 8U);
}

TEST(ConeMemory, AShiftOfAllConesMovesWhatIsRememberedToo) {
    for (const bool with_ids : {true, false}) {
        SCOPED_TRACE(with_ids);
        ConeMemory memory;
        const auto seen = [&](const Point& moved) {
            return with_ids ? lane(moved) : without_ids(lane(moved));
        };
        std::vector<Cone> first = seen({0.0, 0.0});
        first.push_back(cone(with_ids ? 50 : kNoId, 12.0, 9.0));  // not seen again
        for (int i = 0; i < 3; ++i) (void)memory.observe(frame(first));
        const Point jump(0.4, -0.5);
        const auto shift = memory.observe(frame(seen(jump), jump));
        ASSERT_TRUE(shift);
        EXPECT_LT(((*shift)({8.0, 0.0}) - Point(8.4, -0.5)).norm(), 0.02);
        EXPECT_EQ(memory.cones().size(), 9U);
        EXPECT_NE(near(memory, {12.4, 8.5}, 0.1), nullptr) << "it moved with the others";
        EXPECT_FALSE(memory.observe(frame(seen(jump), jump)));
    }
}

TEST(ConeMemory, OneConeThatMovesIsNoShift) {
    ConeMemory memory;
    for (int i = 0; i < 3; ++i) (void)memory.observe(frame(lane()));
    std::vector<Cone> moved = lane();
    moved[2].position += Point(0.6, 0.6);
    EXPECT_FALSE(memory.observe(frame(moved)));
}

TEST(ConeMemory, TheOrderOfAFrameHasNoEffect) {
    ConeMemory one;
    ConeMemory other;
    std::mt19937 random(2);
    for (int i = 0; i < 4; ++i) {
        std::vector<Cone> cones = without_ids(lane({0.02 * i, 0.0}));
        (void)one.observe(frame(cones));
        std::ranges::shuffle(cones, random);
        (void)other.observe(frame(cones));
    }
    ASSERT_EQ(one.cones().size(), other.cones().size());
    for (const auto& c : one.cones()) EXPECT_NE(near(other, c.position, 1e-12), nullptr);
}

TEST(ConeMemory, ColorsAreDecidedByWhatWasSeenMost) {
    ConeMemory memory;
    for (const ConeColor color : {ConeColor::yellow, ConeColor::blue, ConeColor::unknown, ConeColor::blue}) {
        std::vector<Cone> cones = lane();
        cones[0].color = color;
        (void)memory.observe(frame(cones));
    }
    EXPECT_EQ(color_of(*near(memory, {4.0, 1.75})), ConeColor::blue);
    EXPECT_EQ(color_of(*near(memory, {4.0, -1.75})), ConeColor::unknown);
    EXPECT_EQ(color_of({.colors = {0, 4, 0, 2, 3}}), ConeColor::big_orange);
}

TEST(ConeMemory, IsBoundedByItsSettings) {
    ConeMemorySettings settings;
    settings.max_cones = 100;
    ConeMemory memory(settings);
    // Rows of cones, each seen often enough to be kept, 30 m farther each time.
    for (int row = 0; row < 40; ++row) {
        std::vector<Cone> cones = lane({30.0 * row, 0.0});
        for (Cone& c : cones) c.id += 100 * row;
        for (int i = 0; i < 5; ++i) (void)memory.observe(frame(cones, {30.0 * row, 0.0}));
        EXPECT_LE(memory.cones().size(), 100U);
    }
    EXPECT_EQ(memory.cones().size(), 100U);
    EXPECT_NE(near(memory, {30.0 * 39 + 4.0, 1.75}), nullptr) << "those seen last are kept";
}

}  // namespace
}  // namespace conelane
