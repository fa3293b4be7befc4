#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <new>

// Replaces operator new of the whole program: a test program includes this once.

namespace conelane::tests {

/// Of this thread.
struct Allocations {
    std::int64_t made = 0;            ///< including failed ones
    std::int64_t living = 0;          ///< made and not freed
    std::int64_t until_failure = -1;  ///< successes before the next failure; negative: no failure
};
inline thread_local Allocations allocations;

inline void* allocate(std::size_t size, std::size_t alignment) {
    ++allocations.made;
    if (allocations.until_failure >= 0 && allocations.until_failure-- == 0) return nullptr;
    size = size == 0 ? 1 : size;
    void* const memory = alignment == 0
                             ? std::malloc(size)
                             : std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
    if (memory != nullptr) ++allocations.living;
    return memory;
}
inline void free_memory(void* memory) {
    if (memory != nullptr) --allocations.living;
    std::free(memory);
}

}  // namespace conelane::tests

// The other forms call these. If inlined, GCC 12 reports new and free as a mismatch.
[[gnu::noinline]] void* operator new(std::size_t size) {
    if (void* const memory = conelane::tests::allocate(size, 0)) return memory;
    throw std::bad_alloc();
}
[[gnu::noinline]] void* operator new(std::size_t size, std::align_val_t alignment) {
    if (void* const memory = conelane::tests::allocate(size, static_cast<std::size_t>(alignment)))
        return memory;
    throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept {
    conelane::tests::free_memory(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t /*size*/) noexcept {
    conelane::tests::free_memory(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::align_val_t /*alignment*/) noexcept {
    conelane::tests::free_memory(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t /*size*/,
                                       std::align_val_t /*alignment*/) noexcept {
    conelane::tests::free_memory(memory);
}
// The address sanitizer has forms of its own, which do not call those above.
[[gnu::noinline]] void* operator new[](std::size_t size) {
    return operator new(size);
}
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t& /*tag*/) noexcept {
    return conelane::tests::allocate(size, 0);
}
[[gnu::noinline]] void operator delete[](void* memory) noexcept {
    conelane::tests::free_memory(memory);
}
[[gnu::noinline]] void operator delete[](void* memory, std::size_t /*size*/) noexcept {
    conelane::tests::free_memory(memory);
}
[[gnu::noinline]] void operator delete(void* memory, const std::nothrow_t& /*tag*/) noexcept {
    conelane::tests::free_memory(memory);
}
