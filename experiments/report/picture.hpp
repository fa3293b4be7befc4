#pragma once

#include "conelane/drivable_lane.hpp"
#include "evaluation/formats/lane_file.hpp"
#include "evaluation/world/annotated_scene.hpp"
#include "evaluation/world/track.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace conelane::experiments {

/// A lane of a picture. The drivable lane gives the trusted length and the inferred boundary.
struct PicturedLane {
    LaneRecord record;
    DrivableLane drivable;
};

/// A scene as the viewer of the report page draws it.
struct Picture {
    AnnotatedScene scene;
    TrackBoundariesByName
        tracks;  ///< the track of the scene, or nothing; needed to tell false cones from those of the course
    std::vector<PicturedLane> lanes;
    bool with_given = false;  ///< a second panel with the input of a detector
    bool with_truth = true;   ///< the band of the ground truth
    std::string title;        ///< above the lanes; empty: the scene's id
};

/// Writes a picture as .svg or .png, by the ending of its name, through the Python package in the program.
/// The same picture gives the same bytes. `wished_python` and errors: see run_package; also InputError if the
/// file cannot be written.
void write_picture(const Picture& picture, const std::filesystem::path& file,
                   const std::string& wished_python = "");

}  // namespace conelane::experiments
