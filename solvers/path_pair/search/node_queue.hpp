#pragma once

#include "solvers/path_pair/search/node.hpp"

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

namespace conelane::path_pair {

/// The open nodes. Nodes that were given back are used again, with their memory.
class NodeQueue {
  public:
    /// From `max_open` open nodes on the search goes depth-first, which bounds the memory.
    explicit NodeQueue(std::size_t max_open) : max_open_(max_open) {}

    void clear();
    [[nodiscard]] bool empty() const { return open_.empty(); }
    /// A node as it was given back, or a new one. It stays where it is until it is taken.
    Node& add();
    /// The node that comes next, off the queue: one of the lowest bound, of these the last that was added.
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
