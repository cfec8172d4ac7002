#include "support/kernel_sums.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

namespace grainvdb::testing {
namespace {

double dot(const Vec3& a, const Vec3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Vec3 along(const Vec3& d, double s, const Vec3& a) {
  return {d[0] + s * a[0], d[1] + s * a[1], d[2] + s * a[2]};
}

/// The images of a difference along one axis that lie within `reach`.
struct Images {
  std::array<double, 5> value;
  int count = 0;
};
Images images(const Box& box, std::size_t axis, double d, double reach) {
  Images result;
  if (!box.periodic[axis]) {
    if (std::abs(d) < reach) result.value[static_cast<std::size_t>(result.count++)] = d;
    return result;
  }
  const double l = box.hi[axis] - box.lo[axis];
  const double nearest = d - l * std::round(d / l);
  for (int k = -2; k <= 2; ++k)
    if (const double image = nearest + k * l; std::abs(image) < reach)
      result.value[static_cast<std::size_t>(result.count++)] = image;
  return result;
}

/// Calls f(d) for every image d of x - start with |d_a| < reach_a.
template <class F>
void for_each_image(const Box& box, const Vec3& x, const Vec3& start, const Vec3& reach, F&& f) {
  std::array<Images, 3> axis;
  for (std::size_t a = 0; a < 3; ++a) {
    axis[a] = images(box, a, x[a] - start[a], reach[a]);
    if (axis[a].count == 0) return;
  }
  for (int i = 0; i < axis[0].count; ++i)
    for (int j = 0; j < axis[1].count; ++j)
      for (int k = 0; k < axis[2].count; ++k)
        f(Vec3{axis[0].value[static_cast<std::size_t>(i)], axis[1].value[static_cast<std::size_t>(j)],
               axis[2].value[static_cast<std::size_t>(k)]});
}

Vec3 position(const Particles& p, std::size_t i) {
  return {p.position[0][i], p.position[1][i], p.position[2][i]};
}

/// Σ over particles of q ⊗ (the values that `weights(d, r)` gives); `width` of them.
template <class Weights>
Sums sum_over_particles(const VoxelBox& box, double cutoff, const Particles& p, const std::vector<double>& q,
                        int values, int width, const Weights& weights) {
  Sums sums(box.size(), values * width);
  for (std::size_t n = 0; n < box.size(); ++n) {
    const Vec3 x = box.centre(n);
    for (std::size_t i = 0; i < p.size(); ++i)
      for_each_image(box.box(), x, position(p, i), {cutoff, cutoff, cutoff}, [&](const Vec3& d) {
        const double r = std::sqrt(dot(d, d));
        if (!(r < cutoff)) return;
        sums.reached[n] = 1;
        const auto w = weights(d, r);
        for (int v = 0; v < values; ++v)
          for (int j = 0; j < width; ++j) {
            const double term =
                q[i * static_cast<std::size_t>(values) + static_cast<std::size_t>(v)] * w[static_cast<std::size_t>(j)];
            const std::size_t at = sums.index(n, v * width + j);
            sums.value[at] += term;
            sums.magnitude[at] += std::abs(term);
          }
      });
  }
  return sums;
}

double gauss_rule(const Vec3& d, const Vec3& a, double cutoff, const Quadrature& rule) {
  double sum = 0;
  for (std::size_t g = 0; g < rule.node.size(); ++g) {
    const Vec3 x = along(d, rule.node[g], a);
    sum += rule.weight[g] * lucy(std::sqrt(dot(x, x)), cutoff);
  }
  return sum;
}

bool segment_reaches(const Vec3& d, const Vec3& a, double cutoff) {
  const double a2 = dot(a, a);
  const double s = a2 > 0 ? std::clamp(-dot(d, a) / a2, 0.0, 1.0) : 0.0;
  const Vec3 x = along(d, s, a);
  return std::sqrt(dot(x, x)) < cutoff;
}

}  // namespace

Sums& Sums::operator+=(const Sums& o) {
  for (std::size_t n = 0; n < value.size(); ++n) {
    value[n] += o.value[n];
    magnitude[n] += o.magnitude[n];
  }
  for (std::size_t n = 0; n < reached.size(); ++n) reached[n] += o.reached[n];
  return *this;
}

double lucy(double r, double cutoff) {
  const double q = r / cutoff;
  if (q >= 1) return 0;
  const double p = 1 - q;
  return 105 / (16 * std::numbers::pi * cutoff * cutoff * cutoff) * p * p * p * (1 + 3 * q);
}

Quadrature gauss_legendre(int n) {
  Quadrature rule;
  for (int i = 0; i < n; ++i) {
    double x = std::cos(std::numbers::pi * (i + 0.75) / (n + 0.5));
    double slope = 0;
    for (int iteration = 0; iteration < 100; ++iteration) {
      double p0 = 1;
      double p1 = x;
      for (int k = 2; k <= n; ++k) {
        const double p2 = ((2 * k - 1) * x * p1 - (k - 1) * p0) / k;
        p0 = p1;
        p1 = p2;
      }
      slope = n * (x * p1 - p0) / (x * x - 1);
      const double step = p1 / slope;
      x -= step;
      if (std::abs(step) < 1e-16) break;
    }
    rule.node.push_back(0.5 * (1 + x));
    rule.weight.push_back(1 / ((1 - x * x) * slope * slope));
  }
  return rule;
}

double line_mean(const Vec3& d, const Vec3& a, double cutoff) {
  static const Quadrature rule = gauss_legendre(20);
  const double length = std::sqrt(dot(a, a));
  if (length == 0) return lucy(std::sqrt(dot(d, d)), cutoff);
  const double foot = -dot(d, a) / (length * length);
  const Vec3 nearest = along(d, foot, a);
  const double b = std::sqrt(dot(nearest, nearest));
  if (b >= cutoff) return 0;
  const double rim = std::sqrt((cutoff - b) * (cutoff + b)) / length;
  const double lo = std::max(0.0, foot - rim);
  const double hi = std::min(1.0, foot + rim);
  if (lo >= hi) return 0;

  std::vector<double> ends{lo, hi};
  for (double t : {0.0, 1.0, 4.0, 16.0})
    for (double side : {-1.0, 1.0})
      if (const double s = foot + side * t * b / length; s > lo && s < hi) ends.push_back(s);
  std::sort(ends.begin(), ends.end());
  double sum = 0;
  for (std::size_t k = 0; k + 1 < ends.size(); ++k)
    for (std::size_t g = 0; g < rule.node.size(); ++g) {
      const double s = ends[k] + (ends[k + 1] - ends[k]) * rule.node[g];
      const Vec3 x = along(d, s, a);
      sum += rule.weight[g] * (ends[k + 1] - ends[k]) * lucy(std::sqrt(dot(x, x)), cutoff);
    }
  return sum;
}

Branches branches_of(const Frame& frame) {
  std::map<std::int64_t, std::size_t> row;
  for (std::size_t i = 0; i < frame.particles.size(); ++i) row[frame.particles.id[i]] = i;
  Branches b;
  for (std::size_t k = 0; k < frame.contacts.size(); ++k)
    for (const double sign : {1.0, -1.0}) {
      const Vec3 x = position(frame.particles, row.at(sign > 0 ? frame.contacts.id1[k] : frame.contacts.id2[k]));
      Vec3 arm;
      Vec3 force;
      for (std::size_t a = 0; a < 3; ++a) {
        arm[a] = x[a] - frame.contacts.point[a][k];
        const double l = frame.box.hi[a] - frame.box.lo[a];
        if (frame.box.periodic[a]) arm[a] -= l * std::round(arm[a] / l);
        force[a] = sign * frame.contacts.force[a][k];
      }
      b.start.push_back(x);
      b.arm.push_back(arm);
      b.force.push_back(force);
    }
  return b;
}

Sums particle_sums(const VoxelBox& box, double cutoff, const Particles& p, const std::vector<double>& q, int channels) {
  return sum_over_particles(box, cutoff, p, q, channels, 1,
                            [&](const Vec3&, double r) { return std::array{lucy(r, cutoff)}; });
}

Sums square_sums(const VoxelBox& box, double cutoff, const Particles& p, const std::vector<double>& q, int channels) {
  return sum_over_particles(box, cutoff, p, q, channels, 1,
                            [&](const Vec3&, double r) { return std::array{lucy(r, cutoff) * lucy(r, cutoff)}; });
}

double lucy_of_images(const Box& box, const Vec3& d, double cutoff) {
  double sum = 0;
  for_each_image(box, d, {0, 0, 0}, {cutoff, cutoff, cutoff},
                 [&](const Vec3& image) { sum += lucy(std::sqrt(dot(image, image)), cutoff); });
  return sum;
}

Sums gradient_sums(const VoxelBox& box, double cutoff, const Particles& p, const std::vector<double>& q, int values) {
  const double scale = -1260 / (16 * std::numbers::pi * std::pow(cutoff, 5));
  return sum_over_particles(box, cutoff, p, q, values, 3, [&](const Vec3& d, double r) {
    const double rim = 1 - r / cutoff;
    const double factor = scale * rim * rim;
    return std::array{factor * d[0], factor * d[1], factor * d[2]};
  });
}

namespace {

/// Σ q weight(d, a) over the images of branches that reach a voxel, d from the branch's start.
template <class Weight>
Sums sum_over_branches(const VoxelBox& box, double cutoff, const Branches& b, const std::vector<double>& q,
                       int channels, const Weight& weight) {
  Sums sums(box.size(), channels);
  for (std::size_t n = 0; n < box.size(); ++n) {
    const Vec3 x = box.centre(n);
    for (std::size_t i = 0; i < b.size(); ++i) {
      const Vec3 reach{cutoff + std::abs(b.arm[i][0]), cutoff + std::abs(b.arm[i][1]), cutoff + std::abs(b.arm[i][2])};
      for_each_image(box.box(), x, b.start[i], reach, [&](const Vec3& d) {
        if (!segment_reaches(d, b.arm[i], cutoff)) return;
        const double w = weight(d, b.arm[i]);
        sums.reached[n] = 1;
        for (int c = 0; c < channels; ++c) {
          const double term = q[i * static_cast<std::size_t>(channels) + static_cast<std::size_t>(c)] * w;
          const std::size_t at = sums.index(n, c);
          sums.value[at] += term;
          sums.magnitude[at] += std::abs(term);
        }
      });
    }
  }
  return sums;
}

}  // namespace

Sums branch_sums(const VoxelBox& box, double cutoff, const Branches& b, const std::vector<double>& q, int channels,
                 int gauss_points) {
  if (gauss_points == 0)
    return sum_over_branches(box, cutoff, b, q, channels,
                             [&](const Vec3& d, const Vec3& a) { return line_mean(d, a, cutoff); });
  const Quadrature rule = gauss_legendre(gauss_points);
  return sum_over_branches(box, cutoff, b, q, channels,
                           [&](const Vec3& d, const Vec3& a) { return gauss_rule(d, a, cutoff, rule); });
}

Sums branch_magnitudes(const VoxelBox& box, double cutoff, const Branches& b, const std::vector<double>& q,
                       int channels) {
  return sum_over_branches(box, cutoff, b, q, channels, [](const Vec3&, const Vec3&) { return 1.0; });
}

}  // namespace grainvdb::testing
