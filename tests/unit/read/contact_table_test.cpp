/// Columns of contact dumps: by the keywords of the compute, by a map, by plain names.
#include "read/contact_columns.hpp"
#include "unit/read/dump_files.hpp"

namespace grainvdb::contact_table_test {
namespace {

using namespace testing_dumps;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

class ContactTableTest : public ::testing::Test {
 protected:
  Contacts read(const std::string& columns, const std::vector<std::string>& rows) {
    spec_.particles = {files_.write("dump", particle_dump(0, "id x y z", {"1 0 0 0", "2 1 0 0", "3 2 0 0"}))};
    spec_.contacts.files = {files_.write("contacts", contact_dump(0, columns, rows))};
    return open_dumps(spec_)->read(0, Column::contacts).contacts;
  }
  /// "c_c[first] … c_c[last]" and the row "first … last".
  static std::string indexed(int first, int last) {
    std::string text;
    for (int i = first; i <= last; ++i) text += "c_c[" + std::to_string(i) + "] ";
    return text;
  }
  static std::string counting(int first, int last) {
    std::string text;
    for (int i = first; i <= last; ++i) text += std::to_string(i) + " ";
    return text;
  }
  static void expect_forces(const Contacts& c, const Vec3& expected) {
    for (std::size_t a = 0; a < 3; ++a) EXPECT_THAT(c.force[a], ElementsAre(expected[a]));
  }
  static void expect_point(const Contacts& c, const Vec3& expected) {
    for (std::size_t a = 0; a < 3; ++a) EXPECT_THAT(c.point[a], ElementsAre(expected[a]));
  }

  DumpFiles files_;
  InputSpec spec_;
};

TEST_F(ContactTableTest, AllKeywordsInTheOrderOfTheCompute) {
  // pos 1-6, vel 7-12, id 13-15, force 16-18, normal 19-21, tangential 22-24, torque 25-27, history 28-30, area 31,
  // delta 32, point 33-35; the keywords here are in another order.
  spec_.contacts.compute = {"contactPoint", "delta", "pos",    "force_tangential", "force_normal", "force",
                            "id",           "vel",   "torque", "history",          "contactArea"};
  const Contacts c = read(indexed(1, 35), {counting(1, 35)});
  EXPECT_THAT(c.id1, ElementsAre(13));
  EXPECT_THAT(c.id2, ElementsAre(14));
  expect_forces(c, {16, 17, 18});
  expect_point(c, {33, 34, 35});
}

TEST_F(ContactTableTest, RarerKeywordsShiftTheRest) {
  // id 1-3, force 4-6, torque normal 7-9 and tangential 10-12, heat flux 13, point 14-16, ms_id 17-18.
  spec_.contacts.compute = {"id",       "force",        "torque_normal", "torque_tangential",
                            "heatFlux", "contactPoint", "ms_id",         "verbose"};
  const Contacts c = read(indexed(1, 18), {counting(1, 18)});
  expect_forces(c, {4, 5, 6});
  expect_point(c, {14, 15, 16});
}

TEST_F(ContactTableTest, ADumpMayHoldSomeColumnsOnlyInAnyOrder) {
  spec_.contacts.compute = {"pos", "id", "force", "history", "contactPoint", "delta"};
  const Contacts c = read("c_c[12] c_c[8] c_c[11] c_c[7] c_c[10]", {"6 2 5 1 4"});
  EXPECT_THAT(c.id1, ElementsAre(1));
  EXPECT_THAT(c.id2, ElementsAre(2));
  expect_forces(c, {4, 5, 6});
  EXPECT_THAT(c.point[0], IsEmpty());
}

TEST_F(ContactTableTest, NormalAndTangentialForcesAddUp) {
  spec_.contacts.compute = {"id", "force_normal", "force_tangential"};
  expect_forces(read(indexed(1, 9), {"1 2 0 10 20 30 1 2 3"}), {11, 22, 33});
  // Also where the compute has the total force but the dump leaves it out.
  spec_.contacts.compute = {"id", "force", "force_normal", "force_tangential"};
  expect_forces(read(indexed(1, 3) + indexed(7, 12), {"1 2 0 10 20 30 1 2 3"}), {11, 22, 33});
}

TEST_F(ContactTableTest, WiderHistoryDoesNotMatterWithoutContactPoint) {
  spec_.contacts.compute = {"id", "force", "history", "delta"};
  expect_forces(read(indexed(1, 14), {counting(1, 14)}), {4, 5, 6});
}

TEST_F(ContactTableTest, ColumnMap) {
  spec_.contacts.columns = {{"id1", {"c_pp[1]"}},
                            {"id2", {"c_pp[2]"}},
                            {"normal_force", {"c_pl[1]", "c_pl[2]", "c_pl[3]"}},
                            {"tangential_force", {"c_pl[4]", "c_pl[5]", "c_pl[6]"}}};
  const Contacts c = read("c_pp[1] c_pp[2] c_pl[1] c_pl[2] c_pl[3] c_pl[4] c_pl[5] c_pl[6]", {"3 1 10 20 30 1 2 3"});
  EXPECT_THAT(c.id1, ElementsAre(3));
  EXPECT_THAT(c.id2, ElementsAre(1));
  expect_forces(c, {11, 22, 33});
  EXPECT_THAT(c.point[0], IsEmpty());
  spec_.contacts.columns = {{"id1", {"a"}}, {"id2", {"b"}}, {"force", {"p", "q", "r"}}, {"point", {"s", "t", "u"}}};
  expect_point(read("a b p q r s t u v", {counting(1, 9)}), {6, 7, 8});
}

TEST_F(ContactTableTest, PlainNames) {
  expect_forces(read("index id1 id2 fx fy fz", {"1 1 2 7 8 9"}), {7, 8, 9});
}

TEST_F(ContactTableTest, IdsMayBePrintedAsRealNumbers) {
  const Contacts c = read("id1 id2 fx fy fz", {"561.0 7. 0 0 1"});
  EXPECT_THAT(c.id1, ElementsAre(561));
  EXPECT_THAT(c.id2, ElementsAre(7));
}

TEST_F(ContactTableTest, RowsAreSortedByTheirIds) {
  const Contacts c = read("id1 id2 fx fy fz", {"3 2 0 0 3", "1 3 0 0 2", "1 2 0 0 1"});
  EXPECT_THAT(c.id1, ElementsAre(1, 1, 3));
  EXPECT_THAT(c.id2, ElementsAre(2, 3, 2));
  EXPECT_THAT(c.force[2], ElementsAre(1, 2, 3));
}

TEST(ComputesAmong, AreNamedOnceWithTheirLargestColumn) {
  const std::vector<ComputeUse> all =
      computes_among({"id", "c_pp[1]", "c_pl[3]", "c_pp[2]", "c_pl[1]", "c_ke", "c_x[0]", "c_x[1", "c_x[a]", "v_n[2]"});
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].name, "pp");
  EXPECT_EQ(all[0].largest, 2U);
  EXPECT_EQ(all[1].name, "pl");
  EXPECT_EQ(all[1].largest, 3U);
}

TEST_F(ContactTableTest, NoContactsIsAFrame) {
  EXPECT_EQ(read("id1 id2 fx fy fz", {}).size(), 0U);
}

}  // namespace
}  // namespace grainvdb::contact_table_test
