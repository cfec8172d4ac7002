#pragma once
/// Finding columns by name, for particles and contacts alike.
#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "grainvdb/error.hpp"
#include "grainvdb/frame.hpp"
#include "grainvdb/frame_source.hpp"
#include "read/dump_file.hpp"

namespace grainvdb {

/// Builds a TableRequest by column name.
class ColumnFinder {
 public:
  ColumnFinder(const FrameHeader& header, std::string file) : header_(header), file_(std::move(file)) {}

  bool has(std::string_view name) const;
  bool has_all(const std::array<std::string, 3>& names) const;

  /// Requests a column that is there; returns its index in DumpTable::real or DumpTable::whole. Asking twice gives the
  /// same index. Throws InputError when two columns bear the name.
  std::size_t real(std::string_view name);
  std::size_t whole(std::string_view name);
  std::array<std::size_t, 3> real3(const std::array<std::string, 3>& names);

  const TableRequest& request() const { return request_; }
  const FrameHeader& header() const { return header_; }
  Location location() const { return {file_, header_.columns_line}; }
  /// The names of all columns, separated by blanks.
  std::string names() const;

 private:
  std::size_t find(std::string_view name) const;

  const FrameHeader& header_;
  std::string file_;
  TableRequest request_;
};

/// Where a key of the input stands in the pipeline file, or the nearest section above it that is known.
Location stated_at(const InputSpec& spec, std::string key);

/// Ids of a table must be positive and, as some codes keep them as doubles, below 2^53. Throws InputError for the first
/// that is not.
void check_ids(const std::vector<std::int64_t>& ids, std::string_view column, const DumpTable& table,
               const std::string& file);

}  // namespace grainvdb
