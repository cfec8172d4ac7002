#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "splat/branch_set.hpp"
#include "splat/contact_leaves.hpp"
#include "splat/gather.hpp"
#include "splat/splat.hpp"

namespace grainvdb {

struct ContactSplat::Parts {
  Parts(const Lattice& of, const LucyKernel& with, const HalfBranches& branches, const BranchValues& values,
        LineIntegral line_integral, const Region* wanted)
      : lattice(of),
        kernel(with),
        q(values.q),
        method(line_integral),
        set(of, with, branches, values, line_integral, wanted),
        leaves(of, with, set) {}

  /// Every integral in double precision, by whatever method.
  void sum_in_double(const Topology& topology, const LeafConsumer& consume) const {
    const std::size_t width = set.channels();
    const std::vector<double> own = set.values_of_pieces();
    const double* const values = own.empty() ? q.data() : own.data();
    const double h = lattice.voxel();
    gather_leaves(
        lattice, set.buckets(), (kernel.cutoff() + set.half_arm()) / h, topology, set.channels(),
        [&](std::size_t entry, const LeafWindow& window, double* sums) {
          const std::size_t b = set.buckets().point[entry];
          const Vec3 arm = set.arm(b);
          const double half = 0.5 * std::sqrt(arm[0] * arm[0] + arm[1] * arm[1] + arm[2] * arm[2]);
          const double* value = values + b * width;
          for_each_voxel(window, entry_index(set.buckets(), entry), (kernel.cutoff() + half) / h,
                         [&](int offset, const Vec3& d) {
                           const double w = set.weight(b, d);
                           double* sum = sums + static_cast<std::size_t>(offset) * width;
                           for (std::size_t c = 0; c < width; ++c) sum[c] += value[c] * w;
                         });
        },
        consume);
  }

  const Lattice& lattice;
  const LucyKernel& kernel;
  std::span<const double> q;
  LineIntegral method;
  BranchSet set;
  ContactLeaves leaves;
};

ContactSplat::ContactSplat(const Lattice& lattice, const LucyKernel& kernel, const HalfBranches& branches,
                           std::span<const double> q, int channels, LineIntegral method, const Region* wanted)
    : ContactSplat(lattice, kernel, branches, q, channels, method, wanted, std::make_shared<const Topology>()) {
  has_more_voxels_ = false;
  if (parts_) topology_ = parts_->leaves.topology(wanted);
}

ContactSplat::ContactSplat(const Lattice& lattice, const LucyKernel& kernel, const HalfBranches& branches,
                           std::span<const double> q, int channels, LineIntegral method, const Region* wanted,
                           std::shared_ptr<const Topology> onto)
    : topology_(std::move(onto)) {
  if (channels < 1 || q.size() != branches.size() * static_cast<std::size_t>(channels))
    throw std::invalid_argument("the splat needs one value per branch and channel");
  if (branches.size() == 0) return;
  parts_ = std::make_unique<Parts>(lattice, kernel, branches, BranchValues{q, static_cast<std::size_t>(channels)},
                                   method, wanted);
}

ContactSplat::~ContactSplat() = default;

void ContactSplat::sums(const LeafConsumer& consume, Accumulation how) const {
  if (!parts_) return;
  if (how == Accumulation::twofold || parts_->method.method == LineIntegral::Method::exact) {
    parts_->sum_in_double(*topology_, consume);
  } else if (has_more_voxels_) {
    parts_->leaves.sums_where_reached(*topology_, consume, how);
  } else {
    parts_->leaves.sums(*topology_, consume, how);
  }
}

LeafBuffers splat_contacts(const Lattice& lattice, const LucyKernel& kernel, const HalfBranches& branches,
                           std::span<const double> q, int channels, LineIntegral method) {
  const ContactSplat splat(lattice, kernel, branches, q, channels, method);
  LeafBuffers result(splat.topology(), channels);
  splat.sums([&](std::size_t leaf, const double* values) {
    std::copy_n(values, static_cast<std::size_t>(channels) * leaf_size, result.block(leaf, 0));
  });
  return result;
}

}  // namespace grainvdb
