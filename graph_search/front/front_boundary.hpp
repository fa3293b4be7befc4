#pragma once

#include "graph_search/front/front_map.hpp"

namespace conelane {

/// Rules for a single boundary. They were chosen by hand: the networks of `front` judge a boundary by the
/// other one, and have learned from scenes with both.
struct BoundaryRules {
    // Limits for the first cone, in the frame of the car.
    double start_behind_m = 0.6;
    double start_ahead_m = 12.0;
    double start_aside_m = 6.0;
    double shortest_segment_m = 0.5;
    double largest_first_turn_rad = 1.4;  ///< from the heading to the first segment
    double largest_turn_rad = 1.0;        ///< from segment to segment
    double largest_turn_change_rad = 1.0;
    double largest_length_ratio = 2.5;       ///< of successive segments
    double largest_bridging_turn_rad = 0.5;  ///< onto a segment over kShortSegment_m
    /// Limits for the distance of the car from the boundary, which is continued back to the car along an arc.
    double nearest_m = 0.4;
    double farthest_m = 4.5;
    double usual_distance_m = 1.75;  ///< half a usual lane
    std::size_t fewest_cones = 3;
    std::size_t max_cones = 100;
    // Limits for the sum and the mean of all segment scores: only short boundaries must be nearly perfect.
    double least_score = 1.6;
    double least_mean_score = 0.6;
    std::size_t beam_width = 64;
};

/// Finds the boundary of a scene that shows only one: the longest smooth chain of cones that begins beside
/// the car. A segment counts 1, less for uneven spacing, for a turn, for a change of turn, and for being
/// shorter than 2 m. The side is the one on which the chain passes the car: the arc through its first three
/// cones is followed back to the car, so in a bend the outer boundary may begin on the other side of the
/// heading. From the third cone on, gaps of up to kMaxSegment_m are bridged. Keeps memory from call to call.
class BoundarySearch {
  public:
    /// Puts the boundary into `cones` and returns its side. Returns nothing if there is none, or if the
    /// budget is spent before the end. A deterministic beam search; of equal chains, the one found first.
    std::optional<Side> find(FrontMap& map, SearchBudget& budget, std::vector<Vertex>& cones);

  private:
    static constexpr std::size_t kNone = ~std::size_t{0};

    struct Chain {
        Vertex last;
        std::size_t parent;
        std::size_t count;
        double score;
        Point direction;
        double segment_m = 0.0;
        double turn_rad = 0.0;
        Side side = kLeft;  ///< known from the third cone on
    };

    [[nodiscard]] bool is_boundary(const Chain& chain) const;
    void start(const FrontMap& map);
    void extend(FrontMap& map, std::size_t number);
    /// The distance of the car to the left of the chain, taken back along the arc through the last two
    /// segments, of which the first begins at `first`.
    [[nodiscard]] static double car_to_left_m(const Point& first, const Chain& chain, double turn_rad,
                                              double segment_m);
    /// Whether the chain already has the cone, or a segment that the new segment would meet.
    [[nodiscard]] bool meets(const FrontMap& map, std::size_t number, const Segment& added, Vertex to) const;
    void keep_best(std::size_t first);

    BoundaryRules rules_;
    std::vector<Chain> chains_;
    std::vector<Chain> next_;
};

}  // namespace conelane
