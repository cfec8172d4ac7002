#include "pipeline/derive_errors.hpp"

#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "average/jackknife.hpp"
#include "average/leave_one_out.hpp"
#include "base/parallel.hpp"

namespace grainvdb {
namespace {

/// The moments from which a field is made, through others or itself.
std::vector<MomentPtr> moments_behind(const std::string& field, const DeriveSetting& setting) {
  std::set<std::string> behind{field};
  std::vector<MomentPtr> moments;
  const auto& stages = setting.errors.by_block;
  for (auto stage = stages.rbegin(); stage != stages.rend(); ++stage) {
    if (!behind.contains((*stage)->name)) continue;
    const StageNeeds needs = (*stage)->needs(setting.pipeline.stages);
    behind.insert(needs.fields.begin(), needs.fields.end());
    moments.insert(moments.end(), needs.moments.begin(), needs.moments.end());
  }
  return moments;
}

std::vector<std::size_t> blocks_with_frames(const LeaveOneOut& others) {
  std::vector<std::size_t> blocks;
  for (std::size_t b = 0; b < others.block_count(); ++b)
    if (others.frames(b) > 0) blocks.push_back(b);
  return blocks;
}

struct Estimate {
  const Stage* stage;
  const SparseField* of;
  Jackknife jackknife;
};

SparseField write(const Estimate& estimate, const DeriveSetting& setting, const LeaveOneOut& others, bool enough_blocks,
                  Mask& mask) {
  const SparseField& of = *estimate.of;
  SparseField out(meta_of(*estimate.stage, setting.units), of.topology(), setting.lattice);
  const std::vector<MomentPtr> moments = moments_behind(of.meta().name, setting);
  parallel_for(of.topology()->leaf_count(), [&](std::size_t leaf) {
    const LeafMask reached = enough_blocks ? others.reached_twice(leaf, moments) : LeafMask{};
    for (int c = 0; c < of.components(); ++c)
      of.topology()->mask(leaf).for_each([&](int v) {
        if (std::isnan(of.leaf(leaf, c)[v])) return;
        const double error = reached.test(v) ? estimate.jackknife.error(leaf, c, v) : std::nan("");
        if (std::isnan(error)) mask.add(leaf, v, Reason::few_blocks);
        out.leaf(leaf, c)[v] = static_cast<float>(error);
      });
  });
  return out;
}

}  // namespace

void derive_errors(const DeriveSetting& setting, const WindowSums& sums, const MomentMeans& means, DerivedFields& all) {
  const std::vector<const Stage*>& stages = setting.errors.errors;
  if (stages.empty()) return;
  LeaveOneOut others(sums, means);
  const std::vector<std::size_t> blocks = blocks_with_frames(others);
  std::vector<std::size_t> frames;
  for (const std::size_t b : blocks) frames.push_back(others.frames(b));
  const bool enough_blocks = blocks.size() >= 2;

  std::vector<Estimate> estimates;
  std::set<std::string> fields;
  for (const Stage* stage : stages) {
    const SparseField& of = all.fields.at(stage->error_of);
    estimates.push_back({stage, &of, Jackknife(of, frames)});
    fields.insert(stage->error_of);
  }
  for (std::size_t j = 0; enough_blocks && j < blocks.size(); ++j) {
    const MomentMeans rest = others.without(blocks[j]);
    std::optional<WallTreatment::Renormalised> inside;
    if (setting.walls != nullptr) inside.emplace(setting.walls->renormalise(rest, sums.blocked()));
    const DerivedFields without = derive_fields(setting.pipeline, setting.errors.by_block, fields, setting.lattice,
                                                setting.units, inside ? inside->means : rest);
    all.grids += without.grids;
    for (Estimate& e : estimates) e.jackknife.leave_out(j, without.fields.at(e.stage->error_of));
  }
  for (const Estimate& e : estimates) {
    all.grids += static_cast<std::size_t>(e.stage->components);
    all.fields.emplace(e.stage->name, write(e, setting, others, enough_blocks, all.mask));
  }
}

std::size_t error_bytes_per_leaf(const Plan& plan) {
  std::size_t components = 0;
  for (const Stage* stage : plan.errors.errors) components += static_cast<std::size_t>(stage->components);
  return LeaveOneOut::bytes_per_leaf(plan.block_sums) + components * Jackknife::bytes_per_leaf();
}

}  // namespace grainvdb
