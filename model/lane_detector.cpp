#include "model/lane_detector.hpp"

namespace conelane {

std::string_view to_string(LaneStatus status) {
    switch (status) {
        case LaneStatus::found:
            return "found";
        case LaneStatus::none:
            return "none";
        case LaneStatus::stopped:
            return "stopped";
        case LaneStatus::error:
            break;
    }
    return "error";
}

}  // namespace conelane
