#pragma once

#include <string_view>

namespace conelane {

// The files beside this one, byte by byte, embedded when the library was configured.
extern const std::string_view kFrontFile;
extern const std::string_view kRankNetPaperFile;
extern const std::string_view kRankNetExtendedFile;
extern const std::string_view kStepScoresFile;

}  // namespace conelane
