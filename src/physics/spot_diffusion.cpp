#include "grainvdb/spot_diffusion.hpp"

#include <cmath>
#include <cstddef>
#include <stdexcept>

namespace grainvdb {
namespace {

/// The places i of a walk of n steps ±1, i = -n, -n + 2, …, n, within `reach` of 0, as f(i, probability).
template <class F>
void for_each_place(int n, double reach, const F& f) {
  const double all = std::lgamma(n + 1.0) - n * std::log(2.0);
  for (int k = 0; k <= n; ++k) {
    const int place = 2 * k - n;
    if (std::abs(place) <= reach) f(place, std::exp(all - std::lgamma(k + 1.0) - std::lgamma(n - k + 1.0)));
  }
}

/// ⟨Ω(D + Δx) + Ω(D - Δx) - 2Ω(D)⟩/4 for steps m apart: m - 1 whole steps lie between, and half of each of the two.
double correlation(const SpotWalk& walk, int m) {
  const auto& [dx, dy, dz] = walk.step;
  const double beyond = 2 * walk.radius, z = m * dz;
  const auto places = [beyond](double step) { return step > 0 ? beyond / step + 2 : 1e9; };
  double sum = 0;
  for_each_place(m - 1, places(dy), [&](int whole, double of_whole) {
    for (const int halves : {-1, 0, 1}) {
      const double y = (whole + halves) * dy, weight = of_whole * (halves == 0 ? 0.5 : 0.25);
      for_each_place(m - 1, places(dx), [&](int i, double of_place) {
        const auto overlap = [&](double x) { return ball_overlap(std::sqrt(x * x + y * y + z * z), walk.radius); };
        sum += weight * of_place * (overlap((i + 1) * dx) + overlap((i - 1) * dx) - 2 * overlap(i * dx)) / 4;
      });
    }
  });
  return sum;
}

}  // namespace

double ball_overlap(double distance, double radius) {
  const double q = distance / radius;
  return q >= 0 && q < 2 ? 1 - 0.75 * q + 0.0625 * q * q * q : 0;
}

DiffusionShare::DiffusionShare(const SpotWalk& walk) {
  if (!(walk.radius > 0) || !(walk.step[2] > 0))
    throw std::invalid_argument("a spot needs a radius > 0 and steps that go up");
  for (int m = 1; m * walk.step[2] < 2 * walk.radius; ++m) correlation_.push_back(correlation(walk, m));
}

double DiffusionShare::after(double steps) const {
  if (!(steps > 0)) return 1;
  // ⟨max(K - m, 0)⟩ falls by P(K ≥ m) from one m to the next.
  double sum = 0, beyond = steps, below = 0;
  for (std::size_t k = 0; k < correlation_.size(); ++k) {
    const auto fewer = static_cast<double>(k);
    below += std::exp(fewer * std::log(steps) - steps - std::lgamma(fewer + 1));  // P(K ≤ k)
    beyond -= 1 - below;
    sum += beyond * correlation_[k];
  }
  return 1 + 2 * sum / steps;
}

double DiffusionShare::finally() const {
  double sum = 0;
  for (const double c : correlation_) sum += c;
  return 1 + 2 * sum;
}

}  // namespace grainvdb
