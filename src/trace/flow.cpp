#include "grainvdb/flow.hpp"

#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

#include "trace/cell.hpp"
#include "trace/flow_blocks.hpp"
#include "trace/spline.hpp"

namespace grainvdb {
namespace {

/// The product of weights along the axes over the n³ voxels from `block` on.
template <std::size_t n>
std::array<double, flow_lanes> weigh(const float* block, int edge, const std::array<std::array<double, n>, 3>& w) {
  std::array<double, flow_lanes> sum{};
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j)
      for (std::size_t k = 0; k < n; ++k) {
        const float* const voxel =
            block + ((i * static_cast<std::size_t>(edge) + j) * static_cast<std::size_t>(edge) + k) * flow_lanes;
        for (std::size_t c = 0; c < flow_lanes; ++c)
          sum[c] += w[0][i] * w[1][j] * w[2][k] * static_cast<double>(voxel[c]);
      }
  return sum;
}

template <std::size_t n>
std::optional<FlowValue> value_of(const FlowBlocks& blocks, const float* block, const Vec3& within,
                                  std::array<double, n> (*weights)(double), std::array<double, n> (*slopes)(double)) {
  std::array<std::array<double, n>, 3> plain;
  for (std::size_t a = 0; a < 3; ++a) plain[a] = weights(within[a]);
  const auto u = weigh(block, blocks.edge, plain);
  if (std::isnan(u[0]) || std::isnan(u[1]) || std::isnan(u[2])) return std::nullopt;
  FlowValue value{{u[0], u[1], u[2]}, u[3], {}};
  for (std::size_t j = 0; j < 3; ++j) {
    auto along = plain;
    along[j] = slopes(within[j]);
    const auto d = weigh(block, blocks.edge, along);
    for (std::size_t i = 0; i < 3; ++i) value.gradient[3 * i + j] = d[i] / blocks.lattice.voxel();
  }
  return value;
}

void check(bool good, const std::string& what) {
  if (!good) throw std::invalid_argument(what);
}

bool same_lattice(const Lattice& a, const Lattice& b) {
  bool same = a.voxel() == b.voxel() && a.origin() == b.origin();
  for (int axis = 0; axis < 3; ++axis) {
    const auto& p = a.period(axis);
    const auto& q = b.period(axis);
    same = same && p.has_value() == q.has_value() && (!p || (p->first == q->first && p->count == q->count));
  }
  return same;
}

std::unique_ptr<FlowBlocks> blocks_of(const Lattice& lattice, const SparseField& velocity,
                                      const SparseField* shear_rate, Interpolation interpolation) {
  check(velocity.components() == 3,
        "the velocity of tracers must have 3 components, found " + std::to_string(velocity.components()));
  if (shear_rate != nullptr) {
    check(shear_rate->components() == 1,
          "the shear rate must have 1 component, found " + std::to_string(shear_rate->components()));
    check(shear_rate->topology() == velocity.topology(), "the shear rate must share the topology of the velocity");
  }
  return std::make_unique<FlowBlocks>(lattice, velocity, shear_rate, interpolation);
}

}  // namespace

FlowGrid::FlowGrid(const Lattice& lattice, const SparseField& velocity, const SparseField* shear_rate,
                   Interpolation interpolation)
    : blocks_(blocks_of(lattice, velocity, shear_rate, interpolation)) {}
FlowGrid::~FlowGrid() = default;
FlowGrid::FlowGrid(FlowGrid&&) noexcept = default;
FlowGrid& FlowGrid::operator=(FlowGrid&&) noexcept = default;

std::optional<FlowValue> FlowGrid::at(const Vec3& x) const {
  constexpr double most = 1 << 30;
  for (int a = 0; a < 3; ++a)
    if (!(std::abs(blocks_->lattice.to_index(a, x[static_cast<std::size_t>(a)])) < most)) return std::nullopt;
  const Cell cell = cell_at(blocks_->lattice, x);
  const float* const block = blocks_->block(blocks_->index.find(leaf_origin(cell.voxel)));
  const auto in_block = [&](int more) {
    const auto local = [&](std::int32_t i) { return (i & (leaf_edge - 1)) + more; };
    return block + blocks_->offset({local(cell.voxel.x), local(cell.voxel.y), local(cell.voxel.z)});
  };
  if (blocks_->interpolation == Interpolation::tricubic)
    if (const auto value = value_of<4>(*blocks_, in_block(0), cell.within, cubic_weights, cubic_slopes);
        value && !std::isnan(value->shear_rate))
      return value;
  return value_of<2>(*blocks_, in_block(blocks_->below), cell.within, linear_weights, linear_slopes);
}

std::size_t FlowGrid::bytes() const {
  return blocks_->values.size() * sizeof(float) + blocks_->index.bytes();
}

const Lattice& FlowGrid::lattice() const {
  return blocks_->lattice;
}

Flow::Flow(std::shared_ptr<const FlowGrid> mean) : first_(std::move(mean)) {}

Flow::Flow(std::shared_ptr<const FlowGrid> first, double t0, std::shared_ptr<const FlowGrid> second, double t1)
    : first_(std::move(first)), second_(std::move(second)), t0_(t0), t1_(t1) {
  std::ostringstream times;
  times << "the frames that carry tracers must be in order of time, found " << t0 << " and " << t1;
  check(t0 < t1 && std::isfinite(t1 - t0), times.str());
  check(same_lattice(first_->lattice(), second_->lattice()) &&
            first_->blocks().interpolation == second_->blocks().interpolation,
        "both frames that carry tracers must have one lattice and interpolation");
}

}  // namespace grainvdb
