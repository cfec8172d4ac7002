#include "grainvdb/box.hpp"

#include <cmath>

namespace grainvdb {

double Box::wrap(int axis, double x) const {
  if (!periodic[axis]) return x;
  const double l = length(axis);
  double y = x - l * std::floor((x - lo[axis]) / l);
  // Rounding can leave y a hair outside when x lies at a bound.
  if (y < lo[axis]) y = lo[axis];
  if (y >= hi[axis]) y -= l;
  return y < lo[axis] ? lo[axis] : y;
}

double Box::minimum_image(int axis, double dx) const {
  if (!periodic[axis]) return dx;
  const double l = length(axis);
  return dx - l * std::round(dx / l);
}

}  // namespace grainvdb
