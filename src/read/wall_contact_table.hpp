#pragma once
/// From the columns of a dump of contacts with walls to these contacts.
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "grainvdb/frame.hpp"
#include "grainvdb/frame_source.hpp"
#include "read/dump_file.hpp"

namespace grainvdb {

/// Which columns of a table become which quantity: indices into DumpTable::real, or DumpTable::whole for ids.
struct WallContactLayout {
  TableRequest request;
  std::size_t id = 0;                                       ///< of the particle
  std::optional<std::pair<std::size_t, std::size_t>> wall;  ///< mesh and triangle
  std::vector<std::array<std::size_t, 3>> forces;           ///< summed: the total force, or its two parts
  std::array<std::size_t, 3> point{};
};

/// Throws ConfigError when the specification itself is wrong: unknown keywords, compute and columns at once, no
/// contact point, …
void check_wall_contact_spec(const InputSpec& spec);

/// Finds the columns as the specification says. Throws InputError.
WallContactLayout wall_contact_layout(const FrameHeader& header, const std::string& file, const InputSpec& spec);

/// Checks and converts a table: every id is one of `ids`, which ascend, each contact with a triangle once; rows are put
/// into ascending order of id, mesh and triangle. Throws InputError.
WallContacts make_wall_contacts(const WallContactLayout& layout, DumpTable table, const FrameHeader& header,
                                const std::string& file, const std::vector<std::int64_t>& ids);

}  // namespace grainvdb
