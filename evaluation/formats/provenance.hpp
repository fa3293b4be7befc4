#pragma once

#include <string>

namespace conelane {

/// Origin of a result.
struct Provenance {
    std::string
        commit;  ///< of the sources; ends in "-dirty" if they were changed, "unknown" outside a checkout
    std::string compiler;  ///< name and version, and the build type
    std::string machine;   ///< processor, processors, operating system
};
[[nodiscard]] Provenance provenance();

}  // namespace conelane
