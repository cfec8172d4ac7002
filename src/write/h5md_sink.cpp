#include "write/h5md_sink.hpp"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "grainvdb/version.hpp"
#include "write/atomic_file.hpp"
#include "write/hdf5_file.hpp"
#include "write/hdf5_provenance.hpp"
#include "write/tracer_columns.hpp"
#include "write/tracer_sidecar.hpp"

namespace grainvdb {
namespace {

const std::string tracer_group = "/particles/tracers";

constexpr const char* double_number = "NumberType=\"Float\" Precision=\"8\"";
constexpr const char* float_number = "NumberType=\"Float\" Precision=\"4\"";
constexpr const char* byte_number = "NumberType=\"UChar\" Precision=\"1\"";
constexpr const char* id_number = "NumberType=\"Int\" Precision=\"8\"";

/// Chunks hold up to so many tracers, and several samples where there are fewer tracers than `fewest`.
constexpr hsize_t most_tracers = 16384;
constexpr hsize_t fewest_entries = 4096;

/// Entry by entry from one array per component.
template <class T, class Columns>
std::vector<T> interleaved(const Columns& columns) {
  std::vector<T> values;
  const std::size_t n = columns.begin()->size();
  values.reserve(n * columns.size());
  for (std::size_t i = 0; i < n; ++i)
    for (const auto& column : columns) values.push_back(column[i]);
  return values;
}

class H5mdSink final : public TracerSink {
 public:
  explicit H5mdSink(const std::string& directory)
      : path_((std::filesystem::path(directory) / "tracers.h5").string()),
        sidecar_path_((std::filesystem::path(directory) / "tracers.xmf2").string()) {}

  void begin(const TracerLayout& layout) override;
  void write(const TracerSample& sample) override;
  void commit(const Provenance& provenance) override;
  std::vector<std::string> files() const override { return {path_, sidecar_path_}; }

 private:
  std::size_t tracers() const { return layout_->id.size(); }
  hsize_t samples_per_chunk() const { return std::max<hsize_t>(1, fewest_entries / tracers()); }
  void describe_file();
  void create_box();
  /// A group with value, step and time; all share the step and time of the positions.
  template <class T>
  void create_element(const std::string& name, int components, const std::string& unit, const std::string& long_name);
  void observe(const TracerDataset& set);
  void create_columns(const TracerSample& sample);
  void create_stop();

