#include <algorithm>
#include <cmath>
#include <map>

#include "support/reference.hpp"

namespace grainvdb::testing {
namespace {

struct Ratio {
  double weight = 0;
  Vec3 sum{};
  Vec3 value() const { return {sum[0] / weight, sum[1] / weight, sum[2] / weight}; }
};

/// Linear interpolation between the lattice points around u along the axes that vary; f(corner) gives the value there.
template <class F>
Vec3 linear(const Vec3& u, std::array<bool, 3> constant, const F& f) {
  Vec3 result{};
  for (int corner = 0; corner < 8; ++corner) {
    Coord c;
    double weight = 1;
    bool skip = false;
    for (int a = 0; a < 3; ++a) {
      const auto axis = static_cast<std::size_t>(a);
      const int upper = (corner >> a) & 1;
      if (constant[axis]) {
        skip = skip || upper == 1;
        continue;
      }
      const double base = std::floor(u[axis]);
      const double t = u[axis] - base;
      weight *= upper == 1 ? t : 1 - t;
      c = shifted(c, a, static_cast<int>(base) + upper);
    }
    if (skip || weight == 0) continue;
    const Vec3 value = f(c);
    for (std::size_t a = 0; a < 3; ++a) result[a] += weight * value[a];
  }
  return result;
}

}  // namespace

std::vector<Vec3> interpolate(const VoxelBox& box, const Sums& numerator, const Sums& denominator,
                              const Columns3& position) {
  std::vector<Vec3> result;
  for (std::size_t i = 0; i < position[0].size(); ++i) {
    const Vec3 u = box.to_index_space({position[0][i], position[1][i], position[2][i]});
    result.push_back(linear(u, {false, false, false}, [&](const Coord& c) {
      const std::size_t n = box.index(c).value();
      Ratio r{denominator.at(n), {}};
      for (int a = 0; a < 3; ++a) r.sum[static_cast<std::size_t>(a)] = numerator.at(n, a);
      return r.value();
    }));
  }
  return result;
}

std::vector<double> deviation_factors(const VoxelBox& box, double cutoff, const std::vector<double>& weight,
                                      const Sums& denominator, const Columns3& position) {
  std::vector<double> result;
  const auto at = [&](std::size_t i) { return Vec3{position[0][i], position[1][i], position[2][i]}; };
  for (std::size_t i = 0; i < weight.size(); ++i) {
    double factor = 0;
    for (std::size_t j = 0; j < weight.size(); ++j) {
      const Vec3 x = at(j);
      const Vec3 share = linear(box.to_index_space(at(i)), {false, false, false}, [&](const Coord& c) {
        const Vec3 v = box.centre(c);
        const double w = lucy_of_images(box.box(), {v[0] - x[0], v[1] - x[1], v[2] - x[2]}, cutoff);
        return Vec3{weight[j] * w / denominator.at(box.index(c).value()), 0, 0};
      });
      factor += std::pow((i == j ? 1 : 0) - share[0], 2);
    }
    result.push_back(factor);
  }
  return result;
}

std::vector<Vec3> interpolate_profile(const VoxelBox& box, const Sums& numerator, const Sums& denominator,
                                      const Columns3& position, std::array<bool, 3> homogeneous) {
  // The stored voxel with its homogeneous coordinates set to zero names the profile's point.
  const auto point_of = [&](Coord c) {
    for (int a = 0; a < 3; ++a)
      if (homogeneous[static_cast<std::size_t>(a)]) c = shifted(c, a, -c[a]);
    return c;
  };
  std::map<Coord, Ratio> profile;
  for (std::size_t n = 0; n < box.size(); ++n) {
    Ratio& r = profile[point_of(box.coord(n))];
    r.weight += denominator.at(n);
    for (int a = 0; a < 3; ++a) r.sum[static_cast<std::size_t>(a)] += numerator.at(n, a);
  }
  const Coord any = box.coord(0);
  std::vector<Vec3> result;
  for (std::size_t i = 0; i < position[0].size(); ++i) {
    const Vec3 u = box.to_index_space({position[0][i], position[1][i], position[2][i]});
    result.push_back(linear(u, homogeneous, [&](Coord c) {
      for (int a = 0; a < 3; ++a)
        if (homogeneous[static_cast<std::size_t>(a)]) c = shifted(c, a, any[a] - c[a]);
      return profile.at(point_of(box.coord(box.index(c).value()))).value();
    }));
  }
  return result;
}

}  // namespace grainvdb::testing
