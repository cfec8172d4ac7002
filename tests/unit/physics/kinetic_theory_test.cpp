#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "grainvdb/laws.hpp"
#include "unit/physics/printed.hpp"

namespace grainvdb::kinetic_theory_test {
namespace {

TEST(KineticTheory, SteadyShearPressureHasThePublishedValues) {
  const KineticTheory skt(.7);
  const double nu[] = {.1, .2, .3, .4, .5};
  const double p[] = {.3690, .3011, .4191, .7512, 1.5591};
  for (int i = 0; i < 5; ++i) EXPECT_NEAR(skt.steady_shear_pressure(nu[i]), p[i], half_a_digit(4)) << "nu = " << nu[i];
}

// p = ρ f₁ T and Γ = τγ̇ with the T that balances them.
TEST(KineticTheory, SteadyShearBalancesDissipation) {
  const KineticTheory skt(.85);
  for (double nu : {.05, .25, .45}) {
    const double t = skt.f2(nu) / skt.f3(nu);  // T_kin/(d² γ̇²)
    const double work = skt.f2(nu) * std::sqrt(t);
    const double loss = skt.f3(nu) * t * std::sqrt(t);
    EXPECT_NEAR(work, loss, 1e-14 * work);
    EXPECT_NEAR(skt.steady_shear_pressure(nu), skt.f1(nu) * t, 1e-14 * skt.f1(nu) * t);
  }
}

// Elastic spheres: f₁ is the Carnahan-Starling equation of state Z = (1+ν+ν²-ν³)/(1-ν)³, an independent form of it.
TEST(KineticTheory, ElasticPressureIsCarnahanStarling) {
  const KineticTheory elastic(1);
  for (double nu : {1e-6, .1, .3, .49}) {
    const double z = (1 + nu + nu * nu - nu * nu * nu) / std::pow(1 - nu, 3);
    EXPECT_NEAR(elastic.f1(nu), nu * z, 1e-14 * nu * z);
  }
  EXPECT_EQ(elastic.f3(.3), 0);
  EXPECT_TRUE(std::isinf(elastic.steady_shear_pressure(.3)));
}

// Dilute limit ν → 0 at e = 1: J G² → (π/32)(25/24), so f₂ → (8/(5√π)) (25π/768) = 5√π/96, Chapman and Enskog's
// viscosity.
TEST(KineticTheory, DiluteViscosity) {
  const KineticTheory elastic(1);
  EXPECT_NEAR(elastic.f2(1e-9), 5 * std::sqrt(std::numbers::pi) / 96, 1e-8);
}

TEST(KineticTheory, CorrectedSignsOfJ) {
  // By hand at ν = .3, e = .7: G = .51/.686, J = .85 + (π/32)(5+3.74 G)(5+6.8 G)/((24-.54-2.55) G²).
  const double g = .51 / .686;
  const double j = .85 + std::numbers::pi / 32 * (5 + 3.74 * g) * (5 + 6.8 * g) / (20.91 * g * g);
  EXPECT_NEAR(KineticTheory(.7).j(.3), j, 1e-14 * j);
}

TEST(KineticTheory, UndefinedOutsideItsRange) {
  const KineticTheory skt(.7);
  for (double nu : {-.1, 0.0, 1.0, 1.2}) {
    EXPECT_TRUE(std::isnan(skt.f1(nu))) << nu;
    EXPECT_TRUE(std::isnan(skt.f2(nu))) << nu;
    EXPECT_TRUE(std::isnan(skt.f3(nu))) << nu;
    EXPECT_TRUE(std::isnan(skt.steady_shear_pressure(nu))) << nu;
  }
}

}  // namespace
}  // namespace grainvdb::kinetic_theory_test
