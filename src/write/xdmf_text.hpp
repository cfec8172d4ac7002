#pragma once
/// Pieces of XDMF 2 text that all sidecars share.
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace grainvdb {

/// The shortest text that reads back as the same number, whatever the locale.
std::string xdmf_number(double value);

/// Text with what XML reserves written as entities.
std::string xml_escaped(std::string_view text);

/// Numbers with blanks between them.
std::string xdmf_numbers(const std::vector<std::uint64_t>& numbers);

/// Values in an HDF5 file, or one entry along the first axis of a dataset with a time axis.
struct XdmfDataset {
  std::string name;
  std::string where;                  ///< FILE:PATH
  std::string number;                 ///< XML attributes of the number type, e.g. NumberType="Float" Precision="4"
  std::uint64_t components = 1;       ///< the last axis of the dataset where there are several
  std::vector<std::uint64_t> shape;   ///< of one entry, components apart
  std::optional<std::uint64_t> step;  ///< which entry; none where there is no time axis
  std::uint64_t steps = 1;            ///< entries of the time axis
};

/// The values as a DataItem.
std::string xdmf_values(const XdmfDataset& set);

/// The values as a point attribute. Six components are two vectors, NAME_1 and NAME_2: XDMF knows no such attribute.
std::string xdmf_attribute(const XdmfDataset& set);

}  // namespace grainvdb
