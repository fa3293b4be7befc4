#pragma once

#include "graph_search/front/front_weights.hpp"

#include <filesystem>
#include <string_view>

namespace conelane {

/// The weights of `front` from the bytes of a file that `conelane train front --out FILE` wrote: a JSON
/// object with `version` 1 to 3, `features`, the names of the inputs as the library has them, and the numbers
/// of the networks, such as `extend_hidden`. In files of version 1 the features of colors are absent: they
/// get weights of 0, so that colors make no difference. Throws InvalidInput naming the key, or the line that
/// is not JSON.
[[nodiscard]] FrontWeights parse_front_weights(std::string_view json);

/// The same from a file. Throws InvalidInput naming the file too, also if it cannot be read.
[[nodiscard]] FrontWeights read_front_weights(const std::filesystem::path& file);

}  // namespace conelane
