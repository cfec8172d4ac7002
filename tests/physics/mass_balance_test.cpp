// ∂ρ/∂t = -∇·(Σ m v W) holds exactly; with frames Δt apart the residual falls as Δt².
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "support/run_in_memory.hpp"

namespace grainvdb::testing::mass_balance_test {
namespace {

constexpr double cutoff = 2;
constexpr double voxel = 0.125;
constexpr int inner = 16;  // voxels from the middle to the rim of what is balanced

/// Grains of different mass that fly freely through a box, at one time.
Frame flying(double time) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> along(-6, 6), speed(-1, 1), size(0.4, 0.6);
  Frame frame;
  frame.box = {{-20, -20, -20}, {20, 20, 20}, {false, false, false}};
  frame.time = time;
  frame.step = std::lround(1000 * (time + 10));
  Particles& p = frame.particles;
  for (int i = 0; i < 1500; ++i) {
    p.id.push_back(i + 1);
    p.type.push_back(1);
    p.radius.push_back(size(random));
    p.mass.push_back(2 * std::pow(p.radius.back(), 3));
    for (std::size_t a = 0; a < 3; ++a) {
      const double at = along(random), v = speed(random);
      p.position[a].push_back(at + v * time);
      p.velocity[a].push_back(v);
      p.angular_velocity[a].push_back(0);
    }
  }
  return frame;
}

/// Density and momentum at -Δt, 0 and Δt, on voxels around the middle.
class Balance {
 public:
  explicit Balance(double dt) : dt_(dt) {
    Pipeline p = make_pipeline(voxel, {0, 0, 0}, cutoff, {"density", "velocity"});
    set_option(p, "velocity", "weighting", std::string("mass"));
    p.window = 1;
    p.region = {{-2.5, -2.5, -2.5}, {2.5, 2.5, 2.5}};
    times_ = run(p, {flying(-dt), flying(0), flying(dt)}).record.times;
  }

  /// rms over the voxels of ∂ρ/∂t + ∇·(ρu), over that of ∂ρ/∂t.
  double residual() const {
    double wrong = 0, all = 0;
    for (int x = -inner; x < inner; ++x)
      for (int y = -inner; y < inner; ++y)
        for (int z = -inner; z < inner; ++z) {
          const Coord c{x, y, z};
          const double rate = (density(2, c) - density(0, c)) / (2 * dt_);
          wrong += std::pow(rate + divergence(c), 2);
          all += rate * rate;
        }
    return std::sqrt(wrong / all);
  }

 private:
  double density(std::size_t time, const Coord& c) const {
    return static_cast<double>(times_[time].field("density").at(c));
  }
  /// By central differences of order 4: 6e-4 of the rate are missing, whatever Δt is.
  double divergence(const Coord& c) const {
    double sum = 0;
    for (int a = 0; a < 3; ++a) {
      const auto flux = [&](int by) {
        const Coord there{c.x + (a == 0 ? by : 0), c.y + (a == 1 ? by : 0), c.z + (a == 2 ? by : 0)};
        return density(1, there) * static_cast<double>(times_[1].field("velocity").at(there, a));
      };
      sum += (8 * (flux(1) - flux(-1)) - (flux(2) - flux(-2))) / (12 * voxel);
    }
    return sum;
  }

  double dt_;
  std::vector<Written> times_;
};

TEST(MassBalance, ResidualFallsAsTheSquareOfTheTimeBetweenFrames) {
  const double coarse = Balance(0.5).residual(), middle = Balance(0.25).residual(), fine = Balance(0.125).residual();
  // Another packing, summed directly with the exact divergence, has residuals of 0.288, 0.0702 and 0.01755: quotients
  // of 4.11 and 4.00. What is missing in space, 6e-4, is 4 % of the last.
  EXPECT_NEAR(coarse / middle, 4, 0.4);
  EXPECT_NEAR(middle / fine, 4, 0.2);
  EXPECT_LT(fine, 0.03);
}

}  // namespace
}  // namespace grainvdb::testing::mass_balance_test
