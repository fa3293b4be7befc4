// The inputs of the networks of `front` for a lane that grows, by hand; scores depend only on these inputs.

#include "tests/support/cones_at.hpp"
#include "tests/support/front_fixture.hpp"

namespace conelane {
namespace {

constexpr float kRounding = 1e-4F;  ///< angles are approximated

/// Cones of a scene by their index in it, so that a test can name them; the car is at the origin.
class Growth {
  public:
    /// `colors`: of the first cones; the others' are unknown.
    explicit Growth(const std::vector<Point>& cones, const std::vector<ConeColor>& colors = {}) {
        scene = tests::cones_at(cones);
        for (std::size_t i = 0; i < colors.size(); ++i) scene.cones[i].color = colors[i];
        map.build(scene);
        vertex_.resize(cones.size());
        for (Vertex v = 0; v < map.size(); ++v) vertex_[map.scene_index(v)] = v;
    }
    void start(std::size_t left, std::size_t right) {
        state = start_state(map, vertex_[left], vertex_[right]);
    }
    [[nodiscard]] FrontMove move(Side side, std::size_t to) {
        const std::span<const FrontEdge> edges = map.edges(state.ends[side].cones[0]);
        const auto edge = std::ranges::find(edges, vertex_[to], &FrontEdge::to);
        return {vertex_[to], static_cast<std::size_t>(edge - edges.begin())};
    }
    void go_on(Side side, std::size_t to) { state = moved(map, state, side, move(side, to)); }
    [[nodiscard]] Vertex vertex(std::size_t cone) const { return vertex_[cone]; }

    Scene scene;
    FrontMap map;
    FrontState state;

