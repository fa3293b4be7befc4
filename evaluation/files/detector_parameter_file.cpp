#include "evaluation/files/detector_parameter_file.hpp"

#include "evaluation/files/json_node.hpp"
#include "evaluation/files/known_keys.hpp"

#include <span>
#include <string_view>
#include <vector>

namespace conelane {
namespace {

template <typename Parameters>
Parameters parse(std::string_view text, const std::filesystem::path& file,
                 std::span<const ParameterField<Parameters>> fields) {
    Parameters parameters;
    std::vector<std::string_view> keys;
    with_json_text(text, file, [&](const JsonNode& json) {
        for (const ParameterField<Parameters>& field : fields) {
            parameters.*field.value = json.member(field.key).number_in(field.lowest, field.highest);
            keys.push_back(field.key);
        }
        require_known_keys(json, keys);
    });
    return parameters;
}

}  // namespace

DelaunayBeamParameters parse_delaunay_beam_parameters(std::string_view text,
                                                      const std::filesystem::path& file) {
    return parse(text, file, delaunay_beam_fields());
}

AstarLaneParameters parse_astar_lane_parameters(std::string_view text, const std::filesystem::path& file) {
    return parse(text, file, astar_lane_fields());
}

}  // namespace conelane
