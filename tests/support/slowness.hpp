#pragma once

namespace conelane::tests {

#if defined(__has_feature)  // Clang's way to say it
#if __has_feature(address_sanitizer)
#define CONELANE_UNDER_SANITIZER
#endif
#endif

/// By what factor a build under sanitizers, or one that does not optimise, may be slower.
#if defined(__SANITIZE_ADDRESS__) || defined(CONELANE_UNDER_SANITIZER) || !defined(__OPTIMIZE__)
inline constexpr double kSlowness = 20.0;
#else
inline constexpr double kSlowness = 1.0;
#endif

}  // namespace conelane::tests
