/// MercuryDPM files. Debian has no MercuryDPM: sample_dumps/formats/make_mercury.py wrote these grains and contacts of
/// a LIGGGHTS run in its format, and the small files here follow its source.
#include "unit/read/sample_formats.hpp"

namespace grainvdb::mercury_test {
namespace {

using namespace testing_dumps;
using ::testing::ElementsAre;

constexpr ColumnSet grain_columns = Column::velocity | Column::angular_velocity | Column::radius | Column::type;

constexpr const char* box_3d = " 0 0 -1 10 10 1 \n";
/// Three grains: position, velocity, radius, angles, angular velocity, species.
constexpr const char* rows_3d =
    "1 2 0.5 0.1 0.2 0.3 0.5 9 9 9 1 2 3 0\n"
    "2 2 0.5 0.4 0.5 0.6 0.5 9 9 9 4 5 6 1\n"
    "3 2 0.25 0.7 0.8 0.9 0.25 9 9 9 7 8 9 0\n";
std::string data_frame(const std::string& time) {
  return "3 " + time + box_3d + rows_3d;
}
std::string fstat_frame(const std::string& time, const std::string& rows) {
  return "# " + time + " 1\n# 0 0 -1 10 10 1\n# 0.25 0.5 0 0 0 0\n" + rows;
}
/// Normal force 2 along -x, tangential force 3 along y, on the first grain.
std::string contact(const std::string& first, const std::string& second) {
  return "0 " + first + " " + second + " 0 0 0 0.01 0 2 3 -1 0 0 0 1 0\n";
}
std::string reverse_contact(const std::string& first, const std::string& second) {
  return "0 " + first + " " + second + " 0 0 0 0.01 0 2 3 1 0 0 0 -1 0\n";
}

class Mercury : public ::testing::Test {
 protected:
  InputSpec spec(const std::string& data, const std::string& fstat = {}) const {
    InputSpec spec = particles_in({files_.write("name.data", data)});
    spec.periodic = "xy";
    spec.density = 1;
    if (!fstat.empty()) spec.contacts.files = {files_.write("name.fstat", fstat)};
    return spec;
  }
  void expect_data_refused(const std::string& data, const std::vector<std::string>& parts) const {
    expect_error<InputError>([&] { open_dumps(spec(data))->read(0, grain_columns); }, parts);
  }
  void expect_fstat_refused(const std::string& fstat, const std::vector<std::string>& parts) const {
    expect_error<InputError>([&] { open_dumps(spec(data_frame("0"), fstat))->read(0, Column::contacts); }, parts);
  }
  DumpFiles files_;
};

TEST_F(Mercury, IsTheRunThatItWasMadeOf) {
  InputSpec spec = particles_in({sample("mercury.data")});
  spec.contacts.files = {sample("mercury.fstat")};
  spec.periodic = "x";
  const auto mercury = open_dumps(spec);
  const auto liggghts = open_dumps(liggghts_text());
  ASSERT_EQ(mercury->frames().size(), 2U);
  for (const std::size_t k : {1U, 0U}) {
    const Frame a = mercury->read(k, grain_columns | Column::contacts),
                b = liggghts->read(k, grain_columns | Column::contacts);
    EXPECT_EQ(a.step, static_cast<std::int64_t>(k));
    EXPECT_NEAR(*a.time, *b.time, 1e-15);
    EXPECT_EQ(a.box, b.box);
    EXPECT_EQ(a.particles.id, b.particles.id);
    // Written with 16 digits: the last is 1e-15 of the number at most.
    expect_near(a.particles.position, b.particles.position, 1e-15 * 0.01);
    expect_near(a.particles.velocity, b.particles.velocity, 1e-15);
    expect_near(a.particles.angular_velocity, b.particles.angular_velocity, 1e-15 * 1000);
    EXPECT_EQ(a.particles.radius, b.particles.radius);
    // Each of the four contacts once, of (0, 1) the line in that order; the one with the floor left out.
    EXPECT_THAT(a.contacts.id1, ElementsAre(1, 1, 1, 3));
    EXPECT_THAT(a.contacts.id2, ElementsAre(2, 3, 4, 4));
    EXPECT_THAT(b.contacts.id1, ElementsAre(1, 1, 2, 3));
    // LIGGGHTS has the force on 2 from 1 where this has the force on 1 from 2. Six digits of forces up to 0.013, in the
    // total and both of its parts, of which the normal one was put back into its direction.
    const std::vector<std::size_t> same{2, 0, 1, 3};
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (std::size_t i = 0; i < 4; ++i)
        EXPECT_NEAR(a.contacts.force[axis][i], (i == 0 ? -1 : 1) * b.contacts.force[axis][same[i]], 4 * 5e-8) << k << i;
  }
}

TEST_F(Mercury, HasColumnsBoxAndTime) {
  const Frame frame = open_dumps(spec(data_frame("0.5") + data_frame("0.75")))->read(1, grain_columns);
  EXPECT_EQ(frame.step, 1);
  EXPECT_EQ(frame.time, 0.75);
  EXPECT_EQ(frame.box, (Box{{0, 0, -1}, {10, 10, 1}, {true, true, false}}));
  EXPECT_THAT(frame.particles.id, ElementsAre(1, 2, 3));
  EXPECT_THAT(frame.particles.position[0], ElementsAre(1, 2, 3));
  EXPECT_THAT(frame.particles.velocity[2], ElementsAre(0.3, 0.6, 0.9));
  EXPECT_THAT(frame.particles.radius, ElementsAre(0.5, 0.5, 0.25));
  EXPECT_THAT(frame.particles.angular_velocity[0], ElementsAre(1, 4, 7));
  EXPECT_THAT(frame.particles.type, ElementsAre(0, 1, 0));
}

/// x y vx vy radius angle -omegaz species.
TEST_F(Mercury, InTwoDimensionsLiesAtZero) {
  InputSpec flat = spec("2 0.5 0 0 10 5 \n1 2 0.1 0.2 0.5 9 3 0\n2 3 0.4 0.5 0.5 9 -6 1\n");
  expect_error<ConfigError>([&] { open_dumps(flat); }, {"does not say where the box ends along z", "input.box"});
  flat.box = Box{{0, 0, -1}, {99, 99, 1}, {}};
  const Frame frame = read_only_frame(flat, grain_columns);
  EXPECT_EQ(frame.box, (Box{{0, 0, -1}, {10, 5, 1}, {true, true, false}}));
  EXPECT_THAT(frame.particles.position[1], ElementsAre(2, 3));
  EXPECT_THAT(frame.particles.position[2], ElementsAre(0, 0));
  EXPECT_THAT(frame.particles.velocity[1], ElementsAre(0.2, 0.5));
  EXPECT_THAT(frame.particles.velocity[2], ElementsAre(0, 0));
  EXPECT_THAT(frame.particles.angular_velocity[1], ElementsAre(0, 0));
  EXPECT_THAT(frame.particles.angular_velocity[2], ElementsAre(-3, 6));
  EXPECT_THAT(frame.particles.type, ElementsAre(0, 1));
}

TEST_F(Mercury, TakesTheNumberOfTheFrameFromTheNameOfTheFile) {
  InputSpec many = particles_in(
      {files_.write("v2/name.data.0007", data_frame("7")), files_.write("v2/name.data.0008", data_frame("8"))});
  many.periodic = "none";
  const auto source = open_dumps(many);
  EXPECT_EQ(source->frames()[0].step, 7);
  EXPECT_EQ(source->frames()[1].step, 8);
}

TEST_F(Mercury, NeedsToBeToldWhatIsPeriodic) {
  InputSpec untold = spec(data_frame("0"));
  untold.periodic.reset();
  expect_error<ConfigError>([&] { open_dumps(untold); },
                            {"name.data does not say which axes are periodic", "input.periodic"});
  untold.periodic = "xx";
  expect_error<ConfigError>([&] { open_dumps(untold); }, {"input.periodic does not name axes", "xx"});
}

/// Walls have negative numbers, and none of the contacts between grains; a fixed grain (here 2) has no line of its own.
TEST_F(Mercury, CountsEachContactOnce) {
  const std::string rows = contact("1", "0") + reverse_contact("0", "1") + contact("0", "-1") + contact("2", "1");
  const Frame frame = read_only_frame(spec(data_frame("0"), fstat_frame("0", rows)), Column::contacts);
  EXPECT_THAT(frame.contacts.id1, ElementsAre(1, 3));
  EXPECT_THAT(frame.contacts.id2, ElementsAre(2, 2));
  EXPECT_THAT(frame.contacts.force[0], ElementsAre(2, -2));
  EXPECT_THAT(frame.contacts.force[1], ElementsAre(-3, 3));
  EXPECT_TRUE(frame.contacts.point[0].empty());
}

/// Of walls n points from the grain into the wall: -(f_n n + f_t t) acts on the grain.
TEST_F(Mercury, HasTheForcesOfWallsOnGrains) {
  const std::string rows = std::string("0 1 -2 2 1.5 0.5 0.01 0 5 2 0 -1 0 1 0 0\n") + contact("0", "1") +
                           reverse_contact("1", "0") + "0 1 -1 2 2 0 0.01 0 4 3 0 0 -1 -1 0 0\n";
  InputSpec both = spec(data_frame("0"), fstat_frame("0", rows));
  both.wall_contacts.files = both.contacts.files;
  const auto source = open_dumps(both);
  EXPECT_THAT(source->wall_contact_columns(), ElementsAre("id", "fx", "fy", "fz", "cx", "cy", "cz"));
  const Frame frame = source->read(0, Column::contacts | Column::wall_contacts);
  EXPECT_THAT(frame.contacts.id1, ElementsAre(1));
  EXPECT_THAT(frame.wall_contacts.id, ElementsAre(2, 2));
  const Columns3 force{{{-2, 3}, {5, 0}, {0, 4}}}, point{{{2, 2}, {1.5, 2}, {0.5, 0}}};
  EXPECT_EQ(frame.wall_contacts.force, force);
  EXPECT_EQ(frame.wall_contacts.point, point);
  EXPECT_EQ(source->files().size(), 2U);  // the .fstat counts once

  both.wall_contacts.files = {files_.write("twice.fstat", fstat_frame("0", contact("0", "-1") + contact("0", "-1")))};
  expect_error<InputError>([&] { open_dumps(both)->read(0, Column::wall_contacts); },
                           {"twice.fstat:5", "contact of 0 with -1 comes twice", "line 4"});
  both.wall_contacts.files = {files_.write("far.fstat", fstat_frame("0", contact("0", "1") + contact("9", "-1")))};
  expect_error<InputError>([&] { open_dumps(both)->read(0, Column::wall_contacts); }, {"far.fstat:5", "found id 10"});
}

TEST_F(Mercury, AFrameMayHaveNoContacts) {
  const std::string fstat = fstat_frame("0", "") + fstat_frame("1", contact("0", "1")) + fstat_frame("2", "");
  const auto source = open_dumps(spec(data_frame("0") + data_frame("1") + data_frame("2"), fstat));
  for (const std::size_t k : {2U, 1U, 0U}) EXPECT_EQ(source->read(k, Column::contacts).contacts.size(), k % 2);
}

TEST_F(Mercury, ContactsOfAnotherTimeAreRefused) {
  expect_fstat_refused(fstat_frame("0.5", contact("0", "1")), {"of another time", "0.5", "name.fstat:1"});
}

TEST_F(Mercury, RefusesWrongCounts) {
  const std::string rows = rows_3d;
  expect_data_refused("4 0" + std::string(box_3d) + rows, {"the file ends within a frame", "3 rows", "4 particles"});
  expect_data_refused("2 0" + std::string(box_3d) + rows, {"name.data:4", "not the line before the particles"});
  expect_data_refused("4 0" + std::string(box_3d) + rows + data_frame("1"),
                      {"name.data:6", "not the line before the particles"});
  expect_data_refused("1000000000000 0" + std::string(box_3d) + rows, {"3 rows", "1000000000000 particles"});
}

TEST_F(Mercury, RefusesWhatIsCutOffOrNoNumber) {
  const std::string good = data_frame("0");
  expect_data_refused(good.substr(0, good.size() - 1), {"incomplete", "name.data:4"});
  expect_data_refused("1 0" + std::string(box_3d) + "1 2 nan 0 0 0 0.5 9 9 9 0 0 0 0\n",
                      {"name.data:2", "nan", "column z"});
  expect_data_refused("1 0 0 0 0 10 0 1\n1 2 0 0 0 0 0.5 9 9 9 0 0 0 0\n", {"name.data:1", "empty along y"});
  expect_data_refused(good + "3 0.5 0 0\n" + rows_3d, {"name.data:5", "3 0.5 0 0"});
}

TEST_F(Mercury, RefusesContactsThatCannotBeMeant) {
  expect_fstat_refused(fstat_frame("0", contact("0", "1") + contact("0", "1")),
                       {"name.fstat:5", "comes twice", "line 4"});
  expect_fstat_refused(fstat_frame("0", contact("-1", "1")), {"name.fstat:4", "-1"});
  expect_fstat_refused(fstat_frame("0", contact("2", "0") + contact("1", "1")), {"name.fstat:5", "with itself"});
  expect_fstat_refused(fstat_frame("0", "0 0 1 0 0 0 0.01 0 nan 3 -1 0 0 0 1 0\n"), {"name.fstat:4", "nan", "f_n"});
  expect_fstat_refused(fstat_frame("0", "0 0 1 0 0 0\n"), {"name.fstat:4"});
  const std::string whole = fstat_frame("0", contact("0", "1"));
  expect_fstat_refused(whole.substr(0, whole.size() - 1), {"incomplete"});
  expect_fstat_refused(whole + "# 1 1\n# 0 0", {"header of a frame is incomplete"});
}

}  // namespace
}  // namespace grainvdb::mercury_test
