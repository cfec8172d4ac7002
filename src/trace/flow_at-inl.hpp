// A flow as the right-hand side of an equation of motion, compiled once for every instruction set: include it from
// files that hwy/foreach_target.h compiles again and again, after hwy/highway.h.
#if defined(GRAINVDB_TRACE_FLOW_AT_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef GRAINVDB_TRACE_FLOW_AT_INL_HPP
#undef GRAINVDB_TRACE_FLOW_AT_INL_HPP
#else
#define GRAINVDB_TRACE_FLOW_AT_INL_HPP
#endif

#include <algorithm>
#include <cstddef>

#include <hwy/highway.h>

#include "trace/flow_sampler-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace grainvdb {
namespace HWY_NAMESPACE {

/// Several tracers that move together, so that one waits for memory and arithmetic while another computes.
template <std::size_t n>
struct Group {
  Four tracer[n];
};
template <std::size_t n, class F>
HWY_INLINE Group<n> make_group(F&& f) {
  Group<n> group;
#pragma GCC unroll 8
  for (std::size_t i = 0; i < n; ++i) group.tracer[i] = f(i);
  return group;
}
template <std::size_t n>
HWY_INLINE Group<n> moved(const Group<n>& y, double a, const Group<n>& k) {
  return make_group<n>([&](std::size_t i) HWY_ATTR { return moved(y.tracer[i], a, k.tracer[i]); });
}
template <std::size_t n>
HWY_INLINE Group<n> scaled(double a, const Group<n>& k) {
  return make_group<n>([&](std::size_t i) HWY_ATTR { return scaled(a, k.tracer[i]); });
}

/// The time mean.
template <Interpolation interpolation>
class MeanFlow {
 public:
  explicit MeanFlow(const Flow& flow) : sampler_(flow.first().blocks()) {}

  template <std::size_t n>
  class At {
   public:
    explicit At(const MeanFlow& flow) : flow_(flow) { std::fill_n(last_, n, flow.sampler_.nowhere()); }
    HWY_INLINE Group<n> operator()(double, const Group<n>& y) {
      return make_group<n>([&](std::size_t i) HWY_ATTR { return flow_.sampler_(y.tracer[i], last_[i]); });
    }

   private:
    const MeanFlow& flow_;
    LastBlock last_[n];
  };

 private:
  GridSampler<interpolation> sampler_;
};

/// Between two frames.
template <Interpolation interpolation>
class FrameFlow {
 public:
  explicit FrameFlow(const Flow& flow)
      : first_(flow.first().blocks()), second_(flow.second().blocks()), t0_(flow.t0()), span_(flow.t1() - flow.t0()) {}

  template <std::size_t n>
  class At {
   public:
    explicit At(const FrameFlow& flow) : flow_(flow) {
      std::fill_n(last_[0], n, flow.first_.nowhere());
      std::fill_n(last_[1], n, flow.second_.nowhere());
    }
    HWY_INLINE Group<n> operator()(double t, const Group<n>& y) {
      const double s = (t - flow_.t0_) / flow_.span_;
      return make_group<n>([&](std::size_t i) HWY_ATTR {
        return between(flow_.first_(y.tracer[i], last_[0][i]), flow_.second_(y.tracer[i], last_[1][i]), s);
      });
    }

   private:
    const FrameFlow& flow_;
    LastBlock last_[2][n];
  };

 private:
  GridSampler<interpolation> first_, second_;
  double t0_, span_;
};

}  // namespace HWY_NAMESPACE
}  // namespace grainvdb
HWY_AFTER_NAMESPACE();

#endif
