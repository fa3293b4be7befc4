#include "evaluation/world/generated_tracks.hpp"

#include "conelane/invalid_input.hpp"
#include "tests/support/boundary_checks.hpp"

namespace conelane {
namespace {

constexpr std::uint64_t kSeeds = 5;

/// Expected properties of the tracks of a layout; the fixed layouts keep to the rules of Formula Student.
struct Limits {
    double shortest_gap_m = 1.0;  ///< between cones of one boundary
    double max_gap_m = 5.0;
    double narrowest_m = 2.7;  ///< of the lane, across chords
    double widest_m = 5.3;  ///< at the ends of an open track and across chords a little more than the width
    double min_swell_m = 0.8;
    double min_wall_m = 3.5;  ///< between two legs of one boundary
};

Limits limits_of(const std::string& track) {
    const std::string layout = track.substr(0, track.find('@'));
    if (layout == "legs") return {1.2, 4.2, 2.7, 5.3, 0.3, 3.0};
    if (layout == "tight_hairpins") return {0.9, 2.6, 2.5, 3.6, 0.1, 2.4};
    if (layout == "gates") return {0.3, 6.4, 2.5, 5.0, 0.8, 3.5};
    if (layout == "wide") return {2.4, 6.4, 4.2, 6.3, 0.6, 3.5};
    if (layout == "wide_hairpins") return {1.2, 5.4, 2.7, 8.6, 1.5, 2.4};
    if (layout == "sparse") return {2.8, 12.5, 2.3, 4.4, 0.2, 3.5};
    if (layout == "sharp") return {0.4, 5.0, 2.3, 6.0, 0.2, 2.4};
    return {};
}

template <typename Check>
void for_every_track(const Check& check) {
    for (const std::string& name : generated_track_names()) {
        for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
            const Track track = generate_track(name, seed);
            SCOPED_TRACE(track.name);
            check(track, boundaries(track));
        }
    }
}

TEST(GeneratedTrack, ALegIsAsLongAsItsHairpinsNeed) {
    const Track track = generate_track("wide_hairpins", 4697);
    EXPECT_GT(std::min(track.left.size(), track.right.size()), 20U);
}

TEST(RoundedPath, OfASquareIsStraightsAndQuarterCircles) {
    const RoundedPath path({{{0, 0}, 2}, {{10, 0}, 3}, {{10, 10}, 2}, {{0, 10}, 2}}, true);
    EXPECT_NEAR(path.length_m(), 40 - 2 * 9 + std::numbers::pi / 2 * 9, 1e-12);
    EXPECT_NEAR((path.at(0).position - Point(2, 0)).norm(), 0, 1e-12);
    EXPECT_NEAR((path.at(5).position - Point(7, 0)).norm(), 0, 1e-12);
    EXPECT_EQ(path.at(4).curvature_1_m, 0.0);
    const RoundedPath::Place middle = path.at(5 + 3 * std::numbers::pi / 4);
    EXPECT_NEAR((middle.position - Point(7, 3) - 3 * Point(1, -1).normalized()).norm(), 0, 1e-12);
    EXPECT_NEAR((middle.direction - Point(1, 1).normalized()).norm(), 0, 1e-12);
    EXPECT_NEAR(middle.curvature_1_m, 1.0 / 3, 1e-12);
    EXPECT_NEAR((path.at(-1).position - path.at(path.length_m() - 1).position).norm(), 0, 1e-9);
}

TEST(RoundedPath, OpenOnesRunFromEndToEndAndBendBothWays) {
    const RoundedPath path({{{0, 0}, 1}, {{10, 0}, 2}, {{10, -10}, 1}}, false);
    EXPECT_NEAR((path.at(-5).position - Point(0, 0)).norm(), 0, 1e-12);
    EXPECT_NEAR((path.at(1e9).position - Point(10, -10)).norm(), 0, 1e-12);
    EXPECT_NEAR(path.at(8.1).curvature_1_m, -0.5, 1e-12);
}

TEST(RoundedPath, ArcsMustFitTheirSides) {
    EXPECT_THROW(RoundedPath({{{0, 0}, 6}, {{10, 0}, 6}, {{10, 10}, 2}, {{0, 10}, 2}}, true), InvalidInput);
    EXPECT_THROW(RoundedPath({{{0, 0}, 1}, {{10, 0}, 0}, {{10, 10}, 1}}, false), InvalidInput);
    EXPECT_THROW(RoundedPath({{{0, 0}, 1}, {{10, 0}, 1}, {{0, 0}, 1}}, false), InvalidInput);
    EXPECT_THROW(RoundedPath({{{0, 0}, 1}, {{10, 0}, 1}}, true), InvalidInput);
}

TEST(TrackLayouts, KeepToTheRulesOnLengthAndCurvature) {
    std::size_t circuits = 0;
    std::size_t with_strays = 0;
    for (const TrackLayout& layout : track_layouts()) {
        SCOPED_TRACE(layout.name);
        const RoundedPath path(layout.centre_line, layout.closed);
        EXPECT_GE(path.length_m(), 150);
        EXPECT_LE(path.length_m(), 500);
        for (double s_m = 0; s_m < path.length_m(); s_m += 0.2)
            EXPECT_LE(std::abs(path.at(s_m).curvature_1_m), 1 / 4.5);
        if (layout.closed && path.length_m() >= 200) ++circuits;
        if (layout.stray_cones > 0) ++with_strays;
    }
    EXPECT_GE(circuits, 5u);
    EXPECT_GE(with_strays, 2u);
}

TEST(TrackLayouts, SectionsKeepApart) {
    for (const TrackLayout& layout : track_layouts()) {
        SCOPED_TRACE(layout.name);
        const RoundedPath path(layout.centre_line, layout.closed);
        for (double a_m = 0; a_m < path.length_m(); a_m += 1.0) {
            for (double b_m = a_m; b_m < path.length_m(); b_m += 1.0) {
                double apart_m = b_m - a_m;
                if (layout.closed) apart_m = std::min(apart_m, path.length_m() - apart_m);
                if (apart_m < 15) continue;  // half a turn of the tightest hairpin is 14.1 m long
                ASSERT_GT((path.at(a_m).position - path.at(b_m).position).norm(), 8.5) << a_m << " " << b_m;
            }
        }
    }
}

TEST(GeneratedTracks, HoldThePapersTopologies) {
    for (const char* const name : {"straight", "circle", "curvy"})
        EXPECT_THAT(generated_track_names(), Contains(name));
    EXPECT_THROW(static_cast<void>(generate_track("oval", 0)), InvalidInput);
}

TEST(GeneratedTracks, AreNamedByNameAndSeedAndDifferBySeedOnly) {
    EXPECT_EQ(generate_track("circle", 0).name, "circle");
    EXPECT_EQ(generate_track("circle", 3).name, "circle@3");
    const Track once = generate_track("infield", 3);
    const Track again = generate_track("infield", 3);
    const Track other = generate_track("infield", 4);
    ASSERT_EQ(once.cones.size(), again.cones.size());
    bool differs = once.cones.size() != other.cones.size();
    for (std::size_t i = 0; i < once.cones.size(); ++i) {
        EXPECT_EQ(once.cones[i].position, again.cones[i].position);
        differs = differs || once.cones[i].position != other.cones[i].position;
    }
    EXPECT_TRUE(differs);
}

TEST(GeneratedTracks, HaveSimpleBoundariesApartFromEachOtherAndFromThemselves) {
    for_every_track([](const Track& track, const TrackBoundaries& both) {
        EXPECT_TRUE(is_simple(both.left, track.closed));
        EXPECT_TRUE(is_simple(both.right, track.closed));
        const Limits limits = limits_of(track.name);
        EXPECT_GT(clearance_m(both.left, both.right, track.closed), limits.narrowest_m);
        for (const auto* const boundary : {&both.left, &both.right}) {
            const std::vector<Segment> all = segments(*boundary, track.closed);
            const double length_m = polyline_length_m(*boundary, track.closed);
            double start_i_m = 0;
            for (std::size_t i = 0; i < all.size(); ++i) {
                double start_j_m = start_i_m;
                for (std::size_t j = i; j < all.size(); ++j) {
                    double apart_m = start_j_m - start_i_m;
                    if (track.closed) apart_m = std::min(apart_m, length_m - apart_m);
                    if (apart_m > 18) {
                        ASSERT_GT(segment_distance(all[i], all[j]).distance_m, limits.min_wall_m)
                            << i << " " << j;
                    }
                    start_j_m += (all[j].to - all[j].from).norm();
                }
                start_i_m += (all[i].to - all[i].from).norm();
            }
        }
    });
}

TEST(GeneratedTracks, SpaceConesUnevenlyOneToFiveMetresApart) {
    for_every_track([](const Track& track, const TrackBoundaries& both) {
        const Limits limits = limits_of(track.name);
        for (const auto* const boundary : {&both.left, &both.right}) {
            double shortest_m = 10;
            double max_length_m = 0;
            for (const Segment& segment : segments(*boundary, track.closed)) {
                const double gap_m = (segment.to - segment.from).norm();
                EXPECT_GE(gap_m, limits.shortest_gap_m);
                EXPECT_LE(gap_m, limits.max_gap_m);
                shortest_m = std::min(shortest_m, gap_m);
                max_length_m = std::max(max_length_m, gap_m);
            }
            EXPECT_GT(max_length_m, 1.2 * shortest_m);
        }
    });
}

TEST(GeneratedTracks, PutConesDenserInTightBends) {
    const Track track = generate_track("hairpins", 0);
    const TrackLayout* const layout = &*std::ranges::find(track_layouts(), "hairpins", &TrackLayout::name);
    const RoundedPath path(layout->centre_line, layout->closed);
    std::vector<Point> centre_line;
    for (double s_m = 0; s_m < path.length_m(); s_m += 0.1) centre_line.push_back(path.at(s_m).position);
    double in_bends_m = 0;
    double on_straights_m = 0;
    int bends = 0;
    int straights = 0;
    for (const Segment& segment : segments(boundaries(track).right, true)) {
        const double s_m = foot_on_polyline((segment.from + segment.to) / 2, centre_line, true).arc_length_m;
        const double curvature_1_m = std::abs(path.at(s_m).curvature_1_m);
        if (curvature_1_m > 0.15) {
            in_bends_m += (segment.to - segment.from).norm();
            ++bends;
        } else if (curvature_1_m == 0.0) {
            on_straights_m += (segment.to - segment.from).norm();
            ++straights;
        }
    }
    ASSERT_GT(bends, 5);
    ASSERT_GT(straights, 20);
    EXPECT_LT(in_bends_m / bends, 0.7 * on_straights_m / straights);
}

TEST(GeneratedTracks, HaveLanesThreeToFiveMetresWideWithTheLeftBoundaryOnTheLeft) {
    for_every_track([](const Track& track, const TrackBoundaries& both) {
        double narrowest_m = 10;
        double widest_m = 0;
        for (const double left_m : left_offsets_m(both.left, both.right, track.closed)) {
            narrowest_m = std::min(narrowest_m, left_m);
            widest_m = std::max(widest_m, left_m);
        }
        const Limits limits = limits_of(track.name);
        EXPECT_GE(narrowest_m, limits.narrowest_m);
        EXPECT_LE(widest_m, limits.widest_m);
        EXPECT_GE(widest_m - narrowest_m, limits.min_swell_m);
        for (const double left_m : left_offsets_m(both.right, both.left, track.closed))
            EXPECT_LT(left_m, -limits.narrowest_m);
    });
}

TEST(GeneratedTracks, AreWrittenInTenthsOfMillimetresWithDistinctIds) {
    for_every_track([](const Track& track, const TrackBoundaries&) {
        std::set<ConeId> seen;
        for (const Cone& cone : track.cones) {
            EXPECT_TRUE(seen.insert(cone.id).second);
            for (const double value_m : {cone.position.x(), cone.position.y()})
                EXPECT_NEAR(value_m * 1e4, std::round(value_m * 1e4), 1e-6);
        }
        const bool gates = track.name.starts_with("gates");
        for (const auto& [side, color] :
             {std::pair{&track.left, ConeColor::blue}, std::pair{&track.right, ConeColor::yellow}}) {
            std::size_t orange = 0;
            for (const std::size_t index : *side) {
                if (track.cones[index].color == ConeColor::orange) {
                    ++orange;
                } else {
                    EXPECT_EQ(track.cones[index].color, color);
                }
            }
            EXPECT_EQ(orange, gates ? 4u : 0u) << "two at each of two gates";
        }
    });
}

/// The gap of a gate: from the pair of orange cones to the boundary's own cones on both sides.
TEST(GeneratedTracks, GatesStandInWideGaps) {
    for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
        const Track track = generate_track("gates", seed);
        SCOPED_TRACE(track.name);
        for (const std::vector<std::size_t>* const side : {&track.left, &track.right}) {
            std::size_t wide = 0;
            for (std::size_t i = 0; i < side->size(); ++i) {
                const Cone& here = track.cones[(*side)[i]];
                const Cone& next = track.cones[(*side)[(i + 1) % side->size()]];
                const double gap_m = (next.position - here.position).norm();
                if ((here.color == ConeColor::orange) == (next.color == ConeColor::orange)) continue;
                EXPECT_GT(gap_m, 3.8);
                ++wide;
            }
            EXPECT_EQ(wide, 4u);
        }
    }
}

