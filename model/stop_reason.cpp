#include "conelane/stop_reason.hpp"

namespace conelane {

std::string_view to_string(StopReason reason) {
    switch (reason) {
        case StopReason::iterations:
            return "iterations";
        case StopReason::memory:
            return "memory";
        case StopReason::time:
            break;
    }
    return "time";
}

}  // namespace conelane
