#pragma once
/// Random numbers that are the same on every machine: xoshiro256++ (Blackman and Vigna 2019), seeded through
/// splitmix64.
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace grainvdb::spot {

class Random {
 public:
  explicit Random(std::uint64_t seed) {
    for (std::uint64_t& word : state_) {
      std::uint64_t z = (seed += 0x9E3779B97F4A7C15U);
      z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
      z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
      word = z ^ (z >> 31U);
    }
  }

  std::uint64_t bits() {
    const std::uint64_t result = std::rotl(state_[0] + state_[3], 23) + state_[0];
    const std::uint64_t t = state_[1] << 17U;
    state_[2] ^= state_[0];
    state_[3] ^= state_[1];
    state_[1] ^= state_[2];
    state_[0] ^= state_[3];
    state_[2] ^= t;
    state_[3] = std::rotl(state_[3], 45);
    return result;
  }
  /// Uniform in [0, 1).
  double uniform() { return static_cast<double>(bits() >> 11U) * 0x1p-53; }
  double uniform(double lo, double hi) { return lo + (hi - lo) * uniform(); }
  /// Of mean 1; finite, as 1 - uniform() > 0.
  double exponential() { return -std::log(1 - uniform()); }
  /// Uniform in 0 … n-1; the bias is below n/2^53.
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(uniform() * static_cast<double>(n)); }

 private:
  std::array<std::uint64_t, 4> state_{};
};

}  // namespace grainvdb::spot
