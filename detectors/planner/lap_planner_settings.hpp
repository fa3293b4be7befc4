#pragma once

#include <cstddef>

namespace conelane {

/// The constants of the memory of cones.
struct ConeMemorySettings {
    double place_gate_m = 0.5;    ///< a cone without id is the remembered one that stands this near
    double new_id_gate_m = 0.3;   ///< the same, of a cone whose id is new: two true cones stand farther apart
    double same_id_gate_m = 1.5;  ///< farther from the place remembered, an id means another cone
    double doubled_m = 0.35;      ///< remembered cones that stand this near are one cone
    int averaged_sightings = 12;  ///< over which a position is averaged; fewer follow drift sooner
    double max_evidence = 4.0;    ///< sightings that count; a cone that was taken away is kept for so long
    double missed_evidence = 0.5;  ///< what a miss takes away; a cone without evidence is forgotten
    double sure_view_share =
        0.85;                  ///< of the farthest cone and the widest bearing seen: a cone within is in view
    double blind_m = 2.0;      ///< about the car no cone is expected to be seen
    int fleeting_frames = 10;  ///< a cone seen once is forgotten after so many frames
    double max_range_m = 30.0;     ///< of the scene that a detector is given
    double behind_m = 5.0;         ///< of the car, cones are in the scene still
    std::size_t max_cones = 3000;  ///< remembered; those seen longest ago are forgotten first
};

/// The constants of a shift of all cones at once.
struct ShiftSettings {
    double reach_m = 1.25;     ///< the farthest shift that is looked for
    double inlier_m = 0.3;     ///< a cone moved with the others to within this
    double min_shift_m = 0.2;  ///< a smaller one is left to the averages
    std::size_t min_cones = 5;
    double min_share = 0.6;  ///< of the cones compared
};

/// The constants of the votes on cones.
struct ConeVoteSettings {
    double fading = 0.1;      ///< share of the votes before that a vote of weight 1 replaces
    double prior = 0.5;       ///< votes that each answer has before any frame
    double min_votes = 0.05;  ///< a cone with fewer is forgotten
    double near_m = 12.0;     ///< from the car: up to here a cone counts in full, from far_m on nothing
    double far_m = 20.0;
    double max_objection = 6.0;  ///< of all cones of a lane [log odds]
};

/// The constants of the choice between a new lane and the last one.
struct LaneChoiceSettings {
    double near_m = 8.0;         ///< a jump within this arc length ahead of the car needs a second opinion
    double jump_m = 0.9;         ///< between the lines of two frames: half the narrowest lane, less the noise
    double max_support = 6.0;    ///< weights of frames that speak for a lane: no more are counted
    double kept_support = 0.92;  ///< of what spoke for a lane, with each frame
    double unsure_weight = 0.4;  ///< of a frame whose detector gives no probability
    double min_kept_weight = 0.02;  ///< a candidate that is less probable says nothing
    double second_odds = 0.5;       ///< log odds that a candidate which the detector ranks lower lacks
    double second_vote = 0.4;       ///< the weight of its votes on cones, of its probability
    double course_weight = 0.3;     ///< of the lap before, in each frame
    double course_ahead_m = 20.0;   ///< of it that is looked at
    double min_left_m = 3.0;        ///< a lane of which less is left holds nothing back
    double max_offset_m = 2.5;      ///< car to path: farther away it is not on it
};

/// The constants of the course and of laps.
struct CourseSettings {
    double step_m = 0.5;           ///< between the points recorded
    double min_length_m = 40.0;    ///< shorter ones are no circuit
    double max_length_m = 2000.0;  ///< the rules allow 500 m a lap in trackdrive and 1.5 km in autocross
    double closing_m = 1.5;        ///< of the lane from the course recorded, along closing_length_m
    double closing_rad = 0.6;      ///< and of its heading
    double closing_length_m = 6.0;
    double line_half_width_m = 4.0;  ///< of the start line, from its middle
    double line_away_m = 8.0;        ///< from the line before it counts again
    double gate_within_m = 20.0;     ///< of the first pose: farther orange cones are no start line
    double stop_m = 30.0;            ///< after the last line, by the rules
};

}  // namespace conelane
