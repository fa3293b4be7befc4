#pragma once

#include <cstddef>

/// Marks a function whose loops count: on x86-64 it is compiled twice, and the processor decides at the start
/// of the program whether they take four numbers at once (AVX2) or two. The operations and their order are
/// the same, so are the results. Not with sanitizers, which come up after that decision.
#if defined(__x86_64__) && defined(__gnu_linux__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define CONELANE_WIDE_LOOPS [[gnu::target_clones("avx2", "default")]]
#else
#define CONELANE_WIDE_LOOPS
#endif

namespace conelane {

/// Four numbers that the compiler keeps in registers, whatever their width is, ...
using Doubles [[gnu::vector_size(32)]] = double;
/// ... and as they lie in an array, ...
using LooseDoubles [[gnu::vector_size(32), gnu::aligned(8), gnu::may_alias]] = double;
/// ... that is read up to a whole number of fours.
inline constexpr std::size_t kDoubles = sizeof(Doubles) / sizeof(double);

}  // namespace conelane
