#pragma once

#include "graph_search/path_pair_enumeration.hpp"
#include "graph_search/search_graph.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace conelane {

/// Chooses the candidate lane with the least expected cost (minimum Bayes risk). Beyond the paper.
///
/// The candidate of the highest score may be a mistake: several others, each a little less likely, may go
/// another way together, or end before the ways part. So each of the first few is taken for the right lane
/// with probability softmax(scores), and the answer is the one with the highest expected value. A lane's
/// value, where another one is right, is the share of their cones that both have on the same side, less
/// kStrayingPenalty where the lane has a cone within kNearPart_m along its boundary that the other one does
/// not have on that side.
class LaneConsensus {
  public:
    /// As many candidates as can be compared.
    static constexpr std::size_t kMostCandidates = 32;
    /// On tracks left out of a training, fewer lanes leave the track within 20 m with 4 than with 1 (by a
    /// tenth), for 0.4 % of the overlap.
    static constexpr double kStrayingPenalty = 4.0;

    /// Returns the place in `pairs.found()`. The first `count` by score are compared; of equal ones, the one
    /// with the higher score wins, then the one met first. Keeps memory from call to call. Preconditions:
    /// there is a pair, and a score for each; count in [1, kMostCandidates].
    [[nodiscard]] std::size_t choose(const PathPairs& pairs, const SearchGraph& graph,
                                     std::span<const double> scores, std::size_t count);

  private:
    void measure(const PathPairs& pairs, const SearchGraph& graph, std::size_t place);

    /// A candidate's vertices of both sides, one behind the other, those of the near part marked.
    struct Member {
        std::uint32_t vertex;  ///< twice the vertex, plus the side
        bool is_near;
    };
    std::vector<std::size_t> order_;  ///< of the candidates compared, best first
    std::vector<double> probabilities_;
    std::vector<Member> members_;
    std::vector<std::size_t> begins_;  ///< of each candidate in `members_`, and the end of the last one
    std::vector<std::uint32_t> on_;    ///< by Member::vertex: a bit for each candidate that has it
    std::vector<Vertex> side_;
};

}  // namespace conelane
