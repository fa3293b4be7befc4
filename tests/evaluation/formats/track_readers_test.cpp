#include "evaluation/world/centre_line.hpp"
#include "evaluation/world/generated_tracks.hpp"
#include "tests/support/boundary_checks.hpp"
#include "tests/support/file_test.hpp"
#include "tests/support/recorded_tracks.hpp"
#include "tests/support/refusal.hpp"

#include <numeric>

namespace conelane {
namespace {

class TrackFiles : public FileTest {
  protected:
    std::filesystem::path write(const std::string& name, const std::string& content) const {
        return file_with(content, name);
    }
};

std::vector<ConeId> ids(const Track& track, const std::vector<std::size_t>& boundary) {
    return mapped(boundary, [&](const std::size_t index) { return track.cones[index].id; });
}

/// Two nested triangles, driven counter-clockwise, and cone 99 of no boundary.
class FsdFiles : public TrackFiles {
  protected:
    static constexpr const char* kMap =
        "10: [0, 0]\n11: [8, 0]\n12: [4, 8]\n20:\n- -4\n- -3\n21: [12, -3]\n22: [4, 14.5]\n99: [30, 1e1]\n";
    static constexpr const char* kBoundaries = "left: [10, 11, 12]\nright:\n- 20\n- 21\n- 22\n";

