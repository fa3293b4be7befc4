#pragma once

#include <string>
#include <vector>

namespace conelane::experiments {

/// Courses of one place or one designer, so similar that a method that has seen one of them knows the others.
struct CourseFamily {
    std::string name;                 ///< of its folder
    std::vector<std::string> tracks;  ///< SPECs of load_tracks
};

}  // namespace conelane::experiments