  private:
    std::vector<Vertex> vertex_;
};

template <typename Table, typename Values>
float named(const Table& table, const Values& values, std::string_view name) {
    const auto place = std::ranges::find(table, name, &FrontFeature::name);
    EXPECT_NE(place, table.end()) << name;
    return place == table.end() ? 0.0F : values[static_cast<std::size_t>(place - table.begin())];
}

TEST(FrontMap, LooksAtTheClockAmongConesThatAreAlone) {
    Scene scene;
    for (int i = 0; i < 3000; ++i) scene.cones.push_back({i, {1.0, 20.0 * i}, ConeColor::blue, 1.0});
    SearchBudget budget;
    budget.deadline = Deadline(0.0);
    FrontMap().build(scene, budget);
    EXPECT_EQ(budget.stopped_by, StopReason::time);
}

/// A lane that bends to the left. Segments of 3 m, the left one turned by 0.3 rad; the right boundary has
/// only begun:
///                 __ 2
///     0 --- 1 ---
///     3            4
std::vector<Point> bend() {
    return {{2.0, 2.0},
            {5.0, 2.0},
            {5.0 + 3.0 * std::cos(0.3), 2.0 + 3.0 * std::sin(0.3)},
            {2.0, -2.0},
            {6.5, -2.0}};
}

TEST(FrontFeatures, OfAStateAreSeenFromTheBoundaryThatMoves) {
    Growth lane(bend());
    lane.start(0, 3);
    lane.go_on(kLeft, 1);
    lane.go_on(kLeft, 2);
    const StateFeatures left =
        state_features(lane.map, lane.state, kLeft, measure(lane.map, lane.state, kLeft));
    const StateFeatures right =
        state_features(lane.map, lane.state, kRight, measure(lane.map, lane.state, kRight));
    const auto of_left = [&](std::string_view name) { return named(state_feature_table(), left, name); };
    const auto of_right = [&](std::string_view name) { return named(state_feature_table(), right, name); };

    for (const std::string_view known : {"segment_known", "turn_known"}) {
        EXPECT_EQ(of_left("own_" + std::string(known)), 1.0F) << known;
        EXPECT_EQ(of_left("other_" + std::string(known)), 0.0F) << known;
        EXPECT_EQ(of_right("own_" + std::string(known)), 0.0F) << known;
        EXPECT_EQ(of_right("other_" + std::string(known)), 1.0F) << known;
    }
    // A turn to the left is outward for the left boundary and inward for the right one.
    EXPECT_NEAR(of_left("own_turn"), -0.3F, kRounding);
    EXPECT_NEAR(of_right("other_turn"), 0.3F, kRounding);
    // The left boundary points away from the right one, which points towards it.
    EXPECT_NEAR(of_left("skew"), 0.3F, kRounding);
    EXPECT_NEAR(of_right("skew"), 0.3F, kRounding);
    EXPECT_NEAR(of_left("own_segment"), 3.0F / 4.0F, kRounding);
    // The mean includes one usual segment of 3.5 m, like the last segments and the means. A mean is over the
    // whole boundary from beside the car: 8 m in two segments.
    EXPECT_NEAR(of_left("mean_segment"), (3.5F + 3.0F + 4.0F) / 3.0F / 4.0F, kRounding);
    // The right boundary is behind, so its own lag is positive.
    EXPECT_LT(of_left("lag"), 0.0F);
    EXPECT_FLOAT_EQ(of_right("lag"), -of_left("lag"));
}

/// The mean of a boundary with one segment is the length of that segment.
TEST(FrontFeatures, ABoundaryOfOneConeHasNoSegment) {
    Growth lane(bend());
    lane.start(0, 3);
    EXPECT_NEAR(named(state_feature_table(),
                      state_features(lane.map, lane.state, kLeft, measure(lane.map, lane.state, kLeft)),
                      "mean_segment"),
                3.5F / 4.0F, kRounding);
    lane.go_on(kLeft, 1);
    const StateFeatures right =
        state_features(lane.map, lane.state, kRight, measure(lane.map, lane.state, kRight));
    EXPECT_NEAR(named(state_feature_table(), right, "mean_segment"), (3.5F + 3.0F) / 2.0F / 4.0F, kRounding);
    // Beside the beginning of the last segment, the width is that between the cones there.
    EXPECT_NEAR(named(state_feature_table(), right, "width"), 4.0F / 4.0F, kRounding);
}

constexpr ConeColor kBlue = ConeColor::blue;
constexpr ConeColor kYellow = ConeColor::yellow;

/// The left boundary 0, 1, 2 with a cone 6 beside its second segment, the right one 3, 4, 5:
///     0 ----- 1 --6-- 2
///     3 ----- 4 ----- 5
std::vector<Point> colored_lane() {
    return {{2.0, 1.8}, {6.0, 1.8}, {10.0, 1.8}, {2.0, -1.8}, {6.0, -1.8}, {10.0, -1.8}, {8.0, 2.8}};
}

TEST(FrontFeatures, OfColorsSpeakForAndAgainstTheSideThatMoves) {
    Growth lane(colored_lane(), {kBlue, kYellow, kBlue, kYellow, kYellow, ConeColor::orange, kBlue});
    lane.start(0, 3);
    lane.go_on(kLeft, 1);  // onto a yellow cone
    lane.go_on(kRight, 4);
    const StateMeasures measures = measure(lane.map, lane.state, kLeft);
    const StateFeatures state = state_features(lane.map, lane.state, kLeft, measures);
    const auto of_state = [&](std::string_view name) { return named(state_feature_table(), state, name); };
    EXPECT_FLOAT_EQ(of_state("color_share"), 6.0F / 7.0F);
    EXPECT_FLOAT_EQ(of_state("color_agreement"), (3.0F - 1.0F) / 5.0F);
    EXPECT_EQ(of_state("color_end"), -1.0F);
    EXPECT_EQ(of_state("color_other_end"), 1.0F);
    // Each blue or yellow cone and the nearest other one: 0 and 3, 3 and 0, 1 and 6 differ, and so do 6 and 1
    // (2 is as near, but comes later); 2 and 6, 4 and 1 have the same color.
    EXPECT_FLOAT_EQ(of_state("color_consistency"), (2.0F - 4.0F) / 6.0F);

    const ExtendFeatures left = extend_features(lane.map, lane.state, kLeft, lane.move(kLeft, 2), measures);
    const auto of_left = [&](std::string_view name) { return named(extend_feature_table(), left, name); };
    EXPECT_EQ(of_left("color_own"), 1.0F);
    EXPECT_EQ(of_left("color_against"), 0.0F);
    EXPECT_EQ(of_left("color_orange"), 0.0F);
    EXPECT_EQ(of_left("color_none"), 0.0F);
    EXPECT_NEAR(of_left("color_beside"), 0.5F, kRounding);  // 1 of 2 m away, and blue
    EXPECT_EQ(of_left("color_partner"), 0.0F);              // an orange cone

    const StateMeasures of_right = measure(lane.map, lane.state, kRight);
    const ExtendFeatures right =
        extend_features(lane.map, lane.state, kRight, lane.move(kRight, 5), of_right);
    EXPECT_EQ(named(extend_feature_table(), right, "color_orange"), 1.0F);
    EXPECT_EQ(named(extend_feature_table(), right, "color_own"), 0.0F);
    const ExtendFeatures astray =
        extend_features(lane.map, lane.state, kRight, lane.move(kRight, 2), of_right);
    EXPECT_EQ(named(extend_feature_table(), astray, "color_against"), 1.0F);

    const StopFeatures stop = stop_features(lane.map, lane.state, kLeft, left);
    EXPECT_EQ(named(stop_feature_table(), stop, "color_next"), 1.0F);  // cone 2 stands where the next should
    EXPECT_NEAR(named(stop_feature_table(), stop, "color_goes_on"), 2.0F, kRounding);
}

TEST(FrontFeatures, OfColorsTakeProbabilities) {
    Growth lane(colored_lane());
    lane.scene.cones[0].color = kBlue;
    lane.scene.cones[1].color_probabilities = ColorProbabilities{0.5, 0.3, 0.1, 0.04, 0.06};
    lane.map.build(lane.scene);
    lane.start(0, 3);
    const StateMeasures measures = measure(lane.map, lane.state, kLeft);
    const ExtendFeatures seen = extend_features(lane.map, lane.state, kLeft, lane.move(kLeft, 1), measures);
    const auto of = [&](std::string_view name) { return named(extend_feature_table(), seen, name); };
    EXPECT_FLOAT_EQ(of("color_own"), 0.3F);
    EXPECT_FLOAT_EQ(of("color_against"), 0.1F);
    EXPECT_FLOAT_EQ(of("color_orange"), 0.1F);
    EXPECT_NEAR(of("color_none"), 0.5F * 1.4F / 7.0F, 1e-6F);
    const StartFeatures start = start_features(lane.map, start_cone(lane.map, lane.vertex(1)),
                                               start_cone(lane.map, lane.vertex(3)), kLeft);
    EXPECT_FLOAT_EQ(named(start_feature_table(), start, "color_own"), 0.3F);
    EXPECT_FLOAT_EQ(named(start_feature_table(), start, "color_against"), 0.1F);
    const StartFeatures swapped = start_features(lane.map, start_cone(lane.map, lane.vertex(1)),
                                                 start_cone(lane.map, lane.vertex(3)), kRight);
    EXPECT_FLOAT_EQ(named(start_feature_table(), swapped, "color_own"), 0.1F);
}

/// So weights without weights of colors, and scenes without colors, give the same result as before.
TEST(FrontFeatures, OfColorsAreNothingWithoutColorsAndCountNothingThen) {
    Growth lane(colored_lane());
    lane.start(0, 3);
    lane.go_on(kLeft, 1);
    const StateMeasures measures = measure(lane.map, lane.state, kLeft);
    const auto require_none = [](const auto& table, const auto& values) {
        for (std::size_t i = 0; i < table.size(); ++i) {
            if (!table[i].name.starts_with("color_")) continue;
            EXPECT_EQ(values[i], 0.0F) << table[i].name;
        }
    };
    const ExtendFeatures extend = extend_features(lane.map, lane.state, kLeft, lane.move(kLeft, 2), measures);
    require_none(state_feature_table(), state_features(lane.map, lane.state, kLeft, measures));
    require_none(extend_feature_table(), extend);
    require_none(stop_feature_table(), stop_features(lane.map, lane.state, kLeft, extend));
    require_none(start_feature_table(), start_features(lane.map, start_cone(lane.map, lane.vertex(0)),
                                                       start_cone(lane.map, lane.vertex(3)), kLeft));
    // Color features are last, where the cost leaves them out.
    for (const FrontFeatureList& list : front_feature_lists()) {
        for (std::size_t i = 0; i < list.features.size(); ++i) {
            EXPECT_EQ(list.features[i].name.starts_with("color_"), i + list.colors >= list.features.size())
                << list.key << " " << list.features[i].name;
        }
    }
}

/// From cone 0 to 1, of 4 m, with one cone inside and one outside beside it and one across:
///              . 5
///     0 ------------- 1
///              . 4
///     2                3
TEST(FrontFeatures, OfAMoveTellInsideFromOutside) {
    Growth lane({{2.0, 1.8}, {6.0, 1.8}, {2.0, -1.8}, {6.3, -1.8}, {4.0, 0.8}, {4.0, 3.3}});
    lane.start(0, 2);
    const ExtendFeatures seen = extend_features(lane.map, lane.state, kLeft, lane.move(kLeft, 1),
                                                measure(lane.map, lane.state, kLeft));
    const auto of = [&](std::string_view name) { return named(extend_feature_table(), seen, name); };
    EXPECT_NEAR(of("length"), 1.0F, kRounding);
    EXPECT_NEAR(of("beside_inward"), 0.5F, kRounding);    // 1 of 2 m away
    EXPECT_NEAR(of("beside_outward"), 0.25F, kRounding);  // 1.5 of 2 m
    EXPECT_NEAR(of("beside"), 0.75F, kRounding);
    EXPECT_EQ(of("inside"), 1.0F);
    EXPECT_NEAR(of("lead"), 1.0F, kRounding);            // 4 m ahead
    EXPECT_NEAR(of("partner"), 0.3F / 3.0F, kRounding);  // expected at (6, -1.8)
    EXPECT_EQ(of("bridges"), 0.0F);
    const auto radius_m = static_cast<float>(Point(6.3, -1.8).norm());
    EXPECT_NEAR(of("view_left"), (radius_m - static_cast<float>(Point(6.0, 1.8).norm())) / 10.0F, kRounding);
}

TEST(FrontFeatures, AMoveOverAMissedConeBridges) {
    Growth lane({{2.0, 1.8}, {9.0, 1.8}, {2.0, -1.8}});
    lane.start(0, 2);
    const ExtendFeatures seen = extend_features(lane.map, lane.state, kLeft, lane.move(kLeft, 1),
                                                measure(lane.map, lane.state, kLeft));
    EXPECT_EQ(named(extend_feature_table(), seen, "bridges"), 1.0F);
}

/// The boundary of `bend` turns by 0.3 rad with each segment of 3 m, so the next cone is expected at 0.6 rad.
/// The added cone is at the place where a straight boundary would have one.
TEST(FrontFeatures, OfAStopKnowWhereTheNextConeWouldBe) {
    std::vector<Point> cones = bend();
    const Point end = cones[2];
    const Point straight = end + 3.0 * Point(std::cos(0.3), std::sin(0.3));
    const Point next = end + 3.0 * Point(std::cos(0.6), std::sin(0.6));
    cones.push_back(straight);
    Growth lane(cones);
    lane.start(0, 3);
    lane.go_on(kLeft, 1);
    lane.go_on(kLeft, 2);
    const StopFeatures seen = stop_features(lane.map, lane.state, kLeft, {});
    const auto of = [&](std::string_view name) { return named(stop_feature_table(), seen, name); };
    EXPECT_NEAR(of("other_next_ahead"), (2.0 + 3.5) / 4.0, kRounding);  // by a usual segment
    EXPECT_NEAR(of("next_beyond"), (next.norm() - straight.norm()) / 4.0, kRounding);
    EXPECT_NEAR(of("next_off"), (next - straight).norm() / 4.0, kRounding);
    EXPECT_NEAR(of("straight_beyond"), 0.0F, kRounding);
    EXPECT_NEAR(of("straight_off"), 0.0F, kRounding);
    EXPECT_EQ(of("next_cones"), 1.0F);
    EXPECT_EQ(of("moves"), 0.0F);
}

/// The left cone 1.8 m to the left, the right one 1.6 m to the right and 0.4 m farther ahead; cone 2 stands
/// between them and the car, cone 3 goes on from the left one.
TEST(FrontFeatures, OfAStartAreThoseOfItsPair) {
    Growth lane({{2.0, 1.8}, {2.4, -1.6}, {1.5, 0.0}, {6.0, 1.8}});
    const StartCone left_cone = start_cone(lane.map, lane.vertex(0));
    const StartCone right_cone = start_cone(lane.map, lane.vertex(1));
    const StartFeatures left = start_features(lane.map, left_cone, right_cone, kLeft);
    const StartFeatures right = start_features(lane.map, right_cone, left_cone, kRight);
    const auto of_left = [&](std::string_view name) { return named(start_feature_table(), left, name); };
    const auto of_right = [&](std::string_view name) { return named(start_feature_table(), right, name); };
    EXPECT_NEAR(of_left("own_ahead"), 2.0F / 5.0F, kRounding);
    EXPECT_NEAR(of_left("own_outward"), 1.8F / 3.0F, kRounding);
    EXPECT_NEAR(of_left("other_outward"), 1.6F / 3.0F, kRounding);
    EXPECT_NEAR(of_right("own_outward"), 1.6F / 3.0F, kRounding);
    EXPECT_NEAR(of_left("lead"), -0.4F / 4.0F, kRounding);
    EXPECT_NEAR(of_right("lead"), 0.4F / 4.0F, kRounding);
    // The middle of the pair is 0.1 m left of the car.
    EXPECT_NEAR(of_left("middle_outward"), 0.05F, kRounding);
    EXPECT_NEAR(of_right("middle_outward"), -0.05F, kRounding);
    EXPECT_EQ(of_left("inside"), 1.0F);
    EXPECT_EQ(of_right("inside"), 1.0F);
    EXPECT_NEAR(of_left("own_continuation"), 0.0F, kRounding);
    // A segment to cone 3 runs along the heading; the one from cone 2 to the left cone does not.
    EXPECT_NEAR(start_cone(lane.map, lane.vertex(3)).predecessor, 0.0F, kRounding);
    EXPECT_NEAR(of_left("own_predecessor"), std::atan2(1.8, 0.5), kRounding);
}

/// A random lane through 100 cones, ten moves or so long.
class Wandering {
  public:
    explicit Wandering(std::uint64_t seed) : random_(seed) {
        Scene scene;
        for (ConeId id = 0; id < 100; ++id) scene.cones.push_back({id, {anywhere(0, 24), anywhere(-9, 9)}});
        map.build(scene);
        state = start_state(map, any_cone(), any_cone());
    }
    /// A random segment from that side's end; `take` then extends the lane by it.
    FrontMove any_move(Side side) {
        const auto ways = static_cast<double>(map.edges(state.ends[side].cones[0]).size());
        const auto edge = static_cast<std::size_t>(anywhere(0, ways));
        return {map.edges(state.ends[side].cones[0])[edge].to, edge};
    }
    void take(Side side, const FrontMove& move) { state = moved(map, state, side, move); }

