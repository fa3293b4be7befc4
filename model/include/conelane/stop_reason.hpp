#pragma once

#include <string_view>

namespace conelane {

/// The limit that ended a search before its own end.
enum class StopReason { time, iterations, memory };
[[nodiscard]] std::string_view to_string(StopReason reason);

}  // namespace conelane
