#pragma once

#include <cstddef>

namespace conelane {

/// The constants of the memory of cones.
struct ConeMemorySettings {
    double place_gate_m = 0.5;     ///< a cone without id is the remembered cone within this distance
    double new_id_gate_m = 0.3;    ///< the same for a cone with a new id: two true cones are farther apart
    double same_id_gate_m = 1.5;   ///< farther from the remembered place, an id means another cone
    double moved_m = 1.0;          ///< a cone so far from its remembered place has moved: it is seen anew
    double doubled_m = 0.35;       ///< remembered cones within this distance are one cone
    int averaged_sightings = 12;   ///< number of sightings in a mean position; fewer follow drift sooner
    double max_evidence = 4.0;     ///< largest number of counted sightings; so long a removed cone is kept
    double missed_evidence = 0.5;  ///< cost of a miss in sightings; a cone without evidence is forgotten
    double sure_view_share =
        0.85;                  ///< of the farthest cone and the widest bearing seen: a cone within is in view
    double blind_m = 2.0;      ///< within this distance of the car no cone is expected to be seen
    int fleeting_frames = 10;  ///< a cone seen once is forgotten after this many frames
    double max_range_m = 30.0;  ///< range of the scene for the detector
    double narrow_rad = 1.05;   ///< a view whose widest bearing is smaller is narrow
    double near_m = 10.0;       ///< shortest range of the scene of a narrow view
    double behind_m = 5.0;      ///< cones up to this distance behind the car are in the scene
    std::size_t max_cones =
        3000;  ///< largest number of remembered cones; those seen longest ago are forgotten first
};

/// The constants of a shift of all cones at once.
struct ShiftSettings {
    double reach_m = 1.25;     ///< largest shift that is searched
    double inlier_m = 0.3;     ///< a cone within this distance has moved with the others
    double min_shift_m = 0.2;  ///< smaller shifts are left to the averages
    std::size_t min_cones = 5;
    double min_share = 0.6;  ///< share of the compared cones
};

/// The constants of the choice between a new lane and the last one.
struct LaneChoiceSettings {
    double near_m = 8.0;  ///< a jump within this arc length ahead of the car has to be confirmed
    double jump_m = 0.9;  ///< distance of the lines of two frames: half the narrowest lane, less the noise
    double max_support = 6.0;       ///< largest support of a place of a lane, in weights of frames
    double short_m = 12.0;          ///< a shorter lane is extended by the one driven so far
    double unsure_weight = 0.4;     ///< weight of a frame whose detector gives no probability
    double min_kept_weight = 0.02;  ///< a less probable candidate does not count
    double known_ahead_m = 50.0;    ///< length of the lap before that is driven by
    double min_left_m = 3.0;        ///< a lane with a shorter rest does not resist a new one
    double narrowest_m = 2.5;       ///< width of a lane that is inferred from one boundary
    double alone_m = 10.0;          ///< trusted length of such a lane
    double passing_m = 5.0;         ///< length ahead of the car in which its cones become known
    double max_offset_m = 2.5;      ///< distance from car to path: farther away, the car is off it
};

/// The constants of the course and of laps.
struct CourseSettings {
    double step_m = 0.5;           ///< between recorded points
    double min_length_m = 40.0;    ///< shorter circuits do not count
    double max_length_m = 2000.0;  ///< the rules allow 500 m a lap in trackdrive and 1.5 km in autocross
    double closing_m = 1.5;        ///< distance of the lane from the recorded course, along closing_length_m
    double closing_rad = 0.6;      ///< and difference of their headings
    double closing_length_m = 6.0;
    double leaning_from_m = 3.0;     ///< of the car: from here on the course leans on the lane of each frame,
    double leaning_to_m = 20.0;      ///< up to here,
    double leaning_m = 1.0;          ///< where the two are so near,
    double leaning_gain = 0.3;       ///< by this share of their distance
    double line_half_width_m = 4.0;  ///< half width of the start line, from its middle
    double line_away_m = 8.0;        ///< distance from the line before it counts again
    double gate_within_m = 20.0;  ///< distance from the first pose: farther orange cones are not a start line
    double stop_m = 30.0;         ///< length to stop after the last line, by the rules
    double beside_m = 0.8;        ///< cones up to so far outside the lane are noted
    double boundary_m = 0.6;      ///< a cone so near to the boundary is of it
    double same_cone_m = 0.75;    ///< a noted cone is a seen one within this distance
    double settling_cone_m = 1.5;  ///< the same while the course is not yet laid onto the cones
    double settling_gain = 0.5;    ///< of the movement that one frame shows, then kept_gain
    double kept_gain = 0.15;
    int min_expected = 4;    ///< fewer noted cones in view say nothing of the course
    int fitting_frames = 3;  ///< frames until the course is trusted, or not trusted any more
    int missed_frames = 6;   ///< a boundary cone that so many frames in a row should show is gone
    int min_sightings = 3;   ///< of a cone that is noted, or new
    int lately_frames = 5;   ///< a new cone counts that one of so many frames showed
    double in_lane_m = 0.6;  ///< a cone so far inside the boundaries is in the way
    double before_m = 1.0;   ///< the trust ends so far before what contradicts the course
};

}  // namespace conelane
