#pragma once
/// Velocity as tracers meet it: between voxel centres, and between frames.
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

#include "grainvdb/box.hpp"
#include "grainvdb/lattice.hpp"
#include "grainvdb/sparse_field.hpp"

namespace grainvdb {

/// How values between voxel centres are formed. Periodic axes wrap. A value exists only where the 8 voxels around are
/// active and defined.
enum class Interpolation : std::uint8_t {
  trilinear,  ///< from those 8: continuous, exact for linear fields; error h²/8 |∂²u| per axis at most
  tricubic,   ///< from 64 by Catmull-Rom splines: smooth, exact for quadratic fields; error h³/62 |∂³u| per axis at
              ///< most; trilinear in cells where one of the 64 has no value
};

/// The velocity at a place.
struct FlowValue {
  Vec3 velocity{};                   ///< [length/time]
  double shear_rate = 0;             ///< |γ̇| [1/time]; 0 where the grid has none, NaN where it is undefined
  std::array<double, 9> gradient{};  ///< ∂u_i/∂x_j of the interpolant, row i [1/time]
};

struct FlowBlocks;

/// The fields that move tracers, copied into blocks that hold everything a sample needs side by side. Memory: 11.7 kB
/// per leaf (trilinear) or 21.3 kB (tricubic).
class FlowGrid {
 public:
  /// `velocity` has 3 components. `shear_rate` has 1 and the topology of the velocity; nullptr where nobody wants the
  /// strain. Throws std::invalid_argument otherwise.
  FlowGrid(const Lattice& lattice, const SparseField& velocity, const SparseField* shear_rate,
           Interpolation interpolation);
  ~FlowGrid();
  FlowGrid(FlowGrid&&) noexcept;
  FlowGrid& operator=(FlowGrid&&) noexcept;

  /// Nothing where one of the 8 voxels around x is inactive or has no velocity. For tests and look-ups, not for loops.
  std::optional<FlowValue> at(const Vec3& x) const;

  std::size_t bytes() const;
  const Lattice& lattice() const;
  const FlowBlocks& blocks() const { return *blocks_; }

 private:
  std::unique_ptr<FlowBlocks> blocks_;
};

/// The velocity in time: one field for ever, or two frames and a straight line in time between them,
/// u(x,t) = u₀(x) + (t - t₀)/(t₁ - t₀) (u₁(x) - u₀(x)), defined where both are.
class Flow {
 public:
  /// The time mean.
  explicit Flow(std::shared_ptr<const FlowGrid> mean);
  /// Throws std::invalid_argument unless t0 < t1 and both grids have one lattice and interpolation.
  Flow(std::shared_ptr<const FlowGrid> first, double t0, std::shared_ptr<const FlowGrid> second, double t1);

  bool steady() const { return second_ == nullptr; }
  const FlowGrid& first() const { return *first_; }
  const FlowGrid& second() const { return steady() ? *first_ : *second_; }
  double t0() const { return t0_; }
  double t1() const { return t1_; }  ///< both 0 when steady

 private:
  std::shared_ptr<const FlowGrid> first_, second_;
  double t0_ = 0, t1_ = 0;
};

}  // namespace grainvdb
