#include <cmath>
#include <filesystem>

#include <gmock/gmock.h>

#include "unit/pipeline/support.hpp"

namespace grainvdb::load_pipeline_test {
namespace {

using test::load;
using test::minimal_text;
using test::PipelineFile;
using Texts = std::vector<std::string>;

std::string full_text() {
  return R"(grainvdb: 1
input:
  particles: [dumps/a*.dump, /elsewhere/b.dump]
  dt: 1.0e-6
  units: si
  density: 2500
  radius: 0.5
  contacts:
    files: dumps/contacts
    columns:
      id1: c_pp[1]
      id2: ["c_pp[2]"]
      normal_force: [fnx, fny, fnz]
      tangential_force: [ftx, fty, ftz]
select:
  types: [1, 3]
  ids: [1, 500]
  region: {lo: [-.inf, 0, -1.5], hi: [.inf, 2, .inf]}
frames: 2:-1:3
lattice: {voxel: 0.4e-3, origin: [0.1, -2, 3e2]}
kernel: {name: lucy, cutoff: 2.4e-3}
average: {window: 4}
output: {fields: [velocity, phi], formats: [hdf5]}
stages:
  temperature: {mode: two_pass_profile}
  contact_stress: {points: 3}
  mu: {least_pressure: 1, strict: false, axes: [z, x]}
limits: {extent: 5000, dense_voxels: 4e9, memory_gb: 1.5, volume_error: 0.01}
)";
}

TEST(LoadPipeline, ReadsEveryKey) {
  const PipelineFile file(full_text());
  const Pipeline p = load_pipeline(file.path(), {}, test::example_registry());
  EXPECT_EQ(p.file, file.path());
  EXPECT_EQ(p.input.particles, (Texts{file.folder() + "/dumps/a*.dump", "/elsewhere/b.dump"}));
  EXPECT_EQ(p.input.dt, 1e-6);
  EXPECT_EQ(p.input.units, "si");
  EXPECT_EQ(p.input.density, 2500.0);
  EXPECT_EQ(p.input.radius, 0.5);
  EXPECT_EQ(p.input.contacts.files, Texts{file.folder() + "/dumps/contacts"});
  EXPECT_EQ(p.input.contacts.columns.size(), 4U);
  EXPECT_EQ(p.input.contacts.columns.at("id2"), Texts{"c_pp[2]"});
  EXPECT_EQ(p.input.contacts.columns.at("tangential_force"), (Texts{"ftx", "fty", "ftz"}));
  EXPECT_EQ(p.select.types, (std::vector<int>{1, 3}));
  EXPECT_EQ(p.select.ids, (std::pair<std::int64_t, std::int64_t>{1, 500}));
  EXPECT_EQ(p.select.region->first, (Vec3{-INFINITY, 0, -1.5}));
  EXPECT_EQ(p.select.region->second, (Vec3{INFINITY, 2, INFINITY}));
  EXPECT_EQ(p.frames.start, 2);
  EXPECT_EQ(p.frames.stop, -1);
  EXPECT_EQ(p.frames.step, 3);
  EXPECT_EQ(p.voxel, 0.4e-3);
  EXPECT_EQ(p.origin, (Vec3{0.1, -2, 300}));
  EXPECT_EQ(p.cutoff, 2.4e-3);
  EXPECT_EQ(p.window, 4U);
  EXPECT_EQ(p.fields, (Texts{"velocity", "phi"}));
  EXPECT_EQ(p.formats, Texts{"hdf5"});
  EXPECT_EQ(option<std::string>(p.stages, "temperature", "mode"), "two_pass_profile");
  EXPECT_EQ(option<std::int64_t>(p.stages, "contact_stress", "points"), 3);
  EXPECT_EQ(option<double>(p.stages, "mu", "least_pressure"), 1.0);
  EXPECT_FALSE(option<bool>(p.stages, "mu", "strict"));
  EXPECT_EQ(option<Texts>(p.stages, "mu", "axes"), (Texts{"z", "x"}));
  EXPECT_EQ(p.limits.extent, 5000);
  EXPECT_EQ(p.limits.dense_voxels, 4'000'000'000);
  EXPECT_EQ(p.limits.memory_gb, 1.5);
  EXPECT_EQ(p.limits.volume_error, 0.01);
}

TEST(LoadPipeline, FillsInDefaults) {
  const Pipeline p = load(minimal_text());
  EXPECT_TRUE(p.select.empty());
  EXPECT_TRUE(p.input.contacts.files.empty());
  EXPECT_FALSE(p.input.dt || p.input.units || p.input.density || p.input.radius);
  EXPECT_EQ(select_frames(p.frames, 3).size(), 3U);
  EXPECT_EQ(p.origin, Vec3{});
  EXPECT_EQ(p.window, 0U);
  EXPECT_EQ(p.formats, Texts{"hdf5"});
  EXPECT_EQ(option<std::string>(p.stages, "temperature", "mode"), "two_pass");
  EXPECT_EQ(option<Texts>(p.stages, "mu", "axes"), Texts{"x"});
  EXPECT_EQ(p.limits.extent, Limits{}.extent);
  EXPECT_EQ(p.limits.dense_voxels, Limits{}.dense_voxels);
}

TEST(LoadPipeline, TakesWhatDumpsLeaveUnsaid) {
  std::string text = full_text();
  text.insert(text.find("  radius:"),
              "  columns: [id, x, y, z]\n  periodic: xy\n  box: {lo: [0, 0, -1], hi: [1, 2, 3]}\n");
  const Pipeline p = load(text);
  EXPECT_EQ(p.input.columns, (Texts{"id", "x", "y", "z"}));
  EXPECT_EQ(p.input.periodic, "xy");
  ASSERT_TRUE(p.input.box);
  EXPECT_EQ(p.input.box->lo, (Vec3{0, 0, -1}));
  EXPECT_EQ(p.input.box->hi, (Vec3{1, 2, 3}));
}

TEST(LoadPipeline, SaysWhereEachKeyStands) {
  const PipelineFile file(full_text());
  const Pipeline p = load_pipeline(file.path(), {"kernel.cutoff=1"}, test::example_registry());
  EXPECT_EQ(to_string(p.location("lattice.voxel")), file.path() + ":20");
  EXPECT_EQ(p.location("input.contacts").line, 8U);
  EXPECT_EQ(p.location("input.contacts.columns.normal_force").line, 13U);
  EXPECT_EQ(p.location("stages.mu.axes").line, 27U);
  EXPECT_EQ(p.location("frames").line, 19U);
  EXPECT_EQ(p.location("output.fields").line, 23U);
  EXPECT_EQ(to_string(p.location("kernel.cutoff")), "--set kernel.cutoff=1");
  EXPECT_EQ(to_string(p.location("no.such.key")), file.path());
  EXPECT_EQ(p.input.where.at("input.dt").line, 4U);
  EXPECT_EQ(p.input.where.at("input.contacts.files").line, 9U);
  EXPECT_FALSE(p.input.where.contains("lattice.voxel"));
}

// Everything but the resolved text and the places.
void expect_same(const Pipeline& a, const Pipeline& b) {
  EXPECT_EQ(a.input.particles, b.input.particles);
  EXPECT_EQ(a.input.contacts.files, b.input.contacts.files);
  EXPECT_EQ(a.input.contacts.compute, b.input.contacts.compute);
  EXPECT_EQ(a.input.contacts.columns, b.input.contacts.columns);
  EXPECT_EQ(a.input.dt, b.input.dt);
  EXPECT_EQ(a.input.units, b.input.units);
  EXPECT_EQ(a.input.density, b.input.density);
  EXPECT_EQ(a.input.radius, b.input.radius);
  EXPECT_EQ(a.input.columns, b.input.columns);
  EXPECT_EQ(a.input.periodic, b.input.periodic);
  EXPECT_EQ(a.input.box, b.input.box);
  EXPECT_EQ(a.select.types, b.select.types);
  EXPECT_EQ(a.select.ids, b.select.ids);
  EXPECT_EQ(a.select.region, b.select.region);
  EXPECT_EQ(a.frames.start, b.frames.start);
  EXPECT_EQ(a.frames.stop, b.frames.stop);
  EXPECT_EQ(a.frames.step, b.frames.step);
  EXPECT_EQ(a.voxel, b.voxel);
  EXPECT_EQ(a.origin, b.origin);
  EXPECT_EQ(a.cutoff, b.cutoff);
  EXPECT_EQ(a.window, b.window);
  EXPECT_EQ(a.fields, b.fields);
  EXPECT_EQ(a.stages, b.stages);
  EXPECT_EQ(a.formats, b.formats);
  EXPECT_EQ(a.limits.extent, b.limits.extent);
  EXPECT_EQ(a.limits.dense_voxels, b.limits.dense_voxels);
  EXPECT_EQ(a.limits.memory_gb, b.limits.memory_gb);
  EXPECT_EQ(a.limits.volume_error, b.limits.volume_error);
}

TEST(LoadPipeline, TheResolvedTextIsTheSamePipeline) {
  for (const std::string& text : {minimal_text(), full_text()}) {
    Pipeline original = load(text), again = load(original.resolved);
    // Each was read from a folder of its own.
    for (Pipeline* p : {&original, &again}) {
      const std::string folder = p->file.substr(0, p->file.rfind('/'));
      for (std::string& path : p->input.particles)
        if (path.starts_with(folder)) path.erase(0, folder.size());
      for (std::string& path : p->input.contacts.files) path.erase(0, folder.size());
    }
    expect_same(original, again);
    EXPECT_EQ(again.resolved, original.resolved);
  }
}

TEST(LoadPipeline, TheResolvedTextQuotesWhatYamlWouldMisread) {
  std::string text = minimal_text();
  text.replace(text.find("dumps/*.dump"), 12, "[\"*.dump\", 'true', \"null\", '12', 'a: b', \"q\\\"\\n\", 'é#1', y]");
  const Pipeline p = load(text);
  const Pipeline again = load(p.resolved);
  ASSERT_EQ(p.input.particles.size(), 8U);
  for (std::size_t i = 0; i < 8; ++i)
    EXPECT_EQ(p.input.particles[i].substr(p.file.rfind('/')), again.input.particles[i].substr(again.file.rfind('/')));
}

TEST(LoadPipeline, TheFolderOfTheFileIsNotAPattern) {
  const PipelineFile file(minimal_text());
  const std::string folder = file.folder() + "/run[1]*";
  std::filesystem::create_directory(folder);
  std::filesystem::copy(file.path(), folder);
  EXPECT_EQ(load_pipeline(folder + "/p.yaml", {}, test::example_registry()).input.particles,
            Texts{file.folder() + "/run\\[1]\\*/dumps/*.dump"});
  EXPECT_EQ(load_pipeline(folder + "/p.yaml", {"input.particles=one.dump"}, test::example_registry()).input.particles,
            Texts{folder + "/one.dump"});
}

TEST(Overrides, WinOverTheFileAndOverEarlierOnes) {
  const Pipeline p = load(minimal_text(), {"kernel.cutoff=2", "kernel.cutoff=2.5", "output.fields=[phi]",
                                           "average.window=3", "stages.mu.axes=[y, z]",
                                           "lattice={voxel: 0.25, origin: [1, 1, 1]}", "input.contacts.files=c.dump"});
  EXPECT_EQ(p.cutoff, 2.5);
  EXPECT_EQ(p.fields, Texts{"phi"});
  EXPECT_EQ(p.window, 3U);
  EXPECT_EQ(option<Texts>(p.stages, "mu", "axes"), (Texts{"y", "z"}));
  EXPECT_EQ(p.voxel, 0.25);
  EXPECT_EQ(p.origin, (Vec3{1, 1, 1}));
  EXPECT_EQ(p.input.contacts.files.size(), 1U);
}

TEST(LoadPipeline, TimeWindows) {
  EXPECT_EQ(load(minimal_text(), {"average.window=none"}).window, 1U);
  EXPECT_EQ(load(minimal_text(), {"average.window=all"}).window, 0U);
  const Pipeline p = load(minimal_text(), {"average.window=10", "average.step=3"});
  EXPECT_EQ(p.window, 10U);
  EXPECT_EQ(p.window_step, 3U);
}

TEST(Overrides, RangesOfFramesNeedNoQuotes) {
  EXPECT_EQ(load(minimal_text(), {"frames=10:"}).frames.start, 10);
  EXPECT_EQ(load(minimal_text(), {"frames=::"}).frames.step, 1);
  EXPECT_EQ(load(minimal_text(), {"frames=::2"}).frames.step, 2);
  EXPECT_EQ(load(minimal_text(), {"frames='-5:'"}).frames.start, -5);
  EXPECT_EQ(load(minimal_text(), {"frames=3"}).frames.stop, 4);
}

TEST(Overrides, MayRepairTheFile) {
  std::string text = minimal_text();
  text.replace(text.find("cutoff: 3"), 9, "cutoff: x");
  EXPECT_EQ(load(text, {"kernel.cutoff=3"}).cutoff, 3);
}

TEST(Overrides, MayLeaveOutSections) {
  const Texts shells{"measure.profile.axis=x", "measure.profile.bin=2"};
  Texts overrides = shells;
  EXPECT_EQ(load(minimal_text(), overrides).measure.size(), 1U);
  overrides.emplace_back("measure.profile=null");
  overrides.emplace_back("measure.plane_profile.axis=y");
  const Pipeline p = load(minimal_text(), overrides);
  EXPECT_EQ(p.measure.size(), 1U);
  EXPECT_TRUE(p.measure.contains("plane_profile"));
  EXPECT_FALSE(p.where.contains("measure.profile.axis"));
  EXPECT_FALSE(load(minimal_text(), {"trace=null"}).trace) << "there was none";
  EXPECT_THROW(load(minimal_text(), {"kernel=null"}), ConfigError) << "it is needed";
  EXPECT_THROW(load(minimal_text(), {"kernel.cutoff=null"}), ConfigError) << "no section";
}

TEST(LoadPipeline, AverageUntil) {
  const auto with = [](const std::string& average) {
    const PipelineFile file(
        "grainvdb: 1\ninput: {particles: a}\nlattice: {voxel: 1}\nkernel: {cutoff: 3}\n"
        "output: {fields: [phi]}\naverage: " +
        average + "\n");
    return load_pipeline(file.path());
  };
  EXPECT_FALSE(with("{window: all}").until);
  const Pipeline p = with("{blocks: 8, until: {field: mu, relative: 0.01, quantile: 0.9}}");
  EXPECT_EQ(p.blocks, 8U);
  ASSERT_TRUE(p.until);
  EXPECT_EQ(p.until->field, "mu");
  EXPECT_EQ(p.until->error, 0.01);
  EXPECT_TRUE(p.until->relative);
  EXPECT_EQ(p.until->quantile, 0.9);
  EXPECT_FALSE(with("{until: {field: velocity, error: 2, quantile: 1}}").until->relative);
  for (const char* refused :
       {"{until: {field: mu, quantile: 0.9}}", "{until: {field: mu, error: 1, relative: 1, quantile: 0.9}}",
        "{until: {field: mu, error: 1}}", "{until: {field: mask, error: 1, quantile: 0.9}}",
        "{until: {field: mu, error: 0, quantile: 0.9}}", "{until: {field: mu, error: 1, quantile: 1.1}}",
        "{window: 4, until: {field: mu, error: 1, quantile: 0.9}}", "{blocks: 1}"})
    EXPECT_THROW(with(refused), ConfigError) << refused;
}

TEST(LoadPipeline, ContactsOfLammpsComputes) {
  const auto with = [](const std::string& contacts) {
    std::string text = minimal_text();
    const std::string before = "lattice:";
    return text.insert(text.find(before), "  contacts: " + contacts + "\n");
  };
  const ContactSpec contacts = load(with("{files: c, lammps: {ids: pp, forces: pl}}")).input.contacts;
  EXPECT_EQ(contacts.columns, (std::map<std::string, Texts>{{"id1", {"c_pp[1]"}},
                                                            {"id2", {"c_pp[2]"}},
                                                            {"normal_force", {"c_pl[1]", "c_pl[2]", "c_pl[3]"}},
                                                            {"tangential_force", {"c_pl[4]", "c_pl[5]", "c_pl[6]"}}}));
  EXPECT_TRUE(contacts.compute.empty());
  EXPECT_THAT(test::refusal(with("{files: c, lammps: {ids: pp}}")),
              testing::HasSubstr("'input.contacts.lammps.forces' is missing"));
  EXPECT_THAT(test::refusal(with("{files: c, lammps: {ids: pp, forces: pl}, compute: [id, force]}")),
              testing::HasSubstr("input.contacts.compute beside input.contacts.lammps"));
  EXPECT_THAT(
      test::refusal(with("{files: c, lammps: {ids: pp, forces: pl}, columns: {id1: a, id2: b, force: [x, y, z]}}")),
      testing::HasSubstr("input.contacts.columns beside input.contacts.lammps"));
}

TEST(LoadPipeline, ContactsWithWalls) {
  const auto with = [](const std::string& walls) {
    std::string text = minimal_text();
    const std::string before = "lattice:";
    return text.insert(text.find(before), "  wall_contacts: " + walls + "\n");
  };
  const WallContactSpec by_compute = load(with("{files: /d/w*, compute: [pos, id, force]}")).input.wall_contacts;
  EXPECT_EQ(by_compute.files, Texts{"/d/w*"});
  EXPECT_EQ(by_compute.compute, (Texts{"pos", "id", "force"}));
  EXPECT_TRUE(by_compute.columns.empty());
  const WallContactSpec by_columns =
      load(with("{files: /d/w, columns: {id: i, mesh: m, triangle: t, force: [a, b, c], point: [x, y, z]}}"))
          .input.wall_contacts;
  EXPECT_EQ(by_columns.columns, (std::map<std::string, Texts>{{"id", {"i"}},
                                                              {"mesh", {"m"}},
                                                              {"triangle", {"t"}},
                                                              {"force", {"a", "b", "c"}},
                                                              {"point", {"x", "y", "z"}}}));
  EXPECT_THAT(test::refusal(with("{compute: [pos, id, force]}")),
              testing::HasSubstr("'input.wall_contacts.files' is missing"));
  EXPECT_THAT(test::refusal(with("{files: w, columns: {id: i, force: [a, b, c]}}")),
              testing::HasSubstr("'input.wall_contacts.columns.point' is missing"));
  EXPECT_THAT(test::refusal(with("{files: w, columns: {id: i, point: [x, y, z]}}")),
              testing::HasSubstr("the contact force must be given in one way"));
  EXPECT_THAT(test::refusal(with("{files: w, compute: [id], columns: {id: i, force: [a, b, c], point: [x, y, z]}}")),
              testing::HasSubstr("the columns of the wall contact dumps are described twice"));
}

}  // namespace
}  // namespace grainvdb::load_pipeline_test
