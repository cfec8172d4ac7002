#include "spot/staggered_lattice.hpp"

#include <cmath>
#include <set>

#include <gmock/gmock.h>

#include "grainvdb/error.hpp"

namespace grainvdb::spot::staggered_lattice_test {
namespace {

using ::testing::HasSubstr;

const Vec3 face_centred{0.5, 0.5, 0.70711};
const Box silo{{-4, 0, 1}, {4.6, 3, 9}, {false, true, false}};

Vec3 difference(const Box& box, const Vec3& to, const Vec3& from) {
  Vec3 d{};
  for (int a = 0; a < 3; ++a) d[a] = box.minimum_image(a, to[a] - from[a]);
  return d;
}

// Each of (±Δx, ±Δy, Δz) once in the bulk; towards walls only those that lie inside.
void expect_upper_neighbours(const Box& box, const StaggeredLattice& lattice, std::size_t most) {
  std::size_t full = 0;
  for (std::size_t site = 0; site < lattice.size(); ++site) {
    const auto above = lattice.above(site);
    EXPECT_EQ(above.count == 0, lattice.layer_of(site) + 1 == lattice.layers());
    std::set<std::pair<bool, bool>> signs;
    for (std::size_t n = 0; n < above.count; ++n) {
      const Vec3 d = difference(box, lattice.position(above.site[n]), lattice.position(site));
      for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(std::abs(d[a]), lattice.step()[a], 1e-12);
      EXPECT_GT(d[2], 0);
      EXPECT_TRUE(signs.insert({d[0] > 0, d[1] > 0}).second);
    }
    full += above.count == most ? 1U : 0U;
  }
  EXPECT_GT(full, lattice.size() / 2);
}

TEST(StaggeredLattice, UpperNeighboursAreOneStepAway) {
  expect_upper_neighbours(silo, StaggeredLattice(silo, 1, face_centred, 8), 4);
  const double s = 1 / std::sqrt(3.0);
  const Box walls{{0, 0, 0}, {9, 9, 8}, {false, false, false}};
  expect_upper_neighbours(walls, StaggeredLattice(walls, 1, {s, s, s}, 8), 4);
  expect_upper_neighbours(silo, StaggeredLattice(silo, 1, {0.5, 0, 0.9}, 8), 2);
}

TEST(StaggeredLattice, SpheresTouchButDoNotOverlapEachOtherOrWalls) {
  const StaggeredLattice lattice(silo, 1, face_centred, 6);
  // Eight and seven columns between walls 8.6 apart, three along y, layers at .5, 1.21, … 5.45 above the floor.
  EXPECT_EQ(lattice.layers(), 8U);
  EXPECT_EQ(lattice.in_layer(0), 8 * 3U);
  EXPECT_EQ(lattice.in_layer(1), 7 * 3U);
  const Packing packing = lattice_packing(lattice, 1);
  ASSERT_EQ(packing.id.size(), 4 * (8 + 7) * 3U);
  for (std::size_t i = 0; i < packing.id.size(); ++i) {
    EXPECT_EQ(packing.id[i], static_cast<std::int64_t>(i + 1));
    EXPECT_GE(packing.position[i][0], silo.lo[0] + 0.5);
    EXPECT_LE(packing.position[i][0], silo.hi[0] - 0.5);
    EXPECT_GE(packing.position[i][2], silo.lo[2] + 0.5);
    EXPECT_LE(packing.position[i][2], silo.lo[2] + 5.5);
    for (std::size_t j = 0; j < i; ++j) {
      const Vec3 d = difference(silo, packing.position[i], packing.position[j]);
      EXPECT_GT(std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]), 1 - 1e-6);
    }
  }
  // Symmetric between the walls.
  EXPECT_NEAR(packing.position.front()[0] + packing.position[23][0], silo.lo[0] + silo.hi[0], 1e-12);
}

std::string lattice_refusal(const Box& box, const Vec3& step, double height) {
  try {
    const StaggeredLattice lattice(box, 1, step, height);
  } catch (const ConfigError& e) {
    return e.what();
  }
  return "nothing was refused";
}

TEST(StaggeredLattice, RefusesWhatDoesNotFit) {
  EXPECT_EQ(lattice_refusal(silo, face_centred, 8), "nothing was refused");
  EXPECT_THAT(lattice_refusal(silo, {0.5, 0.5, 0.7}, 8), HasSubstr("overlap from layer to layer"));
  EXPECT_THAT(lattice_refusal(silo, {0.45, 0.5, 0.9}, 8), HasSubstr("overlap in a layer"));
  EXPECT_THAT(lattice_refusal(silo, {1, 1, 0.4}, 8), HasSubstr("next but one"));
  EXPECT_THAT(lattice_refusal(silo, {0.5, 0.6, 0.7}, 8), HasSubstr("does not fit the periodic axis y"));
  EXPECT_THAT(lattice_refusal(silo, {4, 0.5, 0.7}, 8), HasSubstr("does not fit between the walls along x"));
  EXPECT_THAT(lattice_refusal(silo, face_centred, 0.9), HasSubstr("has no layer"));
}

}  // namespace
}  // namespace grainvdb::spot::staggered_lattice_test
