// The ways to add up: what double precision gives, and what plain single precision loses.
#include "splat/accumulate.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "bin/buckets.hpp"
#include "splat/second_moments.hpp"
#include "splat/splat.hpp"
#include "unit/splat/branch_scene.hpp"

namespace grainvdb::accumulate_test {
namespace {

using SM = SecondMoments;

class Accumulations : public testing::TestWithParam<Scene> {
 protected:
  /// Records of w and w (mean + v) for each axis, w about 1.5 and v within 1.
  void make(double mean) {
    const auto weights = random_values(count, 32), velocities = random_values(3 * count, 33);
    q.clear();
    for (std::size_t p = 0; p < count; ++p) {
      q.push_back(1.5 + 0.5 * weights[p]);
      for (std::size_t a = 0; a < 3; ++a) q.push_back(q[4 * p] * (mean + velocities[3 * p + a]));
    }
  }
  LeafBuffers sums(Accumulation how) const {
    LeafBuffers result(topology, 4);
    accumulate_particles(how, lattice, kernel, buckets, *topology, q, std::array{-1, 0, 0, 0}, into(result, 4));
    return result;
  }
  LeafBuffers products(Accumulation how) const {
    LeafBuffers result(topology, SM::channels);
    accumulate_second_moments(how, lattice, kernel, buckets, *topology, q, into(result, SM::channels));
    return result;
  }
  static LeafConsumer into(LeafBuffers& result, std::size_t channels) {
    return [&result, channels](std::size_t leaf, const double* values) {
      std::copy_n(values, channels * leaf_size, result.block(leaf, 0));
    };
  }
  /// Σ q W and Σ |q| W of the values at one voxel.
  std::array<double, 2> expected(const Coord& voxel, std::size_t value) const {
    std::array<double, 2> sum{};
    for (std::size_t p = 0; p < count; ++p) {
      const double term = q[4 * p + value] * lucy(norm(scene.shortest(lattice.centre(voxel), row(x, p))), scene.cutoff);
      sum[0] += term;
      sum[1] += std::abs(term);
    }
    return sum;
  }
  template <class F>
  void for_each_active(const F& f) const {
    for (std::size_t l = 0; l < topology->leaf_count(); ++l)
      topology->mask(l).for_each([&](int offset) { f(l, offset); });
  }
  /// The largest distance of the mean velocity along x from that of sums in double.
  double error_of_mean(Accumulation how) const {
    const LeafBuffers found = sums(how), exact = sums(Accumulation::twofold);
    double largest = 0;
    for_each_active([&](std::size_t l, int v) {
      const auto mean = [&](const LeafBuffers& of) { return of.block(l, 1)[v] / of.block(l, 0)[v]; };
      largest = std::max(largest, std::abs(mean(found) - mean(exact)));
    });
    return largest;
  }
  /// The same of the variance along x, from the second moments.
  double error_of_variance(Accumulation how) const {
    const LeafBuffers found = products(how), exact = products(Accumulation::twofold);
    double largest = 0;
    for_each_active([&](std::size_t l, int v) {
      const auto variance = [&](const LeafBuffers& of) {
        const auto at = [&](std::size_t c) {
          return of.block(l, static_cast<int>(c))[v] / of.block(l, static_cast<int>(SM::weight))[v];
        };
        return at(SM::velocity_square) - at(SM::velocity) * at(SM::velocity);
      };
      largest = std::max(largest, std::abs(variance(found) - variance(exact)));
    });
    return largest;
  }

