#include "pipeline/until.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "average/growing_blocks.hpp"
#include "average/leave_one_out.hpp"
#include "pipeline/number.hpp"

namespace grainvdb {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

double magnitude(const SparseField& field, std::size_t leaf, int offset) {
  double sum = 0;
  for (int c = 0; c < field.components(); ++c) {
    const auto x = static_cast<double>(field.leaf(leaf, c)[offset]);
    sum += x * x;
  }
  return std::sqrt(sum);
}

/// NaN where the field is undefined.
double error_at(const Until& until, const SparseField& field, const SparseField& error, std::size_t leaf, int offset) {
  const double value = magnitude(field, leaf, offset);
  if (std::isnan(value)) return value;
  const double e = magnitude(error, leaf, offset);
  if (std::isnan(e)) return infinite;
  return !until.relative || e == 0 ? e : e / value;
}

/// What is compared with the target: "phi_error/|phi| in 90 % of voxels".
std::string compared(const Until& until) {
  return until.field + "_error" + (until.relative ? "/|" + until.field + '|' : "") + " in " +
         short_number(100 * until.quantile) + " % of voxels";
}

}  // namespace

double error_of_share(const Until& until, const SparseField& field, const SparseField& error,
                      const std::optional<Region>& region) {
  const Topology& all = *field.topology();
  const Topology wanted = region ? region->clip(all) : all;
  std::vector<double> errors;
  for (std::size_t l = 0; l < wanted.leaf_count(); ++l) {
    const std::size_t leaf = all.find(wanted.origin(l)).value();
    wanted.mask(l).for_each([&](int offset) {
      const double e = error_at(until, field, error, leaf, offset);
      if (!std::isnan(e)) errors.push_back(e);
    });
  }
  if (errors.empty()) return infinite;
  const auto count = static_cast<std::size_t>(std::ceil(until.quantile * static_cast<double>(errors.size())));
  const auto at = errors.begin() + static_cast<std::ptrdiff_t>(std::clamp<std::size_t>(count, 1, errors.size()) - 1);
  std::nth_element(errors.begin(), at, errors.end());
  return *at;
}

double error_so_far(const DeriveSetting& setting, const WindowSums& sums, const std::optional<Region>& region) {
  const Until& until = *setting.pipeline.until;
  const MomentMeans voxels = sums.means();
  LeaveOneOut blocks(sums, voxels);
  const MomentMeans means = blocks.of_all();
  std::optional<WallTreatment::Renormalised> inside;
  if (setting.walls != nullptr) inside.emplace(setting.walls->renormalise(means, sums.blocked()));
  DerivedFields fields = derive_fields(setting.pipeline, setting.errors.by_block, {until.field}, setting.lattice,
                                       setting.units, inside ? inside->means : means);
  derive_errors(setting, sums, voxels, fields);
  if (setting.walls != nullptr) setting.walls->mask(fields);
  return error_of_share(until, fields.fields.at(until.field), fields.fields.at(until.field + "_error"), region);
}

bool is_time_to_look(const Pipeline& pipeline, std::size_t frames) {
  return frames >= pipeline.blocks && frames % growing_block_length(pipeline.blocks, frames) == 0;
}

std::string describe_progress(const Until& until, double error) {
  return compared(until) + " at " + short_number(error) + ", ends at " + short_number(until.error);
}

std::string describe(const Until& until, const Stop& stop) {
  return std::string(stop.met ? "stopped by average.until" : "average.until was not met") + " after " +
         std::to_string(stop.frames) + " of " + std::to_string(stop.frames_there) + " frames: " + compared(until) +
         " is at most " + short_number(stop.error) + ", wanted " + short_number(until.error);
}

}  // namespace grainvdb
