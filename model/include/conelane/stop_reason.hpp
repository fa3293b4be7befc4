#pragma once

#include <string_view>

namespace conelane {

/// The limit that ended a search before it was complete.
enum class StopReason { time, iterations, memory };
[[nodiscard]] std::string_view to_string(StopReason reason);

}  // namespace conelane
