/// Columns of particle dumps by name, through the public interface.
#include <numbers>

#include "unit/read/dump_files.hpp"

namespace grainvdb::particle_table_test {
namespace {

using namespace testing_dumps;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

class ParticleTableTest : public ::testing::Test {
 protected:
  Frame read(const std::string& columns, const std::vector<std::string>& rows, ColumnSet wanted) {
    spec_.particles = {files_.write("dump", particle_dump(0, columns, rows))};
    source_ = open_dumps(spec_);
    return source_->read(0, wanted);
  }
  DumpFiles files_;
  InputSpec spec_;
  std::unique_ptr<FrameSource> source_;
};

TEST_F(ParticleTableTest, ColumnsAreFoundByNameAndRowsSortedById) {
  const Frame frame = read("vz mass c_q[1] z id omegax y type f_w vx omegaz x radius omegay v_e vy",
                           {"3 0.5 abc 9 40 11 8 2 - 1 13 7 0.25 12 - 2", "6 1.5 abc 6 7 14 5 1 - 4 16 4 0.75 15 - 5"},
                           every_particle_column);
  const Particles& p = frame.particles;
  EXPECT_THAT(p.id, ElementsAre(7, 40));
  EXPECT_THAT(p.position[0], ElementsAre(4, 7));
  EXPECT_THAT(p.position[1], ElementsAre(5, 8));
  EXPECT_THAT(p.position[2], ElementsAre(6, 9));
  EXPECT_THAT(p.velocity[0], ElementsAre(4, 1));
  EXPECT_THAT(p.velocity[1], ElementsAre(5, 2));
  EXPECT_THAT(p.velocity[2], ElementsAre(6, 3));
  EXPECT_THAT(p.angular_velocity[0], ElementsAre(14, 11));
  EXPECT_THAT(p.angular_velocity[1], ElementsAre(15, 12));
  EXPECT_THAT(p.angular_velocity[2], ElementsAre(16, 13));
  EXPECT_THAT(p.radius, ElementsAre(0.75, 0.25));
  EXPECT_THAT(p.mass, ElementsAre(1.5, 0.5));
  EXPECT_THAT(p.type, ElementsAre(1, 2));
}

TEST_F(ParticleTableTest, OnlyWantedColumnsAreConverted) {
  const Frame frame = read("id type x y z vx vy vz radius mass", {"1 one 1 2 3 no no no no no"}, {});
  EXPECT_THAT(frame.particles.id, ElementsAre(1));
  EXPECT_THAT(frame.particles.velocity[0], IsEmpty());
  EXPECT_THAT(frame.particles.angular_velocity[0], IsEmpty());
  EXPECT_THAT(frame.particles.radius, IsEmpty());
  EXPECT_THAT(frame.particles.mass, IsEmpty());
  EXPECT_THAT(frame.particles.type, IsEmpty());
  EXPECT_THAT(source_->counters().columns_parsed, UnorderedElementsAre("id", "x", "y", "z"));
}

TEST_F(ParticleTableTest, DiameterIsTwiceTheRadius) {
  EXPECT_THAT(read("id x y z diameter", {"1 0 0 0 3"}, Column::radius).particles.radius, ElementsAre(1.5));
  EXPECT_THAT(read("id x y z diameter radius", {"1 0 0 0 3 7"}, Column::radius).particles.radius, ElementsAre(7));
}

TEST_F(ParticleTableTest, CommonRadiusServesDumpsWithoutRadii) {
  spec_.radius = 0.5;
  EXPECT_THAT(read("id x y z", {"1 0 0 0", "2 1 1 1"}, Column::radius).particles.radius, ElementsAre(0.5, 0.5));
  EXPECT_THAT(read("id x y z radius", {"1 0 0 0 2"}, Column::radius).particles.radius, ElementsAre(2));
}

TEST_F(ParticleTableTest, MassFromDensityAndRadius) {
  const double volume = 4.0 / 3.0 * std::numbers::pi * 8;
  spec_.density = 2.5;
  const Frame frame = read("id x y z radius", {"1 0 0 0 2"}, Column::mass);
  EXPECT_THAT(frame.particles.mass, ElementsAre(::testing::DoubleEq(2.5 * volume)));
  EXPECT_THAT(frame.particles.radius, IsEmpty());
  EXPECT_THAT(read("id x y z radius density", {"1 0 0 0 2 3"}, Column::mass).particles.mass,
              ElementsAre(::testing::DoubleEq(3 * volume)));
  EXPECT_THAT(read("id x y z radius density mass", {"1 0 0 0 2 3 9"}, Column::mass).particles.mass, ElementsAre(9));
  spec_.radius = 1;
  EXPECT_THAT(read("id x y z", {"1 0 0 0"}, Column::mass).particles.mass,
              ElementsAre(::testing::DoubleEq(2.5 * volume / 8)));
}

TEST_F(ParticleTableTest, PositionFamilies) {
  // The box is 10 × 10 × 20 with lo = (0, 0, -5).
  const auto position = [&](const std::string& columns, const std::string& row) {
    const Columns3 p = read("id " + columns, {"1 " + row}, {}).particles.position;
    return Vec3{p[0].at(0), p[1].at(0), p[2].at(0)};
  };
  EXPECT_EQ(position("x y z", "1 2 3"), (Vec3{1, 2, 3}));
  EXPECT_EQ(position("xu yu zu", "11 -2 3"), (Vec3{11, -2, 3}));
  EXPECT_EQ(position("xs ys zs", "0.5 0.25 0.5"), (Vec3{5, 2.5, 5}));
  EXPECT_EQ(position("xsu ysu zsu", "1.5 -0.25 0.5"), (Vec3{15, -2.5, 5}));
  EXPECT_EQ(position("xs ys zs xu yu zu x y z", "0 0 0 0 0 0 1 2 3"), (Vec3{1, 2, 3}));
  // All axes come from one family.
  EXPECT_EQ(position("x y zs xu yu zu", "9 9 9 1 2 3"), (Vec3{1, 2, 3}));
}

TEST_F(ParticleTableTest, PositionsOutsideThePeriodicBoxAreLeftAsTheyAre) {
  EXPECT_THAT(read("id x y z", {"1 -0.001 10.001 3"}, {}).particles.position[0], ElementsAre(-0.001));
}

TEST_F(ParticleTableTest, NoParticlesIsAFrame) {
  const Frame frame = read("id type x y z vx vy vz omegax omegay omegaz radius mass", {}, every_particle_column);
  EXPECT_EQ(frame.particles.size(), 0U);
}

TEST_F(ParticleTableTest, BlanksAroundFieldsDoNotMatter) {
  const Frame frame = read("id x y z", {"  1\t 1   2 3 \t", "2 4 5 6"}, {});
  EXPECT_THAT(frame.particles.position[2], ElementsAre(3, 6));
}

}  // namespace
}  // namespace grainvdb::particle_table_test
