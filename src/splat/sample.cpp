#include "splat/sample.hpp"

#include <cmath>
#include <cstdint>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>

#include "base/nan.hpp"
#include "base/parallel.hpp"
#include "splat/leaf_finder.hpp"

namespace grainvdb {
namespace {

// Numerator and denominator of a ratio at one voxel.
struct Terms {
  Vec3 numerator{};
  double denominator = 0;
};

class VoxelRatio {
 public:
  explicit VoxelRatio(const RatioView& ratio)
      : ratio_(ratio),
        shared_(ratio.numerator.topology == ratio.denominator.topology),
        numerator_(*ratio.numerator.topology),
        denominator_(*ratio.denominator.topology) {}

  Terms operator()(const Coord& c) {
    const Coord origin = leaf_origin(c);
    const int offset = leaf_offset(c);
    Terms t;
    const auto below = denominator_.leaf(origin);
    if (below) t.denominator = ratio_.denominator.block(*below, ratio_.channel)[offset];
    if (const auto above = shared_ ? below : numerator_.leaf(origin))
      for (int a = 0; a < 3; ++a) t.numerator[a] = ratio_.numerator.block(*above, ratio_.first + a)[offset];
    return t;
  }

 private:
  const RatioView& ratio_;
  bool shared_;
  LeafFinder numerator_;
  LeafFinder denominator_;
};

// Sums over the homogeneous axes, dense over the bounds of the denominator along the others.
class Profile {
 public:
  Profile(const RatioView& ratio, std::array<bool, 3> homogeneous) : homogeneous_(homogeneous) {
    const Topology& topology = *ratio.denominator.topology;
    const auto bounds = topology.bounds();
    if (!bounds) return;
    std::size_t size = 1;
    for (int a = 0; a < 3; ++a) {
      if (homogeneous[a]) continue;
      first_[a] = bounds->first[a];
      count_[a] = std::int64_t{bounds->last[a]} - bounds->first[a] + 1;
      size *= static_cast<std::size_t>(count_[a]);
    }
    sums_.resize(size);
    // Leaf after leaf in the order of the topology, so that the sums do not depend on threads.
    for (std::size_t l = 0; l < topology.leaf_count(); ++l) {
      const double* value = ratio.denominator.block(l, ratio.channel);
      topology.mask(l).for_each(
          [&](int offset) { at(voxel_at(topology.origin(l), offset))->denominator += value[offset]; });
    }
    const Topology& upper = *ratio.numerator.topology;
    for (std::size_t l = 0; l < upper.leaf_count(); ++l)
      upper.mask(l).for_each([&](int offset) {
        Terms* sum = at(voxel_at(upper.origin(l), offset));
        if (sum == nullptr) return;
        for (int a = 0; a < 3; ++a) sum->numerator[a] += ratio.numerator.block(l, ratio.first + a)[offset];
      });
  }

  Terms operator()(const Coord& c) {
    const Terms* sum = at(c);
    return sum == nullptr ? Terms{} : *sum;
  }

 private:
  // The sum that a voxel belongs to; nothing outside the bounds.
  Terms* at(const Coord& c) {
    std::size_t i = 0;
    for (int a = 0; a < 3; ++a) {
      const std::int64_t k = homogeneous_[a] ? 0 : std::int64_t{c[a]} - first_[a];
      if (k < 0 || k >= count_[a]) return nullptr;
      i = i * static_cast<std::size_t>(count_[a]) + static_cast<std::size_t>(k);
    }
    return sums_.empty() ? nullptr : &sums_[i];
  }

  std::array<bool, 3> homogeneous_;
  std::array<std::int32_t, 3> first_{};
  std::array<std::int64_t, 3> count_{1, 1, 1};
  std::vector<Terms> sums_;
};

// Where a position lies along an axis: between voxel `below`, and the next with weight `fraction`.
struct Place {
  std::int32_t below = 0;
  double fraction = 0;
};

Place place(const Lattice& lattice, int axis, double x) {
  const double u = lattice.wrap_index(axis, lattice.to_index(axis, x));
  if (!(std::abs(u) < std::numeric_limits<std::int32_t>::max() - 1))
    throw std::invalid_argument("position " + std::to_string(x) + " does not fit the voxel index range");
  const double below = std::floor(u);
  return {static_cast<std::int32_t>(below), u - below};
}

constexpr Vec3 undefined{nan, nan, nan};

// The voxels around a position with their trilinear weights, in lexicographic order.
Surroundings around(const std::array<Place, 3>& places) {
  Surroundings result;
  for (int corner = 0; corner < 8; ++corner) {
    const std::array<int, 3> step{corner >> 2, (corner >> 1) & 1, corner & 1};
    double weight = 1;
    for (int a = 0; a < 3; ++a) weight *= step[a] == 1 ? places[a].fraction : 1 - places[a].fraction;
    result[static_cast<std::size_t>(corner)] = {
        {places[0].below + step[0], places[1].below + step[1], places[2].below + step[2]}, weight};
  }
  return result;
}

// Σ over the surrounding voxels of their weight times their ratio. Voxels of no weight are not asked for.
template <class Ratio>
Vec3 interpolate(const Lattice& lattice, const std::array<Place, 3>& places, Outside outside, Ratio& ratio) {
  Vec3 result{};
  for (const Surrounding& s : around(places)) {
    if (s.weight == 0) continue;
    const Coord voxel = lattice.wrap(s.voxel);
    const Terms terms = ratio(voxel);
    if (outside == Outside::undefined && !(terms.denominator > 0)) return undefined;
    require_reached(voxel, terms.denominator);
    for (int a = 0; a < 3; ++a) result[a] += s.weight * (terms.numerator[a] / terms.denominator);
  }
  return result;
}

}  // namespace

void require_reached(const Coord& voxel, double total) {
  if (total > 0) return;
  std::ostringstream text;
  text << "a field is sampled beside voxel (" << voxel.x << ", " << voxel.y << ", " << voxel.z
       << "), which no kernel reaches";
  throw std::logic_error(text.str());
}

Surroundings surroundings(const Lattice& lattice, const Vec3& position) {
  return around({place(lattice, 0, position[0]), place(lattice, 1, position[1]), place(lattice, 2, position[2])});
}

std::vector<Vec3> sample_trilinear(const Lattice& lattice, const RatioView& ratio, const Columns3& position) {
  std::vector<Vec3> result(position[0].size());
  parallel_ranges(result.size(), [&](std::size_t begin, std::size_t end) {
    VoxelRatio at_voxel(ratio);
    for (std::size_t p = begin; p != end; ++p)
      result[p] = interpolate(
          lattice,
          {place(lattice, 0, position[0][p]), place(lattice, 1, position[1][p]), place(lattice, 2, position[2][p])},
          ratio.outside, at_voxel);
  });
  return result;
}

std::vector<Vec3> sample_profile(const Lattice& lattice, const RatioView& ratio, const Columns3& position,
                                 std::array<bool, 3> homogeneous) {
  Profile profile(ratio, homogeneous);
  std::vector<Vec3> result(position[0].size());
  parallel_ranges(result.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p != end; ++p) {
      std::array<Place, 3> places{};
      for (int a = 0; a < 3; ++a)
        if (!homogeneous[a]) places[a] = place(lattice, a, position[a][p]);
      result[p] = interpolate(lattice, places, ratio.outside, profile);
    }
  });
  return result;
}

}  // namespace grainvdb
