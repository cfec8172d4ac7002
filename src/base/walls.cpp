#include "grainvdb/walls.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "base/vec3.hpp"

namespace grainvdb {
namespace {

Vec3 combined(double s, const Vec3& a, double t, const Vec3& b) {
  return {s * a[0] + t * b[0], s * a[1] + t * b[1], s * a[2] + t * b[2]};
}
Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Vec3 unit(const Vec3& a) {
  const double length = std::sqrt(dot(a, a));
  return {a[0] / length, a[1] / length, a[2] / length};
}
/// Some unit vector across a unit vector.
Vec3 across(const Vec3& a) {
  const std::size_t least = std::abs(a[0]) <= std::abs(a[1]) && std::abs(a[0]) <= std::abs(a[2]) ? 0
                            : std::abs(a[1]) <= std::abs(a[2])                                   ? 1
                                                                                                 : 2;
  Vec3 axis{};
  axis[least] = 1;
  return unit(cross(a, axis));
}

/// Where a point lies about the axis of a cylinder or cone.
struct AboutAxis {
  double along;    ///< from the wall's point
  double outward;  ///< from the axis
  Vec3 radial;     ///< unit vector; any across the axis for points on it
};
AboutAxis about_axis(const Wall& w, const Vec3& x) {
  const Vec3 y = combined(1, x, -1, w.point);
  const double along = dot(y, w.direction);
  const Vec3 off = combined(1, y, -along, w.direction);
  const double outward = std::sqrt(dot(off, off));
  return {along, outward, outward > 0 ? combined(1 / outward, off, 0, off) : across(w.direction)};
}

/// The distance from one wall, positive on the material's side.
double distance_from(const Wall& w, const Vec3& x) {
  if (w.shape == Wall::Shape::plane) return dot(combined(1, x, -1, w.point), w.direction);
  const AboutAxis at = about_axis(w, x);
  const double sine = std::sin(w.angle);
  const double cosine = std::cos(w.angle);
  double inward = w.radius - at.outward;
  if (w.shape == Wall::Shape::cone) {
    // Behind the apex the apex itself is nearest.
    const bool behind = at.along * cosine + at.outward * sine < 0;
    inward = behind ? -std::hypot(at.along, at.outward) : at.along * sine - at.outward * cosine;
  }
  return w.encloses ? inward : -inward;
}

/// The direction in which the distance grows.
Vec3 normal_at(const Wall& w, const Vec3& x) {
  if (w.shape == Wall::Shape::plane) return w.direction;
  const AboutAxis at = about_axis(w, x);
  const double sign = w.encloses ? 1 : -1;
  if (w.shape == Wall::Shape::cylinder) return combined(-sign, at.radial, 0, at.radial);
  return combined(sign * std::sin(w.angle), w.direction, -sign * std::cos(w.angle), at.radial);
}

/// Calls f(t) for the real roots of a t² + 2 b t + c.
template <class F>
void for_each_root(double a, double b, double c, const F& f) {
  const double discriminant = b * b - a * c;
  if (!(discriminant >= 0)) return;
  const double q = -(b + std::copysign(std::sqrt(discriminant), b));
  if (a != 0) f(q / a);
  if (q != 0) f(c / q);
}

/// Calls f(t) for every t where the line x + t e may cross a wall.
template <class F>
void for_each_crossing(const Wall& w, const Vec3& x, const Vec3& e, const F& f) {
  const Vec3 y = combined(1, x, -1, w.point);
  const double y_along = dot(y, w.direction);
  const double e_along = dot(e, w.direction);
  if (w.shape == Wall::Shape::plane) {
    if (e_along != 0) f(-y_along / e_along);
  } else if (w.shape == Wall::Shape::cylinder) {
    for_each_root(1 - e_along * e_along, dot(y, e) - y_along * e_along,
                  dot(y, y) - y_along * y_along - w.radius * w.radius, f);
  } else {
    const double k = std::cos(w.angle) * std::cos(w.angle);
    for_each_root(e_along * e_along - k, y_along * e_along - k * dot(y, e), y_along * y_along - k * dot(y, y), f);
  }
}

/// The walls near one point, seen along rays from it.
class Rays {
 public:
  Rays(const LucyKernel& kernel, const std::vector<const Wall*>& near, const Vec3& x)
      : kernel_(kernel), near_(near), x_(x) {}

  /// The part of the kernel along a ray that lies on the right side of all walls: ∫ 4π r² W dr over it.
  double inside(const Vec3& e) {
    cuts_.assign({0, kernel_.cutoff()});
    for (const Wall* w : near_)
      for_each_crossing(*w, x_, e, [&](double t) {
        if (t > 0 && t < kernel_.cutoff()) cuts_.push_back(t);
      });
    std::sort(cuts_.begin(), cuts_.end());
    double sum = 0;
    for (std::size_t k = 1; k < cuts_.size(); ++k) {
      const Vec3 middle = combined(1, x_, 0.5 * (cuts_[k - 1] + cuts_[k]), e);
      if (std::all_of(near_.begin(), near_.end(), [&](const Wall* w) { return distance_from(*w, middle) >= 0; }))
        sum += kernel_.radial_integral(cuts_[k]) - kernel_.radial_integral(cuts_[k - 1]);
    }
    return sum;
  }

