#include "model/connecting_flow.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <tuple>
#include <utility>
#include <vector>

namespace conelane {
namespace {

struct FlowEdge {
    std::size_t i, j;
    int chosen;               ///< column a_ij
    std::array<int, 2> flow;  ///< columns from i to j, and from j to i
};

std::int32_t label_index(std::size_t value) {
    return static_cast<std::int32_t>(value);
}

}  // namespace

void add_connecting_flow(BinaryProgram& program, const LaneGraphProblem& problem) {
    // The other path has at least two of the n cones, so a path has at most n - 2 cones, which take n - 3.
    const double most = std::max(1.0, static_cast<double>(problem.cone_count) - 3.0);
    std::vector<FlowEdge> edges;
    for (std::size_t c = 0; c < program.columns.size(); ++c) {
        const Label& label = program.columns[c].label;
        if (label.family != "a") continue;
        edges.push_back({static_cast<std::size_t>(label.index.first),
                         static_cast<std::size_t>(label.index.second),
                         static_cast<int>(c),
                         {}});
    }
    std::vector<std::vector<std::pair<std::size_t, int>>> at(
        problem.cone_count);  // edge number; 0 if the cone is its i, else 1
    for (std::size_t e = 0; e < edges.size(); ++e) {
        FlowEdge& edge = edges[e];
        edge.flow = {
            program.add_column({"y", {label_index(edge.i), label_index(edge.j)}}, 0.0, false, 0.0, most),
            program.add_column({"y", {label_index(edge.j), label_index(edge.i)}}, 0.0, false, 0.0, most)};
        at[edge.i].emplace_back(e, 0);
        at[edge.j].emplace_back(e, 1);
    }
    std::vector<int> source(problem.cone_count, -1);
    for (std::size_t cone = 0; cone < problem.cone_count; ++cone) {
        if (problem.parameters.pairing == Pairing::near_far && !problem.near[cone]) continue;
        source[cone] = program.add_column({"s", {label_index(cone)}}, 0.0, false, 0.0, most);
    }
    RowWriter rows(program);
    for (const FlowEdge& edge : edges) {
        rows.begin({"flow", {label_index(edge.i), label_index(edge.j)}}, -kInfinity, 0.0);
        for (const int column : edge.flow) rows.add(column, 1.0);
        rows.add(edge.chosen, -most);
        rows.end();
    }
    for (std::size_t cone = 0; cone < problem.cone_count; ++cone) {
        rows.begin({"fed", {label_index(cone)}}, 0.0, 0.0);
        for (const auto& [e, place] : at[cone]) {
            const auto out = static_cast<std::size_t>(place);
            rows.add(edges[e].flow[1 - out], 1.0);
            rows.add(edges[e].flow[out], -1.0);
            rows.add(edges[e].chosen, -0.5);
        }
        if (source[cone] >= 0) rows.add(source[cone], 1.0);
        rows.end();
        if (source[cone] < 0) continue;
        // s_i is 0 unless the degree is one: s_i <= most A_i, s_i <= most (2 - A_i).
        for (const auto& [family, sign, upper] :
             {std::tuple{"source_in", -1.0, 0.0}, std::tuple{"source_end", 1.0, 2.0}}) {
            rows.begin({family, {label_index(cone)}}, -kInfinity, upper * most);
            rows.add(source[cone], 1.0);
            for (const auto& [e, place] : at[cone]) rows.add(edges[e].chosen, sign * most);
            rows.end();
        }
    }
}

}  // namespace conelane
