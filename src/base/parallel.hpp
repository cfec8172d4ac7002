#pragma once
/// Loops that run in parallel. What they compute must not depend on the order of the calls.
#include <algorithm>
#include <cstddef>

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#ifdef __SANITIZE_THREAD__
#include <sanitizer/tsan_interface.h>
#endif

namespace grainvdb {

/// A distribution's TBB is not instrumented, so that the thread sanitizer cannot see that a loop starts after what
/// stands before it and ends before what stands after it. A fence tells it so; without the sanitizer it is nothing.
class LoopFence {
 public:
#ifdef __SANITIZE_THREAD__
  LoopFence() {
    __tsan_release(&start_);
  }
  ~LoopFence() {
    __tsan_acquire(&end_);
  }
  void enter() {
    __tsan_acquire(&start_);
  }
  void leave() {
    __tsan_release(&end_);
  }

 private:
  char start_ = 0, end_ = 0;
#else
  void enter() {}
  void leave() {}
#endif
};

/// How many threads a loop may use here. Results must not depend on it.
inline std::size_t thread_count() {
  return std::min(static_cast<std::size_t>(tbb::this_task_arena::max_concurrency()),
                  tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
}

/// Calls f(begin, end) for ranges that make up [0, n), in parallel.
template <class F>
void parallel_ranges(std::size_t n, const F& f) {
  LoopFence fence;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n), [&](const tbb::blocked_range<std::size_t>& range) {
    fence.enter();
    f(range.begin(), range.end());
    fence.leave();
  });
}

/// Calls f(i) for every i in [0, n), in parallel.
template <class F>
void parallel_for(std::size_t n, const F& f) {
  parallel_ranges(n, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i != end; ++i) f(i);
  });
}

}  // namespace grainvdb