 private:
  const LucyKernel& kernel_;
  const std::vector<const Wall*>& near_;
  Vec3 x_;
  std::vector<double> cuts_;
};

/// Mean over all directions: Gauss-Legendre in the cosine from the nearest wall's normal, equal steps around it. The
/// intervals of the cosine end where a plane leaves the support.
double mean_over_directions(Rays rays, const Vec3& normal, double distance_in_cutoffs) {
  constexpr int around = 32;
  constexpr int parts = 2;  // of each interval
  const Vec3 u = across(normal);
  const Vec3 v = cross(normal, u);
  const double rim = std::clamp(-std::abs(distance_in_cutoffs), -1.0, 1.0);
  const std::array<double, 4> ends{-1, rim, -rim, 1};
  double sum = 0;
  for (std::size_t k = 1; k < ends.size(); ++k)
    for (int part = 0; part < parts; ++part) {
      const double half = (ends[k] - ends[k - 1]) / (2 * parts);
      const double middle = ends[k - 1] + half * (2 * part + 1);
      if (half == 0) continue;
      for (const LineNode& node : gauss_rule(8)) {
        const double cosine = middle + half * node.x;
        const double sine = std::sqrt(1 - cosine * cosine);
        double ring = 0;
        for (int i = 0; i < around; ++i) {
          const double angle = 2 * std::numbers::pi * (i + 0.5) / around;
          const Vec3 flat = combined(sine * std::cos(angle), u, sine * std::sin(angle), v);
          ring += rays.inside(combined(1, flat, cosine, normal));
        }
        sum += 0.5 * half * node.weight * ring / around;
      }
    }
  return sum;
}

/// Whether the walls are planes that cut nothing off twice: one, or two that face each other.
bool cut_apart(const std::vector<const Wall*>& walls) {
  for (const Wall* w : walls)
    if (w->shape != Wall::Shape::plane) return false;
  return walls.size() == 1 || (walls.size() == 2 && dot(walls[0]->direction, walls[1]->direction) < -1 + 1e-12);
}

}  // namespace

// Planes that touch a cone go through its apex. Behind the apex of a cone with the material around it, the apex is
// nearest.
HalfSpace half_space_at(const Wall& w, const Vec3& x) {
  Vec3 normal = normal_at(w, x);
  if (w.shape == Wall::Shape::cone && !w.encloses) {
    const AboutAxis at = about_axis(w, x);
    if (at.along * std::cos(w.angle) + at.outward * std::sin(w.angle) < 0) normal = unit(combined(1, x, -1, w.point));
  }
  const double beyond_axis = w.shape == Wall::Shape::cylinder ? (w.encloses ? -w.radius : w.radius) : 0;
  return {normal, dot(normal, w.point) + beyond_axis};
}

Vec3 inward_normal(const BoxFace& face) {
  Vec3 normal{};
  normal[static_cast<std::size_t>(face.axis)] = face.high ? -1 : 1;
  return normal;
}

WallDomain::WallDomain(std::vector<Wall> walls) : walls_(std::move(walls)) {
  for (Wall& w : walls_) {
    const double length = std::sqrt(dot(w.direction, w.direction));
    if (!(length > 0) || !std::isfinite(length))
      throw std::invalid_argument("the direction of a wall must be finite and not zero");
    w.direction = unit(w.direction);
    if (w.shape == Wall::Shape::cylinder && !(w.radius > 0))
      throw std::invalid_argument("the radius of a cylinder must be positive");
    if (w.shape == Wall::Shape::cone && !(w.angle > 0 && w.angle < std::numbers::pi / 2))
      throw std::invalid_argument("the half opening angle of a cone must lie between 0 and pi/2");
  }
}

double WallDomain::distance(const Vec3& x) const {
  double least = std::numeric_limits<double>::infinity();
  for (const Wall& w : walls_) least = std::min(least, distance_from(w, x));
  return least;
}

double WallDomain::inside_fraction(const LucyKernel& kernel, const Vec3& x) const {
  std::vector<const Wall*> near;
  const Wall* nearest = nullptr;
  double least = kernel.cutoff();
  for (const Wall& w : walls_) {
    const double d = distance_from(w, x);
    if (d <= -kernel.cutoff()) return 0;
    if (d >= kernel.cutoff()) continue;
    near.push_back(&w);
    if (nearest == nullptr || d < least) {
      nearest = &w;
      least = d;
    }
  }
  if (near.empty()) return 1;
  if (cut_apart(near)) {
    double inside = 1;
    for (const Wall* w : near) inside -= 0.5 - kernel.marginal_integral(distance_from(*w, x));
    return std::max(inside, 0.0);
  }
  return mean_over_directions(Rays(kernel, near, x), normal_at(*nearest, x), least / kernel.cutoff());
}

}  // namespace grainvdb
