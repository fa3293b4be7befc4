// Courses as people write them: columns, separators, names of colors; cones that cannot belong to a boundary.

#include "tests/support/file_test.hpp"
#include "tests/support/recorded_tracks.hpp"

#include <fmt/format.h>

namespace conelane {
namespace {

struct Row {
    std::string tag;
    double x_m;
    double y_m;
};

/// A ring of 20 blue and 24 yellow cones, in the order of the angle.
std::vector<Row> ring() {
    std::vector<Row> rows;
    for (const auto& [tag, count, radius_m] : {std::tuple{"blue", 20, 10.0}, {"yellow", 24, 13.5}}) {
        for (int k = 0; k < count; ++k) {
            const double angle_rad = 2.0 * std::numbers::pi * k / count;
            rows.push_back({tag, radius_m * std::cos(angle_rad), radius_m * std::sin(angle_rad)});
        }
    }
    return rows;
}

/// An open lane of 11 pairs along +x with a bend of 20 degrees, blue on its left.
std::vector<Row> open_lane() {
    std::vector<Row> rows;
    for (const auto& [tag, side] : {std::pair{"blue", 1.75}, {"yellow", -1.75}}) {
        for (int k = 0; k <= 10; ++k) {
            const double past_m = std::max(0.0, 4.0 * k - 20.0);
            rows.push_back({tag, 4.0 * k, side + 0.35 * past_m});
        }
    }
    return rows;
}

class WrittenCourses : public FileTest {
  protected:
    [[nodiscard]] Track read(const std::string& text) const {
        return read_eufs_track(file_with(text, "course.csv"));
    }
    [[nodiscard]] Track read(const std::vector<Row>& rows, const std::string& header = "tag,x,y\n",
                             const std::string& format = "{0},{1},{2}\n") const {
        std::string text = header;
        for (const Row& row : rows) text += fmt::format(fmt::runtime(format), row.tag, row.x_m, row.y_m);
        return read(text);
    }
};

TEST_F(WrittenCourses, MeanTheSameHoweverTheirColumnsAreWritten) {
    const TrackBoundaries expected = boundaries(read(ring()));
    struct Writing {
        std::string header, format, warning;
    };
    const std::string taken = "column 1 is taken for tag, column 2 is taken for x, column 3 is taken for y";
    for (const Writing& writing : {
             Writing{"\xEF\xBB\xBFtag,x,y,direction\r\n", "{0},{1},{2},0\r\n", ""},
             {"\"tag\",\"x\",\"y\"\n", "\"{0}\",\"{1}\",\"{2}\"\n", ""},
             {" tag , x , y \n", "{0} , {1} , {2} \n", ""},
             {"# a course\ny,x,z,tag\n", "{2},{1},7,{0}\n", ""},
             {"Tag,X,Y\n", "{0},{1},{2}\n", "'Tag' is taken for tag, 'X' is taken for x, 'Y' is taken for y"},
             {"cone_type,X,Y,Z,std_X,std_Y,std_Z,right,left\n", "{0},{1},{2},0,0,0,0,0,1\n",
              "'cone_type' is"},
             {"# color,x [m],y [m]\n", "{0},{1},{2}\n", "is taken for tag, 'x [m]' is taken for x"},
             {"id,pos_x,pos_y,colour\n", "4,{1},{2},{0}\n", "'pos_x' is taken for x"},
             {"", "{0},{1},{2},0,0.01,0.01,0\n", "no header, " + taken + ", column 4 is taken for direction"},
             {"", "{0},{1},{2}\n", "no header, " + taken},
             {"", "{1},{2},{0}\n", "no header, column 3 is taken for tag, column 1 is taken for x"},
             {"tag;x;y\n", "{0};{1};{2}\n", "semicolons"},
             {"", "{0}\t{1}\t{2}\n", "tabs"},
             {"", "  {0}   {1} {2}\n", "blanks"},
         }) {
        SCOPED_TRACE(writing.header + writing.format);
        const Track track = read(ring(), writing.header, writing.format);
        EXPECT_EQ(boundaries(track).left, expected.left);
        EXPECT_EQ(boundaries(track).right, expected.right);
        EXPECT_TRUE(track.closed);
        if (writing.warning.empty()) {
            EXPECT_THAT(track.warnings, IsEmpty());
        } else {
            EXPECT_THAT(track.warnings, ElementsAre(HasSubstr(writing.warning)));
        }
    }
}

TEST_F(WrittenCourses, HaveDecimalCommasBetweenOtherSeparators) {
    std::string text;
    for (const Row& row : ring()) {
        std::string line = fmt::format("{};{};{}\n", row.tag, row.x_m, row.y_m);
        std::ranges::replace(line, '.', ',');
        text += line;
    }
    EXPECT_EQ(boundaries(read(text)).left, boundaries(read(ring())).left);
}

TEST_F(WrittenCourses, NameTheirColorsInManyWays) {
    for (const auto& [blue, yellow] : {std::pair{"Blue", "YELLOW"},
                                       {"blue_cone", "yellow-cone"},
                                       {"left", "right"},
                                       {"cone blue", "ConeYellow"},
                                       {"b", "y"},
                                       {"small_blue", "small_yellow"}}) {
        SCOPED_TRACE(blue);
        std::vector<Row> rows = ring();
        for (Row& row : rows) row.tag = row.tag == "blue" ? blue : yellow;
        const Track track = read(rows);
        EXPECT_EQ(track.left.size(), 20U);
        EXPECT_EQ(track.right.size(), 24U);
        EXPECT_THAT(track.warnings,
                    ElementsAre(AllOf(HasSubstr(fmt::format("'{}' is taken for blue", blue)),
                                      HasSubstr(fmt::format("'{}' is taken for yellow", yellow)))));
    }
    for (const std::string tag :
         {"orange_big", "Big-Orange", "small_orange", "orange", "LARGE_ORANGE_CONE"}) {
        std::vector<Row> rows = ring();
        rows[5].tag = tag;
        EXPECT_EQ(read(rows).cones[5].color, ConeColor::orange) << tag;
    }
}

/// Whether a polyline runs where another one does, but for cones that are missing: within 0.9 m.
void expect_same_line(const std::vector<Point>& line, const std::vector<Point>& other, bool closed) {
    for (const Point& place : line) EXPECT_LT(foot_on_polyline(place, other, closed).distance_m, 0.9);
    for (const Point& place : other) EXPECT_LT(foot_on_polyline(place, line, closed).distance_m, 0.9);
}

TEST_F(WrittenCourses, LeaveOutConesThatCannotBelong) {
    struct Fault {
        std::string name;
        std::vector<Row> added;
        std::vector<std::pair<std::size_t, std::string>> recolored;
        std::string warning;
    };
    for (const bool closed : {true, false}) {
        const std::vector<Row> rows = closed ? ring() : open_lane();
        const std::size_t n = rows.size();
        const Track expected = read(rows);
        ASSERT_EQ(expected.closed, closed);
        ASSERT_THAT(expected.warnings, IsEmpty());
        const std::vector<Row> ghosts{
            {"blue", 80.0, -40.0}, {"blue", -60.0, 90.0}, {"big_orange", -60.0, -90.0}};
        for (const Fault& fault : {
                 Fault{"a ghost", {{"yellow", 180.0, -40.0}}, {}, "is far from all"},
                 {"a near ghost", {{"yellow", -14.0, -21.0}}, {}, "the yellow cone of line"},
                 {"two ghosts", {{"yellow", 180.0, -40.0}, {"blue", 180.0, -36.0}}, {}, "is far from all"},
                 {"two ghosts of a color", ghosts, {}, "is far from all"},
                 {"the wrong color", {}, {{4, "yellow"}}, "the yellow cone of line 6 at"},
                 {"twice", {}, {{4, "yellow"}, {n - 4, "blue"}}, "stands in the other boundary"},
                 {"the wrong color first", {}, {{0, "yellow"}}, "of line 2 at"},
                 {"the wrong color last", {}, {{n - 1, "blue"}}, "the blue cone of line"},
             }) {
            SCOPED_TRACE(fault.name + (closed ? ", closed" : ", open"));
            std::vector<Row> written = rows;
            std::vector<std::size_t> cones;  // that cannot belong
            for (const auto& [cone, tag] : fault.recolored) {
                written[cone].tag = tag;
                cones.push_back(cone);
            }
            for (const Row& row : fault.added) {
                cones.push_back(written.size());
                written.push_back(row);
            }
            const Track track = read(written);
            EXPECT_EQ(track.cones.size(), written.size()) << "they stay on the map";
            EXPECT_EQ(track.closed, closed);
            EXPECT_EQ(track.left.size() + track.right.size() + cones.size(), written.size());
            for (const std::size_t cone : cones) {
                EXPECT_THAT(track.left, testing::Not(testing::Contains(cone)));
                EXPECT_THAT(track.right, testing::Not(testing::Contains(cone)));
            }
            EXPECT_THAT(track.warnings, ElementsAre(AllOf(HasSubstr("left out of the boundaries: "),
                                                          HasSubstr(fault.warning))));
            if (!closed && (cones[0] == 0 || cones[0] == n - 1)) continue;  // shorter by a cone
            expect_same_line(boundaries(track).left, boundaries(expected).left, closed);
            expect_same_line(boundaries(track).right, boundaries(expected).right, closed);
        }
    }
}

TEST_F(WrittenCourses, AreReadOnceWhereTheirBoundariesAreWrittenTwice) {
    for (const bool closed : {true, false}) {
        const std::vector<Row> rows = closed ? ring() : open_lane();
        const TrackBoundaries expected = boundaries(read(rows));
        for (const double apart_m : {0.0, 0.2, 0.4}) {
            for (const bool each : {true, false}) {  // each cone twice, or one row behind the other
                SCOPED_TRACE(fmt::format("{} m apart, closed {}, each {}", apart_m, closed, each));
                std::vector<Row> written;
                for (const Row& row : rows) {
                    written.push_back(row);
                    if (each) written.push_back({row.tag, row.x_m + 0.8 * apart_m, row.y_m - 0.6 * apart_m});
                }
                for (const Row& row : rows) {
                    if (!each) written.push_back({row.tag, row.x_m + 0.8 * apart_m, row.y_m - 0.6 * apart_m});
                }
                const Track track = read(written);
                EXPECT_EQ(boundaries(track).left, expected.left);
                EXPECT_EQ(boundaries(track).right, expected.right);
                EXPECT_EQ(track.cones.size(), (apart_m > kDoubledTrackCone_m ? 2 : 1) * rows.size());
                EXPECT_THAT(track.warnings,
                            ElementsAre(AllOf(HasSubstr("repeats another cone"), HasSubstr(" more"))));
            }
        }
    }
}

TEST_F(WrittenCourses, OfUseAreReadAlike) {
    const std::filesystem::path folder = recorded_data() / "use" / "courses";
    if (!std::filesystem::is_directory(folder))
        GTEST_SKIP() << "no use/courses in CONELANE_DATA or in ../shared/data";
    const Track expected = read_eufs_track(folder / "eufs.csv");
    EXPECT_THAT(expected.warnings, IsEmpty());
    for (const std::string name : {"no_header", "byte_order_mark", "capitals", "quoted", "fsds"}) {
        SCOPED_TRACE(name);
        const Track track = read_eufs_track(folder / (name + ".csv"));
        EXPECT_THAT(boundaries(track).left, testing::UnorderedElementsAreArray(boundaries(expected).left));
        EXPECT_THAT(boundaries(track).right, testing::UnorderedElementsAreArray(boundaries(expected).right));
    }
    for (const std::string name : {"ghost", "wrong_colour"}) {
        SCOPED_TRACE(name);
        const Track track = read_eufs_track(folder / (name + ".csv"));
        EXPECT_THAT(track.warnings,
                    ElementsAre(HasSubstr("left out of the boundaries: the yellow cone of line")));
        EXPECT_EQ(boundaries(track).right, boundaries(expected).right);
        EXPECT_EQ(track.left.size(), expected.left.size() - (name == "wrong_colour" ? 1 : 0));
    }
}

TEST(RecordedCourses, LoseNoConeThatBelongs) {
    CONELANE_RECORDED_TRACKS_OR_SKIP(tracks);
    for (const Track& track : tracks) {
        for (const std::string& warning : track.warnings)
            EXPECT_THAT(warning, testing::Not(HasSubstr("left out"))) << track.name;
    }
}

}  // namespace
}  // namespace conelane
