// What many frames say of cones, against the lane of one.

#include "detectors/planner/cone_votes.hpp"

#include <vector>

#include <gtest/gtest.h>

namespace conelane {
namespace {

/// A straight lane ahead of a car at the origin: left ids 1 to 4, right ids 11 to 14, a cone every 3 m; id 21
/// stands 1.5 m outside the right boundary, id 22 in the middle of the lane.
class Votes : public testing::Test {
  protected:
    Votes() {
        for (int i = 0; i < 4; ++i) scene_.cones.push_back({1 + i, {3.0 + 3.0 * i, 1.75}});
        for (int i = 0; i < 4; ++i) scene_.cones.push_back({11 + i, {3.0 + 3.0 * i, -1.75}});
        scene_.cones.push_back({21, {7.5, -3.25}});
        scene_.cones.push_back({22, {4.5, 0.0}});
    }
    void frames(int count, const Lane& lane, double weight) {
        const std::vector<VotedLane> voted{{&lane, weight}};
        for (int i = 0; i < count; ++i) votes_.vote(scene_, voted);
    }
    [[nodiscard]] double objection(const Lane& lane) const { return votes_.objection(scene_, lane); }

    Scene scene_{"frame", {}, {}};
    Lane right_{{1, 2, 3, 4}, {11, 12, 13, 14}};
    Lane crossing_{{1, 2}, {11, 3, 4}};      ///< takes two left cones for right ones
    Lane wide_{{1, 2, 3, 4}, {11, 21, 14}};  ///< has the right cones 12 and 13 inside
    ConeVoteSettings settings_;
    ConeVotes votes_{settings_};
};

TEST_F(Votes, NoFramesSayNothing) {
    EXPECT_EQ(objection(right_), 0.0);
    EXPECT_EQ(objection(crossing_), 0.0);
}

TEST_F(Votes, SpeakAgainstALaneThatTakesConesForTheOtherSide) {
    frames(20, right_, 0.9);
    EXPECT_LT(objection(right_), 0.01);
    EXPECT_GT(objection(crossing_), 3.0);
    EXPECT_LE(objection(crossing_), settings_.max_objection);
}

TEST_F(Votes, SpeakAgainstALaneThatHasConesOfABoundaryInside) {
    frames(20, right_, 0.9);
    EXPECT_GT(objection(wide_), 2.0);
    EXPECT_GT(objection({{1, 2, 3, 4}, {11, 22, 14}}), 1.0) << "a cone that was passed is on no boundary";
}

TEST_F(Votes, ALaneOfOneBoundaryHasNothingInside) {
    frames(20, right_, 0.9);
    EXPECT_LT(objection({{1, 2, 3, 4}, {}}), 0.01);
    EXPECT_GT(objection({{}, {1, 2, 3, 4}}), 3.0);
}

TEST_F(Votes, AreOutvotedWithinASecondByFramesThatAreSure) {
    frames(100, right_, 1.0);
    frames(10, crossing_, 1.0);
    EXPECT_LT(objection(crossing_), 0.5);
    EXPECT_GT(objection(right_), 1.0);
}

TEST_F(Votes, AreHardlyMovedByFramesThatAreLittleSure) {
    frames(20, right_, 0.9);
    const double before = objection(crossing_);
    frames(10, crossing_, 0.1);
    EXPECT_GT(objection(crossing_), 0.5 * before);
    EXPECT_LT(objection(right_), 0.01);
}

TEST_F(Votes, ConesFarFromTheCarCountLess) {
    frames(20, right_, 0.9);
    const double near = objection(crossing_);
    scene_.pose.position.x() = -8.0;
    EXPECT_LT(objection(crossing_), near);
    scene_.pose.position.x() = -30.0;
    EXPECT_EQ(objection(crossing_), 0.0);
}

TEST_F(Votes, AConeThatIsInNoSceneIsForgotten) {
    frames(20, right_, 0.9);
    const Scene whole = scene_;
    scene_.cones.clear();
    frames(1, right_, 0.9);
    scene_ = whole;
    EXPECT_EQ(objection(crossing_), 0.0);
}

}  // namespace
}  // namespace conelane
