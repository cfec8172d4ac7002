#include "pipeline/species_stages.hpp"

#include <cstddef>
#include <map>
#include <stdexcept>
#include <utility>

#include "average/register.hpp"
#include "grainvdb/error.hpp"
#include "pipeline/text.hpp"

namespace grainvdb {
namespace {

/// What the stage of all grains sees when it makes the field of a species.
class PartialInput : public StageInput {
 public:
  PartialInput(const StageInput& all, const StageNeeds& needs, const Species& species, int index)
      : all_(all), species_(species), mask_(all.mask().topology()) {
    for (const MomentPtr& m : needs.moments) moments_.emplace(m->name, moment_of_species(m, species, index));
  }

  const Lattice& lattice() const override { return all_.lattice(); }
  const LucyKernel& kernel() const override { return all_.kernel(); }
  const StageSettings& settings() const override { return all_.settings(); }
  const Topology& topology() const override { return all_.topology(); }
  const SparseField& field(const std::string& name) const override {
    return all_.field(name_of_partial(name, species_.name));
  }
  const double* moment(std::size_t leaf, const Moment& moment, int channel) const override {
    return all_.moment(leaf, *moments_.at(moment.name), channel);
  }
  const double* frame_count(std::size_t leaf) const override { return all_.frame_count(leaf); }
  Mask& mask() const override { return mask_; }

  /// The reasons that the stage noted; where it found no material there is none of the species.
  void pass_on_reasons() const {
    constexpr auto no_material = static_cast<std::uint32_t>(Reason::no_material);
    for_each_leaf(all_.topology(), [&](std::size_t leaf) {
      const std::uint32_t* noted = mask_.leaf(leaf);
      all_.topology().mask(leaf).for_each([&](int v) {
        if ((noted[v] & no_material) != 0) all_.mask().add(leaf, v, Reason::no_species);
        if (const std::uint32_t others = noted[v] & ~no_material; others != 0)
          all_.mask().add(leaf, v, static_cast<Reason>(others));
      });
    });
  }

 private:
  const StageInput& all_;
  const Species& species_;
  std::map<std::string, MomentPtr> moments_;
  mutable Mask mask_;
};

StageNeeds needs_of_partial(const Stage& all, const Species& species, int index, const StageSettings& settings) {
  StageNeeds needs = all.needs(settings);
  for (std::string& field : needs.fields) field = name_of_partial(field, species.name);
  for (MomentPtr& moment : needs.moments) moment = moment_of_species(moment, species, index);
  return needs;
}

Stage stage_of_species(const Stage& all, const Species& species, int index) {
  Stage s = all;
  s.name = name_of_partial(all.name, species.name);
  s.description = all.description + ", of species " + species.name + " alone";
  s.equation = all.equation + ", summed over species " + species.name + " alone";
  s.options.clear();  // those of the field of all grains hold
  s.species_of = all.name;
  s.by_species = false;
  s.species_conflict = {};
  s.conflict = [all](const StageSettings& settings) -> std::optional<OptionConflict> {
    if (all.conflict)
      if (auto conflict = all.conflict(settings)) return conflict;
    return all.species_conflict ? all.species_conflict(settings) : std::nullopt;
  };
  s.needs = [all, species, index](const StageSettings& settings) {
    return needs_of_partial(all, species, index, settings);
  };
  s.compute = [all, species, index](const StageInput& in, SparseField& out) {
    const PartialInput own(in, all.needs(in.settings()), species, index);
    all.compute(own, out);
    own.pass_on_reasons();
  };
  return s;
}

void add_partial(StageRegistry& registry, Stage stage, const Pipeline& pipeline, const Species& species) {
  if (registry.find(stage.name) != nullptr)
    throw ConfigError({pipeline.location("species." + species.name),
                       "a field of species " + quote_text(species.name) + " would have a name that is taken",
                       stage.name,
                       "another name for the species",
                       {}});
  registry.add(std::move(stage));
}

}  // namespace

std::string name_of_partial(const std::string& field, const std::string& species) {
  return field + '_' + species;
}

std::vector<std::string> fields_by_species(const StageRegistry& registry) {
  std::vector<std::string> names;
  for (const Stage& stage : registry.stages())
    if (stage.by_species) names.push_back(stage.name);
  return names;
}

StageRegistry with_species(const StageRegistry& registry, const Pipeline& pipeline) {
  StageRegistry all = registry;
  for (std::size_t n = 0; n < pipeline.species.size(); ++n)
    for (const std::string& field : fields_by_species(registry)) {
      const Species& species = pipeline.species[n];
      const Stage stage = stage_of_species(*registry.find(field), species, static_cast<int>(n));
      add_partial(all, stage, pipeline, species);
      if (registry.find(field + "_error") != nullptr) add_partial(all, standard_error_of(stage), pipeline, species);
    }
  return all;
}

MomentPtr moment_of_species(const MomentPtr& all, const Species& species, int index) {
  if (all->kind != Moment::Kind::contacts && all->kind != Moment::Kind::particles)
    throw std::logic_error("the moment '" + all->name + "' has no part that is that of a species");
  Moment m = *all;
  m.name += " of species " + species.name;
  m.species = index;
  if (m.weight) m.weight = moment_of_species(m.weight, species, index);
  return std::make_shared<const Moment>(std::move(m));
}

}  // namespace grainvdb
