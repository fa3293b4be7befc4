#include "evaluation/outside/finished_lanes.hpp"

#include "evaluation/input_error.hpp"
#include "evaluation/outside/outside_program.hpp"
#include "evaluation/outside/point_snapping.hpp"

#include <cstddef>
#include <string>
#include <unordered_map>
#include <utility>

namespace conelane {

std::vector<LaneRecord> read_finished_lanes(const OutsideDetector& detector,
                                            std::span<const AnnotatedScene> scenes) {
    std::vector<LaneRecord> answers = read_foreign_lanes(detector.source);
    std::unordered_map<std::string, LaneRecord*> answer_to;
    for (LaneRecord& answer : answers) answer_to.emplace(answer.scene, &answer);
    std::vector<LaneRecord> records;
    records.reserve(scenes.size());
    std::size_t missing = 0;
    for (const AnnotatedScene& annotated : scenes) {
        const Scene& scene = annotated.scene;
        const auto found = answer_to.find(scene.id);
        if (found == answer_to.end()) {
            ++missing;
            records.push_back({scene.id, detector.name, {}, OutsideLimits{}.answer_ms, {}});
            records.back().answer.status = LaneStatus::error;
            records.back().answer.message = "the lanes file has no answer to this scene";
            continue;
        }
        LaneRecord& record = *found->second;
        if (const std::string fault = fault_of(record, scene); !fault.empty())
            throw InputError(detector.source, record.line, "", fault);
        if (const std::string tangle = tangle_of(record, scene); !tangle.empty())
            throw InputError(detector.source, record.line, "", tangle);
        snap_to_cones(record, scene);
        record.detector = detector.name;
        record.latency_ms = record.self_timed_ms.value_or(0.0);
        records.push_back(std::move(record));
    }
    if (missing == scenes.size()) throw InputError(detector.source, 0, "scene", "answers none of the scenes");
    return records;
}

}  // namespace conelane
