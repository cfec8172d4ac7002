/// Dumps of contacts with meshes: the columns of compute wall/gran/local and of a map, and what is refused.
#include "unit/read/sample_formats.hpp"

namespace grainvdb::wall_contact_table_test {
namespace {

using namespace testing_dumps;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::Not;

class WallContactTable : public ::testing::Test {
 protected:
  WallContactTable() {
    spec_.particles = {files_.write("dump", particle_dump(7, "id x y z", {"11 0 0 0", "12 1 0 0", "30 2 0 0"}))};
    spec_.wall_contacts.compute = {"pos", "id", "force"};
  }
  WallContacts read(const std::string& columns, const std::vector<std::string>& rows, std::int64_t step = 7) {
    spec_.wall_contacts.files = {files_.write("walls", contact_dump(step, columns, rows))};
    return open_dumps(spec_)->read(0, Column::wall_contacts).wall_contacts;
  }
  template <class E = InputError>
  void refuses(const std::string& columns, const std::vector<std::string>& rows,
               const std::vector<std::string>& parts) {
    expect_error<E>([&] { read(columns, rows); }, parts);
  }
  /// "c_w[first] … c_w[last]".
  static std::string indexed(int first, int last) {
    std::string text;
    for (int i = first; i <= last; ++i) text += "c_w[" + std::to_string(i) + "] ";
    return text;
  }
  static Vec3 row(const Columns3& columns, std::size_t k) { return {columns[0][k], columns[1][k], columns[2][k]}; }

