#include "grainvdb/reduced_units.hpp"

#include <cmath>

#include "base/unit_product.hpp"

namespace grainvdb {

double ReducedUnits::size(const Dimension& quantity) const {
  const double mass = density * diameter * diameter * diameter, time = std::sqrt(diameter / gravity);
  return std::pow(mass, quantity.mass) * std::pow(diameter, quantity.length) * std::pow(time, quantity.time);
}

// Powers of g and d are whole, or both half a number more.
std::string ReducedUnits::symbol(const Dimension& quantity) {
  const int g_halves = -quantity.time, d_halves = 2 * (3 * quantity.mass + quantity.length) + quantity.time;
  UnitProduct product;
  product.multiply("rho_p", quantity.mass);
  product.multiply("g", g_halves / 2);
  product.multiply("d", d_halves / 2);
  if (g_halves % 2 != 0) {
    const bool g_above = g_halves > 0, d_above = d_halves > 0;
    if (g_above == d_above) {
      product.multiply("sqrt(g d)", g_above ? 1 : -1);
    } else {
      product.multiply(g_above ? "sqrt(g/d)" : "sqrt(d/g)", 1);
    }
  }
  return product.text();
}

}  // namespace grainvdb
