#pragma once

#include "conelane/detectors.hpp"

#include <string>
#include <vector>

namespace conelane::tests {

/// The detectors of the library, for parameterised tests.
inline std::vector<std::string> detector_names() {
    std::vector<std::string> names;
    for (const DetectorInfo& detector : detectors()) names.emplace_back(detector.name);
    return names;
}

}  // namespace conelane::tests
