// `conelane drive` as a user or a script calls it.

#include "tests/support/program_fixture.hpp"

namespace conelane::experiments {
namespace {

class DriveCommand : public ProgramFixture {
  protected:
    Outcome drive(const std::string& arguments) { return run("drive " + arguments); }

    /// A bend to the right that starts at the origin; the right boundary is nearer in its middle. Scenes "a"
    /// and "b" are the same; "c" has no lane.
    void make_files() {
        std::string cones;
        std::string left;
        std::string right;
        for (int i = 0; i < 8; ++i) {
            const double angle = 0.2 * i;
            for (const bool on_left : {true, false}) {
                const double radius = on_left ? 16.7 : 13.3;
                const nlohmann::json cone{{"id", on_left ? i : 100 + i},
                                          {"x", radius * std::sin(angle)},
                                          {"y", radius * std::cos(angle) - 15.0}};
                cones += (cones.empty() ? "" : ", ") + cone.dump();
            }
            left += (i > 0 ? ", " : "") + std::to_string(i);
            right += (i > 0 ? ", " : "") + std::to_string(100 + i);
        }
        std::string scenes;
        for (const char* id : {"a", "b", "c"}) {
            scenes += R"({"id": ")" + std::string(id) +
                      R"(", "pose": {"x": 0, "y": 0, "yaw": 0}, "cones": [)" + cones + "]}\n";
        }
        file_with(scenes, "s.scenes.jsonl");
        const auto found = [&](const std::string& scene, const std::string& detector) {
            return R"({"scene": ")" + scene + R"(", "method": ")" + detector +
                   R"(", "status": "found", "left": [)" + left + R"(], "right": [)" + right +
                   R"(], "closed": false, "latency_ms": 1, "trusted_m": 12.5})" + "\n";
        };
        file_with(found("a", "clc") + found("b", "clc") + kNone, "l.lanes.jsonl");
    }

    static std::vector<std::vector<double>> rows_of(const std::string& csv) {
        std::vector<std::vector<double>> rows;
        for (const std::string& line : lines_of(csv)) {
            if (line.starts_with('#')) continue;
            rows.emplace_back();
            std::istringstream values(line);
            for (std::string value; std::getline(values, value, ',');)
                rows.back().push_back(std::stod(value));
        }
        return rows;
    }

    const std::string kNone =
        R"({"scene": "c", "method": "clc", "status": "none", "left": [], "right": [], "latency_ms": 1})"
        "\n";
    const std::string kInputs = "--lanes l.lanes.jsonl --scenes s.scenes.jsonl ";
};

TEST_F(DriveCommand, WritesALineOfJsonForEachLane) {
    make_files();
    const Outcome outcome = drive(kInputs + "--out d.jsonl");
    EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
    EXPECT_EQ(outcome.output + outcome.errors, "");
    const std::vector<nlohmann::json> lanes = json_lines("d.jsonl");
    ASSERT_EQ(lanes.size(), 3U);
    EXPECT_EQ(lanes[0].at("scene"), "a");
    EXPECT_EQ(lanes[0].at("method"), "clc");
    EXPECT_EQ(lanes[0].at("status"), "found");
    EXPECT_EQ(lanes[0].at("closed"), false);
    EXPECT_EQ(lanes[0].at("trusted_m"), 12.5);
    EXPECT_NEAR(lanes[0].at("length_m"), 1.4 * 15.0, 0.6);
    EXPECT_EQ(lanes[0].at("bridged").size(), 0U);
    EXPECT_GT(lanes[0].at("points").size(), 38U);
    const nlohmann::json& point = lanes[0].at("points").at(20);
    EXPECT_DOUBLE_EQ(point.at("s_m"), 10.0);
    EXPECT_NEAR(std::hypot(point.at("x_m").get<double>(), point.at("y_m").get<double>() + 15.0), 15.0, 0.2);
    EXPECT_NEAR(point.at("heading_rad"), -10.0 / 15.0, 0.03);
    EXPECT_NEAR(point.at("curvature_1pm"), -1.0 / 15.0, 0.003);
    EXPECT_NEAR(point.at("width_left_m"), 1.7, 0.15);
    EXPECT_NEAR(point.at("width_right_m"), 1.7, 0.15);
    EXPECT_EQ(lanes[1].at("points"), lanes[0].at("points"));
    EXPECT_EQ(lanes[2].at("status"), "none");
    EXPECT_EQ(lanes[2].at("points").size(), 0U);
    EXPECT_FALSE(lanes[2].contains("trusted_m"));
}

TEST_F(DriveCommand, WritesTheColumnsOfTumAndOfFtFsd) {
    make_files();
    ASSERT_EQ(drive(kInputs + "--id b --step 2 --out d.jsonl").exit_code, 0);
    const nlohmann::json points = nlohmann::json::parse(text_of(path("d.jsonl"))).at("points");
    ASSERT_EQ(drive(kInputs + "--id b --step 2 --format tum --out d.csv").exit_code, 0);
    EXPECT_THAT(text_of(path("d.csv")), StartsWith("# x_m,y_m,w_tr_right_m,w_tr_left_m\n0."));
    const std::vector<std::vector<double>> tum = rows_of(text_of(path("d.csv")));
    ASSERT_EQ(drive(kInputs + "--id b --step 2 --format ftfsd --out e.csv").exit_code, 0);
    EXPECT_THAT(text_of(path("e.csv")), StartsWith("# s_m,x_m,y_m,curvature_1pm\n0.000000,0."));
    const std::vector<std::vector<double>> ft_fsd = rows_of(text_of(path("e.csv")));
    ASSERT_EQ(tum.size(), points.size());
    ASSERT_EQ(ft_fsd.size(), points.size());
    const auto expect_row = [](const std::vector<double>& row, const nlohmann::json& point,
                               const std::vector<std::string>& keys) {
        ASSERT_EQ(row.size(), keys.size());
        for (std::size_t i = 0; i < row.size(); ++i) EXPECT_NEAR(row[i], point.at(keys[i]), 1e-6) << keys[i];
    };
    bool sides_differ = false;
    for (std::size_t i = 0; i < points.size(); ++i) {
        expect_row(tum[i], points[i], {"x_m", "y_m", "width_right_m", "width_left_m"});
        expect_row(ft_fsd[i], points[i], {"s_m", "x_m", "y_m", "curvature_1pm"});
        sides_differ = sides_differ || std::abs(tum[i][2] - tum[i][3]) > 1e-3;
    }
    EXPECT_TRUE(sides_differ);  // else an exchange would not show
}

}  // namespace
}  // namespace conelane::experiments
