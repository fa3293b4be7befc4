#pragma once

#include <cstddef>

/// Marks a function whose loops run over batches of numbers (SIMD). On x86-64 it is compiled twice, with AVX2
/// and without, and the processor decides at the start of the program which one runs. Both do the same
/// operations in the same order, so both give the same results. Not with sanitizers, which start after that
/// decision.
#if defined(__x86_64__) && defined(__gnu_linux__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define CONELANE_SIMD [[gnu::target_clones("avx2", "default")]]
#else
#define CONELANE_SIMD
#endif

namespace conelane {

/// A batch of four numbers in registers, for any register width.
using Doubles [[gnu::vector_size(32)]] = double;
/// The same as stored in an array of double.
using UnalignedDoubles [[gnu::vector_size(32), gnu::aligned(8), gnu::may_alias]] = double;
/// Arrays are read in whole batches, so they are longer than their content.
inline constexpr std::size_t kDoublesPerBatch = sizeof(Doubles) / sizeof(double);

}  // namespace conelane
