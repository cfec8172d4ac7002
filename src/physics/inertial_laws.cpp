#include <cmath>

#include "grainvdb/laws.hpp"

namespace grainvdb {

double FrictionLaw::operator()(double inertial_number) const {
  return mu_0 + (mu_infinity - mu_0) * inertial_number / (i_0 + inertial_number);
}

double SoftFrictionLaw::operator()(double inertial_number, double soft_pressure) const {
  return hard(inertial_number) * (1 - std::sqrt(soft_pressure / p_0));
}

// With a = ν_c(1+p*/p_c*) and b = aI/I_c the law is ν + b√ν - a = 0, so √ν = (-b+√(b²+4a))/2; written so that nothing
// cancels when b² ≫ a.
double PackingLaw::operator()(double inertial_number, double soft_pressure) const {
  const double a = nu_c * (1 + soft_pressure / p_c);
  const double b = a * inertial_number / i_c;
  const double root = 2 * a / (b + std::sqrt(b * b + 4 * a));
  return root * root;
}

}  // namespace grainvdb
