#pragma once
/// A stage's surroundings made by hand: base fields and moments as functions of the voxel.
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "derive/register.hpp"
#include "fields/register.hpp"
#include "grainvdb/stage.hpp"

namespace grainvdb::testing {

inline constexpr float nan = std::numeric_limits<float>::quiet_NaN();
/// What inactive voxels hold: a stage that reads one gives a result that no test expects.
inline constexpr float never_read = 1e30F;

/// The voxels of the box first … last for which `active` holds.
inline std::shared_ptr<const Topology> make_topology(
    const Coord& first, const Coord& last,
    const std::function<bool(const Coord&)>& active = [](const Coord&) { return true; }) {
  std::map<Coord, LeafMask> leaves;
  for (std::int32_t x = first.x; x <= last.x; ++x)
    for (std::int32_t y = first.y; y <= last.y; ++y)
      for (std::int32_t z = first.z; z <= last.z; ++z)
        if (active({x, y, z})) leaves[leaf_origin({x, y, z})].set(leaf_offset({x, y, z}));
  std::vector<Coord> origins;
  std::vector<LeafMask> masks;
  for (const auto& [origin, mask] : leaves) {
    origins.push_back(origin);
    masks.push_back(mask);
  }
  return std::make_shared<Topology>(std::move(origins), std::move(masks));
}

/// A hash of a voxel and a seed, uniform in [0, 1): random fields that do not depend on the order of evaluation.
inline double noise(const Coord& c, std::uint64_t seed) {
  std::uint64_t z = seed;
  for (int axis = 0; axis < 3; ++axis) {
    z += 0x9e3779b97f4a7c15ULL + static_cast<std::uint32_t>(c[axis]);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    z ^= z >> 31;
  }
  return static_cast<double>(z >> 11) * 0x1p-53;
}

class FakeInput : public StageInput {
 public:
  using Values = std::function<double(const Coord&, int component)>;

  explicit FakeInput(std::shared_ptr<const Topology> topology, const Lattice& lattice = Lattice(1, {0, 0, 0}))
      : lattice_(lattice),
        kernel_(3 * lattice.voxel()),
        topology_(std::move(topology)),
        mask_(std::make_unique<Mask>(topology_)) {
    register_velocity(registry_);
    register_angular_velocity(registry_);
    register_gradients(registry_);
    register_rates(registry_);
    register_stress_invariants(registry_);
    register_rheology(registry_);
    register_fluidity(registry_);
    register_spin(registry_);
    register_principal(registry_);
    register_mohr_coulomb(registry_);
    register_coaxiality(registry_);
    register_spot_drift(registry_);
    settings_ = registry_.default_settings();
  }

  /// Gives a field, in place of the stage that would make it.
  void set(const std::string& name, int components, const Values& values) {
    SparseField field({name, "1", components, "", "", nan}, topology_, lattice_);
    for (std::size_t l = 0; l < topology_->leaf_count(); ++l)
      for (int k = 0; k < components; ++k)
        for (int v = 0; v < leaf_size; ++v)
          field.leaf(l, k)[v] = topology_->mask(l).test(v)
                                    ? static_cast<float>(values(voxel_at(topology_->origin(l), v), k))
                                    : never_read;
    fields_.erase(name);
    fields_.emplace(name, std::move(field));
  }
  void set(const std::string& name, double value) {
    set(name, 1, [value](const Coord&, int) { return value; });
  }
  void set(const std::string& name, const std::vector<double>& value) {
    set(name, static_cast<int>(value.size()), [&](const Coord&, int k) { return value[static_cast<std::size_t>(k)]; });
  }

  void set_moment(const Moment& moment, const Values& values) {
    LeafBuffers buffers(topology_, moment.channels);
    for (std::size_t l = 0; l < topology_->leaf_count(); ++l)
      for (int k = 0; k < moment.channels; ++k)
        for (int v = 0; v < leaf_size; ++v)
          buffers.block(l, k)[v] = topology_->mask(l).test(v) ? values(voxel_at(topology_->origin(l), v), k)
                                                              : static_cast<double>(never_read);
    moments_[moment.name] = std::move(buffers);
  }

  void set_option(const std::string& stage, const std::string& name, const OptionValue& value) {
    settings_.at(stage).at(name) = value;
  }

  /// The field of that name: given, or made by its stage from what it needs.
  const SparseField& derive(const std::string& name) {
    if (const auto it = fields_.find(name); it != fields_.end()) return it->second;
    const Stage* stage = registry_.find(name);
    if (stage == nullptr) throw std::logic_error("no stage and no given field: " + name);
    for (const std::string& need : stage->needs(settings_).fields) derive(need);
    SparseField out({stage->name, "1", stage->components, "", "", nan}, topology_, lattice_);
    stage->compute(*this, out);
    return fields_.emplace(name, std::move(out)).first->second;
  }
  double value(const std::string& name, const Coord& c = {}, int component = 0) {
    return static_cast<double>(derive(name).value(c, component));
  }
  std::vector<double> values(const std::string& name, const Coord& c = {}) {
    std::vector<double> v;
    for (int k = 0; k < derive(name).components(); ++k) v.push_back(value(name, c, k));
    return v;
  }
  bool has_reason(Reason r, const Coord& c = {}) const { return (reasons_at(c) & static_cast<std::uint32_t>(r)) != 0; }
  std::uint32_t reasons_at(const Coord& c) const {
    return mask_->leaf(*topology_->find(leaf_origin(c)))[leaf_offset(c)];
  }
  template <class F>
  void for_each(F&& f) const {
    for (std::size_t l = 0; l < topology_->leaf_count(); ++l)
      topology_->mask(l).for_each([&](int v) { f(voxel_at(topology_->origin(l), v)); });
  }
  const StageRegistry& registry() const { return registry_; }

  const Lattice& lattice() const override { return lattice_; }
  const LucyKernel& kernel() const override { return kernel_; }
  const StageSettings& settings() const override { return settings_; }
  const Topology& topology() const override { return *topology_; }
  const SparseField& field(const std::string& name) const override { return fields_.at(name); }
  const double* moment(std::size_t leaf, const Moment& m, int channel) const override {
    return moments_.at(m.name).block(leaf, channel);
  }
  const double* frame_count(std::size_t) const override { throw std::logic_error("not given"); }
  Mask& mask() const override { return *mask_; }

 private:
  Lattice lattice_;
  LucyKernel kernel_;
  std::shared_ptr<const Topology> topology_;
  std::unique_ptr<Mask> mask_;
  StageRegistry registry_;
  StageSettings settings_;
  std::map<std::string, SparseField> fields_;
  std::map<std::string, LeafBuffers> moments_;
};

/// One active voxel at the origin: enough for formulas.
inline FakeInput one_voxel() {
  return FakeInput(make_topology({0, 0, 0}, {0, 0, 0}));
}

}  // namespace grainvdb::testing