  DumpFiles files_;
  InputSpec spec_;
};

TEST_F(WallContactTable, OfLiggghtsToTheLastDigit) {
  InputSpec spec = particles_in({sample("mesh_grains_2000.dump")});
  spec.wall_contacts.files = {sample("mesh_walls_2000.dump")};
  spec.wall_contacts.compute = {"pos", "id", "force", "contactPoint"};
  const Frame frame = read_only_frame(spec, Column::wall_contacts);
  const WallContacts& c = frame.wall_contacts;
  // The corner grain touches both meshes, the floor first.
  EXPECT_THAT(c.id, ElementsAre(1, 1, 2, 3));
  EXPECT_EQ(row(c.point, 0), (Vec3{0.0060000000000000001, 0.0014999241350407196, 0.001}));
  EXPECT_EQ(row(c.force, 0), (Vec3{0, 1.150431046518381e-06, 1.23680226087228e-05}));
  EXPECT_EQ(row(c.point, 1), (Vec3{0.0060000000000000001, 0.001, 0.0014998213655242427}));
  EXPECT_EQ(row(c.force, 1), (Vec3{0, 3.4230574997568802e-06, 6.870913498632421e-07}));
  EXPECT_EQ(row(c.point, 2), (Vec3{0.0060000000000000001, 0.0024998561105415802, 0.001}));
  EXPECT_EQ(row(c.force, 2), (Vec3{0, 4.6326800063522473e-07, 1.212866880164891e-05}));
  EXPECT_EQ(row(c.point, 3), (Vec3{0.0035109519368073708, 0.0037191885930771738, 0.001}));
  EXPECT_EQ(row(c.force, 3), (Vec3{2.1909779759316305e-19, 7.1972250995817583e-07, 1.2591891380117476e-05}));
}

TEST_F(WallContactTable, AllKeywordsInTheOrderOfTheCompute) {
  // pos 1-6, vel 7-12, id 13-15, force 16-18, normal 19-21, tangential 22-24, torque 25-27, history 28-30, area 31,
  // delta 32, point 33-35, which is never filled in.
  spec_.wall_contacts.compute = {"contactPoint", "delta", "force_tangential", "force_normal", "force",      "id",
                                 "vel",          "pos",   "torque",           "history",      "contactArea"};
  std::string text;
  for (int i = 1; i <= 35; ++i) text += std::to_string(i == 15 ? 30 : i) + " ";
  const WallContacts c = read(indexed(1, 35), {text});
  EXPECT_THAT(c.id, ElementsAre(30));
  EXPECT_EQ(row(c.point, 0), (Vec3{1, 2, 3}));
  EXPECT_EQ(row(c.force, 0), (Vec3{16, 17, 18}));
}

TEST_F(WallContactTable, NormalAndTangentialForcesAddUp) {
  spec_.wall_contacts.compute = {"pos", "id", "force_normal", "force_tangential"};
  const WallContacts c = read(indexed(1, 15), {"1 2 3 0 0 0 0 5 12 10 20 30 1 2 3"});
  EXPECT_EQ(row(c.force, 0), (Vec3{11, 22, 33}));
}

TEST_F(WallContactTable, ColumnMap) {
  spec_.wall_contacts.compute.clear();
  spec_.wall_contacts.columns = {{"id", {"grain"}}, {"force", {"p", "q", "r"}}, {"point", {"s", "t", "u"}}};
  const WallContacts c = read("s t u p q r grain", {"1 2 3 4 5 6 12", "1 2 3 7 8 9 12"});
  EXPECT_THAT(c.id, ElementsAre(12, 12));
  EXPECT_EQ(row(c.point, 1), (Vec3{1, 2, 3}));
  EXPECT_EQ(row(c.force, 1), (Vec3{7, 8, 9}));
}

TEST_F(WallContactTable, RowsAreSortedByParticleMeshAndTriangle) {
  const std::string columns = indexed(1, 3) + indexed(7, 12);
  const WallContacts c = read(columns, {"3 0 0 1 4 12 0 0 0", "4 0 0 0 2 30 0 0 0", "2 0 0 1 3 12 0 0 0",
                                        "1 0 0 0 9 12 0 0 0", "0 0 0 5 0 11 0 0 0"});
  EXPECT_THAT(c.id, ElementsAre(11, 12, 12, 12, 30));
  EXPECT_THAT(c.point[0], ElementsAre(0, 1, 2, 3, 4));
}

TEST_F(WallContactTable, NoContactsIsAFrame) {
  EXPECT_EQ(read(indexed(1, 12), {}).size(), 0U);
}

TEST_F(WallContactTable, IsReadOnlyWhereItIsWanted) {
  read(indexed(1, 12), {});
  const auto source = open_dumps(spec_);
  source->require(0, {});
  source->read(0, {});
  EXPECT_THAT(source->counters().files_opened, Not(Contains(EndsWith("walls"))));
  source->read(0, Column::wall_contacts);
  EXPECT_THAT(source->counters().files_opened, Contains(EndsWith("walls")));
}

TEST_F(WallContactTable, ADirectoryIsSharedWithOtherDumps) {
  spec_.wall_contacts.files = {files_.write("d/walls", contact_dump(7, indexed(1, 12), {"1 2 3 0 0 0 0 1 11 4 5 6"}))};
  files_.write("d/pairs", contact_dump(7, "id1 id2 fx fy fz", {"11 12 1 2 3"}));
  spec_.contacts.files = {files_.path("d")};
  const Frame frame = open_dumps(spec_)->read(0, Column::contacts | Column::wall_contacts);
  EXPECT_THAT(frame.contacts.id2, ElementsAre(12));
  EXPECT_THAT(frame.wall_contacts.id, ElementsAre(11));
}

TEST_F(WallContactTable, AContactThatComesTwiceIsRefused) {
  refuses(
      indexed(1, 12),
      {"0 0 0 0 0 0 0 5 12 0 0 0", "0 0 0 0 0 0 1 5 12 0 0 0", "0 0 0 0 0 0 0 5 11 0 0 0", "0 0 0 0 0 0 0 5 12 1 1 1"},
      {"walls:13", "particle 12 with triangle 5 of mesh 0 comes twice", "line 10"});
}

TEST_F(WallContactTable, AnUnknownParticleIsRefused) {
  const std::vector<std::string> rows{"0 0 0 0 0 0 0 5 12 0 0 0", "0 0 0 0 0 0 0 5 13 0 0 0"};
  refuses(indexed(1, 12), rows, {"walls:11", "particle dump of this step lacks", "found id 13", "third"});
  refuses(indexed(1, 12), {"0 0 0 0 0 0 0 5 0 0 0 0"}, {"walls:10", "c_w[9]", "found 0", "an id from 1"});
}

TEST_F(WallContactTable, MissingColumnsAreNamed) {
  refuses(indexed(4, 12), {}, {"walls:9", "c_w[1] (contact point), c_w[2] (contact point), c_w[3] (contact point)"});
  refuses(indexed(1, 8) + indexed(10, 12), {}, {"walls:9", "expected c_w[9] (id of the particle)"});
  refuses(indexed(1, 11), {}, {"expected c_w[12] (force)", "input.wall_contacts"});
  refuses(indexed(1, 13), {}, {"c_w[13]", "at most c_w[12] for pos, id, force", "input.wall_contacts.compute"});
  refuses("id fx fy fz", {}, {"no columns of a compute", "input.wall_contacts.columns"});
}

TEST_F(WallContactTable, SpecificationsThatCannotBeMeantAreRefused) {
  const auto with = [&](const std::vector<std::string>& compute, const std::vector<std::string>& parts) {
    spec_.wall_contacts.compute = compute;
    refuses<ConfigError>(indexed(1, 12), {}, parts);
  };
  with({"id", "force"}, {"without a contact point", "found no pos"});
  with({"id", "force", "contactPoint"}, {"contactPoint, which compute wall/gran/local never fills in", "pos"});
  with({"pos", "force"}, {"found pos force", "expected pos, id and force"});
  with({"pos", "id", "force_normal"}, {"expected pos, id and force"});
  with({"pos", "id", "forces"}, {"unknown keyword of compute wall/gran/local", "'forces'"});
  spec_.wall_contacts.columns = {{"id", {"a"}}, {"force", {"p", "q", "r"}}};
  with({"pos", "id", "force"}, {"input.wall_contacts has both compute and columns"});
  with({}, {"input.wall_contacts.columns is incomplete", "expected id, point and either force"});
  spec_.wall_contacts.columns.clear();
  spec_.wall_contacts.compute.clear();
  refuses(indexed(1, 12), {}, {"walls:9", "mean is not known", "id fx fy fz cx cy cz", "compute wall/gran/local"});
}

TEST_F(WallContactTable, AMissingTimestepIsRefused) {
  expect_error<InputError>([&] { read(indexed(1, 12), {}, 8); },
                           {"no wall contact dump has timestep 7", "1 other timesteps in the 1 wall contact files",
                            "one wall contact frame for every particle frame"});
  spec_.wall_contacts.files.clear();
  expect_error<InputError>([&] { open_dumps(spec_)->require(0, Column::wall_contacts); },
                           {"no wall contact dumps are given", "input.wall_contacts.files"});
}

}  // namespace
}  // namespace grainvdb::wall_contact_table_test
