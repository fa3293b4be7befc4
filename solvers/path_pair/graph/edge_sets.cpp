#include "solvers/path_pair/graph/edge_sets.hpp"

#include <bit>

namespace conelane::path_pair {

void EdgeSets::assign(const ArcGraph& graph, const ResidualGraph& residual, SearchClock& clock) {
    number_of_edge_.assign(to_index(graph.edge_count()), -1);
    number_.clear();
    edges_.clear();
    for (int a = 0; a < residual.size(); ++a) {
        int& number = number_of_edge_[to_index(residual.edge(a))];
        if (number < 0) {
            number = static_cast<int>(edges_.size());
            edges_.push_back(residual.edge(a));
        }
        number_.push_back(number);
    }
    words_ = (edges_.size() + 63) / 64;
    const auto insert = [&](std::vector<std::uint64_t>& sets, std::size_t row, std::size_t number) {
        sets[row * words_ + number / 64] |= std::uint64_t{1} << (number % 64);
    };
    at_cone_.assign(to_index(graph.cone_count()) * words_, 0);
    for (std::size_t number = 0; number < edges_.size(); ++number) {
        insert(at_cone_, to_index(graph.tail(2 * edges_[number])), number);
        insert(at_cone_, to_index(graph.head(2 * edges_[number])), number);
    }
    // Rows are made one by one: the first write to megabytes of memory takes milliseconds without a check of
    // the clock.
    excluded_.clear();
    excluded_.reserve(edges_.size() * words_);
    for (std::size_t number = 0; number < edges_.size(); ++number) {
        const std::span<const std::uint64_t> row = graph.incompatible_row(edges_[number]);
        if (clock.out_of_time(10 * words_) || clock.tick(row.size())) return;
        excluded_.resize((number + 1) * words_, 0);
        for (std::size_t w = 0; w < row.size(); ++w) {
            for (std::uint64_t bits = row[w]; bits != 0; bits &= bits - 1) {
                const int other = number_of_edge_[w * 64 + to_index(std::countr_zero(bits))];
                if (other >= 0) insert(excluded_, number, to_index(other));
            }
        }
    }
    after_.clear();
    before_.clear();
    after_.reserve(residual.arc.size() * words_);
    before_.reserve(residual.arc.size() * words_);
    for (int a = 0; a < residual.size(); ++a) {
        if (clock.out_of_time(2 * words_) || clock.tick(2 * words_)) return;
        after_.resize((to_index(a) + 1) * words_);
        before_.resize((to_index(a) + 1) * words_);
        const std::uint64_t* const excluded = excluded_.data() + number(a) * words_;
        const std::uint64_t* const at_tail = at_cone_.data() + to_index(residual.tail[to_index(a)]) * words_;
        const std::uint64_t* const at_head = at_cone_.data() + to_index(residual.head[to_index(a)]) * words_;
        for (std::size_t w = 0; w < words_; ++w) {
            after_[to_index(a) * words_ + w] = excluded[w] | at_tail[w];
            before_[to_index(a) * words_ + w] = excluded[w] | at_head[w];
        }
    }
}

}  // namespace conelane::path_pair
