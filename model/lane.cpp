#include "model/lane.hpp"

namespace conelane {

std::string_view to_string(LaneStatus status) {
    switch (status) {
        case LaneStatus::found:
            return "found";
        case LaneStatus::none:
            return "none";
        case LaneStatus::time_limit:
            return "time_limit";
        case LaneStatus::error:
            break;
    }
    return "error";
}

}  // namespace conelane
