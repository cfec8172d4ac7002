#include "write/xdmf_text.hpp"

#include <array>
#include <charconv>

namespace grainvdb {

std::string xdmf_number(double value) {
  std::array<char, 32> buffer;
  return {buffer.data(), std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr};
}

std::string xml_escaped(std::string_view text) {
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

std::string xdmf_numbers(const std::vector<std::uint64_t>& numbers) {
  std::string text;
  for (const std::uint64_t n : numbers) {
    if (!text.empty()) text += ' ';
    text += std::to_string(n);
  }
  return text;
}

namespace {

/// ParaView's reader wants the shape of a selection without the leading 1 of the time step.
std::string selection(const XdmfDataset& set, std::uint64_t first_component, std::uint64_t components) {
  std::vector<std::uint64_t> whole = set.shape, count = set.shape, start(set.shape.size(), 0);
  if (set.components > 1) {
    whole.push_back(set.components);
    count.push_back(components);
    start.push_back(first_component);
  }
  const std::string dimensions = xdmf_numbers(count);
  if (set.step) {
    whole.insert(whole.begin(), set.steps);
    count.insert(count.begin(), 1);
    start.insert(start.begin(), *set.step);
  }
  const std::string file = "<DataItem Dimensions=\"" + xdmf_numbers(whole) + "\" " + set.number + " Format=\"HDF\">" +
                           xml_escaped(set.where) + "</DataItem>\n";
  if (count == whole && !set.step) return file;
  const std::vector<std::uint64_t> stride(whole.size(), 1);
  return "<DataItem ItemType=\"HyperSlab\" Dimensions=\"" + dimensions + "\" " + set.number + ">\n" +
         "<DataItem Dimensions=\"3 " + std::to_string(whole.size()) + "\" NumberType=\"Int\" Format=\"XML\">" +
         xdmf_numbers(start) + ' ' + xdmf_numbers(stride) + ' ' + xdmf_numbers(count) + "</DataItem>\n" + file +
         "</DataItem>\n";
}

std::string attribute(const std::string& name, const char* type, const std::string& values) {
  return "<Attribute Name=\"" + xml_escaped(name) + "\" AttributeType=\"" + type + "\" Center=\"Node\">\n" + values +
         "</Attribute>\n";
}

}  // namespace

std::string xdmf_values(const XdmfDataset& set) {
  return selection(set, 0, set.components);
}

std::string xdmf_attribute(const XdmfDataset& set) {
  if (set.components == 6)
    return attribute(set.name + "_1", "Vector", selection(set, 0, 3)) +
           attribute(set.name + "_2", "Vector", selection(set, 3, 3));
  return attribute(set.name,
                   set.components == 1   ? "Scalar"
                   : set.components == 3 ? "Vector"
                                         : "Tensor",
                   xdmf_values(set));
}

}  // namespace grainvdb