  const Scene& scene = GetParam();
  Lattice lattice = scene.lattice();
  LucyKernel kernel{scene.cutoff};
  Columns3 x = scene.random_positions(60, 31);
  std::size_t count = x[0].size();
  Buckets buckets = bin_points(lattice, x, scene.cutoff);
  std::shared_ptr<const Topology> topology = particle_topology(lattice, kernel, buckets);
  std::vector<double> q;
};

// Some rounding of W and of the terms, and what a voxel is moved against a particle by rounding of positions.
TEST_P(Accumulations, InDoubleAreTheSumsOfTheTerms) {
  make(1e4);
  const LeafBuffers found = sums(Accumulation::twofold);
  const double moved = position_error(x) * largest_gradient(scene.cutoff) * static_cast<double>(count) * 2;
  for_each_active([&](std::size_t l, int v) {
    for (int c = 0; c < 4; ++c) {
      const auto [sum, terms] = expected(voxel_at(topology->origin(l), v), static_cast<std::size_t>(c));
      EXPECT_NEAR(found.block(l, c)[v], sum, 1e-12 * terms + moved * (c == 0 ? 1 : 1e4));
    }
  });
  expect_zero_where_inactive(found);
}

// Of 1 on top of 1e4 shifted sums keep 1e-5, as everywhere. Plain ones round each of the n terms and partial sums of
// the numerator by 2^-24 of 1e4, and the weights again: 2 (n + 4) 2^-24 1e4 at most, some 6e-4 for a single term.
TEST_P(Accumulations, InSingleLoseTheMean) {
  const double mean = 1e4;
  make(mean);
  EXPECT_LT(error_of_mean(Accumulation::shifted), 4e-5);
  EXPECT_GT(error_of_mean(Accumulation::single), 1e-4);
  EXPECT_LT(error_of_mean(Accumulation::single), 2 * static_cast<double>(count + 4) * 0x1p-24 * mean);
  make(1);
  EXPECT_LT(error_of_mean(Accumulation::single), 2 * static_cast<double>(count + 4) * 0x1p-24 * 2);
}

// Squares are 1e8, of which single precision keeps 6: the variance is gone. In double 1e-16 of 1e8 is left, some times.
TEST_P(Accumulations, InSingleLoseTheVariance) {
  make(1e4);
  EXPECT_LT(error_of_variance(Accumulation::shifted), 1e-3);
  EXPECT_GT(error_of_variance(Accumulation::single), 1);
}

TEST_P(Accumulations, SecondMomentsInDoubleAreThoseOfTheTerms) {
  make(0);
  const LeafBuffers found = products(Accumulation::twofold), fast = products(Accumulation::shifted);
  for_each_active([&](std::size_t l, int v) {
    const double w = found.block(l, 0)[v], reach = scene.cutoff + 3.5 * scene.voxel;
    for (std::size_t c = 0; c < SM::channels; ++c) {
      const bool squared = c >= SM::place_square;
      const double size = c < SM::place ? 1 : squared ? reach * reach : std::max(1.0, reach);
      const int k = static_cast<int>(c);
      EXPECT_NEAR(found.block(l, k)[v], fast.block(l, k)[v], 1e-4 * w * size) << c;
    }
  });
}

// Moments that are kept in double precision are so in both ways but the plain one.
TEST_P(Accumulations, OfBufferedMoments) {
  make(1e4);
  const auto buffered = [&](Accumulation how) {
    return accumulate_buffered(how, lattice, kernel, buckets, topology, q, 4);
  };
  const LeafBuffers exact = sums(Accumulation::twofold), single = sums(Accumulation::single);
  const LeafBuffers shifted = buffered(Accumulation::shifted), plain = buffered(Accumulation::single);
  for_each_active([&](std::size_t l, int v) {
    for (int c = 0; c < 4; ++c) {
      EXPECT_EQ(shifted.block(l, c)[v], exact.block(l, c)[v]);
      EXPECT_EQ(plain.block(l, c)[v], single.block(l, c)[v]);
    }
  });
}

TEST_P(Accumulations, GiveTheSameBytesForAnyThreads) {
  make(3);
  for (const Accumulation how : {Accumulation::single, Accumulation::twofold}) {
    expect_same_bytes_for_any_threads([&] { return sums(how); });
    expect_same_bytes_for_any_threads([&] { return products(how); });
  }
}

// Contacts: every method in double to rounding; whole and parted branches among those of the adaptive one.
TEST_P(Accumulations, OfContactsInDouble) {
  const HalfBranches branches = random_branches(scene, 30, 21, 0, 1.2);
  const auto values = random_values(branches.size() * 2, 22);
  const double shift = position_error(branches.start) * largest_gradient(scene.cutoff);
  const auto mean = [&](LineIntegral method) {
    return [&, method](const Vec3& p, const Vec3& a) {
      return method == LineIntegral::adaptive() ? kernel.line_integral_adaptive(p, a)
                                                : kernel.line_integral_gauss(p, a, method.gauss_points);
    };
  };
  for (const LineIntegral method : {LineIntegral::adaptive(), LineIntegral::gauss(2)}) {
    const ContactSplat splat(lattice, kernel, branches, values, 2, method);
    LeafBuffers found(splat.topology(), 2);
    splat.sums(into(found, 2), Accumulation::twofold);
    for (const ReachedVoxel& v : weigh_branches(scene, branches, mean(method)))
      for (int c = 0; c < 2; ++c) {
        double sum = 0, terms = 0, reached = 0;
        for (const auto& [b, w] : v.branches) {
          const double value = values[2 * b + static_cast<std::size_t>(c)];
          sum += value * w;
          terms += std::abs(value) * w;
          reached += std::abs(value);
        }
        EXPECT_NEAR(value_at(found, v.voxel, c), sum, 1e-12 * terms + shift * reached);
      }
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, Accumulations, testing::ValuesIn(scenes()),
                         [](const auto& param) { return param.param.name; });

// At the rims of the supports plain sums are off by more than the bar of the shifted ones.
TEST(AccumulationAtRims, IsWhatIsSummedAgain) {
  double plain = 0, shifted = 0, plain_contacts = 0, shifted_contacts = 0;
  for (const Scene& scene : scenes()) {
    const Lattice lattice = scene.lattice();
    const LucyKernel kernel(scene.cutoff);
    const Columns3 x = scene.random_positions(60, 31);
    const Buckets buckets = bin_points(lattice, x, scene.cutoff);
    const auto topology = particle_topology(lattice, kernel, buckets);
    const std::vector<double> ones(x[0].size(), 1.0);
    const auto largest = [](const LeafBuffers& found, const LeafBuffers& exact) {
      double error = 0;
      for (std::size_t l = 0; l < exact.topology()->leaf_count(); ++l)
        exact.topology()->mask(l).for_each(
            [&](int v) { error = std::max(error, std::abs(found.block(l, 0)[v] / exact.block(l, 0)[v] - 1)); });
      return error;
    };
    const auto particles = [&](Accumulation how) {
      LeafBuffers result(topology, 1);
      accumulate_particles(how, lattice, kernel, buckets, *topology, ones, std::array{-1},
                           [&](std::size_t l, const double* v) { std::copy_n(v, leaf_size, result.block(l, 0)); });
      return result;
    };
    const HalfBranches branches = random_branches(scene, 30, 21);
    const std::vector<double> one_each(branches.size(), 1.0);
    const ContactSplat splat(lattice, kernel, branches, one_each, 1, LineIntegral::adaptive());
    const auto contacts = [&](Accumulation how) {
      LeafBuffers result(splat.topology(), 1);
      splat.sums([&](std::size_t l, const double* v) { std::copy_n(v, leaf_size, result.block(l, 0)); }, how);
      return result;
    };
    plain = std::max(plain, largest(particles(Accumulation::single), particles(Accumulation::twofold)));
    shifted = std::max(shifted, largest(particles(Accumulation::shifted), particles(Accumulation::twofold)));
    plain_contacts = std::max(plain_contacts, largest(contacts(Accumulation::single), contacts(Accumulation::twofold)));
    shifted_contacts =
        std::max(shifted_contacts, largest(contacts(Accumulation::shifted), contacts(Accumulation::twofold)));
  }
  EXPECT_LT(shifted, 1e-5);
  EXPECT_GT(plain, 3e-5);
  EXPECT_LT(shifted_contacts, 1e-5);
  EXPECT_GT(plain_contacts, 3e-5);
}

}  // namespace
}  // namespace grainvdb::accumulate_test
