// The mean of W along a branch by its value and second derivative in the middle, compiled once for every instruction
// set (see bricks-inl.hpp).
#if defined(GRAINVDB_SPLAT_BRANCH_CURVATURE_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef GRAINVDB_SPLAT_BRANCH_CURVATURE_INL_HPP
#undef GRAINVDB_SPLAT_BRANCH_CURVATURE_INL_HPP
#else
#define GRAINVDB_SPLAT_BRANCH_CURVATURE_INL_HPP
#endif

#include <cstddef>
#include <cstdint>

#include <hwy/highway.h>

#include "splat/bricks-inl.hpp"
#include "splat/contact_bricks.hpp"

HWY_BEFORE_NAMESPACE();
namespace grainvdb {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// weights[k][lane] = (1-r)³(1+3r) - ½ (1-r)² a² + (1-r)(a·d)²/r of branch chosen[k] at the brick's voxels, d from its
/// middle (LucyKernel::line_integral_midpoint_curvature).
HWY_NOINLINE inline void weigh_with_curvature(const LeafBranches& b, const std::int32_t* HWY_RESTRICT chosen,
                                              std::size_t count, const Voxels at, const BranchRule& /*rule*/,
                                              float /*epsilon2*/, float* HWY_RESTRICT weights) {
  const V one = hn::Set(d, 1.0F), three = hn::Set(d, 3.0F), zero = hn::Zero(d);
  const V least = hn::Set(d, 1e-18F);  // r = 0 has a·d = 0: what it is divided by does not matter
  for (std::size_t k = 0; k < count; ++k) {
    const auto i = static_cast<std::size_t>(chosen[k]);
    const V dx = hn::Sub(at.x, hn::Set(d, b.x[i])), dy = hn::Sub(at.y, hn::Set(d, b.y[i])),
            dz = hn::Sub(at.z, hn::Set(d, b.z[i]));
    const V r = hn::Sqrt(hn::MulAdd(dx, dx, hn::MulAdd(dy, dy, hn::Mul(dz, dz))));
    const V p = hn::Max(hn::Sub(one, r), zero);
    const V t =
        hn::MulAdd(dx, hn::Set(d, b.ax[i]), hn::MulAdd(dy, hn::Set(d, b.ay[i]), hn::Mul(dz, hn::Set(d, b.az[i]))));
    const V bent = hn::Sub(hn::Mul(p, hn::MulAdd(three, r, one)), hn::Set(d, 0.5F * b.arm2[i]));
    const V stretched = hn::Div(hn::Mul(t, t), hn::Max(r, least));
    hn::Store(hn::Mul(p, hn::MulAdd(p, bent, stretched)), d, weights + k * lanes);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace grainvdb
HWY_AFTER_NAMESPACE();

#endif
