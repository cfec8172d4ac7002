#pragma once
/// From the columns of a contact dump to contacts.
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "grainvdb/frame.hpp"
#include "grainvdb/frame_source.hpp"
#include "read/dump_file.hpp"

namespace grainvdb {

/// Which columns of a table become which quantity: indices into DumpTable::real, or DumpTable::whole for the ids.
struct ContactLayout {
  TableRequest request;
  std::size_t id1 = 0;
  std::size_t id2 = 0;
  std::vector<std::array<std::size_t, 3>> forces;  ///< summed: the total force, or its normal and tangential part
  std::optional<std::array<std::size_t, 3>> point;
};

/// Throws ConfigError when the specification itself is wrong: unknown keywords, compute and columns at once, …
void check_contact_spec(const InputSpec& spec);

/// Finds the columns of a contact dump as its specification says. Throws InputError.
ContactLayout contact_layout(const FrameHeader& header, const std::string& file, const InputSpec& spec);

/// Checks and converts a table: two different ids per row, each pair once, rows in ascending order of (id1, id2).
Contacts make_contacts(const ContactLayout& layout, DumpTable table, const FrameHeader& header,
                       const std::string& file);

}  // namespace grainvdb
