#pragma once
/// What dumps of contacts between particles and of contacts with walls have in common: how their columns are found.
#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "grainvdb/frame.hpp"
#include "grainvdb/frame_source.hpp"
#include "read/columns.hpp"
#include "read/dump_file.hpp"

namespace grainvdb {

using Names3 = std::array<std::string, 3>;
using ColumnMap = std::map<std::string, std::vector<std::string>>;

/// A section of the input that describes contact dumps, such as "input.contacts", and the compute that makes them.
struct ContactSection {
  std::string path;
  std::string compute;
};
ContactSection contact_section();
ContactSection wall_contact_section();

/// The keys of a column map, and how many columns each takes.
using MapKeys = std::vector<std::pair<std::string_view, std::size_t>>;

/// Throws ConfigError: keywords that are unknown or come twice, a map beside them, keys of the map that are unknown,
/// take another number of columns or are needed and absent, the force in no way or in two.
void check_contact_columns(const InputSpec& spec, const ContactSection& section,
                           const std::vector<std::string>& keywords, const ColumnMap& columns, const MapKeys& known,
                           const std::vector<std::string>& needed);

/// A compute some of whose columns, c_NAME[n], a dump has.
struct ComputeUse {
  std::string name;
  std::size_t largest = 0;  ///< n
};
/// Each compute among these names of columns, in their order.
std::vector<ComputeUse> computes_among(const std::vector<std::string>& columns);

/// The columns of a LIGGGHTS compute in a dump. They are in one order, whatever that of the keywords.
class ComputeColumns {
 public:
  /// Throws InputError: the dump has columns of no compute or of several, or more than the keywords account for.
  ComputeColumns(const ColumnFinder& finder, const ContactSection& section, const std::vector<std::string>& keywords);

  /// The name of column `place` of a keyword, empty without the keyword; and of three from there on.
  std::string name(std::string_view keyword, std::size_t place) const;
  std::optional<Names3> names3(std::string_view keyword, std::size_t place = 0) const;

 private:
  std::string prefix_;  // "c_NAME"
  std::map<std::string_view, std::size_t> first_;
};

/// Names of the columns of a force, or of its parts.
struct ForceNames {
  std::optional<Names3> total, normal, tangential;
};
/// The total is left out where the dump leaves it out but has both parts.
ForceNames force_names(const ColumnFinder& finder, const ComputeColumns& compute);
ForceNames force_names(const ColumnMap& columns);

std::optional<Names3> names3(const ColumnMap& columns, const std::string& key);

/// Three columns of a table: indices into DumpTable::real.
using Real3 = std::array<std::size_t, 3>;

/// Collects what a dump lacks, to say it all at once.
class MissingColumns {
 public:
  explicit MissingColumns(const ColumnFinder& finder) : finder_(finder) {}
  void require(const std::string& name, const std::string& meaning);
  void require(const Names3& names, const std::string& meaning);
  void require(const ForceNames& force);
  /// Throws InputError.
  void refuse(const ContactSection& section, const std::string& kind) const;

 private:
  const ColumnFinder& finder_;
  std::string missing_;
};

/// The total force, or its two parts, to be summed.
std::vector<Real3> request_force(ColumnFinder& finder, const ForceNames& force);
Columns3 total_force(const DumpTable& table, const std::vector<Real3>& parts);

/// Throws InputError where a column is asked for as an id and as another quantity.
void refuse_double_use(const ColumnFinder& finder, const ContactSection& section);

}  // namespace grainvdb
