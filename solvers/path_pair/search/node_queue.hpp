#pragma once

#include "solvers/path_pair/search/node.hpp"

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

namespace conelane::path_pair {

/// The open nodes. Nodes that are given back are reused with their memory.
class NodeQueue {
  public:
    /// With `max_open` open nodes or more the search goes depth-first, which bounds the memory.
    explicit NodeQueue(std::size_t max_open) : max_open_(max_open) {}

    void clear();
    [[nodiscard]] bool empty() const { return open_.empty(); }
    /// A reused node with its old content, or a new one. It does not move until it is taken.
    Node& add();
    /// Removes and returns the next node: one of the lowest bound, of these the last that was added.
    /// Precondition: not empty.
    [[nodiscard]] std::unique_ptr<Node> take_next();
    void give_back(std::unique_ptr<Node> node) { spare_.push_back(std::move(node)); }
    /// kUnreachable without a node.
    [[nodiscard]] double min_bound() const;

  private:
    std::size_t max_open_;
    std::vector<std::unique_ptr<Node>> open_;
    std::vector<std::unique_ptr<Node>> spare_;
    std::size_t made_ = 0;
};

}  // namespace conelane::path_pair
