#pragma once
/// Random numbers that are the same on every platform (the distributions of <random> are not).
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

#include "grainvdb/box.hpp"

namespace grainvdb::testing {

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  /// Uniform in [lo, hi).
  double uniform(double lo = 0, double hi = 1) {
    return lo + (hi - lo) * static_cast<double>(engine_() >> 11U) * 0x1p-53;
  }
  /// Normal with mean 0 and variance 1.
  double normal() {
    const double radius = std::sqrt(-2 * std::log(1 - uniform()));
    return radius * std::cos(2 * std::numbers::pi * uniform());
  }
  Vec3 normal3() {
    const double x = normal();
    const double y = normal();
    return {x, y, normal()};
  }
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(uniform(0, static_cast<double>(n))); }

 private:
  std::mt19937_64 engine_;
};

}  // namespace grainvdb::testing
