// C(r) about the velocity field of output times.
#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "field_scene.hpp"
#include "lattices.hpp"
#include "measure/structure.hpp"

namespace grainvdb::testing::field_motion_test {
namespace {

const Lattice lattice(0.5, {0, 0, 0});
const Box room{{0, 0, 0}, {8, 8, 8}, {false, false, false}};

/// A linear flow, which is what trilinear interpolation makes of it; along x with a rate of its own.
Vec3 flow(double rate, const Vec3& x) {
  return {rate * x[2], x[0] - x[1], 0.5 * x[0]};
}

/// An output time that has the flow wherever grains are, or short of the plane x = `end`.
OutputFields output(std::int64_t first, std::int64_t last, double rate, double end = 8) {
  const auto topology = voxels_between({-1, -1, -1}, {static_cast<std::int32_t>(2 * end), 16, 16});
  OutputFields fields{{0, first, last, 5}, {}, Mask(topology)};
  fields.fields.emplace("velocity", field_of("velocity", 3, lattice, topology, [&](const Vec3& x, int c) {
                          return flow(rate, x)[static_cast<std::size_t>(c)];
                        }));
  return fields;
}

/// Grains at random places that move with the flow, and with one velocity beside it.
Frame frame_of(std::int64_t step, double rate) {
  const Scene s = poisson(room, 200, static_cast<std::uint64_t>(step));
  Frame f = s.frame();
  f.step = step;
  for (std::size_t i = 0; i < s.size(); ++i) {
    const Vec3 u = flow(rate, {s.position[0][i], s.position[1][i], s.position[2][i]});
    for (std::size_t a = 0; a < 3; ++a) f.particles.velocity[a].push_back(u[a] + 1);
  }
  return f;
}

/// Whether the table says of what there were so many.
bool remarks(const Table& table, const std::string& of, std::size_t count) {
  const std::string end = ": " + std::to_string(count) + ".";
  return std::any_of(table.remarks.begin(), table.remarks.end(), [&](const std::string& remark) {
    return remark.find(of) != std::string::npos && remark.ends_with(end);
  });
}

class AboutTheField : public ::testing::Test {
 protected:
  Table table(const std::vector<Frame>& frames) {
    measurement_->take(output(0, 10, 1));
    measurement_->take(output(20, 30, -2, 6));
    for (const Frame& frame : frames) measurement_->add(frame);
    return measurement_->tables().at(0);
  }
  const FieldScene scene_{velocity_correlation_measurement(),
                          lattice,
                          voxels_between({0, 0, 0}, {0, 0, 0}),
                          {{"about", std::string("field")}, {"bins", std::int64_t{4}}}};
  std::unique_ptr<Measurement> measurement_ = scene_.make(room);
};

TEST_F(AboutTheField, NeedsTheVelocity) {
  EXPECT_EQ(scene_.needs().fields, std::vector<std::string>{"velocity"});
}

// What is left is the same for all. Fields of up to 16 are floats, so that fluctuations of 1 are off by 1e-6.
TEST_F(AboutTheField, FluctuationsAreAboutTheOutputTimeOfTheirFrame) {
  const Table t = table({frame_of(7, 1), frame_of(20, -2)});
  for (const double c : column(t, "c")) EXPECT_NEAR(c, 1, 3e-6);
}

TEST_F(AboutTheField, FramesInNoOutputTimeAreLeftOut) {
  const Table t = table({frame_of(7, 1), frame_of(15, -2)});
  EXPECT_TRUE(remarks(t, "no output time", 1));
  for (const double c : column(t, "c")) EXPECT_NEAR(c, 1, 3e-6);
}

TEST_F(AboutTheField, GrainsWhereThereIsNoFieldAreLeftOut) {
  const Frame frame = frame_of(20, -2);
  const Table t = table({frame});
  std::size_t beyond = 0;  // the last voxel centre is at 6.25
  for (const double x : frame.particles.position[0])
    if (x >= 6.25) ++beyond;
  EXPECT_TRUE(remarks(t, "field is undefined", beyond));
}

}  // namespace
}  // namespace grainvdb::testing::field_motion_test
