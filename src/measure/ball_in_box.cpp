#include "measure/ball_in_box.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace grainvdb {
namespace {

constexpr double pi = std::numbers::pi;

double root(double x) {
  return std::sqrt(std::max(0.0, x));
}

/// acos and asin of what may lie outside [-1, 1] by rounding.
double arc_cos(double x) {
  return std::acos(std::clamp(x, -1.0, 1.0));
}
double arc_sin(double x) {
  return std::asin(std::clamp(x, -1.0, 1.0));
}

/// Beyond a plane at distance a < r.
double cap(double r, double a) {
  return pi * (r - a) * (r - a) * (2 * r + a) / 3;
}

/// The angle between the circles that two planes cut out of the sphere, where these meet.
double corner_angle(double r, double a, double b) {
  return arc_cos(a * b / (root(r * r - a * a) * root(r * r - b * b)));
}

/// Part of the disc of radius s beyond b.
double segment(double s, double b) {
  return s * s * arc_cos(b / s) - b * root(s * s - b * b);
}

/// Part of the disc of radius s beyond b along one axis and c along the other.
double corner_of_disc(double s, double b, double c) {
  const double end = root(s * s - c * c);
  return 0.5 * (end * c - b * root(s * s - b * b) + s * s * (arc_sin(end / s) - arc_sin(b / s))) - c * (end - b);
}

/// Beyond two planes at right angles, a² + b² < r².
double double_cap(double r, double a, double b) {
  const double sa = root(r * r - a * a), sb = root(r * r - b * b);
  const double area = 2 * r * (r * corner_angle(r, a, b) - a * arc_cos(b / sa) - b * arc_cos(a / sb));
  return (r * area - a * segment(sa, b) - b * segment(sb, a)) / 3;
}

/// Beyond three planes at right angles, a² + b² + c² < r².
double triple_cap(double r, double a, double b, double c) {
  const double sa = root(r * r - a * a), sb = root(r * r - b * b), sc = root(r * r - c * c);
  const double area = r * (r * (corner_angle(r, a, b) + corner_angle(r, b, c) + corner_angle(r, c, a) - pi) -
                           a * (arc_cos(b / sa) - arc_sin(c / sa)) - b * (arc_cos(c / sb) - arc_sin(a / sb)) -
                           c * (arc_cos(a / sc) - arc_sin(b / sc)));
  return (r * area - a * corner_of_disc(sa, b, c) - b * corner_of_disc(sb, c, a) - c * corner_of_disc(sc, a, b)) / 3;
}

}  // namespace

double ball_in_box(double r, const FaceDistances& faces) {
  double volume = 4 * pi / 3 * r * r * r;
  const double r2 = r * r;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (const double a : faces[axis]) {
      if (a >= r) continue;
      volume -= cap(r, a);
      for (const double b : faces[(axis + 1) % 3])
        if (a * a + b * b < r2) volume += double_cap(r, a, b);
    }
  for (const double a : faces[0])
    for (const double b : faces[1])
      for (const double c : faces[2])
        if (a * a + b * b + c * c < r2) volume -= triple_cap(r, a, b, c);
  return volume;
}

}  // namespace grainvdb
