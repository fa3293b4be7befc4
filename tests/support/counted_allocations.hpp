#pragma once

#include <cstddef>
#include <cstdlib>
#include <new>

// Replaces operator new of the whole program: a test program includes this once.

namespace {
std::size_t allocations = 0;
}  // namespace

// Every allocation of this program uses this. If it is inlined, GCC 12 reports new and free as a mismatch.
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
    ++allocations;
    return std::malloc(size == 0 ? 1 : size);
}
[[gnu::noinline]] void* operator new(std::size_t size) {
    if (void* memory = operator new(size, std::nothrow)) return memory;
    throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept {
    std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t /*size*/) noexcept {
    std::free(memory);
}
