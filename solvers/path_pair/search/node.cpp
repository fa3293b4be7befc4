#include "solvers/path_pair/search/node.hpp"

#include <functional>
#include <iterator>

namespace conelane::path_pair {

void NodeQueue::clear() {
    std::ranges::move(open_, std::back_inserter(spare_));
    open_.clear();
    // The same search takes the same nodes again, whose memory has the right size.
    std::ranges::sort(spare_, std::greater(), [](const auto& node) { return node->number; });
}

Node& NodeQueue::add() {
    if (spare_.empty()) {
        spare_.push_back(std::make_unique<Node>());
        spare_.back()->number = made_++;
    }
    open_.push_back(std::move(spare_.back()));
    spare_.pop_back();
    return *open_.back();
}

std::unique_ptr<Node> NodeQueue::take_next() {
    auto next = open_.end() - 1;
    if (open_.size() < max_open_) {
        for (auto node = open_.end(); node-- != open_.begin();) {
            if ((*node)->bound < (*next)->bound) next = node;
        }
    }
    std::unique_ptr<Node> taken = std::move(*next);
    open_.erase(next);
    return taken;
}

double NodeQueue::min_bound() const {
    double least = kUnreachable;
    for (const std::unique_ptr<Node>& node : open_) least = std::min(least, node->bound);
    return least;
}

}  // namespace conelane::path_pair
