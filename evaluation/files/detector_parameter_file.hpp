#pragma once

#include "graph_search/baselines/astar_lane/astar_lane_detector.hpp"
#include "graph_search/baselines/delaunay_beam/delaunay_beam_detector.hpp"

#include <filesystem>
#include <string_view>

namespace conelane {

/// The parameters of a detector from the text of a file: one flat object, a number for each of
/// delaunay_beam_fields(). Throws InputError naming file and key if one is missing or out of its range.
[[nodiscard]] DelaunayBeamParameters parse_delaunay_beam_parameters(std::string_view text,
                                                                    const std::filesystem::path& file);
/// The same for astar_lane_fields().
[[nodiscard]] AstarLaneParameters parse_astar_lane_parameters(std::string_view text,
                                                              const std::filesystem::path& file);

}  // namespace conelane
