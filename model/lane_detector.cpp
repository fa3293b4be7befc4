#include "conelane/lane_detector.hpp"

#include "conelane/invalid_input.hpp"
#include "model/doubled_cones.hpp"

#include <array>
#include <cmath>
#include <exception>
#include <new>

namespace conelane {

struct LaneDetector::Workspace {
    explicit Workspace(double doubled_cone_m) : doubled(doubled_cone_m) {}

    std::vector<ConeId> ids;
    DoubledCones doubled;
};

LaneDetector::LaneDetector(double doubled_cone_m) : workspace_(std::make_unique<Workspace>(doubled_cone_m)) {}
LaneDetector::~LaneDetector() = default;

double LaneDetector::doubled_cone_m() const {
    return workspace_->doubled.radius_m();
}

LaneAnswer LaneDetector::detect(const Scene& scene, const DetectionLimits& limits) {
    LaneAnswer failed;
    failed.status = LaneStatus::error;
    try {
        validate(scene, workspace_->ids);
        if (std::isnan(limits.time_limit_ms)) throw InvalidInput("time_limit_ms", "must be a number");
        DoubledCones& doubled = workspace_->doubled;
        LaneAnswer answer = search(doubled.merge(scene), limits);
        if (!doubled.merged().empty()) answer.merged = doubled.merged();
        return answer;
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& failure) {
        failed.message = failure.what();
    } catch (...) {  // CoinError is not a std::exception
        failed.message = "a library threw an exception of its own";
    }
    return failed;
}

std::string_view to_string(LaneStatus status) {
    constexpr std::array<std::string_view, 4> kNames{"found", "none", "stopped", "error"};
    return kNames[static_cast<std::size_t>(status)];
}

std::string_view to_string(StopReason reason) {
    constexpr std::array<std::string_view, 3> kNames{"time", "iterations", "memory"};
    return kNames[static_cast<std::size_t>(reason)];
}

}  // namespace conelane
