#pragma once

namespace conelane::tests {

#if defined(__has_feature)  // defined by Clang
#if __has_feature(address_sanitizer)
#define CONELANE_UNDER_SANITIZER
#endif
#endif

/// Factor by which a build with sanitizers, or without optimisation, may be slower.
#if defined(__SANITIZE_ADDRESS__) || defined(CONELANE_UNDER_SANITIZER) || !defined(__OPTIMIZE__)
inline constexpr double kSlowness = 20.0;
#else
inline constexpr double kSlowness = 1.0;
#endif

}  // namespace conelane::tests
