#include "evaluation/outside/solver_input.hpp"

#include "evaluation/seeded_random.hpp"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace conelane {
namespace {

std::vector<std::size_t> drawn_order(std::size_t size, const std::string& name, std::uint64_t seed) {
    std::vector<std::size_t> order(size);
    std::iota(order.begin(), order.end(), std::size_t{0});
    boost::random::mt19937_64 random = generator_of(name, seed);
    shuffle(order, random);
    return order;
}

}  // namespace

std::vector<double> PermutedProgram::point_of(std::span<const double> point) const {
    if (point.empty()) return {};
    std::vector<double> first(column_of.size());
    for (std::size_t c = 0; c < first.size(); ++c) first[c] = point[column_of[c]];
    return first;
}

PermutedProgram permuted(const BinaryProgram& program, std::uint64_t seed) {
    PermutedProgram made;
    const std::vector<std::size_t> columns = drawn_order(program.columns.size(), "columns", seed);
    made.column_of.resize(columns.size());
    made.program.columns.reserve(columns.size());
    for (std::size_t place = 0; place < columns.size(); ++place) {
        made.column_of[columns[place]] = place;
        made.program.columns.push_back(program.columns[columns[place]]);
    }
    RowWriter writer(made.program);
    std::vector<std::pair<std::size_t, double>> terms;
    for (const std::size_t row : drawn_order(program.rows.size(), "rows", seed)) {
        terms.clear();
        for (int e = program.row_starts[row]; e < program.row_starts[row + 1]; ++e) {
            const auto entry = static_cast<std::size_t>(e);
            terms.emplace_back(made.column_of[static_cast<std::size_t>(program.entry_columns[entry])],
                               program.entry_values[entry]);
        }
        std::ranges::sort(terms);
        const BinaryProgram::RowBounds& bounds = program.rows[row];
        writer.begin(bounds.label, bounds.lower, bounds.upper);
        for (const auto& [column, value] : terms) writer.add(static_cast<int>(column), value);
        writer.end();
    }
    return made;
}

}  // namespace conelane