/// Distance of each vertex of a boundary to the next leg of the same boundary.
double nearest_leg_m(const std::vector<Point>& boundary) {
    const std::vector<Segment> all = segments(boundary, true);
    double nearest_m = 1e9;
    for (std::size_t i = 0; i < all.size(); ++i) {
        for (std::size_t j = 0; j < all.size(); ++j) {
            const Point along = all[i].to - all[i].from;
            const Point other = all[j].to - all[j].from;
            const bool against = along.dot(other) < -0.97 * along.norm() * other.norm();
            if (against) nearest_m = std::min(nearest_m, segment_distance(all[i], all[j]).distance_m);
        }
    }
    return nearest_m;
}

TEST(GeneratedTracks, LegsLieThreeToSixMetresApartAndEachSeedDrawsOthers) {
    std::set<std::size_t> cones;
    bool left_handed = false;
    bool right_handed = false;
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
        const Track track = generate_track("legs", seed);
        SCOPED_TRACE(track.name);
        const TrackBoundaries both = boundaries(track);
        for (const auto* const boundary : {&both.left, &both.right}) {
            EXPECT_GT(nearest_leg_m(*boundary), 3.0);
            EXPECT_LT(nearest_leg_m(*boundary), 6.2);
        }
        cones.insert(track.cones.size());
        const bool left_is_inner = polyline_length_m(both.left, true) < polyline_length_m(both.right, true);
        (left_is_inner ? left_handed : right_handed) = true;
    }
    EXPECT_GE(cones.size(), 8u);
    EXPECT_TRUE(left_handed && right_handed);
}

TEST(GeneratedTracks, StrayConesLieOutsideTheLaneNearTheTrack) {
    for (const char* const name : {"infield", "serpentine"}) {
        const Track track = generate_track(name, 1);
        SCOPED_TRACE(track.name);
        const TrackBoundaries both = boundaries(track);
        const std::size_t annotated = track.left.size() + track.right.size();
        ASSERT_GE(track.cones.size(), annotated + 10);
        for (std::size_t i = annotated; i < track.cones.size(); ++i) {
            const Point& position = track.cones[i].position;
            EXPECT_EQ(track.cones[i].color, ConeColor::unknown);
            const double to_left_m = foot_on_polyline(position, both.left, true).distance_m;
            const double to_right_m = foot_on_polyline(position, both.right, true).distance_m;
            EXPECT_LT(std::min(to_left_m, to_right_m), 9.0);
            const bool left_of_lane = left_offsets_m({position}, both.left, true)[0] > 0;
            const bool right_of_lane = left_offsets_m({position}, both.right, true)[0] < 0;
            EXPECT_TRUE(to_left_m < to_right_m ? left_of_lane : right_of_lane) << i;
        }
    }
}

}  // namespace
}  // namespace conelane
