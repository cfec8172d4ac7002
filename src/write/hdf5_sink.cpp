#include "write/hdf5_sink.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <numeric>
#include <optional>
#include <set>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "grainvdb/error.hpp"
#include "write/atomic_file.hpp"
#include "write/chunk_grid.hpp"
#include "write/hdf5_file.hpp"
#include "write/hdf5_provenance.hpp"
#include "write/output_names.hpp"
#include "write/xdmf_sidecar.hpp"

namespace grainvdb {
namespace {

constexpr auto outside = static_cast<std::uint32_t>(Reason::outside);

std::string component_scale(int components) {
  return "/component" + std::to_string(components);
}

std::string component_order(int components) {
  if (components == 9) return "component, row by row: xx, xy, xz, yx, yy, yz, zx, zy, zz";
  return "component: x, y, z of a vector, else in the order that long_name says";
}

std::string text_of(const Coord& c) {
  return '(' + std::to_string(c.x) + ", " + std::to_string(c.y) + ", " + std::to_string(c.z) + ')';
}

class Hdf5Sink final : public FieldSink {
 public:
  explicit Hdf5Sink(const std::string& directory)
      : path_((std::filesystem::path(directory) / "fields.hdf").string()),
        sidecar_path_((std::filesystem::path(directory) / "fields.xmf2").string()) {}

  void begin(const OutputLayout& layout) override;
  void write(const OutputTime& time, const std::vector<const SparseField*>& fields, const Mask* mask) override;
  void commit(const Provenance& provenance) override;
  std::vector<std::string> files() const override;

 private:
  bool needs_sidecar() const { return has_time_axis(*layout_) || !fits_vtkhdf(grid_->voxels()); }
  void describe_image();
  void create_axes();
  void create_scale(const std::string& name, const std::vector<double>& values, const std::string& unit,
                    const std::string& long_name);
  template <class T>
  void create_field(const std::string& path, int components, T fill);
  void create_mask();
  template <class T, class Values>
  void write_field(const std::string& path, const std::shared_ptr<const Topology>& topology, int components,
                   T background, const Values& values);
  const std::vector<OccupiedChunk>& occupied(const std::shared_ptr<const Topology>& topology);
  void write_times();

  std::string path_;
  std::string sidecar_path_;
  std::optional<OutputLayout> layout_;
  std::optional<ChunkGrid> grid_;
  std::vector<OutputTime> times_;
  std::unique_ptr<AtomicFile> file_;
  std::unique_ptr<Hdf5File> hdf5_;  // after file_, which it writes to
  std::shared_ptr<const Topology> last_topology_;
  std::vector<OccupiedChunk> last_occupied_;
};

void Hdf5Sink::begin(const OutputLayout& layout) {
  if (layout_) throw std::logic_error("an output can begin only once");
  if (layout.time_count == 0) throw std::invalid_argument("an output needs at least one time");
  grid_.emplace(layout.first, layout.last);
  layout_ = layout;
  file_ = std::make_unique<AtomicFile>(path_);
  hdf5_ = std::make_unique<Hdf5File>(*file_);
  hdf5_->text_attribute("/", "title", "Continuum fields coarse-grained from particle snapshots");
  describe_image();
  create_axes();
  for (const FieldMeta& f : layout.fields) {
    const std::string path = dataset_path(f.name);
    create_field<float>(path, f.components, f.background);
    hdf5_->text_attribute(path, "units", f.unit);
    hdf5_->text_attribute(path, "long_name", f.description);
    hdf5_->text_attribute(path, "equation", f.equation);
    if (std::isnan(f.background)) hdf5_->attribute(path, "_FillValue", f.background);
  }
  if (layout.has_mask) create_mask();
}

void Hdf5Sink::describe_image() {
  hdf5_->create_group("/VTKHDF");
  hdf5_->create_group(std::string(point_data_group));
  const Extent3& n = grid_->voxels();
  if (!fits_vtkhdf(n)) return;
  const std::int64_t version[] = {has_time_axis(*layout_) ? 2 : 1, 0};
  const std::int64_t extent[] = {0, static_cast<std::int64_t>(n[0]) - 1, 0, static_cast<std::int64_t>(n[1]) - 1,
                                 0, static_cast<std::int64_t>(n[2]) - 1};
  const Vec3 origin = layout_->lattice.centre(layout_->first);
  const double h = layout_->lattice.voxel();
  const double spacing[] = {h, h, h};
  const double direction[] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  hdf5_->attribute<std::int64_t>("/VTKHDF", "Version", std::span(version));
  hdf5_->fixed_text_attribute("/VTKHDF", "Type", "ImageData");
  hdf5_->attribute<std::int64_t>("/VTKHDF", "WholeExtent", std::span(extent));
  hdf5_->attribute<double>("/VTKHDF", "Origin", std::span(origin));
  hdf5_->attribute<double>("/VTKHDF", "Spacing", std::span(spacing));
  hdf5_->attribute<double>("/VTKHDF", "Direction", std::span(direction));
}

void Hdf5Sink::create_scale(const std::string& name, const std::vector<double>& values, const std::string& unit,
                            const std::string& long_name) {
  const std::string path = '/' + name;
  hdf5_->create_dataset<double>(path, {values.size()});
  hdf5_->text_attribute(path, "units", unit);
  hdf5_->text_attribute(path, "long_name", long_name);
  hdf5_->make_scale(path, name);
  hdf5_->write<double>(path, values);
}

void Hdf5Sink::create_axes() {
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> centres(grid_->voxels()[static_cast<std::size_t>(axis)]);
    for (std::size_t i = 0; i < centres.size(); ++i)
      centres[i] = layout_->lattice.centre(axis, layout_->first[axis] + static_cast<std::int32_t>(i));
    const std::string name(1, "xyz"[axis]);
    create_scale(name, centres, layout_->length_unit, name + " of the voxel centres");
  }

