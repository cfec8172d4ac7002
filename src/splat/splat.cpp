#include "splat/splat.hpp"

#include <cmath>
#include <stdexcept>
#include <utility>

#include "splat/gather.hpp"

namespace grainvdb {
namespace {

void check_sizes(std::span<const double> q, std::size_t entries, int values) {
  if (values < 1 || q.size() != entries * static_cast<std::size_t>(values))
    throw std::invalid_argument("the splat needs one value per point and channel");
}

double squared(const Vec3& d) {
  return d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
}

// Squared distance [length²] of a voxel from a particle, d in voxels. Topology and sums must see the same bits.
double distance2(const Vec3& d, double h) {
  return squared({d[0] * h, d[1] * h, d[2] * h});
}

// sum_c += q_c w for the channels of one voxel.
void add_scaled(double* sum, const double* q, double w, std::size_t channels) {
  for (std::size_t c = 0; c < channels; ++c) sum[c] += q[c] * w;
}

// The half branches about their midpoints, which the buckets hold in index space.
class BranchGather {
 public:
  BranchGather(const Lattice& lattice, const LucyKernel& kernel, const HalfBranches& branches, LineIntegral method)
      : kernel_(kernel), branches_(branches), method_(method), h_(lattice.voxel()) {
    Columns3 middle = branches.start;
    double longest = 0;
    for (std::size_t b = 0; b < branches.size(); ++b) {
      for (int a = 0; a < 3; ++a) middle[a][b] -= 0.5 * branches.arm[a][b];
      longest = std::max(longest, half_length(b));
    }
    buckets_ = bin_points(lattice, middle, kernel.cutoff() + longest);
    reach_ = (kernel.cutoff() + longest) / h_;
  }

  const Buckets& buckets() const { return buckets_; }
  double reach() const { return reach_; }  // in voxels

  // Calls f(offset, weight) where weight() is ∫₀¹ W(x - x_α + s a) ds at the voxel.
  template <class F>
  void visit(std::size_t entry, const LeafWindow& window, F&& f) const {
    const std::size_t b = buckets_.point[entry];
    const Vec3 arm{branches_.arm[0][b], branches_.arm[1][b], branches_.arm[2][b]};
    const double reach = (kernel_.cutoff() + half_length(b)) / h_;
    for_each_voxel(window, entry_index(buckets_, entry), reach, [&](int offset, const Vec3& d) {
      // x - x_α = x - middle - a/2
      const Vec3 p{d[0] * h_ - 0.5 * arm[0], d[1] * h_ - 0.5 * arm[1], d[2] * h_ - 0.5 * arm[2]};
      f(offset, [&] {
        return method_.gauss_points == 0 ? kernel_.line_integral(p, arm)
                                         : kernel_.line_integral_gauss(p, arm, method_.gauss_points);
      });
    });
  }

 private:
  double half_length(std::size_t b) const {
    const Vec3 a{branches_.arm[0][b], branches_.arm[1][b], branches_.arm[2][b]};
    return 0.5 * std::sqrt(squared(a));
  }

  const LucyKernel& kernel_;
  const HalfBranches& branches_;
  LineIntegral method_;
  double h_;
  Buckets buckets_;
  double reach_ = 0;
};

}  // namespace

LeafBuffers splat_particles(const Lattice& lattice, const LucyKernel& kernel, const Buckets& buckets,
                            std::shared_ptr<const Topology> topology, std::span<const double> q, int channels) {
  const double h = lattice.voxel();
  const double reach = kernel.cutoff() / h;
  const auto width = static_cast<std::size_t>(channels);
  return gather(lattice, buckets, reach, std::move(topology), channels,
                [&](std::size_t entry, const LeafWindow& window, double* sums) {
                  const double* values = q.data() + buckets.point[entry] * width;
                  for_each_voxel(window, entry_index(buckets, entry), reach, [&](int offset, const Vec3& d) {
                    const double w = kernel.value(distance2(d, h));
                    add_scaled(sums + static_cast<std::size_t>(offset) * width, values, w, width);
                  });
                });
}

LeafBuffers splat_particle_gradients(const Lattice& lattice, const LucyKernel& kernel, const Buckets& buckets,
                                     std::shared_ptr<const Topology> topology, std::span<const double> q, int values) {
  const double h = lattice.voxel();
  const double reach = kernel.cutoff() / h;
  const auto count = static_cast<std::size_t>(values);
  return gather(lattice, buckets, reach, std::move(topology), 3 * values,
                [&](std::size_t entry, const LeafWindow& window, double* sums) {
                  const double* value = q.data() + buckets.point[entry] * count;
                  for_each_voxel(window, entry_index(buckets, entry), reach, [&](int offset, const Vec3& d) {
                    const double f = kernel.gradient_factor(distance2(d, h)) * h;
                    double* sum = sums + static_cast<std::size_t>(offset) * 3 * count;
                    for (std::size_t v = 0; v < count; ++v)
                      for (std::size_t j = 0; j < 3; ++j) sum[3 * v + j] += value[v] * (f * d[j]);
                  });
                });
}

LeafBuffers splat_contacts(const Lattice& lattice, const LucyKernel& kernel, const HalfBranches& branches,
                           std::span<const double> q, int channels, LineIntegral method) {
  check_sizes(q, branches.size(), channels);
  const BranchGather branch(lattice, kernel, branches, method);
  auto topology =
      reached_voxels(lattice, branch.buckets(), branch.reach(),
                     [&](std::size_t entry, const LeafWindow& window, auto&& f) { branch.visit(entry, window, f); });
  const auto width = static_cast<std::size_t>(channels);
  return gather(lattice, branch.buckets(), branch.reach(), std::move(topology), channels,
                [&](std::size_t entry, const LeafWindow& window, double* sums) {
                  const double* values = q.data() + branch.buckets().point[entry] * width;
                  branch.visit(entry, window, [&](int offset, auto&& weight) {
                    add_scaled(sums + static_cast<std::size_t>(offset) * width, values, weight(), width);
                  });
                });
}

}  // namespace grainvdb
