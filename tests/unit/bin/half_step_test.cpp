#include "bin/half_step.hpp"

#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace grainvdb::half_step_test {
namespace {

constexpr double dt = 1e-3;

struct Grain {
  double x, v, mass, radius;
};

// Two grains that meet head-on along x, moved by velocity-Verlet steps as LIGGGHTS and LAMMPS take them: forces come
// from the positions of the step and the velocities of the half step before.
class Collision {
 public:
  // `stiffness` and `damping` are those of the pair at an overlap.
  Collision(std::function<double(double)> stiffness, std::function<double(double)> damping)
      : stiffness_(std::move(stiffness)), damping_(std::move(damping)) {}

  void step() {
    kick();
    a_.x += dt * a_.v;
    b_.x += dt * b_.v;
    force_ = force();
    kick();
  }

  double overlap() const { return a_.radius + b_.radius - (b_.x - a_.x); }
  // On a, along x.
  double force_of_run() const { return force_; }
  double force() const {
    const double d = overlap();
    return d <= 0 ? 0 : -stiffness_(d) * d - damping_(d) * (a_.v - b_.v);
  }

  // The dump of this step: the total force of the run, and the contact force with the velocities of the full step.
  Frame dump() const {
    Frame frame;
    frame.box = {{-10, -10, -10}, {10, 10, 10}, {false, false, false}};
    frame.step = 12;
    Particles& p = frame.particles;
    p.id = {3, 5};
    p.position = {std::vector<double>{a_.x, b_.x}, {0, 0}, {0, 0}};
    p.force = {std::vector<double>{force_, -force_}, {0, 0}, {0, 0}};
    p.mass = {a_.mass, b_.mass};
    p.radius = {a_.radius, b_.radius};
    p.type = {1, 1};
    frame.contacts.id1 = {3};
    frame.contacts.id2 = {5};
    frame.contacts.force = {std::vector<double>{force()}, {0}, {0}};
    return frame;
  }

 private:
  void kick() {
    a_.v += 0.5 * dt * force_ / a_.mass;
    b_.v -= 0.5 * dt * force_ / b_.mass;
  }