  create_scale("time", std::vector<double>(layout_->time_count), layout_->time_unit, "mean time of the frames");
  const auto per_time = [&](const std::string& path, const std::string& long_name) {
    hdf5_->create_dataset<std::int64_t>(path, {layout_->time_count});
    hdf5_->text_attribute(path, "units", "1");
    hdf5_->text_attribute(path, "long_name", long_name);
    hdf5_->attach_scale(path, 0, "/time");
  };
  per_time("/first_step", "time step of the first frame");
  per_time("/last_step", "time step of the last frame");
  per_time("/frame_count", "number of frames in the mean");
  if (has_time_axis(*layout_) && fits_vtkhdf(grid_->voxels())) {
    hdf5_->create_group("/VTKHDF/Steps");
    hdf5_->attribute("/VTKHDF/Steps", "NSteps", static_cast<std::int64_t>(layout_->time_count));
    hdf5_->create_dataset<double>("/VTKHDF/Steps/Values", {layout_->time_count});
  }

  std::set<int> component_counts;
  for (const FieldMeta& f : layout_->fields)
    if (f.components > 1) component_counts.insert(f.components);
  for (const int components : component_counts) {
    const std::string path = component_scale(components);
    std::vector<std::int32_t> indices(static_cast<std::size_t>(components));
    std::iota(indices.begin(), indices.end(), 0);
    hdf5_->create_dataset<std::int32_t>(path, {indices.size()});
    hdf5_->text_attribute(path, "units", "1");
    hdf5_->text_attribute(path, "long_name", component_order(components));
    hdf5_->make_scale(path, path.substr(1));
    hdf5_->write<std::int32_t>(path, indices);
  }
}

template <class T>
void Hdf5Sink::create_field(const std::string& path, int components, T fill) {
  const Extent3& n = grid_->voxels();
  const Extent3& c = grid_->chunk();
  Hdf5Dims dims{n[2], n[1], n[0]};
  Hdf5Dims chunk{c[2], c[1], c[0]};
  std::vector<std::string> scales{"/z", "/y", "/x"};
  if (has_time_axis(*layout_)) {
    dims.insert(dims.begin(), layout_->time_count);
    chunk.insert(chunk.begin(), 1);
    scales.insert(scales.begin(), "/time");
  }
  if (components > 1) {
    dims.push_back(static_cast<hsize_t>(components));
    chunk.push_back(static_cast<hsize_t>(components));
    scales.push_back(component_scale(components));
  }
  hdf5_->create_chunked_dataset<T>(path, dims, chunk, fill);
  for (unsigned axis = 0; axis < scales.size(); ++axis) hdf5_->attach_scale(path, axis, scales[axis]);
}

void Hdf5Sink::create_mask() {
  const std::string path = dataset_path(mask_name);
  create_field<std::uint32_t>(path, 1, outside);
  std::vector<std::uint32_t> bits;
  std::string names;
  std::vector<std::string> lines;
  for (const ReasonInfo& r : reasons()) {
    bits.push_back(static_cast<std::uint32_t>(r.reason));
    if (!names.empty()) names += ' ';
    names += r.name;
    lines.push_back(std::to_string(bits.back()) + ' ' + std::string(r.name) + ": " + std::string(r.meaning));
  }
  hdf5_->text_attribute(path, "units", "1");
  hdf5_->text_attribute(path, "long_name", "why fields have no value: the sum of the flags that apply");
  hdf5_->attribute<std::uint32_t>(path, "flag_masks", std::span(std::as_const(bits)));
  hdf5_->text_attribute(path, "flag_meanings", names);
  hdf5_->text_attribute(path, "flags", lines);
}

const std::vector<OccupiedChunk>& Hdf5Sink::occupied(const std::shared_ptr<const Topology>& topology) {
  if (topology == last_topology_) return last_occupied_;
  if (const auto bounds = topology->bounds()) {
    for (int axis = 0; axis < 3; ++axis)
      if (bounds->first[axis] < layout_->first[axis] || bounds->last[axis] > layout_->last[axis])
        throw LimitError({{path_, 0},
                          "a field has voxels outside the written box",
                          "voxels " + text_of(bounds->first) + " to " + text_of(bounds->last),
                          text_of(layout_->first) + " to " + text_of(layout_->last),
                          {}});
  }
  last_occupied_ = grid_->occupied(*topology);
  last_topology_ = topology;
  return last_occupied_;
}

template <class T, class Values>
void Hdf5Sink::write_field(const std::string& path, const std::shared_ptr<const Topology>& topology, int components,
                           T background, const Values& values) {
  std::vector<T> buffer;
  for (const OccupiedChunk& chunk : occupied(topology)) {
    grid_->gather(chunk, *topology, static_cast<std::size_t>(components), background, values, buffer);
    Hdf5Dims start{chunk.start[2], chunk.start[1], chunk.start[0]};
    if (has_time_axis(*layout_)) start.insert(start.begin(), times_.size() - 1);
    if (components > 1) start.push_back(0);
    hdf5_->write_chunk<T>(path, start, buffer);
  }
}

void Hdf5Sink::write(const OutputTime& time, const std::vector<const SparseField*>& fields, const Mask* mask) {
  if (!hdf5_ || times_.size() == layout_->time_count) throw std::logic_error("an output time that was not announced");
  const bool as_announced = (mask != nullptr) == layout_->has_mask &&
                            std::equal(fields.begin(), fields.end(), layout_->fields.begin(), layout_->fields.end(),
                                       [](const SparseField* f, const FieldMeta& meta) {
                                         return f->meta().name == meta.name && f->components() == meta.components;
                                       });
  if (!as_announced) throw std::invalid_argument("the fields to write are not those that were announced");

  times_.push_back(time);
  for (const SparseField* field : fields) {
    write_field<float>(
        dataset_path(field->meta().name), field->topology(), field->components(), field->meta().background,
        [&](std::size_t leaf, std::size_t component) { return field->leaf(leaf, static_cast<int>(component)); });
  }
  if (mask != nullptr) {
    write_field<std::uint32_t>(dataset_path(mask_name), mask->topology(), 1, outside,
                               [&](std::size_t leaf, std::size_t) { return mask->leaf(leaf); });
  }
  hdf5_->flush();
}

void Hdf5Sink::write_times() {
  std::vector<double> time;
  std::vector<std::int64_t> first, last, count;
  for (const OutputTime& t : times_) {
    time.push_back(t.time);
    first.push_back(t.first_step);
    last.push_back(t.last_step);
    count.push_back(static_cast<std::int64_t>(t.frame_count));
  }
  hdf5_->write<double>("/time", time);
  if (has_time_axis(*layout_) && fits_vtkhdf(grid_->voxels())) hdf5_->write<double>("/VTKHDF/Steps/Values", time);
  hdf5_->write<std::int64_t>("/first_step", first);
  hdf5_->write<std::int64_t>("/last_step", last);
  hdf5_->write<std::int64_t>("/frame_count", count);
}

void Hdf5Sink::commit(const Provenance& provenance) {
  if (!hdf5_ || times_.size() != layout_->time_count) throw std::logic_error("an output was committed before its end");
  write_times();
  write_provenance(*hdf5_, provenance);
  for (const auto& [key, text] : provenance) {
    if (key == "version") hdf5_->text_attribute("/", "grainvdb_version", text);
    if (key == "averaging") hdf5_->text_attribute("/", "averaging", text);
  }
  hdf5_->close();
  file_->finish();

  // Everything that can run out of space comes before the first file gets its name.
  if (needs_sidecar()) {
    AtomicFile sidecar(sidecar_path_);
    sidecar.write(0, xdmf_sidecar(*layout_, times_, std::filesystem::path(path_).filename().string()));
    sidecar.finish();
    file_->publish();
    sidecar.publish();
  } else {
    file_->publish();
    remove_file(sidecar_path_);
  }
}

std::vector<std::string> Hdf5Sink::files() const {
  std::vector<std::string> all{path_};
  if (layout_ && needs_sidecar()) all.push_back(sidecar_path_);
  return all;
}

}  // namespace

std::unique_ptr<FieldSink> make_hdf5_sink(const std::string& directory) {
  return std::make_unique<Hdf5Sink>(directory);
}

}  // namespace grainvdb
