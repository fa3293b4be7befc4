#pragma once

#include "conelane/lane.hpp"
#include "graph_search/clc/lane_beam.hpp"
#include "graph_search/clc/start_vertices.hpp"

#include <memory>
#include <utility>

namespace conelane {

struct CandidateSearchOptions {
    std::int64_t iteration_limit = 2500;  ///< it_max of Algorithm 2, for all starting pairs together
    double d_max_m = 5.5;                 ///< largest distance of consecutive cones
    /// A boundary goes on to this many nearest neighbours of a cone only, see StepReach. 0: to all, as in the
    /// paper.
    std::size_t nearest_neighbours = 0;
    LaneBounds bounds;
    StartVertexRules start;
    std::size_t starting_pairs = 3;  ///< number of starting pairs that are tried
    WidthBacktracking width_backtracking = WidthBacktracking::left_behind;
    /// For the next-vertex decider, see there; 0: equation (3) as printed.
    double next_vertex_distance_weight = 0.0;
    /// The first search follows the lane that a beam search of `beam_width` finds by these scores (see
    /// LaneBeam); its work does not count as iterations. Null: none, as in the paper.
    std::shared_ptr<const StepScores> step_scores;
    std::size_t beam_width = 8;
    /// If a search is not complete after half of its iterations, a second search with at most this many
    /// discrepancies (see EnumerationRules) gets the other half. The first search spends its iterations on
    /// the far ends of few lanes; the second considers fewer vertices along the whole lane, and finds some
    /// pairs again. 0: none, as in the paper.
    std::uint32_t second_search_discrepancies = 0;
    /// A search stops when it holds about this much memory. 2500 iterations need some 5 MB.
    std::size_t memory_limit_bytes = std::size_t{1} << 29U;
};

/// Throws InvalidInput naming the option that is out of its range.
void validate(const CandidateSearchOptions& options);

/// The first half of Algorithm 1: from a scene to its candidate lanes. Keeps memory from call to call.
class CandidateSearch {
  public:
    struct Report {
        std::int64_t iterations = 0;
        bool complete = true;   ///< every starting pair tried was searched to its end
        bool exhausted = true;  ///< and no pair and no step was left out
        /// The limit that cut a search short; iterations only if no other limit did.
        std::optional<StopReason> stopped_by;
    };
    struct Request {
        Deadline deadline;
        bool with_features = false;
        /// Start of the search (warm start, section IV-F): the lane of the scene before, by cone id; may be
        /// null. Cones that the car has passed or no longer sees are dropped.
        const Lane* last_lane = nullptr;
    };

    /// Throws InvalidInput as `validate` does.
    explicit CandidateSearch(const CandidateSearchOptions& options);

    /// Finds `pairs()` for a scene. Each starting pair but the last may use half of the remaining iterations.
    /// A warm start and the lane of the beam search come before them, with the same share. The beam search
    /// may use half of the remaining time. Precondition: the scene is valid.
    Report run(const Scene& scene, const Request& request);

    [[nodiscard]] const PathPairs& pairs() const { return pairs_; }
    [[nodiscard]] const SearchGraph& graph() const { return graph_; }
    /// A pair of `pairs()` of the last run, which was on `scene`.
    [[nodiscard]] Lane lane(const PathPair& pair, const Scene& scene);

  private:
    /// Where a search starts, and the lane that it follows first; see PathPairEnumeration::run.
    struct Seed {
        StartPair start{};
        PathPairVertices guide;
        std::size_t found_end = 0;  ///< number of pairs found when it ended
    };

    /// Finds the searches to make, in their order, from `starts_` and the rest of the last lane.
    void find_seeds(const Scene& scene, Report& report);
    /// Sets `remaining_` to the rest of a lane: from the first cone of each side that is still seen and ahead
    /// of the car, as far as every cone is seen. Returns false if a side has none left.
    bool find_remaining(const Lane& lane, const Scene& scene);
    /// Sets `beam_guide_` to the lane of the beam search; returns whether there is one.
    bool find_beam_guide(const Scene& scene, Report& report);
    /// Adds a search that follows the guide, unless there is one already.
    void add_guided(const PathPairVertices& guide);
    void run_from(const Seed& seed, bool is_last, const Scene& scene, Report& report);
    /// Sets the features that depend on the scene.
    void add_scene_features(const Scene& scene);
    [[nodiscard]] std::span<Seed> seeds() { return {seeds_.data(), seed_count_}; }
    Seed& new_seed(StartPair start);

    CandidateSearchOptions options_;
    EnumerationRules rules_;
    SearchGraph graph_;
    StepReach reach_;
    NextVertexDecider next_vertex_;
    SearchBudget budget_;
    StartPairs starts_;
    std::vector<StartPair> pairs_to_try_;
    std::vector<std::pair<ConeId, Vertex>> vertex_of_;
    bool has_remaining_ = false;
    PathPairVertices remaining_;
    LaneBeam beam_;
    PathPairVertices beam_guide_;
    PathPairVertices vertices_;  ///< scratch
    std::vector<Seed> seeds_;    ///< the first seed_count_ are in use; the others keep their memory
    std::size_t seed_count_ = 0;
    PathPairEnumeration enumeration_;
    PathPairs pairs_;
    std::vector<Point> points_;
};

}  // namespace conelane
