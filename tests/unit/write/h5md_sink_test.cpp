#include "write/h5md_sink.hpp"

#include <cmath>
#include <functional>

#include <gmock/gmock.h>

#include "unit/write/hdf5_reader.hpp"
#include "unit/write/tracer_scene.hpp"

namespace grainvdb::h5md_sink_test {
namespace {

using namespace testing;  // NOLINT: the folder's own helpers
using ::testing::ElementsAre;
using ::testing::ElementsAreArray;
using ::testing::HasSubstr;

const std::string group = "/particles/tracers/";

void write_scene(const TracerScene& scene, const std::string& folder) {
  const auto sink = make_h5md_sink(folder);
  scene.write_all(*sink);
  sink->commit(some_provenance());
}

/// Compares every value of an element with `expected(component, tracer, sample)`.
template <class T>
void expect_element(const Hdf5Reader& file, const TracerScene& scene, const std::string& name, int components,
                    const std::function<T(int, std::size_t, int)>& expected) {
  std::vector<hsize_t> shape{static_cast<hsize_t>(scene.samples), scene.tracers};
  if (components > 1) shape.push_back(static_cast<hsize_t>(components));
  ASSERT_EQ(file.dims(group + name + "/value"), shape) << name;
  const auto values = file.read<T>(group + name + "/value");
  std::size_t at = 0, wrong = 0;
  for (int t = 0; t < scene.samples; ++t)
    for (std::size_t i = 0; i < scene.tracers; ++i)
      for (int k = 0; k < components; ++k, ++at) {
        const T e = expected(k, i, t);
        wrong += values[at] == e || (e != e && values[at] != values[at]) ? 0U : 1U;
      }
  EXPECT_EQ(wrong, 0U) << name;
}

void expect_scene_in(const TracerScene& scene, const std::string& path) {
  const Hdf5Reader file(path);
  using S = TracerScene;
  const auto numbers = [&](const std::string& name, int quantity, int components) {
    expect_element<double>(file, scene, name, components,
                           [&](int k, std::size_t i, int t) { return S::number(quantity, k, i, t); });
  };
  numbers("position", 1, 3);
  numbers("displacement", 2, 3);
  numbers("strain", 3, 1);
  numbers("courant", 4, 1);
  numbers("gradient_number", 5, 1);
  expect_element<std::int32_t>(file, scene, "image", 3, S::image);
  for (std::size_t f = 0; f < scene.fields.size(); ++f)
    expect_element<float>(file, scene, scene.fields[f].name, scene.fields[f].components,
                          [&](int k, std::size_t i, int t) { return S::field_value(f, k, i, t); });
  expect_element<std::uint8_t>(file, scene, "stop", 1,
                               [](int, std::size_t i, int t) { return static_cast<std::uint8_t>(S::stop(i, t)); });
  EXPECT_THAT(file.read<std::int64_t>(group + "id"), ElementsAreArray(scene.layout().id));
  const auto time = file.read<double>(group + "position/time");
  const auto step = file.read<std::int64_t>(group + "position/step");
  ASSERT_EQ(time.size(), static_cast<std::size_t>(scene.samples));
  ASSERT_EQ(step.size(), time.size());
  for (int t = 0; t < scene.samples; ++t) {
    EXPECT_EQ(time[static_cast<std::size_t>(t)], S::time(t));
    EXPECT_EQ(step[static_cast<std::size_t>(t)], S::step(t));
  }
}

TEST(H5mdSink, WritesEveryValue) {
  const TemporaryFolder folder;
  const TracerScene scene;
  write_scene(scene, folder.path());
  expect_scene_in(scene, folder / "tracers.h5");
  EXPECT_THAT(folder.names(), ElementsAre("tracers.h5", "tracers.xmf2"));
}

// Chunks hold 4096/N samples of few tracers, one sample of many, and at most 16384 tracers.
TEST(H5mdSink, WritesEveryValueWhateverTheChunks) {
  struct Size {
    std::size_t tracers;
    int samples;
    std::vector<hsize_t> chunk;
  };
  for (const Size& size : {Size{1, 5000, {4096, 1, 3}}, Size{1500, 5, {2, 1500, 3}}, Size{20000, 2, {1, 16384, 3}}}) {
    const TemporaryFolder folder;
    TracerScene scene;
    scene.tracers = size.tracers;
    scene.samples = size.samples;
    write_scene(scene, folder.path());
    expect_scene_in(scene, folder / "tracers.h5");
    EXPECT_EQ(Hdf5Reader(folder / "tracers.h5").chunk(group + "position/value"), size.chunk);
  }
}

TEST(H5mdSink, HoldsWhatH5mdAsksFor) {
  const TemporaryFolder folder;
  write_scene(TracerScene{}, folder.path());
  const Hdf5Reader file(folder / "tracers.h5");
  EXPECT_THAT(file.attribute<std::int64_t>("/h5md", "version"), ElementsAre(1, 1));
  EXPECT_EQ(file.text_of("/h5md/author", "name"), "not recorded");
  EXPECT_EQ(file.text_of("/h5md/creator", "name"), "grainvdb");
  EXPECT_FALSE(file.text_of("/h5md/creator", "version").empty());
  EXPECT_THAT(file.attribute<std::int64_t>(group + "box", "dimension"), ElementsAre(3));
  EXPECT_THAT(file.texts_of(group + "box", "boundary"), ElementsAre("periodic", "none", "periodic"));
  EXPECT_THAT(file.attribute<double>(group + "box", "offset"), ElementsAre(-1, 0, 0.5));
  EXPECT_THAT(file.dims(group + "box/edges/value"), ElementsAre(3, 3, 3));
  const auto edges = file.read<double>(group + "box/edges/value");
  EXPECT_THAT(std::vector(edges.end() - 9, edges.end()), ElementsAre(4, 0, 0, 0, 0.1, 0, 0, 0, 10));
}

bool same_object(const Hdf5Reader& file, const std::string& a, const std::string& b) {
  H5O_info_t first{}, second{};
  EXPECT_GE(H5Oget_info_by_name1(file.id(), a.c_str(), &first, H5P_DEFAULT), 0) << a;
  EXPECT_GE(H5Oget_info_by_name1(file.id(), b.c_str(), &second, H5P_DEFAULT), 0) << b;
  return first.addr == second.addr;
}

TEST(H5mdSink, SharesStepAndTimeAndOffersTheColumnsAsObservables) {
  const TemporaryFolder folder;
  write_scene(TracerScene{}, folder.path());
  const Hdf5Reader file(folder / "tracers.h5");
  for (const char* name : {"image", "box/edges", "phi", "velocity", "stress", "displacement", "strain", "courant",
                           "gradient_number", "stop"})
    for (const char* part : {"/step", "/time"})
      EXPECT_TRUE(same_object(file, group + "position" + part, group + name + part)) << name;
  for (const char* name : {"phi", "velocity", "stress", "displacement", "strain", "courant", "gradient_number", "stop"})
    EXPECT_TRUE(same_object(file, std::string("/observables/") + name, group + name)) << name;
}

TEST(H5mdSink, DescribesEveryDatasetAndUsesNoUnitThatMdAnalysisWouldReject) {
  const TemporaryFolder folder;
  write_scene(TracerScene{}, folder.path());
  const Hdf5Reader file(folder / "tracers.h5");
  for (const char* set :
       {"position/value", "position/step", "position/time", "image/value", "box/edges/value", "id", "stop_time",
        "phi/value", "velocity/value", "displacement/value", "strain/value", "courant/value", "stop/value"}) {
    EXPECT_FALSE(file.text_of(group + set, "units").empty()) << set;
    EXPECT_FALSE(file.text_of(group + set, "long_name").empty()) << set;
    EXPECT_FALSE(file.has_attribute(group + set, "unit")) << set;
  }
  EXPECT_EQ(file.text_of(group + "position/value", "units"), "m");
  EXPECT_EQ(file.text_of(group + "position/time", "units"), "s");
  EXPECT_EQ(file.text_of(group + "position/time", "long_name"), "time of the simulation");
  EXPECT_EQ(file.text_of(group + "stress/value", "units"), "Pa");
  EXPECT_EQ(file.text_of(group + "stress/value", "equation"), "Σ stress W (6)");
  EXPECT_THAT(file.attribute<std::uint8_t>(group + "stop/value", "flag_values"), ElementsAre(0, 1, 2, 3));
  EXPECT_EQ(file.text_of(group + "stop/value", "flag_meanings"), "moving left_material left_domain masked");
  for (const auto& [key, text] : some_provenance()) EXPECT_EQ(file.text("/provenance/" + key), text);
}

TEST(H5mdSink, SaysUntilWhenEachTracerCouldBeFollowed) {
  const TemporaryFolder folder;
  write_scene(TracerScene{}, folder.path());
  const auto times = Hdf5Reader(folder / "tracers.h5").read<double>(group + "stop_time");
  ASSERT_EQ(times.size(), 5U);
  EXPECT_EQ(times[1], TracerScene::time(1));
  EXPECT_EQ(times[2], TracerScene::time(2));
  for (const std::size_t moving : {0U, 3U, 4U}) EXPECT_TRUE(std::isnan(times[moving]));
}

TEST(H5mdSink, LeavesOutWhatIsNotRecorded) {
  const TemporaryFolder folder;
  TracerScene scene;
  scene.optional_columns = false;
  scene.fields.clear();
  write_scene(scene, folder.path());
  const Hdf5Reader file(folder / "tracers.h5");
  for (const char* name : {"strain", "courant", "gradient_number", "stop_time", "phi"})
    EXPECT_FALSE(file.has(group + name)) << name;
  EXPECT_TRUE(file.has(group + "displacement"));
  EXPECT_THAT(read_file(folder / "tracers.xmf2"), ::testing::Not(HasSubstr("strain")));
}

TEST(H5mdSink, TellsParaViewWhereEachSampleLies) {
  const TemporaryFolder folder;
  TracerScene scene;
  scene.samples = 2;
  scene.optional_columns = false;
  scene.fields.resize(2);
  write_scene(scene, folder.path());
  const std::string text = read_file(folder / "tracers.xmf2");
  EXPECT_THAT(text, HasSubstr(R"(<Grid Name="points" GridType="Uniform">
<Time Value="0.6"/>
<Topology TopologyType="Polyvertex" NumberOfElements="5" NodesPerElement="1"/>
<Geometry GeometryType="XYZ">
<DataItem ItemType="HyperSlab" Dimensions="5 3" NumberType="Float" Precision="8">
<DataItem Dimensions="3 3" NumberType="Int" Format="XML">1 0 0 1 1 1 1 5 3</DataItem>
<DataItem Dimensions="2 5 3" NumberType="Float" Precision="8" Format="HDF">tracers.h5:/particles/tracers/position/value</DataItem>
</DataItem>
</Geometry>
<Attribute Name="id" AttributeType="Scalar" Center="Node">
<DataItem Dimensions="5" NumberType="Int" Precision="8" Format="HDF">tracers.h5:/particles/tracers/id</DataItem>
</Attribute>
<Attribute Name="phi" AttributeType="Scalar" Center="Node">
<DataItem ItemType="HyperSlab" Dimensions="5" NumberType="Float" Precision="4">
<DataItem Dimensions="3 2" NumberType="Int" Format="XML">1 0 1 1 1 5</DataItem>
<DataItem Dimensions="2 5" NumberType="Float" Precision="4" Format="HDF">tracers.h5:/particles/tracers/phi/value</DataItem>
</DataItem>
</Attribute>
)"));
  EXPECT_THAT(text, HasSubstr("<Attribute Name=\"velocity\" AttributeType=\"Vector\" Center=\"Node\">"));
  EXPECT_THAT(text, HasSubstr("NumberType=\"UChar\" Precision=\"1\" Format=\"HDF\">"
                              "tracers.h5:/particles/tracers/stop/value<"));
  EXPECT_EQ(text.rfind("<?xml version=\"1.0\" ?>\n<Xdmf Version=\"2.0\">\n", 0), 0U);
  EXPECT_THAT(text, ::testing::EndsWith("</Grid>\n</Grid>\n</Domain>\n</Xdmf>\n"));
}

herr_t expect_no_time_stamp(hid_t, const char* name, const H5O_info_t* info, void*) {
  EXPECT_EQ(info->ctime, 0) << name;
  return 0;
}

TEST(H5mdSink, GivesTheSameBytesForTheSameResult) {
  const TemporaryFolder folder;
  TracerScene scene;
  scene.samples = 7;
  write_scene(scene, folder / "a");
  write_scene(scene, folder / "b");
  EXPECT_TRUE(read_file(folder / "a/tracers.h5") == read_file(folder / "b/tracers.h5"));
  EXPECT_TRUE(read_file(folder / "a/tracers.xmf2") == read_file(folder / "b/tracers.xmf2"));
  const Hdf5Reader file(folder / "a/tracers.h5");
  H5Ovisit1(file.id(), H5_INDEX_NAME, H5_ITER_INC, expect_no_time_stamp, nullptr);
}

}  // namespace
}  // namespace grainvdb::h5md_sink_test