  std::string path_;
  std::string sidecar_path_;
  std::optional<TracerLayout> layout_;
  std::optional<TracerSampleCheck> check_;
  std::vector<double> times_;
  std::vector<double> stop_time_;  ///< of the last sample
  std::vector<TracerDataset> observed_;
  std::unique_ptr<AtomicFile> file_;
  std::unique_ptr<Hdf5File> hdf5_;  // after file_, which it writes to
};

void H5mdSink::begin(const TracerLayout& layout) {
  if (layout_) throw std::logic_error("an output can begin only once");
  check_.emplace(layout);
  layout_ = layout;
  file_ = std::make_unique<AtomicFile>(path_);
  hdf5_ = std::make_unique<Hdf5File>(*file_);
  describe_file();
  hdf5_->create_group("/particles");
  hdf5_->create_group(tracer_group);
  hdf5_->create_group("/observables");
  create_element<double>("position", 3, layout.length_unit, "position, wrapped into the box along its periodic axes");
  create_box();
  create_element<std::int32_t>("image", 3, "1", "periods crossed: unwrapped = position + image × edges");
  hdf5_->create_dataset<std::int64_t>(tracer_group + "/id", {tracers()});
  hdf5_->text_attribute(tracer_group + "/id", "units", "1");
  hdf5_->text_attribute(tracer_group + "/id", "long_name",
                        "id of the tracer, or of the particle that it was seeded on");
  hdf5_->write<std::int64_t>(tracer_group + "/id", layout.id);
}

void H5mdSink::describe_file() {
  const std::int64_t version[] = {1, 1};
  hdf5_->create_group("/h5md");
  hdf5_->attribute<std::int64_t>("/h5md", "version", std::span(version));
  hdf5_->create_group("/h5md/author");
  hdf5_->text_attribute("/h5md/author", "name", "not recorded");
  hdf5_->create_group("/h5md/creator");
  hdf5_->text_attribute("/h5md/creator", "name", "grainvdb");
  hdf5_->text_attribute("/h5md/creator", "version", GRAINVDB_VERSION);
}

template <class T>
void H5mdSink::create_element(const std::string& name, int components, const std::string& unit,
                              const std::string& long_name) {
  const std::string path = tracer_group + '/' + name, value = path + "/value";
  const hsize_t n = tracers();
  Hdf5Dims row{n}, chunk{samples_per_chunk(), std::min(n, most_tracers)};
  if (components > 1) {
    row.push_back(static_cast<hsize_t>(components));
    chunk.push_back(static_cast<hsize_t>(components));
  }
  hdf5_->create_group(path);
  hdf5_->create_growing_dataset<T>(value, row, chunk);
  hdf5_->text_attribute(value, "units", unit);
  hdf5_->text_attribute(value, "long_name", long_name);
  const std::string first = tracer_group + "/position";
  if (path != first) {
    hdf5_->link(path + "/step", first + "/step");
    hdf5_->link(path + "/time", first + "/time");
    return;
  }
  hdf5_->create_growing_dataset<std::int64_t>(path + "/step", {}, {1024});
  hdf5_->text_attribute(path + "/step", "units", "1");
  hdf5_->text_attribute(path + "/step", "long_name", "step of the frame, or number of the integration step");
  hdf5_->create_growing_dataset<double>(path + "/time", {}, {1024});
  hdf5_->text_attribute(path + "/time", "units", layout_->time_unit);
  hdf5_->text_attribute(path + "/time", "long_name", layout_->time_meaning);
}

// MDAnalysis takes the edges from a group over time, as vectors, and nothing else.
void H5mdSink::create_box() {
  const std::string path = tracer_group + "/box";
  const Box& box = layout_->box;
  hdf5_->create_group(path);
  hdf5_->attribute<std::int64_t>(path, "dimension", 3);
  std::vector<std::string> boundary;
  for (const bool periodic : box.periodic) boundary.emplace_back(periodic ? "periodic" : "none");
  hdf5_->text_attribute(path, "boundary", boundary);
  hdf5_->attribute<double>(path, "offset", std::span(std::as_const(box.lo)));
  hdf5_->create_group(path + "/edges");
  hdf5_->create_growing_dataset<double>(path + "/edges/value", {3, 3}, {128, 3, 3});
  hdf5_->text_attribute(path + "/edges/value", "units", layout_->length_unit);
  hdf5_->text_attribute(path + "/edges/value", "long_name", "edges of the box, one vector a row");
  hdf5_->link(path + "/edges/step", tracer_group + "/position/step");
  hdf5_->link(path + "/edges/time", tracer_group + "/position/time");
}

void H5mdSink::observe(const TracerDataset& set) {
  hdf5_->link("/observables/" + set.name, tracer_group + '/' + set.name);
  observed_.push_back(set);
}

void H5mdSink::create_columns(const TracerSample& sample) {
  const auto dataset = [&](const std::string& name, std::uint64_t components, const char* number) {
    return TracerDataset{name, tracer_group + '/' + name + "/value", components, number};
  };
  for (const FieldMeta& f : layout_->fields) {
    create_element<float>(f.name, f.components, f.unit, f.description);
    hdf5_->text_attribute(tracer_group + '/' + f.name + "/value", "equation", f.equation);
    observe(dataset(f.name, static_cast<std::uint64_t>(f.components), float_number));
  }
  for (const TracerNumbers& n : numbers_of(sample, *layout_)) {
    create_element<double>(n.name, static_cast<int>(n.values.size()), n.unit, n.description);
    hdf5_->text_attribute(tracer_group + '/' + n.name + "/value", "equation", n.equation);
    observe(dataset(n.name, n.values.size(), double_number));
  }
  create_stop();
  observe(dataset("stop", 1, byte_number));
}

void H5mdSink::create_stop() {
  create_element<std::uint8_t>("stop", 1, "1", "why the tracer stands still; samples repeat its last good one");
  std::vector<std::uint8_t> values;
  std::string names;
  for (const TracerStop stop : tracer_stops()) {
    values.push_back(static_cast<std::uint8_t>(stop));
    if (!names.empty()) names += ' ';
    names += name_of(stop);
  }
  hdf5_->attribute<std::uint8_t>(tracer_group + "/stop/value", "flag_values", std::span(std::as_const(values)));
  hdf5_->text_attribute(tracer_group + "/stop/value", "flag_meanings", names);
}

void H5mdSink::write(const TracerSample& sample) {
  if (!hdf5_) throw std::logic_error("a sample before the output began");
  check_->check(sample);
  if (times_.empty()) create_columns(sample);
  times_.push_back(sample.time);
  stop_time_ = sample.stop_time;

  hdf5_->append_row<double>(tracer_group + "/position/time", std::span(&sample.time, 1));
  hdf5_->append_row<std::int64_t>(tracer_group + "/position/step", std::span(&sample.step, 1));
  const Box& box = layout_->box;
  const double edges[] = {box.length(0), 0, 0, 0, box.length(1), 0, 0, 0, box.length(2)};
  hdf5_->append_row<double>(tracer_group + "/box/edges/value", std::span(edges));
  hdf5_->append_row<double>(tracer_group + "/position/value", interleaved<double>(sample.position));
  hdf5_->append_row<std::int32_t>(tracer_group + "/image/value", interleaved<std::int32_t>(sample.image));
  for (std::size_t i = 0; i < sample.fields.size(); ++i)
    hdf5_->append_row<float>(tracer_group + '/' + layout_->fields[i].name + "/value", sample.fields[i]);
  for (const TracerNumbers& n : numbers_of(sample, *layout_)) {
    std::vector<std::span<const double>> columns;
    for (const std::vector<double>* column : n.values) columns.emplace_back(*column);
    hdf5_->append_row<double>(tracer_group + '/' + n.name + "/value", interleaved<double>(columns));
  }
  std::vector<std::uint8_t> codes;
  for (const TracerStop stop : sample.stop) codes.push_back(static_cast<std::uint8_t>(stop));
  hdf5_->append_row<std::uint8_t>(tracer_group + "/stop/value", codes);
  if (times_.size() % samples_per_chunk() == 0) hdf5_->flush();  // a full disk shows early
}

void H5mdSink::commit(const Provenance& provenance) {
  if (!hdf5_ || times_.empty()) throw std::logic_error("an output of tracers was committed without a sample");
  if (!stop_time_.empty()) {
    hdf5_->create_dataset<double>(tracer_group + "/stop_time", {tracers()});
    hdf5_->text_attribute(tracer_group + "/stop_time", "units", layout_->time_unit);
    hdf5_->text_attribute(tracer_group + "/stop_time", "long_name",
                          "until when a tracer could be followed; NaN: to the end");
    hdf5_->write<double>(tracer_group + "/stop_time", stop_time_);
  }
  write_provenance(*hdf5_, provenance);
  hdf5_->close();
  file_->finish();

  // Everything that can run out of space comes before the first file gets its name.
  AtomicFile sidecar(sidecar_path_);
  write_tracer_sidecar(sidecar, std::filesystem::path(path_).filename().string(), tracers(), times_,
                       {"position", tracer_group + "/position/value", 3, double_number},
                       {"id", tracer_group + "/id", 1, id_number}, observed_);
  sidecar.finish();
  file_->publish();
  sidecar.publish();
}

}  // namespace

std::unique_ptr<TracerSink> make_h5md_sink(const std::string& directory) {
  return std::make_unique<H5mdSink>(directory);
}

}  // namespace grainvdb
