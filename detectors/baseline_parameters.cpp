#include "detectors/baseline_parameters.hpp"

#include "detectors/parameters/parameter_files.hpp"
#include "detectors/parameters/parameter_reader.hpp"

namespace conelane {
namespace {

template <typename Parameters, typename Fields>
Parameters parameters_of(std::string_view file, const Fields& fields) {
    Parameters parameters;
    const auto keys =
        read_parameters(file, fields, parameters, [](JsonReader&, const std::string&) { return false; });
    for (const auto& field : fields) {
        if (!keys.contains(field.key)) throw InvalidInput(std::string(field.key), "is missing");
    }
    validate(parameters);
    return parameters;
}

}  // namespace

DelaunayBeamParameters tuned_delaunay_beam_parameters() {
    static const auto parameters =
        parameters_of<DelaunayBeamParameters>(kDelaunayBeamFile, delaunay_beam_fields());
    return parameters;
}

AstarLaneParameters tuned_astar_lane_parameters() {
    static const auto parameters = parameters_of<AstarLaneParameters>(kAstarLaneFile, astar_lane_fields());
    return parameters;
}

}  // namespace conelane
