#include "experiments/comparison/pinning.hpp"

#include <sched.h>

namespace conelane::experiments {

struct PinnedThread::Mask {
    cpu_set_t processors;
};

PinnedThread::PinnedThread() : before_(std::make_unique<Mask>()) {
    const int processor = sched_getcpu();
    cpu_set_t one;
    CPU_ZERO(&one);
    if (processor >= 0) CPU_SET(static_cast<unsigned>(processor), &one);
    if (processor < 0 || sched_getaffinity(0, sizeof(cpu_set_t), &before_->processors) != 0 ||
        sched_setaffinity(0, sizeof(cpu_set_t), &one) != 0) {
        before_.reset();
    }
}

PinnedThread::~PinnedThread() {
    if (before_) sched_setaffinity(0, sizeof(cpu_set_t), &before_->processors);
}

}  // namespace conelane::experiments
