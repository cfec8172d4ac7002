#include "write/xdmf_sidecar.hpp"

#include <cstdint>
#include <vector>

#include "write/output_names.hpp"
#include "write/xdmf_text.hpp"

namespace grainvdb {
namespace {

class Sidecar {
 public:
  Sidecar(const OutputLayout& layout, const std::string& data_file) : layout_(layout), data_file_(data_file) {
    const Extent3 voxels = ChunkGrid(layout.first, layout.last).voxels();
    shape_ = {voxels[2], voxels[1], voxels[0]};
  }

  std::string text(std::span<const OutputTime> times) {
    text_ = "<?xml version=\"1.0\" ?>\n<Xdmf Version=\"2.0\">\n<Domain>\n";
    text_ += "<Grid Name=\"fields\" GridType=\"Collection\" CollectionType=\"Temporal\">\n";
    for (std::size_t t = 0; t < times.size(); ++t) add_grid(t, times[t].time);
    return text_ + "</Grid>\n</Domain>\n</Xdmf>\n";
  }

 private:
  void add_grid(std::size_t step, double time) {
    const Vec3 origin = layout_.lattice.centre(layout_.first);
    const std::string h = xdmf_number(layout_.lattice.voxel());
    const std::string vector = "<DataItem Dimensions=\"3\" NumberType=\"Float\" Precision=\"8\" Format=\"XML\">";
    text_ += "<Grid Name=\"image\" GridType=\"Uniform\">\n";
    text_ += "<Time Value=\"" + xdmf_number(time) + "\"/>\n";
    text_ += "<Topology TopologyType=\"3DCoRectMesh\" Dimensions=\"" + xdmf_numbers(shape_) + "\"/>\n";
    text_ += "<Geometry GeometryType=\"ORIGIN_DXDYDZ\">\n";  // both in the order z y x
    text_ +=
        vector + xdmf_number(origin[2]) + ' ' + xdmf_number(origin[1]) + ' ' + xdmf_number(origin[0]) + "</DataItem>\n";
    text_ += vector + h + ' ' + h + ' ' + h + "</DataItem>\n</Geometry>\n";
    for (const FieldMeta& f : layout_.fields)
      add_attribute(f.name, static_cast<std::uint64_t>(f.components), "NumberType=\"Float\" Precision=\"4\"", step);
    if (layout_.has_mask) add_attribute(std::string(mask_name), 1, "NumberType=\"UInt\" Precision=\"4\"", step);
    text_ += "</Grid>\n";
  }

  void add_attribute(const std::string& name, std::uint64_t components, const std::string& number, std::size_t step) {
    XdmfDataset set{name, data_file_ + ':' + dataset_path(name), number, components, shape_, {}, layout_.time_count};
    if (has_time_axis(layout_)) set.step = step;
    text_ += xdmf_attribute(set);
  }

  const OutputLayout& layout_;
  std::string data_file_;
  std::vector<std::uint64_t> shape_;
  std::string text_;
};

}  // namespace

std::string xdmf_sidecar(const OutputLayout& layout, std::span<const OutputTime> times, const std::string& data_file) {
  return Sidecar(layout, data_file).text(times);
}

}  // namespace grainvdb
