#pragma once

#include <string_view>

namespace conelane {

// The files beside this one, byte by byte, embedded when the library was configured.
extern const std::string_view kN12File;
extern const std::string_view kContextFile;
extern const std::string_view kShapeFile;
extern const std::string_view kFullFile;
extern const std::string_view kLearnedFile;
extern const std::string_view kLearnedWeightsFile;
extern const std::string_view kDelaunayBeamFile;
extern const std::string_view kAstarLaneFile;

}  // namespace conelane
