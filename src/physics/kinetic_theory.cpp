#include <cmath>
#include <limits>
#include <numbers>

#include "grainvdb/laws.hpp"

namespace grainvdb {
namespace {

const double sqrt_pi = std::sqrt(std::numbers::pi);

}  // namespace

double KineticTheory::g(double nu) {
  if (!(nu > 0 && nu < 1)) return std::numeric_limits<double>::quiet_NaN();
  const double free = 1 - nu;
  return nu * (2 - nu) / (2 * free * free * free);
}

double KineticTheory::f(double nu) const {
  return (1 + e_) / 2 + 1 / (4 * g(nu));
}

double KineticTheory::j(double nu) const {
  const double gg = g(nu);
  const double above = (5 + 2 * (1 + e_) * (3 * e_ - 1) * gg) * (5 + 4 * (1 + e_) * gg);
  const double below = (24 - 6 * (1 - e_) * (1 - e_) - 5 * (1 - e_ * e_)) * gg * gg;
  return (1 + e_) / 2 + std::numbers::pi / 32 * above / below;
}

double KineticTheory::f1(double nu) const {
  return 4 * nu * g(nu) * f(nu);
}

double KineticTheory::f2(double nu) const {
  return 8 * j(nu) * nu * g(nu) / (5 * sqrt_pi);
}

double KineticTheory::f3(double nu) const {
  return 12 * (1 - e_ * e_) * nu * g(nu) / sqrt_pi;
}

double KineticTheory::steady_shear_pressure(double nu) const {
  return f1(nu) * f2(nu) / f3(nu);
}

}  // namespace grainvdb