    void write_both(const std::string& map, const std::string& boundaries) const {
        file_with(map, "cone_map_3.yaml");
        file_with(boundaries, "boundaries_3.yaml");
    }
};

TEST_F(FsdFiles, GiveBoundariesAndKeepConesOfNone) {
    write_both(kMap, kBoundaries);
    const Track track = read_fsd_track(path(""), 3);
    EXPECT_EQ(track.name, "fsd_3");
    EXPECT_TRUE(track.closed);
    EXPECT_THAT(ids(track, track.left), ElementsAre(10, 11, 12));
    EXPECT_THAT(ids(track, track.right), ElementsAre(20, 21, 22));
    ASSERT_EQ(track.cones.size(), 7u);
    EXPECT_EQ(track.cones[6].id, 99);
    EXPECT_EQ(track.cones[6].position, Point(30, 10));
    EXPECT_EQ(track.cones[5].position, Point(4, 14.5));
    EXPECT_EQ(track.cones[0].color, ConeColor::unknown);
}

TEST_F(FsdFiles, LastIdThatRepeatsTheFirstIsDropped) {
    write_both(kMap, "left: [10, 11, 12, 10]\nright: [20, 21, 22]\n");
    EXPECT_THAT(ids(read_fsd_track(path(""), 3), read_fsd_track(path(""), 3).left), ElementsAre(10, 11, 12));
}

TEST(DoubledCones, TheLaterOneLeavesBoundaryAndMapAndOtherBoundariesStay) {
    Track track;
    track.cones = {{1, {0, 0}}, {2, {0.3, 0}}, {3, {3, 0}}, {4, {0.1, 0.1}}, {5, {3, 4}}, {6, {0, 0.1}}};
    track.left = {1, 2, 0};  // cone 2 comes first, so cone 1 goes
    track.right = {3, 4};    // near cone 1 and 2, but of the other boundary; cone 6 is of none
    const Track single = without_doubled_cones(track);
    EXPECT_THAT(ids(single, single.left), ElementsAre(2, 3));
    EXPECT_THAT(ids(single, single.right), ElementsAre(4, 5));
    ASSERT_EQ(single.cones.size(), 5u);
    EXPECT_EQ(single.cones.back().id, 6);
}

std::string pacsim(const std::string& closed, const std::string& right) {
    return "track:\n  lanesFirstWithLastConnected: " + closed +
           "\n  left:\n  - {position: [0, 2, 0], class: blue}\n  - position: [5, 2.5, 0]\n    class: "
           "big-orange\n"
           "  right:\n" +
           right +
           "  time_keeping:\n  - {position: [9, 9, 0], class: timekeeping}\n"
           "  unknown:\n  - {position: [7, 7, 0], class: unknown}\n";
}
constexpr const char* kPacsimRight =
    "  - {position: [0, -2, 0], class: yellow}\n  - {position: [5, -2, 0], class: yellow}\n";

TEST_F(TrackFiles, PacsimOpenTrackWithUnknownConesAndColors) {
    const Track track = read_pacsim_track(write("yard.yaml", pacsim("false", kPacsimRight)));
    EXPECT_EQ(track.name, "pacsim_yard");
    EXPECT_FALSE(track.closed);
    EXPECT_THAT(track.left, ElementsAre(0, 1));
    EXPECT_THAT(track.right, ElementsAre(2, 3));
    ASSERT_EQ(track.cones.size(), 5u);
    EXPECT_EQ(track.cones[0].color, ConeColor::blue);
    EXPECT_EQ(track.cones[1].color, ConeColor::orange);
    EXPECT_EQ(track.cones[1].position, Point(5, 2.5));
    EXPECT_EQ(track.cones[3].color, ConeColor::yellow);
    EXPECT_EQ(track.cones[4].color, ConeColor::unknown);
    EXPECT_EQ(track.cones[4].position, Point(7, 7));
}

constexpr const char* kEufsHeader = "tag,x,y,direction,x_variance,y_variance,xy_covariance\n";

std::string eufs_row(const std::string& tag, double x, double y, double direction = 0.0) {
    return tag + "," + std::to_string(x) + "," + std::to_string(y) + "," + std::to_string(direction) +
           ",0.01,0.01,0.0\n";
}

/// Rings of radius 10 and 14 with a cone every 30 degrees, the outer one turned by 10, in scrambled order.
/// The car starts at (12, 0) and drives towards +y with the inner cones on its left, or towards -y.
std::string eufs_rings(bool counter_clockwise) {
    constexpr double kStep_rad = std::numbers::pi / 6.0;
    std::string content = kEufsHeader;
    for (int k = 0; k < 12; ++k) {
        const double inner_rad = kStep_rad * ((5 * k) % 12) - 0.1;
        const double outer_rad = kStep_rad * ((7 * k) % 12) + 0.1;
        const bool orange = (7 * k) % 12 == 6;
        content += eufs_row(counter_clockwise ? "blue" : "yellow", 10 * std::cos(inner_rad),
                            10 * std::sin(inner_rad));
        content += eufs_row(orange ? "big_orange" : (counter_clockwise ? "yellow" : "blue"),
                            14 * std::cos(outer_rad), 14 * std::sin(outer_rad));
    }
    content += eufs_row("unknown", 30, 30);
    content += "\n";
    content += eufs_row("car_start", 12, 0, counter_clockwise ? 1.5 : -1.5);
    return content;
}

class EufsRings : public TrackFiles, public ::testing::WithParamInterface<bool> {};

TEST_P(EufsRings, AreOrderedFromTheStartInDrivingDirection) {
    const bool counter_clockwise = GetParam();
    const Track track = read_eufs_track(write("rings.csv", eufs_rings(counter_clockwise)));
    EXPECT_EQ(track.name, "eufs_rings");
    EXPECT_TRUE(track.closed);
    ASSERT_EQ(track.cones.size(), 25u);
    ASSERT_EQ(track.left.size(), 12u);
    ASSERT_EQ(track.right.size(), 12u);
    const TrackBoundaries both = boundaries(track);
    for (const auto* const boundary : {&both.left, &both.right}) {
        for (std::size_t k = 0; k < 12; ++k) {
            const double turn_rad = turning_angle((*boundary)[k], (*boundary)[(k + 1) % 12]);
            EXPECT_NEAR(turn_rad, (counter_clockwise ? 1 : -1) * std::numbers::pi / 6.0, 1e-5) << k;
        }
    }
    // Ahead of the car at angle 0: with the turn, the next cone of the ring.
    const double inner_rad = std::atan2(both.left[0].y(), both.left[0].x());
    EXPECT_NEAR(inner_rad, counter_clockwise ? std::numbers::pi / 6.0 - 0.1 : 0.1 - std::numbers::pi / 6.0,
                1e-5);
    const std::size_t oranges = static_cast<std::size_t>(
        std::ranges::count(counter_clockwise ? track.right : track.left, ConeColor::orange,
                           [&](std::size_t index) { return track.cones[index].color; }));
    EXPECT_EQ(oranges, 1u);
}
INSTANTIATE_TEST_SUITE_P(BothDirections, EufsRings, ::testing::Bool());

/// A circuit written as an EUFS file loses its order; the reader finds it again, although sections of the
/// course are close together.
TEST_F(TrackFiles, EufsOrderIsThatOfTheCircuitWritten) {
    for (const std::string& name : generated_track_names()) {
        const Track circuit = generate_track(name, 0);
        if (!circuit.closed) continue;
        SCOPED_TRACE(name);
        std::vector<std::size_t> scrambled(circuit.cones.size());
        std::iota(scrambled.begin(), scrambled.end(), std::size_t{0});
        boost::random::mt19937_64 generator(1);
        for (std::size_t i = scrambled.size() - 1; i > 0; --i) {
            std::swap(scrambled[i],
                      scrambled[boost::random::uniform_int_distribution<std::size_t>(0, i)(generator)]);
        }
        std::string content = kEufsHeader;
        for (const std::size_t index : scrambled) {
            const Cone& cone = circuit.cones[index];
            content += eufs_row(std::string(to_string(cone.color)), cone.position.x(), cone.position.y());
        }
        const Pose start = centre_line_poses(boundaries(circuit), 1.0)[20];
        content += eufs_row("car_start", start.position.x(), start.position.y(), start.yaw_rad);
        const Track read = read_eufs_track(write(name + ".csv", content));
        const auto expect_order = [&](const std::vector<std::size_t>& expected,
                                      const std::vector<std::size_t>& actual) {
            ASSERT_EQ(actual.size(), expected.size());
            std::vector<std::size_t> found =
                mapped(actual, [&](const std::size_t index) { return scrambled[index]; });
            std::rotate(found.begin(), std::ranges::find(found, expected.front()), found.end());
            EXPECT_EQ(found, expected);
        };
        expect_order(circuit.left, read.left);
        expect_order(circuit.right, read.right);
        EXPECT_EQ(read.cones.size(), circuit.cones.size());
    }
}

TEST_F(TrackFiles, EufsConesOfOtherTagsBelongToNoBoundaryAndAreCounted) {
    std::string content = eufs_rings(true);
    content += eufs_row("inactive_noise", 11, 0) + eufs_row("inactive_noise", 3, 3) + eufs_row("green", 1, 1);
    const Track track = read_eufs_track(write("noisy.csv", content));
    EXPECT_EQ(track.cones.size(), 28u) << "they stay on the map";
    EXPECT_EQ(track.left.size(), 12u);
    EXPECT_EQ(track.right.size(), 12u);
    EXPECT_THAT(track.warnings,
                ElementsAre("3 cones belong to no boundary by their tag: green, inactive_noise"));
    EXPECT_THAT(read_eufs_track(write("clean.csv", eufs_rings(true))).warnings, IsEmpty());
    const auto turned = write("t.csv", with_other(eufs_rings(true), ",1.500000", ",-1.500000"));
    EXPECT_THAT(error_of([&] { (void)read_eufs_track(turned); }),
                HasSubstr("t.csv:28: direction: the car does not drive"));
}

TEST_F(TrackFiles, EufsCourseWithoutCarStartBeginsAtItsFirstPair) {
    for (const bool counter_clockwise : {true, false}) {
        std::string content = eufs_rings(counter_clockwise);
        content.erase(content.find("car_start"));
        const Track track = read_eufs_track(write("t.csv", content));
        const TrackBoundaries both = boundaries(track);
        EXPECT_TRUE(track.closed);
        EXPECT_EQ(both.left.front(), track.cones[counter_clockwise ? 0 : 1].position);
        EXPECT_LT((both.left.front() - both.right.front()).norm(), 5.5);
        const double turn_rad = turning_angle(both.left[0], both.left[1]);
        EXPECT_NEAR(turn_rad, (counter_clockwise ? 1 : -1) * std::numbers::pi / 6.0, 1e-5);
    }
}

/// The rows of a lane from (0, 0) north, then around a bend to the left and back south, or of its first leg.
std::string eufs_open(bool bend) {
    std::string content = kEufsHeader;
    for (const int k : {3, 0, 4, 1, 2, 5}) {
        const double y = 4.0 * k;
        content += eufs_row("blue", -2, y) + eufs_row("yellow", 2, y);
        if (bend) content += eufs_row("blue", -12, y) + eufs_row("yellow", -16, y);
    }
    if (bend) {
        for (const int k : {2, 1, 3}) {
            const double angle_rad = std::numbers::pi * k / 4.0;
            content += eufs_row("blue", -7 + 5 * std::cos(angle_rad), 20 + 5 * std::sin(angle_rad)) +
                       eufs_row("yellow", -7 + 9 * std::cos(angle_rad), 20 + 9 * std::sin(angle_rad));
        }
        content += eufs_row("yellow", -7 + 9 * std::cos(0.4), 20 + 9 * std::sin(0.4));
    }
    return content;
}

TEST_F(TrackFiles, EufsCourseThatCannotCloseIsOpen) {
    for (const bool bend : {false, true}) {
        SCOPED_TRACE(bend);
        const Track track = read_eufs_track(write("t.csv", eufs_open(bend)));
        EXPECT_FALSE(track.closed);
        const TrackBoundaries both = boundaries(track);
        ASSERT_EQ(both.left.size(), bend ? 15u : 6u);
        EXPECT_EQ(both.left.front(), Point(-2, 0));
        EXPECT_EQ(both.right.front(), Point(2, 0));
        EXPECT_EQ(both.left.back(), bend ? Point(-12, 0) : Point(-2, 20));
        EXPECT_EQ(both.right.back(), bend ? Point(-16, 0) : Point(2, 20));
        for (std::size_t k = 1; k < both.left.size(); ++k)
            EXPECT_LT((both.left[k] - both.left[k - 1]).norm(), 4.5);
        const double north_rad = std::numbers::pi / 2.0;
        EXPECT_FALSE(
            read_eufs_track(write("t.csv", eufs_open(bend) + eufs_row("car_start", 0, 8, north_rad))).closed);
        const auto against = write("t.csv", eufs_open(bend) + eufs_row("car_start", 0, 8, -north_rad));
        EXPECT_THAT(error_of([&] { return read_eufs_track(against); }), HasSubstr("the car does not drive"));
    }
}

/// An oval whose lower straight has a gate of 12 m without blue and yellow cones.
TEST_F(TrackFiles, EufsCourseIsClosedAcrossAGate) {
    for (const bool orange : {true, false}) {
        std::string content = kEufsHeader;
        for (int side = 0; side < 2; ++side) {
            const double radius_m = side == 0 ? 8.0 : 12.0;
            const char* const tag = side == 0 ? "blue" : "yellow";
            for (double x = 0.0; x < 30.0; x += 4.0) {
                content += eufs_row(tag, x, radius_m);
                if (x < 10.0 || x > 18.0) content += eufs_row(tag, x, -radius_m);
            }
            for (int k = 1; k < 8; ++k) {
                const double angle_rad = std::numbers::pi * (0.5 + k / 8.0);
                content += eufs_row(tag, radius_m * std::cos(angle_rad), radius_m * std::sin(angle_rad));
                content += eufs_row(tag, 28 - radius_m * std::cos(angle_rad), radius_m * std::sin(angle_rad));
            }
            if (orange)
                content += eufs_row("big_orange", 13.5, -radius_m) + eufs_row("big_orange", 14.5, -radius_m);
        }
        const Track track = read_eufs_track(write("gate.csv", content + eufs_row("car_start", 2, -10, 0)));
        EXPECT_TRUE(track.closed);
        const TrackBoundaries both = boundaries(track);
        const std::vector<double> expected =
            orange ? std::vector<double>{4, 8, 13.5, 14.5, 20} : std::vector<double>{4, 8, 20};
        for (const auto* const boundary : {&both.left, &both.right}) {
            EXPECT_EQ(boundary->size(), orange ? 30u : 28u);
            for (std::size_t k = 0; k < expected.size(); ++k) EXPECT_EQ((*boundary)[k].x(), expected[k]);
        }
    }
}

TEST_F(FsdFiles, SpecLoadsAllNumbersAscendingOrThoseNamed) {
    for (const char* const map : {"cone_map_12.yaml", "cone_map_3.yaml"}) write(map, kMap);
    for (const char* const both : {"boundaries_12.yaml", "boundaries_3.yaml"}) write(both, kBoundaries);
    write("cone_map_old.yaml", "no track");
    const std::string spec = "fsd:" + path("").string();
    const std::vector<Track> all = load_tracks(spec);
    ASSERT_EQ(all.size(), 2u);
    EXPECT_EQ(all[0].name, "fsd_3");
    EXPECT_EQ(all[1].name, "fsd_12");
    ASSERT_EQ(load_tracks(spec + ":12").size(), 1u);
    EXPECT_EQ(load_tracks(spec + ":12")[0].name, "fsd_12");
    EXPECT_EQ(error_of([&] { (void)read_fsd_track(path(""), 5); }), "cone_map_5.yaml: no such file");
    EXPECT_THAT(error_of([&] { return load_tracks(spec + ":3,4"); }),
                HasSubstr("cone_map_4.yaml: no such file"));
    EXPECT_THAT(error_of([&] { return load_tracks(spec + ":3,3"); }), HasSubstr("3 is there twice"));
    EXPECT_THAT(error_of([&] { return load_tracks(spec + ":3,"); }), HasSubstr("'' is not the number"));
    write("boundaries_5.yaml", kBoundaries);
    EXPECT_THAT(error_of([&] { return load_tracks(spec); }), HasSubstr("cone_map_5.yaml: no such file"));
}

TEST_F(TrackFiles, SpecLoadsFilesAndGeneratedTracks) {
    const auto yard = write("yard.yaml", pacsim("false", kPacsimRight));
    const auto rings = write("rings.csv", eufs_rings(true));
    EXPECT_EQ(load_tracks("pacsim:" + yard.string()).at(0).name, "pacsim_yard");
    EXPECT_EQ(load_tracks("eufs:" + rings.string()).at(0).name, "eufs_rings");
    const std::vector<Track> made = load_tracks("generated:circle,straight@7,circle@2");
    ASSERT_EQ(made.size(), 3u);
    EXPECT_EQ(made[0].name, "circle");
    EXPECT_EQ(made[1].name, "straight@7");
    EXPECT_EQ(made[2].name, "circle@2");
}

TEST_F(TrackFiles, SpecOfAFolderLoadsAllFilesOfItsKindByName) {
    std::filesystem::create_directory(path("") / "courses");
    write("courses/z.csv", eufs_rings(true));
    write("courses/a.csv", eufs_rings(true));
    write("courses/b.yaml", pacsim("false", kPacsimRight));
    write("courses/README.md", "courses");
    const std::string folder = (path("") / "courses").string();
    const std::vector<Track> tracks = load_tracks("eufs:" + folder);
    ASSERT_EQ(tracks.size(), 2u);
    EXPECT_EQ(tracks[0].name, "eufs_a");
    EXPECT_EQ(tracks[1].name, "eufs_z");
    EXPECT_EQ(load_tracks("pacsim:" + folder).at(0).name, "pacsim_b");
    EXPECT_THAT(error_of([&] { return load_tracks("ftlog:" + folder); }), HasSubstr("holds no .json file"));
    EXPECT_THAT(error_of([&] { return load_tracks("fsd:" + folder); }),
                HasSubstr("holds no cone_map_N.yaml"));
    EXPECT_THAT(error_of([&] { (void)read_pacsim_track(folder); }), HasSubstr("is a directory"));
}

/// The help names each source once, in the order of the table.
TEST(TrackFormats, AreNamedByTheHelp) {
    EXPECT_EQ(track_grammar(),
              "generated:NAME[@SEED][,...], fsd:DIR[:1,2], pacsim:FILE, eufs:FILE, ftlog:FILE or run:FILE");
    for (const TrackFormat* format : track_formats()) {
        EXPECT_THAT(track_format_lines(), HasSubstr(std::string(format->reads)));
        EXPECT_NE(format->read == nullptr, format->load == nullptr) << format->word;
        EXPECT_EQ(format->read != nullptr, !format->ending.empty()) << format->word;
    }
}

/// Properties that distinguish a recorded course from most others.
struct Peculiar {
    bool closed = true;
    double widest_m = 6.5;
};

Peculiar peculiar(const std::string& name) {
    const std::map<std::string, Peculiar> by_name{
        {"eufs_VSV_XL", {false, 6.5}},
        {"eufs_rand", {true, 9.1}},
    };
    const auto found = by_name.find(name);
    return found == by_name.end() ? Peculiar{} : found->second;
}

TEST(RecordedTracks, HavePlausibleBoundariesWithTheLeftOneOnTheLeft) {
    CONELANE_RECORDED_TRACKS_OR_SKIP(tracks);
    for (const Track& track : tracks) {
        SCOPED_TRACE(track.name);
        const Peculiar expected = peculiar(track.name);
        const TrackBoundaries both = boundaries(track);
        EXPECT_EQ(track.closed, expected.closed);
        EXPECT_GE(track.cones.size(), track.left.size() + track.right.size());
        for (const auto* const boundary : {&both.left, &both.right}) {
            EXPECT_TRUE(is_simple(*boundary, track.closed));
            for (const Segment& segment : segments(*boundary, track.closed)) {
                EXPECT_GT((segment.to - segment.from).norm(), kDoubledTrackCone_m);
                EXPECT_LT((segment.to - segment.from).norm(), 6.5);
            }
        }
        for (const double left_m : left_offsets_m(both.left, both.right, track.closed)) {
            EXPECT_GT(left_m, 2.0);
            EXPECT_LT(left_m, expected.widest_m);
        }
        for (const double left_m : left_offsets_m(both.right, both.left, track.closed)) {
            EXPECT_LT(left_m, -2.0);
            EXPECT_GT(left_m, -expected.widest_m);
        }
    }
}

}  // namespace
}  // namespace conelane
