#include "conelane/lane_detector.hpp"

#include "conelane/invalid_input.hpp"

#include <cmath>
#include <exception>
#include <new>

namespace conelane {

LaneAnswer LaneDetector::detect(const Scene& scene, const DetectionLimits& limits) {
    LaneAnswer failed;
    failed.status = LaneStatus::error;
    try {
        validate(scene, ids_);
        if (std::isnan(limits.time_limit_ms)) throw InvalidInput("time_limit_ms", "must be a number");
        return search(scene, limits);
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& failure) {
        failed.message = failure.what();
    } catch (...) {  // CoinError is no std::exception
        failed.message = "a library threw an exception of its own";
    }
    return failed;
}

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
