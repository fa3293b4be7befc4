#pragma once

namespace conelane::tests {

/// By what factor a build under sanitizers, or one that does not optimise, may be slower.
#if defined(__SANITIZE_ADDRESS__) || !defined(__OPTIMIZE__)
inline constexpr double kSlowness = 20.0;
#else
inline constexpr double kSlowness = 1.0;
#endif

}  // namespace conelane::tests