    FrontMap map;
    FrontState state;

  private:
    double anywhere(double least, double most) {
        return boost::random::uniform_real_distribution<double>(least, most)(random_);
    }
    Vertex any_cone() { return static_cast<Vertex>(anywhere(0, static_cast<double>(map.size()))); }

    boost::random::mt19937_64 random_;
};

/// Cones strictly inside a triangle within a segment's reach of a, up to 3.
float inside(const FrontMap& map, const Point& a, const Point& b, const Point& c) {
    float count = 0.0F;
    for (Vertex cone = 0; cone < map.size(); ++cone) {
        const Point& p = map.position(cone);
        const double sides[]{cross(b - a, p - a), cross(c - b, p - b), cross(a - c, p - c)};
        const auto [least, most] = std::ranges::minmax(sides);
        if (p == a || p == b || p == c || (p - a).norm() > kMaxSegment_m) continue;
        if (least > 0.0 || most < 0.0) count += 1.0F;
    }
    return std::min(count, 3.0F);
}

/// The searches for cones find the same cones as a test of every cone within a segment's reach.
TEST(FrontFeatures, InACrowdAreThoseThatEveryConeGives) {
    int counted = 0;
    int near_partners = 0;
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        Wandering lane(seed);
        for (int step = 0; step < 10; ++step) {
            const Side side = step % 2 == 0 ? kLeft : kRight;
            const Vertex from = lane.state.ends[side].cones[0];
            const FrontEnd other = lane.state.ends[opposite(side)];
            const FrontMove move = lane.any_move(side);
            if (move.to == other.cones[0] || from == other.cones[0]) break;
            const ExtendFeatures seen =
                extend_features(lane.map, lane.state, side, move, measure(lane.map, lane.state, side));
            const Point& at = lane.map.position(move.to);
            const Point& facing = lane.map.position(other.cones[0]);
            const float expected_inside = inside(lane.map, lane.map.position(from), at, facing);
            ASSERT_EQ(named(extend_feature_table(), seen, "inside"), expected_inside) << seed << ", " << step;
            counted += expected_inside > 0.0F ? 1 : 0;

            const Point& along = lane.map.edges(from)[move.edge].direction;
            const double inward = side == kRight ? 1.0 : -1.0;
            const Point across = at + inward * lane.state.mean_width_m() * Point(-along.y(), along.x());
            double nearest_m = std::min(3.0, (facing - across).norm());
            for (const FrontEdge& edge : lane.map.edges(move.to)) {
                if (edge.to == from) continue;
                nearest_m = std::min(nearest_m, (lane.map.position(edge.to) - across).norm());
            }
            ASSERT_NEAR(named(extend_feature_table(), seen, "partner"), nearest_m / 3.0, kRounding);
            near_partners += nearest_m < 3.0 ? 1 : 0;
            lane.take(side, move);

            const FrontEnd& end = lane.state.ends[side];
            const StopFeatures stop = stop_features(lane.map, lane.state, side, {});
            const Point place = lane.map.position(end.cones[0]) + double{end.segment_m} * end.direction;
            double off_m = 6.0;
            for (const FrontEdge& edge : lane.map.edges(end.cones[0])) {
                if (edge.to == end.cones[1] || edge.to == other.cones[0] || edge.to == other.cones[1])
                    continue;
                off_m = std::min(off_m, (lane.map.position(edge.to) - place).norm());
            }
            ASSERT_NEAR(named(stop_feature_table(), stop, "straight_off"), off_m / 4.0, kRounding);
        }
    }
    EXPECT_GT(counted, 300);
    EXPECT_GT(near_partners, 300);
}

TEST(ComeWithin, SaysWhatTheDistanceSays) {
    boost::random::mt19937_64 random(5);
    boost::random::uniform_int_distribution<int> whole(-6, 6);
    int within = 0;
    for (int k = 0; k < 50'000; ++k) {
        const auto point = [&] {
            const double x = whole(random);
            return Point(x, whole(random));
        };
        const Segment a{point(), point()};
        const Segment b{point(), point()};
        const double gap_m = 0.25 + k % 5;
        const bool expected = segment_distance(a, b).distance_m < gap_m;
        ASSERT_EQ(come_within(a, b, gap_m), expected) << k;
        ASSERT_EQ(come_within(b, a, gap_m), expected) << k;
        within += expected ? 1 : 0;
    }
    EXPECT_GT(within, 10'000);
    EXPECT_LT(within, 45'000);
}

/// A false cone far from all others does not change the view distance; one that a segment could reach does.
TEST(FrontMap, TheViewReachesToTheFarthestConeThatIsNotAlone) {
    Scene scene = tests::straight_front_scene(3);
    FrontMap map;
    map.build(scene);
    const double reach_m = map.view_radius_m();
    EXPECT_GT(reach_m, 10.0);
    EXPECT_LT(reach_m, 15.0);
    scene.cones.push_back({100, {-400.0, 700.0}});
    map.build(scene);
    EXPECT_EQ(map.view_radius_m(), reach_m);
    scene.cones.push_back({101, {-400.0, 711.0}});
    map.build(scene);
    EXPECT_NEAR(map.view_radius_m(), std::hypot(400.0, 711.0), 1e-9);
    scene.cones = {{1, {30.0, 1.0}}, {2, {0.0, -40.0}}};
    map.build(scene);
    EXPECT_NEAR(map.view_radius_m(), 40.0, 1e-9) << "where all are alone, the farthest of them";
}

/// A score is the network's value for the inputs; for a start, it is the sum over both boundaries.
void require_scores_of_what_is_seen(const Scene& scene) {
    const FrontWeights weights = tests::random_front_weights(4);
    FrontCost cost(weights);
    FrontMap map;
    map.build(scene);
    FrontStarts starts;
    starts.list(map, {});
    const std::span<const float> pair_scores = cost.score_starts(map, starts);
    ASSERT_GT(starts.pairs.size(), 4U);
    const FrontNetwork start_network(weights.start);
    for (std::size_t i = 0; i < starts.pairs.size(); ++i) {
        const StartCone left = start_cone(map, starts.cones[kLeft][starts.pairs[i].left]);
        const StartCone right = start_cone(map, starts.cones[kRight][starts.pairs[i].right]);
        EXPECT_NEAR(pair_scores[i],
                    start_network.score(start_features(map, left, right, kLeft)) +
                        start_network.score(start_features(map, right, left, kRight)),
                    kRounding);
    }

    const auto vertex = [&](std::size_t cone) {
        Vertex v = 0;
        while (map.scene_index(v) != cone) ++v;
        return v;
    };
    FrontState state = start_state(map, vertex(0), vertex(1));
    FrontMoves moves;
    moves.list(map, state, kLeft, {});
    ASSERT_FALSE(moves.extensions.empty());
    EXPECT_FALSE(moves.stops);
    EXPECT_EQ(cost.score_moves(map, state, kLeft, moves).size(), moves.extensions.size());
    state = moved(map, state, kLeft, moves.extensions.front());
    moves.list(map, state, kLeft, {});
    ASSERT_TRUE(moves.stops);
    const std::span<const float> scores = cost.score_moves(map, state, kLeft, moves);
    ASSERT_EQ(scores.size(), moves.extensions.size() + 1);
    const auto with_state = [&](std::span<const float> more) {
        const StateFeatures seen = state_features(map, state, kLeft, measure(map, state, kLeft));
        std::vector<float> inputs(seen.begin(), seen.end());
        inputs.insert(inputs.end(), more.begin(), more.end());
        return inputs;
    };
    std::vector<float> all;
    const FrontNetwork extend_network(weights.extend);
    for (std::size_t i = 0; i < moves.extensions.size(); ++i) {
        const ExtendFeatures seen =
            extend_features(map, state, kLeft, moves.extensions[i], measure(map, state, kLeft));
        EXPECT_NEAR(scores[i], extend_network.score(with_state(seen)), kRounding);
        all.insert(all.end(), seen.begin(), seen.end());
    }
    const StopFeatures stop = stop_features(map, state, kLeft, all);
    EXPECT_NEAR(scores.back(), FrontNetwork(weights.stop).score(with_state(stop)), kRounding);
}

TEST(FrontCost, ScoresAreTheNetworksValues) {
    Scene scene = tests::straight_front_scene(3);
    require_scores_of_what_is_seen(scene);
    for (std::size_t i = 0; i < scene.cones.size(); ++i) scene.cones[i].color = i % 3 == 0 ? kBlue : kYellow;
    require_scores_of_what_is_seen(scene);
}

}  // namespace
}  // namespace conelane
