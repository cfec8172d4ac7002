#pragma once
/// Laws from the literature to compare measured fields with: pure functions of pure numbers (physics section 4).
#include <array>
#include <string_view>

namespace grainvdb {

/// F(φ) = A - [(φ-B) + √((φ-B)²+C)]/D (A20), the law of gd/δv: a plateau A for φ ≪ B, a fall of slope -2/D for φ ≫ B,
/// joined over a width √C. Finite for any φ; negative beyond zero(), where it no longer describes anything. C ≥ 0, D >
/// 0.
struct FluidityLaw {
  double a = 0;
  double b = 0;
  double c = 0;
  double d = 0;

  double operator()(double phi) const;
  /// The φ at which F(φ) = 0: B + (AD - C/(AD))/2.
  double zero() const;
  bool operator==(const FluidityLaw&) const = default;
};

/// The law of Zhang and Kamrin, (3): A = 2, B = 0.58, C = 1.54e-4, D = 0.048.
inline constexpr FluidityLaw zhang_kamrin_law{2, 0.58, 1.54e-4, 0.048};

/// One row of Table IV: a fit of (A20) to a shear cell.
struct FluidityFit {
  std::string_view name;  ///< what was varied: mu_p friction, mu_r rolling friction (0.05), gamma_t tangential damping
  FluidityLaw law;
};
/// Table IV, in its order.
inline constexpr std::array<FluidityFit, 9> fluidity_fits{{
    {"mu_p = 0.1", {2.58, 0.625, 1.36e-4, 0.00719}},
    {"mu_p = 0.1, mu_r = 0.05", {2.43, 0.608, 1.32e-4, 0.0196}},
    {"mu_p = 0.2", {2.39, 0.599, 2.03e-4, 0.0293}},
    {"mu_p = 0.4", {2.00, 0.584, 0.845e-4, 0.0377}},
    {"mu_p = 0.4, mu_r = 0.05", {1.94, 0.568, 0.319e-4, 0.0565}},
    {"mu_p = 0.6", {1.96, 0.578, 3.30e-4, 0.0449}},
    {"mu_p = 0.8", {1.83, 0.570, 1.53e-4, 0.0537}},
    {"mu_p = 0.8, mu_r = 0.05", {1.75, 0.554, 0.319e-4, 0.0732}},
    {"gamma_t > 0", {1.90, 0.605, 7.27e-4, 0.0215}},
}};

/// μ(I) = μ₀ + (μ_∞-μ₀)/(I₀/I+1), I ≥ 0; μ₀ at I = 0.
struct FrictionLaw {
  double mu_0 = 0.12;
  double mu_infinity = 0.55;
  double i_0 = 0.2;

  double operator()(double inertial_number) const;
};

/// Soft grains: μ(I,p*) = μ(I) (1 - √(p*/p₀*)), p* = p d/k_n ≥ 0.
struct SoftFrictionLaw {
  FrictionLaw hard{};
  double p_0 = 0.9;

  double operator()(double inertial_number, double soft_pressure) const;
};

/// ν(I,p*), the packing fraction that solves ν = ν_c (1 + p*/p_c*) (1 - I √ν/I_c); I, p* ≥ 0.
struct PackingLaw {
  double i_c = 3.28;
  double p_c = 0.33;
  double nu_c = 0.636;

  double operator()(double inertial_number, double soft_pressure) const;
};

/// Kinetic theory of dense inelastic spheres (Savage, Jenkins and others, "SKT"), with T_kin = T/3:
/// p = ρ_p f₁ T_kin, τ = ρ_p d f₂ √T_kin γ̇, Γ = (ρ_p/d) f₃ T_kin^{3/2}. Valid for 0 < ν ≲ 0.5 and restitution 0 ≤ e ≤
/// 1; NaN for ν outside (0, 1).
class KineticTheory {
 public:
  explicit constexpr KineticTheory(double restitution) : e_(restitution) {}

  /// G = ν(2-ν)/[2(1-ν)³].
  static double g(double nu);
  /// F = (1+e)/2 + 1/(4G).
  double f(double nu) const;
  /// J = (1+e)/2 + (π/32) [5+2(1+e)(3e-1)G] [5+4(1+e)G] / {[24-6(1-e)²-5(1-e²)] G²}.
  double j(double nu) const;

  /// f₁ = 4νGF, the pressure.
  double f1(double nu) const;
  /// f₂ = 8JνG/(5√π), the shear stress.
  double f2(double nu) const;
  /// f₃ = 12(1-e²)νG/√π, the dissipation; 0 for elastic grains.
  double f3(double nu) const;

  /// p/(ρ_p d² γ̇²) = f₁ f₂/f₃ in steady homogeneous shear, where dissipation balances τγ̇; infinite for elastic grains.
  double steady_shear_pressure(double nu) const;

 private:
  double e_;
};

enum class Regime { quasi_static, intermediate, inertial };

/// The inertial numbers that part the regimes of flow.
struct RegimeBounds {
  double quasi_static = 1e-3;  ///< below: contacts last, stresses do not depend on the rate
  double inertial = 0.1;       ///< above: collisions, stresses rise as the square of the rate
  constexpr Regime operator()(double inertial_number) const {
    if (inertial_number < quasi_static) return Regime::quasi_static;
    return inertial_number > inertial ? Regime::inertial : Regime::intermediate;
  }
};

}  // namespace grainvdb
