#pragma once

#include "conelane/drivable_lane.hpp"
#include "evaluation/files/lane_file.hpp"
#include "evaluation/scenes/annotated_scene.hpp"
#include "evaluation/tracks/track_boundaries.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace conelane::experiments {

/// A lane of a picture. The drivable lane says where it is trusted and which boundary is inferred.
struct PicturedLane {
    LaneRecord record;
    DrivableLane drivable;
};

/// A scene as the viewer of the report page draws it.
struct Picture {
    AnnotatedScene scene;
    TrackBoundariesByName
        tracks;  ///< that of the scene, or nothing; tells false cones from those of the course
    std::vector<PicturedLane> lanes;
    bool with_given = false;  ///< a second panel: what a detector gets, before anything is known of it
    bool with_truth = true;   ///< the band of the ground truth
    std::string title;        ///< above the lanes; empty: the scene's id
};

/// Writes a picture as .svg or .png, by the ending of its name, through the Python package that the program
/// carries. The same picture gives the same bytes. `wished_python`: see run_package, whose errors this
/// throws, and InputError where the file cannot be written.
void write_picture(const Picture& picture, const std::filesystem::path& file,
                   const std::string& wished_python = "");

}  // namespace conelane::experiments
