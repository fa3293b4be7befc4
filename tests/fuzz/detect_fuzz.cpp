// Every detector on scenes made of the bytes: an answer that keeps the contract of LaneDetector, soon after
// the limit, and its centre line.

#include "experiments/methods/method.hpp"
#include "tests/fuzz/expectations.hpp"
#include "tests/fuzz/fuzzed_scene.hpp"

#include <ctime>

namespace conelane::fuzz {
namespace {

/// Made once, because some read large tables.
LaneDetector& made_detector(const DetectorRecipe& known) {
    static std::map<std::string_view, std::unique_ptr<LaneDetector>> made;
    std::unique_ptr<LaneDetector>& entry = made[known.name];
    if (!entry) entry = make_detector(known);
    return *entry;
}

double processor_seconds() {
    std::timespec time{};
    ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

void require_lane_of(const Scene& scene, const Lane& lane, bool may_be_one_sided) {
    std::set<ConeId> ids;
    for (const Cone& cone : scene.cones) ids.insert(cone.id);
    require(!lane.left.empty() || !lane.right.empty(), "a lane that was found has cones");
    require(may_be_one_sided || (!lane.left.empty() && !lane.right.empty()), "it has them on both sides");
    for (const std::vector<ConeId>* side : {&lane.left, &lane.right}) {
        for (const ConeId id : *side) require(ids.erase(id) == 1, "they are of the scene, each once");
        require(!lane.closed || side->size() >= 3, "a closed boundary has three cones at least");
    }
}

/// What holds for every answer; `detector_contract_test` asks the same of readable scenes.
void require_contract(const Scene& scene, const LaneAnswer& answer, bool may_be_one_sided) {
    switch (answer.status) {
        case LaneStatus::found:
            require_lane_of(scene, answer.lane, may_be_one_sided);
            if (answer.solved) require_lane_of(scene, answer.solved->lane, may_be_one_sided);
            break;
        case LaneStatus::none:
            require(!answer.stopped_by, "`none` is proven");
            break;
        case LaneStatus::stopped:
            require(answer.stopped_by.has_value(), "a limit stopped it");
            break;
        case LaneStatus::error:  // CBC rejects costs above 1e20
            require(!answer.message.empty() && !is_on_a_map(scene), answer.message);
    }
    if (answer.status != LaneStatus::found) {
        require(answer.lane == Lane{} && !answer.solved, "without `found` there is no lane");
    }
    if (answer.optimality) {
        require(std::isfinite(answer.optimality->objective), "an objective is finite");
        require(answer.optimality->bound <= answer.optimality->objective, "a bound is below the objective");
        require(!answer.optimality->optimal || !answer.stopped_by,
                "a search that was stopped proves nothing");
    }
    require(!answer.confidence || (*answer.confidence >= 0.0 && *answer.confidence <= 1.0),
            "a confidence is a probability");
    require(!answer.trusted_m || *answer.trusted_m >= 0.0, "a trusted length is none below 0");
    if (answer.enumeration) {
        for (const LaneCandidate& candidate : answer.enumeration->candidates)
            require_lane_of(scene, candidate.lane, may_be_one_sided);
    }
}

void require_centre_line(const LaneAnswer& answer, const Scene& scene) {
    answers([&] {  // rejects cones beyond 1000 km and boundaries beyond 20 km
        const DrivableLane lane = drivable(answer, scene);
        require(std::isfinite(lane.length_m), "a length is finite");
        for (const DrivablePoint& point : lane.points) {
            require(point.position.allFinite() && std::isfinite(point.heading_rad) &&
                        std::isfinite(point.curvature_1pm) && std::isfinite(point.width_left_m) &&
                        std::isfinite(point.width_right_m),
                    "a point is finite");
        }
    });
}

void detect_on(FuzzedDataProvider& input) {
    constexpr double kLimits_ms[]{0.0, 0.5, 2.0, 5.0, 20.0};
    constexpr double kMaxSeconds =
        2.0;  // seconds of processor time under a sanitizer; the limits above are 0.02 s at most
    const std::span<const experiments::Method> all = experiments::known_methods();
    const DetectorRecipe& known = *all[input.ConsumeIntegralInRange<std::size_t>(0, all.size() - 1)].recipe;
    LaneDetector& chosen = made_detector(known);
    chosen.reset();
    const int scenes = input.ConsumeIntegralInRange(1, 3);
    for (int i = 0; i < scenes; ++i) {
        DetectionLimits limits{.time_limit_ms = input.PickValueInArray(kLimits_ms),
                               .keep_candidates = input.ConsumeBool()};
        const Scene scene = fuzzed_scene(input, 60);
        const double begin_s = processor_seconds();
        const LaneAnswer answer = chosen.detect(scene, limits);
        require(processor_seconds() - begin_s < kMaxSeconds, "a detector ends soon after its limit");
        require_contract(scene, answer, known.name.starts_with("front"));
        require_centre_line(answer, scene);
    }
}

}  // namespace
}  // namespace conelane::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    FuzzedDataProvider input(data, size);
    conelane::fuzz::detect_on(input);
    return 0;
}
