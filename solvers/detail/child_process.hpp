#pragma once

#include <functional>
#include <optional>
#include <vector>

namespace conelane::detail {

/// What `work` returns when it runs in a child process, for libraries that may abort. Nothing where the child
/// died before it was done, or could not be started. The child writes nothing to standard output or error.
[[nodiscard]] std::optional<std::vector<double>> run_in_child(
    const std::function<std::vector<double>()>& work);

}  // namespace conelane::detail
