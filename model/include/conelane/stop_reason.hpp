#pragma once

#include <string_view>

namespace conelane {

/// The limit that cut a search short.
enum class StopReason { time, iterations, memory };
[[nodiscard]] std::string_view to_string(StopReason reason);

}  // namespace conelane
