#pragma once

#include "graph_search/lane_constraints.hpp"
#include "graph_search/lane_neighbourhood.hpp"
#include "graph_search/path_pair_enumeration.hpp"
#include "graph_search/ranking.hpp"
#include "graph_search/search_graph.hpp"
#include "graph_search/start_vertices.hpp"
#include "model/lane.hpp"
#include "model/scene.hpp"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace conelane {

struct CandidateSearchOptions {
    std::int64_t iteration_limit = 2500;  ///< it_max of Algorithm 2, of all starting pairs
    double d_max_m = 5.5;                 ///< largest distance of consecutive cones
    SearchGraphKind graph = SearchGraphKind::all_pairs;
    LaneBounds bounds;
    StartVertexRules start;          ///< its w_min_m and w_max_m are taken from `bounds`
    std::size_t starting_pairs = 3;  ///< how many are tried
    WidthBacktracking width_backtracking = WidthBacktracking::left_behind;
    /// Of the next-vertex decider, see there; 0: equation (3) as printed.
    double next_vertex_distance_weight = 0.0;
    /// Where a search is not complete after half of its iterations, the other half goes to a second one with
    /// at most so many discrepancies (see EnumerationRules). The first spends its iterations on the far end
    /// of few lanes; the second sees fewer vertices of all of a lane, and finds some pairs again. 0: none, as
    /// in the paper.
    std::uint32_t second_search_discrepancies = 0;
    /// Where a ranking is at hand, the lane that it puts first is searched around (see LaneNeighbourhood) so
    /// many times; it ends early where the first has been searched around already. Each time may use
    /// `neighbourhood_iterations`, beyond `iteration_limit`. 0: never, as in the paper.
    std::int64_t neighbourhoods = 0;
    std::int64_t neighbourhood_iterations = 400;
};

/// Throws InvalidInput naming the option that is out of its range.
void validate(const CandidateSearchOptions& options);

/// The first half of Algorithm 1: from a scene to its candidate lanes. Keeps memory from call to call.
class CandidateSearch {
  public:
    struct Report {
        std::int64_t iterations = 0;  ///< those around the best lanes included
        bool complete = true;         ///< every starting pair tried was searched to its end
        bool out_of_time = false;
    };
    struct Request {
        double time_limit_ms = std::numeric_limits<double>::infinity();
        bool with_features = false;
        /// Scores the pairs, features and all, and leads the search around the best ones; may be null.
        const LaneRanking* ranking = nullptr;
        /// Where the search begins (warm start, section IV-F): the lane of the scene before, by cone id; may
        /// be null. What the car has passed and what is no longer seen drops out of it.
        const Lane* last_lane = nullptr;
    };

    /// Throws InvalidInput as `validate` does.
    explicit CandidateSearch(const CandidateSearchOptions& options);

    /// Finds `pairs()` anew. Each starting pair but the last may use half of the iterations that are left; a
    /// warm start comes before them and may as well.
    Report run(const Scene& scene, const Request& request);

    [[nodiscard]] const PathPairs& pairs() const { return pairs_; }
    /// Of the ranking that was asked for, one for each pair.
    [[nodiscard]] std::span<const double> scores() const { return scores_; }
    /// A pair of `pairs()` of the last run, which was on `scene`.
    [[nodiscard]] Lane lane(const PathPair& pair, const Scene& scene) const;

  private:
    void run_from(StartPair start, const PathPairVertices& guide, bool is_last, const Scene& scene,
                  Report& report);
    void search_around_best(const LaneRanking& ranking, const Scene& scene);
    /// Sets the features that belong to the scene, of the pairs from number `first` on.
    void add_scene_features(const Scene& scene, std::size_t first);

    CandidateSearchOptions options_;
    EnumerationRules rules_;
    SearchGraph graph_;
    SearchBudget budget_;
    PathPairEnumeration enumeration_;
    LaneNeighbourhood neighbourhood_;
    PathPairs pairs_;
    std::vector<double> scores_;
    std::vector<std::size_t> searched_around_;
    std::vector<Point> points_;
    double longest_m_ = 0.0;  ///< of the pairs that the starting pairs gave
};

}  // namespace conelane
