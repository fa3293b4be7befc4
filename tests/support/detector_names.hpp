#pragma once

#include "conelane/detectors.hpp"
#include "tests/support/testing.hpp"

namespace conelane::tests {

/// The detectors of the library, for parameterised tests.
inline std::vector<std::string> detector_names() {
    return mapped(detectors(), [](const DetectorInfo& detector) { return std::string(detector.name); });
}

}  // namespace conelane::tests
