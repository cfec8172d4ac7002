/// Pipelines that cannot be run as written: each ends with one error that names the line, what was found and what was
/// expected.
#include <gmock/gmock.h>

#include "grainvdb/field_sink.hpp"
#include "unit/pipeline/support.hpp"

namespace grainvdb::refusals_test {
namespace {

using test::minimal_text;
using test::refusal;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

// The minimal file with one text replaced.
std::string with(const std::string& from, const std::string& to) {
  std::string text = minimal_text();
  const auto at = text.find(from);
  if (at == std::string::npos) throw std::logic_error("no '" + from + "' in the file");
  return text.replace(at, from.size(), to);
}

// The minimal file with lines added at its end, from line 10 on.
std::string plus(const std::string& lines) {
  return minimal_text() + lines;
}

TEST(Refusals, UnknownNames) {
  EXPECT_THAT(refusal(with("cutoff:", "cutof:")),
              AllOf(StartsWith("FILE:7: unknown key 'cutof' in section 'kernel'"), HasSubstr("expected name, cutoff or accumulation"),
                    HasSubstr("Did you mean 'cutoff'?")));
  EXPECT_THAT(refusal(with("kernel:", "kernal:")),
              AllOf(StartsWith("FILE:6: unknown key 'kernal';"), HasSubstr("Did you mean 'kernel'?")));
  EXPECT_THAT(refusal(with("velocity]", "velocitie]")),
              AllOf(StartsWith("FILE:9: unknown name in output.fields; found 'velocitie'"),
                    HasSubstr("Did you mean 'velocity'?")));
  EXPECT_THAT(refusal(plus("stages:\n  temprature: {mode: one_pass}\n")),
              AllOf(StartsWith("FILE:11: unknown stage 'temprature'"), HasSubstr("Did you mean 'temperature'?")));
  EXPECT_THAT(refusal(plus("stages:\n  temperature:\n    mod: one_pass\n")),
              AllOf(StartsWith("FILE:12: unknown key 'mod' in section 'stages.temperature'"),
                    HasSubstr("Did you mean 'mode'?")));
  EXPECT_THAT(refusal(plus("stages:\n  temperature:\n    mode: two_passes\n")),
              AllOf(StartsWith("FILE:12: unknown name in stages.temperature.mode; found 'two_passes'"),
                    HasSubstr("Did you mean 'two_pass'?")));
  EXPECT_THAT(refusal(plus("stages: {mu: {axes: [x, w]}}\n")), StartsWith("FILE:10: unknown name in stages.mu.axes"));
  EXPECT_THAT(refusal(plus("stages: {phi: {mode: x}}\n")),
              AllOf(StartsWith("FILE:10: unknown key 'mode'"), HasSubstr("nothing to set")));
  EXPECT_THAT(refusal(with("[phi, velocity]", "[phi]\n  formats: hdf")),
              AllOf(StartsWith("FILE:10: unknown name in output.formats"), HasSubstr("Did you mean 'hdf5'?")));
  EXPECT_THAT(refusal(with("cutoff:", "name: lucky\n  cutoff:")), HasSubstr("Did you mean 'lucy'?"));
  EXPECT_THAT(refusal(with("  particles:", "  units: SI\n  particles:")), HasSubstr("Did you mean 'si'?"));
}

TEST(Refusals, KeysInTheWrongPlace) {
  EXPECT_THAT(refusal(plus("window: 3\n")),
              AllOf(StartsWith("FILE:10: unknown key 'window'"), HasSubstr("There is 'average.window'.")));
  EXPECT_THAT(refusal(plus("kernel.name: lucy\n")), StartsWith("FILE:10: unknown key 'kernel.name'"));
  EXPECT_THAT(refusal(plus("select.region: {lo: [0,0,0], hi: [1,1,1]}\n")),
              StartsWith("FILE:10: unknown key 'select.region'"));
}

TEST(Refusals, RepeatedKeys) {
  EXPECT_THAT(refusal(plus("kernel: {cutoff: 4}\n")),
              AllOf(StartsWith("FILE:10: the key 'kernel' is repeated"), HasSubstr("It stands first in line 6.")));
  EXPECT_THAT(refusal(with("  cutoff: 3\n", "  cutoff: 3\n  cutoff: 4\n")),
              StartsWith("FILE:8: the key 'cutoff' is repeated"));
}

TEST(Refusals, RepeatedItems) {
  EXPECT_THAT(refusal(with("[phi, velocity]", "[phi, velocity,\n   phi]")),
              StartsWith("FILE:10: output.fields names 'phi' twice"));
  EXPECT_THAT(refusal(with("dumps/*.dump", "[a, b, a]")), StartsWith("FILE:3: input.particles names 'a' twice"));
}

TEST(Refusals, MissingKeys) {
  EXPECT_THAT(refusal(with("  cutoff: 3\n", "  name: lucy\n")),
              AllOf(StartsWith("FILE:6: the key 'kernel.cutoff' is missing"), HasSubstr("a number > 0 [length]")));
  EXPECT_THAT(refusal(with("lattice:\n  voxel: 0.5\n", "")), StartsWith("FILE: the section 'lattice' is missing"));
  EXPECT_THAT(refusal(with("  voxel: 0.5\n", "")), StartsWith("FILE:4: section 'lattice' is empty"));
  EXPECT_THAT(refusal(with("grainvdb: 1\n", "")),
              AllOf(HasSubstr("not a grainvdb pipeline file"), HasSubstr("expected grainvdb: 1")));
  EXPECT_THAT(refusal(plus("select: {region: {lo: [0, 0, 0]}}\n")),
              StartsWith("FILE:10: the key 'select.region.hi' is missing"));
  EXPECT_THAT(refusal(plus("select:\n")), StartsWith("FILE:10: section 'select' is empty"));
  EXPECT_THAT(refusal(with("0.5", "")), StartsWith("FILE:5: lattice.voxel has no value"));
}

TEST(Refusals, WrongTypes) {
  EXPECT_THAT(refusal(with("0.5", "half")),
              AllOf(StartsWith("FILE:5: lattice.voxel is not a number; found 'half'; expected a number > 0 [length]")));
  EXPECT_THAT(refusal(with("0.5", "0.4mm")), AllOf(StartsWith("FILE:5: lattice.voxel is not a number; found '0.4mm'"),
                                                   HasSubstr("without their unit")));
  EXPECT_THAT(refusal(with("0.5", "\"0.5\"")), StartsWith("FILE:5: lattice.voxel must not be in quotes"));
  EXPECT_THAT(refusal(with("0.5", "[0.5]")), StartsWith("FILE:5: lattice.voxel must be a single value; found a list"));
  EXPECT_THAT(refusal(with("0.5", "{a: 0.5}")),
              StartsWith("FILE:5: lattice.voxel must be a single value; found a section"));
  EXPECT_THAT(refusal(with("lattice:\n  voxel: 0.5", "lattice: 0.5")),
              StartsWith("FILE:4: section 'lattice' must hold keys; found '0.5'"));
  EXPECT_THAT(refusal("- a\n- b\n"), HasSubstr("FILE"));
  EXPECT_THAT(refusal("just text\n"), HasSubstr("FILE"));
  EXPECT_THAT(refusal(with("voxel: 0.5", "voxel: 0.5\n  origin: 3")),
              StartsWith("FILE:6: lattice.origin must be a list"));
  EXPECT_THAT(
      refusal(with("voxel: 0.5", "voxel: 0.5\n  origin: [1, 2]")),
      StartsWith("FILE:6: lattice.origin has the wrong number of items; found 2; expected a list of 3 numbers"));
  EXPECT_THAT(refusal(with("voxel: 0.5", "voxel: 0.5\n  origin: [1,\n   b, 3]")),
              StartsWith("FILE:7: lattice.origin is not a number"));
  EXPECT_THAT(refusal(plus("average: {window: some}\n")),
              StartsWith("FILE:10: average.window is not a number of frames"));
  EXPECT_THAT(refusal(plus("stages: {mu: {strict: yes}}\n")),
              StartsWith("FILE:10: stages.mu.strict must be true or false; found 'yes'"));
  EXPECT_THAT(refusal(plus("stages: {mu: {strict: 'true'}}\n")),
              StartsWith("FILE:10: stages.mu.strict must not be in quotes"));
  EXPECT_THAT(refusal(plus("stages: {contact_stress: {points: 1.5}}\n")),
              StartsWith("FILE:10: stages.contact_stress.points is not a whole number"));
  EXPECT_THAT(refusal(plus("frames: [1, 2]\n")), StartsWith("FILE:10: frames must be a single value"));
  EXPECT_THAT(refusal(plus("select: {types: 1.5}\n")), StartsWith("FILE:10: select.types must be a list"));
  EXPECT_THAT(refusal(with("[phi, velocity]", "[phi, [velocity]]")),
              StartsWith("FILE:9: output.fields must be a single value; found a list"));
}

TEST(Refusals, ImpossibleValues) {
  for (const char* bad : {"0", "-1", "-0.0"})
    EXPECT_THAT(refusal(with("0.5", bad)), StartsWith("FILE:5: lattice.voxel is too small")) << bad;
  for (const char* bad : {".nan", "nan", "1e999", "inf"})
    EXPECT_THAT(refusal(with("0.5", bad)), StartsWith("FILE:5: lattice.voxel is not a number")) << bad;
  EXPECT_THAT(refusal(with("0.5", ".inf")), StartsWith("FILE:5: lattice.voxel must be finite"));
  EXPECT_THAT(refusal(with("cutoff: 3", "cutoff: 0")), StartsWith("FILE:7: kernel.cutoff is too small"));
  EXPECT_THAT(refusal(with("cutoff: 3", "cutoff: -.inf")), StartsWith("FILE:7: kernel.cutoff must be finite"));
  EXPECT_THAT(refusal(with("voxel: 0.5", "voxel: 0.5\n  origin: [0, .inf, 0]")),
              StartsWith("FILE:6: lattice.origin must be finite"));
  for (const char* key : {"dt", "density", "radius"})
    EXPECT_THAT(refusal(with("  particles:", std::string("  ") + key + ": 0\n  particles:")),
                StartsWith("FILE:3: input." + std::string(key) + " is too small"));
  EXPECT_THAT(refusal(with("grainvdb: 1", "grainvdb: 2")),
              AllOf(StartsWith("FILE:1: grainvdb is too large"), HasSubstr("another release")));
  EXPECT_THAT(refusal(plus("average: {window: 0}\n")), StartsWith("FILE:10: average.window is too small"));
  EXPECT_THAT(refusal(plus("average: {window: 3, step: 0}\n")), StartsWith("FILE:10: average.step is too small"));
  EXPECT_THAT(
      refusal(plus("average: {step: 5}\n")),
      AllOf(StartsWith("FILE:10: average.step has no meaning for one mean of all frames"), HasSubstr("frames: ::5")));
  EXPECT_THAT(refusal(plus("limits: {extent: 0}\n")), StartsWith("FILE:10: limits.extent is too small"));
  EXPECT_THAT(refusal(plus("limits: {extent: 1e10}\n")), StartsWith("FILE:10: limits.extent is too large"));
  EXPECT_THAT(refusal(plus("limits: {memory_gb: -1}\n")), StartsWith("FILE:10: limits.memory_gb is too small"));
  EXPECT_THAT(
      refusal(plus("stages: {contact_stress: {points: 9}}\n")),
      AllOf(StartsWith("FILE:10: stages.contact_stress.points is too large; found '9'"), HasSubstr(">= 0 and <= 8")));
  EXPECT_THAT(refusal(plus("stages: {mu: {least_pressure: -1}}\n")),
              StartsWith("FILE:10: stages.mu.least_pressure is too small"));
  EXPECT_THAT(refusal(plus("select: {types: [-1]}\n")), StartsWith("FILE:10: select.types is too small"));
}

TEST(Refusals, EmptyListsAndTexts) {
  EXPECT_THAT(refusal(with("[phi, velocity]", "[]")), StartsWith("FILE:9: output.fields is an empty list"));
  EXPECT_THAT(refusal(with("dumps/*.dump", "[]")), StartsWith("FILE:3: input.particles is an empty list"));
  EXPECT_THAT(refusal(with("dumps/*.dump", "''")), StartsWith("FILE:3: input.particles is empty"));
  EXPECT_THAT(refusal(with("dumps/*.dump", "[a, ~]")), StartsWith("FILE:3: input.particles has no value"));
  EXPECT_THAT(refusal(plus("select: {types: []}\n")), StartsWith("FILE:10: select.types is an empty list"));
}

TEST(Refusals, FramesThatSelectNothing) {
  for (const char* bad : {"a:b", "::0", "::-1", "1:2:3:4", "'1 2'", "1.5"})
    EXPECT_THAT(refusal(plus(std::string("frames: ") + bad + "\n")),
                StartsWith("FILE:10: frames is not a range of frames"))
        << bad;
  for (const char* bad : {"5:5", "5:3", "-1:-3", ":0"})
    EXPECT_THAT(refusal(plus(std::string("frames: '") + bad + "'\n")), StartsWith("FILE:10: frames selects no frame"))
        << bad;
}

TEST(Refusals, SelectionsThatSelectNothing) {
  EXPECT_THAT(refusal(plus("select:\n  ids: [5, 4]\n")),
              StartsWith("FILE:11: select.ids selects nothing; found [5, 4]"));
  EXPECT_THAT(refusal(plus("select:\n  ids: [5]\n")), StartsWith("FILE:11: select.ids has the wrong number of items"));
  EXPECT_THAT(refusal(plus("select:\n  region: {lo: [0, 1, 0], hi: [1, 1, 1]}\n")),
              StartsWith("FILE:11: select.region selects nothing along y"));
}

TEST(Refusals, ContactsDescribedTwiceOrNotWhole) {
  const auto contacts = [](const std::string& lines) {
    return with("lattice:", "  contacts:\n    files: c*\n" + lines + "lattice:");
  };
  EXPECT_THAT(refusal(contacts("    compute: [id, force]\n    columns: {id1: a, id2: b, force: [x, y, z]}\n")),
              StartsWith("FILE:4: the columns of the contact dumps are described twice"));
  EXPECT_THAT(refusal(contacts("    compute: [id, forse]\n")),
              AllOf(StartsWith("FILE:6: unknown name in input.contacts.compute"), HasSubstr("Did you mean 'force'?")));
  EXPECT_THAT(refusal(contacts("    columns: {id1: a, id2: b}\n")),
              StartsWith("FILE:6: the contact force must be given in one way"));
  EXPECT_THAT(refusal(contacts("    columns: {id1: a, id2: b, normal_force: [x, y, z]}\n")),
              StartsWith("FILE:6: the contact force must be given in one way"));
  EXPECT_THAT(
      refusal(contacts(
          "    columns: {id1: a, id2: b, force: [x, y, z], normal_force: [p, q, r], tangential_force: [s, t, u]}\n")),
      StartsWith("FILE:6: the contact force must be given in one way"));
  EXPECT_THAT(refusal(contacts("    columns: {id1: a, force: [x, y, z]}\n")),
              StartsWith("FILE:6: the key 'input.contacts.columns.id2' is missing"));
  EXPECT_THAT(refusal(contacts("    columns: {id1: a, id2: b, force: [x, y]}\n")),
              StartsWith("FILE:6: input.contacts.columns.force has the wrong number of items; found 2"));
  EXPECT_THAT(refusal(with("lattice:", "  contacts: {compute: [id, force]}\nlattice:")),
              StartsWith("FILE:4: the key 'input.contacts.files' is missing"));
}

TEST(Refusals, YamlThatIsRefusedAtAll) {
  EXPECT_THAT(refusal(plus("---\na: 1\n")), StartsWith("FILE:10: a second YAML document"));
  EXPECT_THAT(refusal(with("dumps/*.dump", "*.dump")),
              StartsWith("FILE:3: this is not valid YAML"));  // an alias to nothing
  EXPECT_THAT(refusal(plus("select: &s {types: *s}\n")), StartsWith("FILE:10: this alias stands inside"));
}

TEST(Refusals, OverridesSayWhichOneIsWrong) {
  const auto set = [](const std::string& text) { return refusal(minimal_text(), {text}); };
  EXPECT_THAT(set("kernel.cutof=3"), AllOf(StartsWith("--set kernel.cutof=3: unknown key 'cutof' in section 'kernel'"),
                                           HasSubstr("Did you mean 'cutoff'?")));
  EXPECT_THAT(set("kernel.cutoff=3mm"),
              StartsWith("--set kernel.cutoff=3mm: kernel.cutoff is not a number; found '3mm'"));
  EXPECT_THAT(set("kernel.cutoff="), StartsWith("--set kernel.cutoff=: kernel.cutoff has no value"));
  EXPECT_THAT(set("kernel.cutoff.x=1"), StartsWith("--set kernel.cutoff.x=1: kernel.cutoff must be a single value"));
  EXPECT_THAT(set("output.fields=[phi, phi]"),
              StartsWith("--set output.fields=[phi, phi]: output.fields names 'phi' twice"));
  EXPECT_THAT(set("output.fields=[phi"), StartsWith("--set output.fields=[phi: this is not valid YAML"));
  EXPECT_THAT(set("frames=1:x"), StartsWith("--set frames=1:x: frames is not a range of frames"));
  EXPECT_THAT(set("kernel.cutoff"), HasSubstr("an override must have the form key=value"));
  EXPECT_THAT(set("=3"), HasSubstr("an override must have the form key=value"));
  EXPECT_THAT(set("kernel..cutoff=3"), HasSubstr("a part of the key is empty"));
  EXPECT_THAT(set("kernel.=3"), HasSubstr("a part of the key is empty"));
  EXPECT_THAT(set("select={types: [1], types: [2]}"), HasSubstr("the key 'types' is repeated"));
}

}  // namespace
}  // namespace grainvdb::refusals_test
