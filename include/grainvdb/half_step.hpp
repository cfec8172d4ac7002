#pragma once
/// The contact law behind dumped contact forces, as far as its normal damping goes.
#include <cstdint>
#include <optional>
#include <vector>

namespace grainvdb {

/// How the normal damping coefficient γ [mass/time] of a pair follows from the particles, m* = m_i m_j/(m_i + m_j),
/// R* = r_i r_j/(r_i + r_j), Y* = Y/(2(1 - ν²)), B = ln e/√(ln²e + π²).
enum class DampingLaw {
  rate,   ///< LAMMPS gran/hooke: γ = γ_n m*
  hooke,  ///< LIGGGHTS hooke: γ = -2B √(k m*), k = 16/15 √R* Y* (15 m* V²/(16 √R* Y*))^(1/5)
  hertz   ///< LIGGGHTS hertz: γ = -2 √(5/6) B √(S m*), S = 2 Y* √(R* δ), δ the overlap
};

/// `input.contacts.half_step` of a pipeline file.
struct HalfStep {
  DampingLaw law = DampingLaw::rate;
  double dt = 0;                          ///< of the run [time]
  double rate = 0;                        ///< γ_n [1/time]
  double youngs_modulus = 0;              ///< Y [force/length²]
  double poisson_ratio = 0;               ///< ν
  double restitution = 0;                 ///< e
  double characteristic_velocity = 0;     ///< V [length/time]
  std::optional<double> friction;         ///< μ_p; without it the tangential forces are left as they are
  std::vector<int> still_types;           ///< particles that forces do not move: a wall of grains
  std::vector<int> frozen_types;          ///< still ones that count as infinitely heavy (`fix freeze`)
  std::vector<std::int64_t> whole_steps;  ///< steps that are left as they are: the first of each `run` has v(n) itself
};

}  // namespace grainvdb
