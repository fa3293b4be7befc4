#pragma once

#include <algorithm>
#include <cstddef>

#include <oneapi/tbb/enumerable_thread_specific.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

namespace conelane {

/// Calls use(local, i) for each i below `count`, on that many threads; each thread has a `local` from make().
template <typename Make, typename Use>
void in_parallel(std::size_t count, unsigned threads, const Make& make, const Use& use) {
    oneapi::tbb::enumerable_thread_specific<decltype(make())> locals(make);
    oneapi::tbb::task_arena arena(
        std::min(static_cast<int>(threads), oneapi::tbb::info::default_concurrency()));
    arena.execute([&] {
        oneapi::tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) { use(locals.local(), i); });
    });
}

}  // namespace conelane
