#include "write/xdmf_sidecar.hpp"

#include <array>
#include <charconv>
#include <cstdint>
#include <string_view>
#include <vector>

#include "write/output_names.hpp"

namespace grainvdb {
namespace {

/// The shortest text that reads back as the same number, whatever the locale.
std::string text_of(double value) {
  std::array<char, 32> buffer;
  return {buffer.data(), std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr};
}

std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

std::string joined(const std::vector<std::uint64_t>& numbers) {
  std::string text;
  for (const std::uint64_t n : numbers) {
    if (!text.empty()) text += ' ';
    text += std::to_string(n);
  }
  return text;
}

struct Attribute {
  std::string name;
  std::uint64_t components;
  std::string number;  ///< XML attributes of its number type
};

std::vector<Attribute> attributes_of(const OutputLayout& layout) {
  std::vector<Attribute> all;
  for (const FieldMeta& f : layout.fields)
    all.push_back({f.name, static_cast<std::uint64_t>(f.components), "NumberType=\"Float\" Precision=\"4\""});
  if (layout.has_mask) all.push_back({std::string(mask_name), 1, "NumberType=\"UInt\" Precision=\"4\""});
  return all;
}

const char* attribute_type(std::uint64_t components) {
  return components == 1 ? "Scalar" : components == 3 ? "Vector" : "Tensor";
}

class Sidecar {
 public:
  Sidecar(const OutputLayout& layout, const std::string& data_file)
      : layout_(layout), data_file_(escaped(data_file)), attributes_(attributes_of(layout)) {
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
    const std::string h = text_of(layout_.lattice.voxel());
    const std::string vector = "<DataItem Dimensions=\"3\" NumberType=\"Float\" Precision=\"8\" Format=\"XML\">";
    text_ += "<Grid Name=\"image\" GridType=\"Uniform\">\n";
    text_ += "<Time Value=\"" + text_of(time) + "\"/>\n";
    text_ += "<Topology TopologyType=\"3DCoRectMesh\" Dimensions=\"" + joined(shape_) + "\"/>\n";
    text_ += "<Geometry GeometryType=\"ORIGIN_DXDYDZ\">\n";  // both in the order z y x
    text_ += vector + text_of(origin[2]) + ' ' + text_of(origin[1]) + ' ' + text_of(origin[0]) + "</DataItem>\n";
    text_ += vector + h + ' ' + h + ' ' + h + "</DataItem>\n</Geometry>\n";
    for (const Attribute& a : attributes_) add_attribute(a, step);
    text_ += "</Grid>\n";
  }

  void add_attribute(const Attribute& attribute, std::size_t step) {
    std::vector<std::uint64_t> shape = shape_;
    if (attribute.components > 1) shape.push_back(attribute.components);
    const std::string where = data_file_ + ':' + escaped(dataset_path(attribute.name));
    text_ += "<Attribute Name=\"" + escaped(attribute.name) + "\" AttributeType=\"" +
             attribute_type(attribute.components) + "\" Center=\"Node\">\n";
    if (has_time_axis(layout_)) {
      add_selection(shape, attribute.number, where, step);
    } else {
      text_ += "<DataItem Dimensions=\"" + joined(shape) + "\" " + attribute.number + " Format=\"HDF\">" + where +
               "</DataItem>\n";
    }
    text_ += "</Attribute>\n";
  }

  void add_selection(const std::vector<std::uint64_t>& shape, const std::string& number, const std::string& where,
                     std::size_t step) {
    std::vector<std::uint64_t> start(shape.size() + 1), stride(shape.size() + 1, 1), count(shape), whole(shape);
    start.front() = step;
    count.insert(count.begin(), 1);
    whole.insert(whole.begin(), layout_.time_count);
    text_ += "<DataItem ItemType=\"HyperSlab\" Dimensions=\"" + joined(shape) + "\" " + number + ">\n";
    text_ += "<DataItem Dimensions=\"3 " + std::to_string(whole.size()) + "\" NumberType=\"Int\" Format=\"XML\">" +
             joined(start) + ' ' + joined(stride) + ' ' + joined(count) + "</DataItem>\n";
    text_ += "<DataItem Dimensions=\"" + joined(whole) + "\" " + number + " Format=\"HDF\">" + where +
             "</DataItem>\n</DataItem>\n";
  }

  const OutputLayout& layout_;
  std::string data_file_;
  std::vector<Attribute> attributes_;
  std::vector<std::uint64_t> shape_;
  std::string text_;
};

}  // namespace

std::string xdmf_sidecar(const OutputLayout& layout, std::span<const OutputTime> times, const std::string& data_file) {
  return Sidecar(layout, data_file).text(times);
}

}  // namespace grainvdb
