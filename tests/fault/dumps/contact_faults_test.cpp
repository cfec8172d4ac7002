/// Contact dumps that are missing, malformed or not understood.
#include "unit/read/dump_files.hpp"

namespace grainvdb::contact_faults_test {
namespace {

using namespace testing_dumps;

class ContactFaults : public ::testing::Test {
 protected:
  ContactFaults() {
    spec_.particles = {files_.write("dump", particle_dump(0, "id x y z", {"1 0 0 0", "2 1 0 0"}))};
    spec_.where["input.contacts"] = {"run.yaml", 8};
  }
  void refuses(const std::string& columns, const std::vector<std::string>& rows, int line,
               std::vector<std::string> parts) {
    const std::string path = files_.write("contacts", contact_dump(0, columns, rows));
    parts.push_back(path + ":" + std::to_string(line) + ": ");
    spec_.contacts.files = {path};
    const auto source = open_dumps(spec_);
    EXPECT_NO_THROW(source->read(0, {}));  // nobody is bothered who wants no contacts
    expect_error<InputError>([&] { source->read(0, Column::contacts); }, parts);
  }
  static std::string indexed(int first, int last) {
    std::string text;
    for (int i = first; i <= last; ++i) text += "c_c[" + std::to_string(i) + "] ";
    return text;
  }
  DumpFiles files_;
  InputSpec spec_;
};

TEST_F(ContactFaults, NoContactDumpsGiven) {
  const auto source = open_dumps(spec_);
  EXPECT_NO_THROW(source->read(0, {}));
  expect_error<InputError>([&] { source->read(0, Column::contacts); }, {"run.yaml:8", "no contact dumps are given"});
}

TEST_F(ContactFaults, NoContactDumpOfTheStep) {
  const std::string path = files_.write("contacts", contact_dump(5, "id1 id2 fx fy fz", {}));
  spec_.contacts.files = {path};
  const auto source = open_dumps(spec_);
  EXPECT_NO_THROW(source->read(0, {}));
  expect_error<InputError>([&] { source->read(0, Column::contacts); },
                           {"run.yaml:8", "no contact dump has timestep 0", path});
}

TEST_F(ContactFaults, PatternWithoutMatch) {
  spec_.contacts.files = {files_.path("contacts*")};
  expect_error<InputError>([&] { open_dumps(spec_); }, {"run.yaml:8", "no file matches"});
}

TEST_F(ContactFaults, OneStepInTwoContactFiles) {
  const std::string text = contact_dump(0, "id1 id2 fx fy fz", {});
  const std::string a = files_.write("contacts_a", text), b = files_.write("contacts_b", text);
  spec_.contacts.files = {a, b};
  expect_error<InputError>([&] { open_dumps(spec_)->read(0, Column::contacts); },
                           {"timestep 0 comes twice", a + ":1", b + ":1"});
}

TEST_F(ContactFaults, ParticlesAmongTheContacts) {
  spec_.contacts.files = {files_.write("other", particle_dump(0, "id x y z", {}))};
  expect_error<InputError>([&] { open_dumps(spec_)->read(0, Column::contacts); }, {"other:9", "among the contacts"});
}

TEST_F(ContactFaults, BadRows) {
  const std::string columns = "id1 id2 fx fy fz";
  refuses(columns, {"1 2 0 0 nan"}, 10, {"column fz", "'nan'"});
  refuses(columns, {"1 2 0 0 1", "1 3 0 0"}, 11, {"too short", "4 fields"});
  refuses(columns, {"1 2 0 0 1 1"}, 10, {"too long"});
  refuses(columns, {"1 2.5 0 0 1"}, 10, {"column id2", "'2.5'"});
  refuses(columns, {"1e+06 2 0 0 1"}, 10, {"column id1", "'1e+06'", "dump_modify"});
  refuses(columns, {"1 -2 0 0 1"}, 10, {"column id2", "found -2"});
  refuses(columns, {"1 9007199254740993.0 0 0 1"}, 10, {"column id2", "2^53"});
}

TEST_F(ContactFaults, AParticleInContactWithItself) {
  refuses("id1 id2 fx fy fz", {"1 2 0 0 1", "2 2 0 0 1"}, 11, {"with itself", "id 2"});
}

TEST_F(ContactFaults, APairTwice) {
  refuses("id1 id2 fx fy fz", {"1 2 0 0 1", "1 3 0 0 1", "1 2 0 0 2"}, 12, {"particles 1 and 2", "twice", "line 10"});
  refuses("id1 id2 fx fy fz", {"1 2 0 0 1", "2 1 0 0 -1"}, 11, {"particles 1 and 2", "twice", "line 10"});
}

TEST_F(ContactFaults, CutOffContactDump) {
  std::string text = contact_dump(0, "id1 id2 fx fy fz", {"1 2 0 0 0.61"});
  text.resize(text.size() - 2);
  const std::string path = files_.write("contacts", text);
  spec_.contacts.files = {path};
  expect_error<InputError>([&] { open_dumps(spec_)->read(0, Column::contacts); }, {path + ":10", "newline"});
}

TEST_F(ContactFaults, ColumnsWithoutMeaning) {
  refuses("c_c[1] c_c[2] c_c[3]", {}, 9,
          {"not known", "c_c[1] c_c[2] c_c[3]", "input.contacts.compute", "input.contacts.columns"});
  refuses("id1 id2 fx fy", {}, 9, {"not known"});
}

TEST_F(ContactFaults, ColumnsThatTheKeywordsDoNotExplain) {
  spec_.contacts.compute = {"pos", "id", "force"};  // 12 columns
  refuses(indexed(1, 13), {}, 9, {"do not account for", "c_c[13]", "at most c_c[12]", "List every keyword"});
}

TEST_F(ContactFaults, AWiderHistoryHidesTheContactPoint) {
  spec_.contacts.compute = {"id", "force", "history", "contactPoint"};  // 12 columns, if the history is 3 wide
  refuses(indexed(1, 14), {}, 9, {"c_c[14]", "at most c_c[12]", "history", "input.contacts.columns"});
}

TEST_F(ContactFaults, ColumnsThatTheDumpLacks) {
  spec_.contacts.compute = {"pos", "id", "force", "contactPoint"};
  refuses(indexed(1, 8), {}, 9, {"lacks columns", "c_c[10] (force)", "c_c[12] (force)"});
  refuses(indexed(1, 6) + indexed(8, 12), {}, 9, {"lacks columns", "c_c[7] (id1)"});
  refuses(indexed(1, 14), {}, 9, {"lacks columns", "c_c[15] (contact point)"});
  spec_.contacts.compute = {"id"};
  refuses(indexed(1, 3), {}, 9, {"lacks columns", "force, or normal and tangential force"});
  spec_.contacts.compute = {"id", "force_normal"};
  refuses(indexed(1, 6), {}, 9, {"lacks columns", "force, or normal and tangential force"});
  spec_.contacts.compute = {"force"};
  refuses(indexed(1, 3), {}, 9, {"lacks columns", "id1, id2"});
}

TEST_F(ContactFaults, ColumnsOfTwoComputesOrOfNone) {
  spec_.contacts.compute = {"id", "force"};
  refuses("c_a[1] c_a[2] c_a[3] c_b[4] c_b[5] c_b[6]", {}, 9, {"more than one compute", "input.contacts.columns"});
  refuses("id1 id2 fx fy fz", {}, 9, {"no columns of a compute", "c_name[1]"});
}

TEST_F(ContactFaults, AColumnMapThatNamesColumnsThatAreNotThere) {
  spec_.contacts.columns = {{"id1", {"a"}}, {"id2", {"b"}}, {"force", {"p", "q", "r"}}, {"point", {"s", "t", "u"}}};
  refuses("a b p q s t", {}, 9, {"lacks columns", "found a b p q s t", "r (force)", "u (contact point)"});
  spec_.contacts.columns = {{"id1", {"a"}}, {"id2", {"b"}}, {"force", {"a", "q", "r"}}};
  refuses("a b q r", {}, 9, {"stands for an id and for another quantity"});
}

TEST_F(ContactFaults, UnitsOfTheContactDumpInConflict) {
  spec_.units = "si";
  const std::string path = files_.write("contacts", "ITEM: UNITS\nlj\n" + contact_dump(0, "id1 id2 fx fy fz", {}));
  spec_.contacts.files = {path};
  expect_error<InputError>([&] { open_dumps(spec_)->read(0, Column::contacts); }, {path + ":2", "units", "lj", "si"});
}

TEST_F(ContactFaults, SpecificationsThatCannotBeMeant) {
  const auto refuses_spec = [&](const std::vector<std::string>& parts) {
    expect_error<ConfigError>([&] { open_dumps(spec_); }, parts);
  };
  spec_.contacts.compute = {"id", "forces"};
  refuses_spec({"run.yaml:8", "unknown keyword", "'forces'", "force_normal"});
  spec_.contacts.compute = {"id", "force", "id"};
  refuses_spec({"'id' is listed twice"});
  spec_.contacts.compute = {"id"};
  spec_.contacts.columns = {{"id1", {"a"}}};
  refuses_spec({"both compute and columns"});
  spec_.contacts.compute = {};
  refuses_spec({"incomplete"});
  spec_.contacts.columns = {{"id1", {"a"}}, {"id2", {"b"}}, {"forces", {"p", "q", "r"}}};
  refuses_spec({"unknown quantity", "'forces'", "normal_force"});
  spec_.contacts.columns = {{"id1", {"a"}}, {"id2", {"b"}}, {"force", {"p", "q"}}};
  refuses_spec({"columns.force", "found 2", "expected 3"});
  spec_.contacts.columns = {{"id1", {"a"}}, {"id2", {"b"}}, {"normal_force", {"p", "q", "r"}}};
  refuses_spec({"incomplete", "normal_force"});
  spec_.contacts.columns = {
      {"id1", {"a"}}, {"id2", {"b"}}, {"force", {"p", "q", "r"}}, {"normal_force", {"p", "q", "r"}}};
  refuses_spec({"force twice"});
}

}  // namespace
}  // namespace grainvdb::contact_faults_test
