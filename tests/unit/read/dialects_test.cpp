/// Rows cut from real dumps of LIGGGHTS and LAMMPS, with what is known about them.
#include <cmath>

#include "unit/read/dump_files.hpp"

namespace grainvdb::dialects_test {
namespace {

using namespace testing_dumps;
using ::testing::ElementsAre;

std::size_t row_of(const Particles& particles, std::int64_t id) {
  return static_cast<std::size_t>(std::find(particles.id.begin(), particles.id.end(), id) - particles.id.begin());
}

/// LIGGGHTS 3.8: a shear cell, user-chosen formats. Wall grain 7413 does not move; the force that its only contact
/// exerts is the force that the particle dump gives for it.
constexpr const char* shear_particles =
    "ITEM: TIMESTEP\n306000\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp pp ff\n0 0.0096\n0 0.0096\n-0.0016 "
    "0.0457055\n"
    "ITEM: ATOMS id type x y z vx vy vz fx fy fz omegax omegay omegaz radius mass \n"
    "997 1 0.000853262645 0.000799988229 0.000255811601 -3.086679e-05 -3.25917e-05 -2.245184e-05 2.52791e-08 "
    "4.545816e-07 "
    "9.895437e-08 0.03210993 -0.09272053 0.1625962 0.000442828283 9.09357538e-07 \n"
    "7413 2 0.0012 0.0004 -0.0004 0 0 0 0.000341834 -0.0002678568 -0.0005229153 0 0 0 0.0004 6.70206433e-07 \n";
constexpr const char* shear_contacts =
    "ITEM: TIMESTEP\n306000\nITEM: NUMBER OF ENTRIES\n1\nITEM: BOX BOUNDS pp pp ff\n0 0.0096\n0 0.0096\n-0.0016 "
    "0.0457055\n"
    "ITEM: ENTRIES c_clf[13] c_clf[14] c_clf[15] c_clf[16] c_clf[17] c_clf[18] c_clf[19] c_clf[20] c_clf[21] c_clf[32] "
    "c_clf[33] "
    "c_clf[34] c_clf[35] \n"
    "7413 997 0 0.0003418271 -0.0002678489 -0.0005229024 0.0002775564 -0.0003201827 -0.0005249642 3.16098e-08 "
    "0.00103544104 "
    "0.000589831422 -8.87567187e-05 \n";

TEST(LiggghtsDump, ShearCellWithContacts) {
  const DumpFiles files;
  InputSpec spec;
  spec.particles = {files.write("dump_000306000.liggghts", shear_particles)};
  spec.contacts.files = {files.write("contacts_000306000.liggghts", shear_contacts)};
  spec.contacts.compute = {"pos",    "vel",     "id",          "force",        "force_normal", "force_tangential",
                           "torque", "history", "contactArea", "contactPoint", "delta"};
  spec.dt = 1e-6;
  spec.units = "si";
  const auto source = open_dumps(spec);
  ASSERT_EQ(source->frames().size(), 1U);
  EXPECT_EQ(source->frames()[0].step, 306000);
  EXPECT_NEAR(*source->frames()[0].time, 0.306, 1e-15);
  EXPECT_EQ(source->frames()[0].particle_count, 2U);
  EXPECT_EQ(source->units().name, "si");
  EXPECT_EQ(source->contact_columns().size(), 13U);

  const Frame frame = source->read(0, every_particle_column | Column::contacts);
  EXPECT_EQ(frame.box, (Box{{0, 0, -0.0016}, {0.0096, 0.0096, 0.0457055}, {true, true, false}}));
  const Particles& p = frame.particles;
  EXPECT_THAT(p.id, ElementsAre(997, 7413));
  EXPECT_THAT(p.type, ElementsAre(1, 2));
  EXPECT_THAT(p.velocity[1], ElementsAre(-3.25917e-05, 0));
  EXPECT_THAT(p.angular_velocity[2], ElementsAre(0.1625962, 0));
  EXPECT_THAT(p.radius, ElementsAre(0.000442828283, 0.0004));
  EXPECT_THAT(p.mass, ElementsAre(9.09357538e-07, 6.70206433e-07));

  const Contacts& c = frame.contacts;
  EXPECT_THAT(c.id1, ElementsAre(7413));
  EXPECT_THAT(c.id2, ElementsAre(997));
  // The dump's own forces come from velocities half a step earlier: they differ by up to 4e-5 of the force here.
  const Vec3 dumped_force{0.000341834, -0.0002678568, -0.0005229153};
  const std::size_t first = row_of(p, 7413), second = row_of(p, 997);
  for (std::size_t a = 0; a < 3; ++a) {
    EXPECT_NEAR(c.force[a][0], dumped_force[a], 4e-5 * 6.8e-4);
    // On the line of centres at r1/(r1+r2); all coordinates have 9 digits below 2e-3, so 5e-12 each.
    const double share = p.radius[first] / (p.radius[first] + p.radius[second]);
    EXPECT_NEAR(c.point[a][0], p.position[a][first] + share * (p.position[a][second] - p.position[a][first]), 1.5e-11);
  }
}

/// LIGGGHTS with its default formats, unsorted; two of the grains of the last run.
TEST(LiggghtsDump, DefaultFormatsUnsorted) {
  const DumpFiles files;
  InputSpec spec;
  spec.particles = {
      files.write("dump60000.liggghts",
                  "ITEM: TIMESTEP\n60000\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp pp ff\n0 0.0064\n0 "
                  "0.0064\n-0.0016 0.0129199\n"
                  "ITEM: ATOMS id type x y z vx vy vz fx fy fz omegax omegay omegaz radius mass \n"
                  "561 2 0.0004 0.0004 -0.0004 0 0 0 1.02258e-06 9.38526e-07 -5.31672e-06 0 0 0 0.0004 6.70206e-07 \n"
                  "358 1 0.000134053 7.42479e-06 0.000263293 0.0284109 -0.0139569 0.00313094 -1.02258e-06 -9.38526e-07 "
                  "-2.04453e-06 "
                  "-31.1041 62.6334 68.4151 0.000415354 7.50382e-07 \n")};
  spec.contacts.files = {files.write("contacts60000.liggghts",
                                     "ITEM: TIMESTEP\n60000\nITEM: NUMBER OF ENTRIES\n1\nITEM: BOX BOUNDS pp pp ff\n0 "
                                     "0.0064\n0 0.0064\n-0.0016 0.0129199\n"
                                     "ITEM: ENTRIES c_cl[1] c_cl[2] c_cl[3] c_cl[4] c_cl[5] c_cl[6] c_cl[7] c_cl[8] "
                                     "c_cl[9] c_cl[10] c_cl[11] c_cl[12] c_cl[13] "
                                     "c_cl[14] c_cl[15] c_cl[16] c_cl[17] c_cl[18] c_cl[19] \n"
                                     "0.0004 0.0004 -0.0004 0.000134053 7.42479e-06 0.000263293 561 358 0 1.02258e-06 "
                                     "9.38526e-07 -5.31672e-06 1.09192e-10 "
                                     "2.57934e-10 1.96441e-10 2.47726e-10 0.00026953 0.000207409 -7.45986e-05 \n")};
  spec.contacts.compute = {"pos", "id", "force", "history", "contactPoint", "delta"};
  const Frame frame = open_dumps(spec)->read(0, every_particle_column | Column::contacts);
  EXPECT_THAT(frame.particles.id, ElementsAre(358, 561));
  EXPECT_THAT(frame.particles.position[1], ElementsAre(7.42479e-06, 0.0004));
  EXPECT_THAT(frame.contacts.id1, ElementsAre(561));
  EXPECT_THAT(frame.contacts.force[2], ElementsAre(-5.31672e-06));
  EXPECT_THAT(frame.contacts.point[0], ElementsAre(0.00026953));
  EXPECT_THAT(frame.contacts.point[2], ElementsAre(-7.45986e-05));
}

/// LAMMPS: one frame of a silo as `dump atom` (scaled) and as `dump custom`, and its `dump local`.
constexpr const char* silo_box =
    "ITEM: BOX BOUNDS ff pp ff\n-1.6000000000000000e+01 1.6000000000000000e+01\n0.0000000000000000e+00 "
    "8.0000000000000000e+00\n"
    "-1.0000000000000000e+01 8.0000000000000000e+01\n";

TEST(LammpsDump, SiloInThreeDumps) {
  const DumpFiles files;
  const std::string start = "ITEM: TIMESTEP\n14000\nITEM: NUMBER OF ATOMS\n2\n";
  const std::string scaled =
      files.write("simple_0014000.dump", start + silo_box +
                                             "ITEM: ATOMS id type xs ys zs\n241 1 0.06250011 0.1250008 "
                                             "0.1134122\n1 2 0.046875 0.0625 0.1055556\n");
  InputSpec spec;
  spec.particles = {files.write("full_0014000.dump",
                                start + silo_box +
                                    "ITEM: ATOMS id type x y z vx vy vz fx fy fz omegax omegay omegaz radius mass\n"
                                    "1 2 -14.5 0.5 -0.5 0 0 0 0 0 0 0 0 0 0.5 0.52359878\n"
                                    "241 1 -13.999996 1.0000068 0.20709927 -0.0031527855 0.0045523713 0.00084758369 "
                                    "0.66796935 -3.7455937 -0.95372475 "
                                    "0.0014651109 -0.0018293388 -0.0066870893 0.5 0.52359878\n")};
  spec.contacts.files = {files.write(
      "contacts_0014000.dump", "ITEM: TIMESTEP\n14000\nITEM: NUMBER OF ENTRIES\n1\n" + std::string(silo_box) +
                                   "ITEM: ENTRIES c_pp[1] c_pp[2] c_pl[1] c_pl[2] c_pl[3] c_pl[4] c_pl[5] c_pl[6] \n"
                                   "1 241 -0.08407484 -0.08407537 -0.1188977 -0.03702373 0.06726168 -0.02138214 \n")};
  spec.contacts.columns = {{"id1", {"c_pp[1]"}},
                           {"id2", {"c_pp[2]"}},
                           {"normal_force", {"c_pl[1]", "c_pl[2]", "c_pl[3]"}},
                           {"tangential_force", {"c_pl[4]", "c_pl[5]", "c_pl[6]"}}};
  const Frame full = open_dumps(spec)->read(0, every_particle_column | Column::contacts);
  const Frame simple = open_dumps(particles_in({scaled}))->read(0, Column::type);
  EXPECT_EQ(full.box, (Box{{-16, 0, -10}, {16, 8, 80}, {false, true, false}}));
  EXPECT_EQ(simple.box, full.box);
  EXPECT_EQ(simple.particles.id, full.particles.id);
  EXPECT_EQ(simple.particles.type, full.particles.type);
  // Half a unit of the last printed digit: scaled coordinates have 7 significant digits, the others 8.
  const Vec3 half_unit{32 * 5e-9 + 5e-7, 8 * 5e-8 + 5e-8, 90 * 5e-8 + 5e-9};
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t i = 0; i < 2; ++i)
      EXPECT_NEAR(simple.particles.position[a][i], full.particles.position[a][i], half_unit[a]) << a;
  EXPECT_THAT(full.contacts.force[0], ElementsAre(-0.08407484 + -0.03702373));
  EXPECT_TRUE(full.contacts.point[0].empty());
}

}  // namespace
}  // namespace grainvdb::dialects_test
