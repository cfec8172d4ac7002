#include "pipeline/derive_fields.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace grainvdb {
namespace {

class Input : public StageInput {
 public:
  Input(const Pipeline& pipeline, const Lattice& lattice, const MomentMeans& means, DerivedFields& state)
      : pipeline_(pipeline), lattice_(lattice), kernel_(pipeline.cutoff), means_(means), state_(state) {}

  const Lattice& lattice() const override { return lattice_; }
  const LucyKernel& kernel() const override { return kernel_; }
  const StageSettings& settings() const override { return pipeline_.stages; }
  const Topology& topology() const override { return *means_.topology(); }
  const SparseField& field(const std::string& name) const override { return state_.fields.at(name); }
  const double* moment(std::size_t leaf, const Moment& m, int channel) const override {
    return means_.block(leaf, m, channel);
  }
  const double* frame_count(std::size_t leaf) const override { return means_.frame_count(leaf); }
  Mask& mask() const override { return state_.mask; }

 private:
  const Pipeline& pipeline_;
  const Lattice& lattice_;
  LucyKernel kernel_;
  const MomentMeans& means_;
  DerivedFields& state_;
};

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

FieldMeta meta_of(const Stage& stage, const UnitSystem& units) {
  return {stage.name,       units.symbol(stage.dimension),
          stage.components, stage.description,
          stage.equation,   stage.additive ? 0.0F : std::numeric_limits<float>::quiet_NaN(),
          stage.dimension};
}

DerivedFields derive_fields(const Pipeline& pipeline, const std::vector<const Stage*>& stages,
                            const std::set<std::string>& kept, const Lattice& lattice, const UnitSystem& units,
                            const MomentMeans& means) {
  DerivedFields state{{}, Mask(means.topology()), 0};
  const Input input(pipeline, lattice, means, state);
  for (std::size_t s = 0; s < stages.size(); ++s) {
    const Stage& stage = *stages[s];
    if (!stage.compute) continue;
    SparseField field(meta_of(stage, units), means.topology(), lattice);
    state.grids += static_cast<std::size_t>(stage.components);
    stage.compute(input, field);
    state.fields.emplace(stage.name, std::move(field));

    std::erase_if(state.fields, [&](const auto& entry) {
      if (kept.contains(entry.first)) return false;
      return std::none_of(stages.begin() + static_cast<std::ptrdiff_t>(s) + 1, stages.end(), [&](const Stage* later) {
        return contains(later->needs(pipeline.stages).fields, entry.first);
      });
    });
  }
  return state;
}

}  // namespace grainvdb
