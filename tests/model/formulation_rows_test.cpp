// Rows of the two formulations that follow from other rows in a right program, and the names of columns: each
// is compared with edges that are chosen by hand.

#include "model/lane_graph_model.hpp"
#include "tests/support/six_cone_lane.hpp"
#include "tests/support/testing.hpp"

namespace conelane {
namespace {

using Cones = std::set<std::int32_t>;

const Cones kAll{0, 1, 2, 3, 4, 5};
const std::vector<Edge> kLane{{0, 1}, {1, 2}, {3, 4}, {4, 5}};

/// The columns of chosen edges and inliers; all others are 0.
std::vector<double> point_of(const BinaryProgram& program, const std::vector<Edge>& edges,
                             const Cones& inliers) {
    std::vector<double> point;
    for (const BinaryProgram::Column& column : program.columns) {
        const Label& label = column.label;
        const bool is_edge =
            label.family == "a" &&
            std::ranges::find(edges, make_edge(static_cast<std::size_t>(label.index.first),
                                               static_cast<std::size_t>(label.index.second))) != edges.end();
        const bool is_inlier = label.family == "g" && inliers.contains(label.index.first);
        point.push_back(is_edge || is_inlier ? 1.0 : 0.0);
    }
    return point;
}

/// Names of the rows of a family that the edges and inliers violate.
std::vector<std::string> violated(std::string_view family, const std::vector<Edge>& edges,
                                  const Cones& inliers) {
    const Scene scene = tests::six_cone_lane();
    const LaneGraphProblem problem = make_problem(scene, {}, EdgeExtent::all_pairs);
    const LaneGraphModel model(problem, Formulation::paper);
    const BinaryProgram& program = model.program();
    const std::vector<double> point = point_of(program, edges, inliers);
    std::vector<std::string> result;
    for (std::size_t r = 0; r < program.rows.size(); ++r) {
        if (program.rows[r].label.family != family) continue;
        double sum = 0.0;
        for (int e = program.row_starts[r]; e < program.row_starts[r + 1]; ++e) {
            const auto entry = static_cast<std::size_t>(e);
            sum +=
                program.entry_values[entry] * point[static_cast<std::size_t>(program.entry_columns[entry])];
        }
        if (sum < program.rows[r].lower || sum > program.rows[r].upper)
            result.push_back(to_string(program.rows[r].label));
    }
    return result;
}

TEST(PaperRows, AcceptTheLane) {
    for (const char* family : {"inlier_has_edge", "degree_at_most_two", "four_endpoints", "two_paths"})
        EXPECT_THAT(violated(family, kLane, kAll), testing::IsEmpty()) << family;
}

TEST(PaperRows, AnInlierHasAnEdge) {
    EXPECT_THAT(violated("inlier_has_edge", {{0, 1}, {3, 4}, {4, 5}}, kAll), testing::SizeIs(1));
}

TEST(PaperRows, AConeHasAtMostTwoEdgesAndNoneIfItIsNoInlier) {
    std::vector<Edge> rungs = kLane;
    rungs.push_back({1, 4});
    EXPECT_THAT(violated("degree_at_most_two", rungs, kAll), testing::SizeIs(2)) << "1 and 4";
    Cones without = kAll;
    without.erase(1);
    EXPECT_THAT(violated("degree_at_most_two", kLane, without), testing::SizeIs(1));
}

TEST(PaperRows, TwoPathsHaveFourEndpoints) {
    EXPECT_THAT(violated("four_endpoints", {{0, 1}, {1, 2}}, {0, 1, 2}), testing::SizeIs(1));
    EXPECT_THAT(violated("four_endpoints", {{0, 1}, {2, 5}, {3, 4}}, kAll), testing::SizeIs(1));
}

/// A written program names a column e by the cone that it comes from and the one where the path ends.
TEST(TightRows, NearEndpointsAreColumnsThatEndAtANearCone) {
    const Scene scene = tests::six_cone_lane();
    const LaneGraphProblem problem = make_problem(scene, {});
    const LaneGraphModel model(problem, Formulation::tight);
    const BinaryProgram& program = model.program();
    const auto row = std::ranges::find(program.rows, std::string_view("near_endpoints"),
                                       [](const auto& bounds) { return bounds.label.family; });
    ASSERT_NE(row, program.rows.end());
    const auto r = static_cast<std::size_t>(row - program.rows.begin());
    EXPECT_GT(program.row_starts[r + 1], program.row_starts[r]);
    for (int e = program.row_starts[r]; e < program.row_starts[r + 1]; ++e) {
        const auto column = static_cast<std::size_t>(program.entry_columns[static_cast<std::size_t>(e)]);
        const Label& label = program.columns[column].label;
        EXPECT_EQ(label.family, "e");
        EXPECT_TRUE(problem.near[static_cast<std::size_t>(label.index.second)]) << to_string(label);
    }
}

/// The path from 0 to 1 joins two near cones. The row that forbids it allows the lane, which continues to 2.
TEST(TightRows, APathBetweenNearConesMayGoOn) {
    const Scene scene = tests::six_cone_lane();
    const LaneGraphProblem problem = make_problem(scene, {});
    const LaneGraphModel model(problem, Formulation::tight);
    const std::vector<double> stops = point_of(model.program(), {{0, 1}, {3, 4}, {4, 5}}, {});
    const std::vector<double> goes_on = point_of(model.program(), kLane, {});
    const std::vector<ProgramRow> rows = model.separate(stops);
    ASSERT_EQ(rows.size(), 1U);
    const auto sum = [&](const std::vector<double>& point) {
        double result = 0.0;
        for (const auto& [column, value] : rows.front().terms)
            result += value * point[static_cast<std::size_t>(column)];
        return result;
    };
    EXPECT_GT(sum(stops), rows.front().upper);
    EXPECT_LE(sum(goes_on), rows.front().upper);
}

}  // namespace
}  // namespace conelane
