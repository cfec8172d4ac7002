#include <cmath>
#include <stdexcept>
#include <utility>

#include "splat/branch_set.hpp"
#include "splat/contact_leaves.hpp"
#include "splat/gather.hpp"
#include "splat/splat.hpp"

namespace grainvdb {
namespace {

LeafBuffers sum_exactly(const Lattice& lattice, const LucyKernel& kernel, const BranchSet& set,
                        std::shared_ptr<const Topology> topology, std::span<const double> q, int channels) {
  const auto width = static_cast<std::size_t>(channels);
  const double h = lattice.voxel();
  return gather(lattice, set.buckets(), (kernel.cutoff() + set.half_arm()) / h, std::move(topology), channels,
                [&](std::size_t entry, const LeafWindow& window, double* sums) {
                  const std::size_t b = set.buckets().point[entry];
                  const Vec3 arm = set.arm(b);
                  const double half = 0.5 * std::sqrt(arm[0] * arm[0] + arm[1] * arm[1] + arm[2] * arm[2]);
                  const double* value = q.data() + b * width;
                  for_each_voxel(window, entry_index(set.buckets(), entry), (kernel.cutoff() + half) / h,
                                 [&](int offset, const Vec3& d) {
                                   const double w = set.weight(b, d);
                                   double* sum = sums + static_cast<std::size_t>(offset) * width;
                                   for (std::size_t c = 0; c < width; ++c) sum[c] += value[c] * w;
                                 });
                });
}

}  // namespace

LeafBuffers splat_contacts(const Lattice& lattice, const LucyKernel& kernel, const HalfBranches& branches,
                           std::span<const double> q, int channels, LineIntegral method) {
  if (channels < 1 || q.size() != branches.size() * static_cast<std::size_t>(channels))
    throw std::invalid_argument("the splat needs one value per branch and channel");
  if (branches.size() == 0) return {std::make_shared<const Topology>(), channels};
  const BranchSet set(lattice, kernel, branches, {q, static_cast<std::size_t>(channels)}, method);
  const ContactLeaves leaves(lattice, kernel, set);
  auto topology = leaves.topology();
  if (method.method == LineIntegral::Method::exact)
    return sum_exactly(lattice, kernel, set, std::move(topology), q, channels);
  return leaves.sums(std::move(topology));
}

}  // namespace grainvdb
