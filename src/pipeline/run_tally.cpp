#include "pipeline/run_tally.hpp"

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "measure/grains.hpp"

namespace grainvdb {
namespace {

std::size_t channel_count(const Plan& plan) {
  std::size_t n = 0;
  for (const Sweep& sweep : plan.sweeps)
    for (const auto& pass : sweep.passes)
      for (const MomentPtr& m : pass) n += static_cast<std::size_t>(m->channels);
  return n;
}

}  // namespace

void RunTally::add(const FrameContext& frame) {
  material_ += frame.particles().size();
  const std::vector<double>& radius = frame.particles().radius;
  if (!(diameter_ > 0) && !radius.empty()) diameter_ = mean_diameter(radius);
  size_.particles = std::max(size_.particles, static_cast<double>(frame.particles().size()));
  size_.contacts = std::max(size_.contacts, static_cast<double>(frame.contact_count()));
}

void RunTally::add(const DerivedFields& output, std::size_t summed_leaves) {
  report_.summed_leaves = summed_leaves;
  size_.voxels = std::max(size_.voxels, static_cast<double>(summed_leaves) * leaf_size);
  report_.active_voxels = output.mask.topology()->active_voxel_count();
  report_.grids += output.grids;
  report_.masked.clear();
  for (const ReasonInfo& r : reasons())
    if (const std::size_t n = output.mask.count(r.reason); n > 0) report_.masked.emplace_back(r.name, n);
}

RunReport RunTally::report(const Plan& plan, const Pipeline& pipeline) const {
  RunReport report = report_;
  report.channels = channel_count(plan);
  report.memory = memory_model(plan, pipeline).peak(size_);
  const double least = pipeline.limits.cutoff_in_diameters;
  if (pipeline.cutoff < least * diameter_) report.narrow_kernel = NarrowKernel{pipeline.cutoff / diameter_, least};
  return report;
}

void RunTally::save(ByteWriter& to) const {
  to.number(size_);
  to.number(diameter_);
  for (const std::size_t n : {material_, report_.active_voxels, report_.summed_leaves, report_.grids})
    to.number(std::uint64_t{n});
  to.number(report_.stop.has_value());
  if (report_.stop) to.number(*report_.stop);
  to.number(std::uint64_t{report_.masked.size()});
  for (const auto& [reason, voxels] : report_.masked) {
    to.text(reason);
    to.number(std::uint64_t{voxels});
  }
}

void RunTally::load(ByteReader& from) {
  size_ = from.number<RunSize>();
  diameter_ = from.number<double>();
  for (std::size_t* n : {&material_, &report_.active_voxels, &report_.summed_leaves, &report_.grids}) *n = from.count();
  if (from.number<bool>()) report_.stop = from.number<Stop>();
  for (std::size_t left = from.count(); left > 0; --left) {
    std::string reason = from.text();
    report_.masked.emplace_back(std::move(reason), from.count());
  }
}

}  // namespace grainvdb