  Grain a_{-0.4, 1, 2, 0.4}, b_{0.6005, -1, 3, 0.6};
  std::function<double(double)> stiffness_, damping_;
  double force_ = 0;
};

constexpr double mass = 2.0 * 3 / 5;          // effective
constexpr double radius = 0.4 * 0.6 / 1;      // effective
constexpr double modulus = 1e4 / (2 * 0.91);  // effective, Y = 1e4, ν = 0.3

double restitution_factor(double e) {
  return std::log(e) / std::hypot(std::log(e), std::numbers::pi);
}

struct Case {
  std::string name;
  HalfStep spec;
  std::function<double(double)> stiffness, damping;
};

std::vector<Case> cases() {
  HalfStep rate;
  rate.law = DampingLaw::rate;
  rate.rate = 40;
  HalfStep hooke;
  hooke.law = DampingLaw::hooke;
  hooke.youngs_modulus = 1e4;
  hooke.poisson_ratio = 0.3;
  hooke.restitution = 0.1;
  hooke.characteristic_velocity = 2;
  HalfStep hertz = hooke;
  hertz.law = DampingLaw::hertz;
  const double k =
      16.0 / 15 * std::sqrt(radius) * modulus * std::pow(15 * mass * 4 / (16 * std::sqrt(radius) * modulus), 0.2);
  std::vector<Case> all;
  all.push_back({"rate", rate, [](double) { return 1e4; }, [](double) { return 40 * mass; }});
  all.push_back({"hooke", hooke, [k](double) { return k; },
                 [k](double) { return -2 * restitution_factor(0.1) * std::sqrt(k * mass); }});
  all.push_back({"hertz", hertz, [](double d) { return 4.0 / 3 * modulus * std::sqrt(radius * d); },
                 [](double d) {
                   return -2 * std::sqrt(5.0 / 6) * restitution_factor(0.1) *
                          std::sqrt(2 * modulus * std::sqrt(radius * d) * mass);
                 }});
  for (Case& c : all) c.spec.dt = dt;
  return all;
}

TEST(HalfStep, GivesTheForcesThatTheRunUsed) {
  for (const Case& c : cases()) {
    Collision collision(c.stiffness, c.damping);
    double largest = 0;
    int touching = 0;
    for (int n = 0; n < 60; ++n) {
      collision.step();
      if (collision.overlap() <= 0) continue;
      ++touching;
      Frame frame = collision.dump();
      largest = std::max(largest, std::abs(frame.contacts.force[0][0] / collision.force_of_run() - 1));
      correct_half_step(c.spec, frame);
      // Rounding of some ten operations.
      EXPECT_NEAR(frame.contacts.force[0][0], collision.force_of_run(), 1e-13 * c.damping(0.1) + 1e-12) << c.name;
    }
    EXPECT_GT(touching, 20) << c.name;
    EXPECT_GT(largest, 0.01) << c.name;  // or there is nothing to correct
  }
}

Frame touching_grains() {
  const Case c = cases()[0];
  Collision collision(c.stiffness, c.damping);
  for (int n = 0; n < 20; ++n) collision.step();
  return collision.dump();
}

double corrected(const HalfStep& spec, Frame frame) {
  correct_half_step(spec, frame);
  return frame.contacts.force[0][0];
}

TEST(HalfStep, StillGrainsDoNotAccelerateAndFrozenOnesAreInfinitelyHeavy) {
  HalfStep spec = cases()[0].spec;
  Frame frame = touching_grains();
  frame.particles.type = {1, 2};
  const double dumped = frame.contacts.force[0][0];
  const double a = frame.particles.force[0][0] / 2;
  // n points from the second grain to the first, against x.
  spec.still_types = {2};
  EXPECT_NEAR(corrected(spec, frame) - dumped, 0.5 * 40 * mass * dt * a, 1e-12);
  spec.still_types.clear();
  spec.frozen_types = {2};
  EXPECT_NEAR(corrected(spec, frame) - dumped, 0.5 * 40 * 2 * dt * a, 1e-12);
}

TEST(HalfStep, LeavesOutTheImageOfTheSecondGrainAcrossAPeriod) {
  const HalfStep spec = cases()[0].spec;
  Frame frame = touching_grains();
  const double a = frame.particles.force[0][0] / 2;
  const double both = corrected(spec, frame) - frame.contacts.force[0][0];
  frame.box = {{0, -10, -10}, {5, 10, 10}, {true, false, false}};
  // The first grain has left the box a little, and was not wrapped.
  ASSERT_LT(frame.particles.position[0][0], 0);
  EXPECT_NEAR(corrected(spec, frame) - frame.contacts.force[0][0], both, 1e-12);
  // Unwrapped coordinates, the same pair.
  frame.particles.position[0][0] += 50;
  EXPECT_NEAR(corrected(spec, frame) - frame.contacts.force[0][0], 0.5 * 40 * mass * dt * a, 1e-12);
  // Wrapped.
  frame.particles.position[0][0] -= 45;
  EXPECT_NEAR(corrected(spec, frame) - frame.contacts.force[0][0], 0.5 * 40 * mass * dt * a, 1e-12);
}

// A wall is like a frozen grain of 1e6 times the radius: R* of that one is 4e-7 less, and its overlap of 2e-3 is
// rounded by 1e-10. Both go into the damping by their square root at most.
TEST(HalfStep, OfAContactWithAWallIsThatWithAHugeFrozenGrain) {
  constexpr double huge = 1e6;
  for (const Case& c : cases()) {
    Collision collision(c.stiffness, c.damping);
    for (int n = 0; n < 5; ++n) collision.step();
    Frame grains = collision.dump();
    HalfStep spec = c.spec;
    spec.frozen_types = {2};
    spec.friction = 0.5;
    grains.box.periodic = {false, true, false};
    grains.particles.type = {1, 2};
    grains.particles.radius[1] = huge;
    const double touched = grains.particles.position[0][0] + 0.398;
    grains.particles.position[0][1] = touched + huge;
    const double dumped = grains.contacts.force[0][0];
    grains.contacts.force[1] = {0.5 * dumped};
    Frame wall = grains;
    wall.contacts = {};
    wall.wall_contacts.id = {3, 4};
    wall.wall_contacts.force = {std::vector<double>{dumped, dumped}, {0.5 * dumped, 0}, {0, 0}};
    wall.wall_contacts.point = {std::vector<double>{touched, touched}, {20, 20}, {0, 0}};  // one period away
    correct_half_step(spec, grains);
    correct_half_step(spec, wall);
    const double change = grains.contacts.force[0][0] - dumped;
    EXPECT_GT(std::abs(change), 1e-3 * std::abs(dumped)) << c.name;
    EXPECT_NEAR(wall.wall_contacts.force[0][0] - dumped, change, 1e-6 * std::abs(change)) << c.name;
    EXPECT_NEAR(wall.wall_contacts.force[1][0], grains.contacts.force[1][0], 1e-6 * std::abs(change)) << c.name;
    EXPECT_EQ(wall.wall_contacts.force[0][1], dumped) << c.name;  // of a grain that the frame lacks
  }
}

TEST(HalfStep, LeavesWholeStepsAndUnknownGrains) {
  HalfStep spec = cases()[0].spec;
  Frame frame = touching_grains();
  const double dumped = frame.contacts.force[0][0];
  EXPECT_NE(corrected(spec, frame), dumped);
  frame.contacts.id2 = {4};
  EXPECT_EQ(corrected(spec, frame), dumped);
  frame.contacts.id2 = {5};
  spec.whole_steps = {12};
  EXPECT_EQ(corrected(spec, frame), dumped);
}

TEST(HalfStep, TangentialForcesOfSlidingContactsFollowTheNormalForce) {
  HalfStep spec = cases()[0].spec;
  Frame frame = touching_grains();
  const double normal = frame.contacts.force[0][0];
  frame.contacts.force[1][0] = 0.5 * std::abs(normal);
  const auto tangential = [&] {
    Frame copy = frame;
    correct_half_step(spec, copy);
    return copy.contacts.force[1][0];
  };
  const double after = corrected(spec, frame);
  EXPECT_EQ(tangential(), frame.contacts.force[1][0]);  // no friction is named
  spec.friction = 0.5;
  EXPECT_NEAR(tangential(), 0.5 * std::abs(after), 1e-12 * std::abs(after));
  spec.friction = 0.6;  // it sticks
  EXPECT_EQ(tangential(), frame.contacts.force[1][0]);
}

TEST(HalfStep, ReadsNoMoreThanItNeeds) {
  HalfStep spec;
  EXPECT_EQ(half_step_columns(spec), Column::force | Column::mass);
  spec.frozen_types = {2};
  EXPECT_EQ(half_step_columns(spec), Column::force | Column::mass | ColumnSet(Column::type));
  spec = {};
  spec.law = DampingLaw::hertz;
  EXPECT_EQ(half_step_columns(spec), Column::force | Column::mass | ColumnSet(Column::radius));
}

}  // namespace
}  // namespace grainvdb::half_step_test
