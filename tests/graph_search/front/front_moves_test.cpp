// The moves of a side of the front: each rule alone.

#include "graph_search/front/front_moves.hpp"

#include "tests/support/testing.hpp"

namespace conelane {
namespace {

using testing::ElementsAre;
using testing::UnorderedElementsAre;

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
        std::vector<ConeId> ids;
        for (const FrontMove& move : moves.extensions)
            ids.push_back(scene_.cones[map_.scene_index(move.to)].id);
        return ids;
    }

    FrontState state;
    FrontMoves moves;

  private:
    Scene scene_;
    FrontMap map_;
};

/// The cone 3 is 8.1 m from the only cone of the right side.
TEST(FrontMoves, ASideThatGoesOnAloneStaysNearTheOtherOne) {
    Front front({{6.0, 1.8}, {6.5, 5.0}});
    EXPECT_THAT(front.list({}), UnorderedElementsAre(2, 3));
    front.state.ends[kRight].stopped = true;
    EXPECT_THAT(front.list({}), ElementsAre(2));
}

TEST(FrontMoves, OfTheShortSegmentsTheShortestAreListedAndTheRestIsMentioned) {
    Front front({{6.5, 2.2}, {6.0, 1.8}});
    FrontRules rules;
    rules.short_segments = 1;
    EXPECT_THAT(front.list(rules), ElementsAre(3));
    EXPECT_TRUE(front.moves.left_out);
    rules.short_segments = 2;
    EXPECT_THAT(front.list(rules), ElementsAre(3, 2));
    EXPECT_FALSE(front.moves.left_out);
}

TEST(FrontMoves, OfTheLongSegmentsTheStraightestAreListed) {
    Front front({{9.5, 4.0}, {10.0, 1.8}, {9.0, -0.2}});
    FrontRules rules;
    rules.long_segments = 1;
    EXPECT_THAT(front.list(rules), ElementsAre(3));
    rules.long_segments = 2;
    EXPECT_THAT(front.list(rules), ElementsAre(3, 4));
}

}  // namespace
}  // namespace conelane
