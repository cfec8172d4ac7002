#pragma once
/// One snapshot of a simulation: box, particle columns and contacts, as structures of arrays.
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "grainvdb/box.hpp"

namespace grainvdb {

/// The columns that a computation can ask for. `id` and `position` are always read: the first orders the rows,
/// so that results do not depend on the order in which the dump lists them.
enum class Column : unsigned {
  velocity = 1u << 0,
  angular_velocity = 1u << 1,
  radius = 1u << 2,
  mass = 1u << 3,
  type = 1u << 4,
  contacts = 1u << 5,  ///< the contact file of the frame: ids, force on the first id, contact point where given
  force = 1u << 6,
  wall_contacts = 1u << 7,  ///< the file of contacts with walls that are no grains: id, force, contact point
};

/// A set of columns.
class ColumnSet {
 public:
  constexpr ColumnSet() = default;
  constexpr ColumnSet(Column c) : bits_(static_cast<unsigned>(c)) {}  // NOLINT: implicit by design
  constexpr bool has(Column c) const { return (bits_ & static_cast<unsigned>(c)) != 0; }
  constexpr ColumnSet without(Column c) const { return ColumnSet(bits_ & ~static_cast<unsigned>(c)); }
  constexpr ColumnSet operator|(ColumnSet o) const { return ColumnSet(bits_ | o.bits_); }
  constexpr ColumnSet& operator|=(ColumnSet o) {
    bits_ |= o.bits_;
    return *this;
  }
  constexpr bool operator==(const ColumnSet&) const = default;

 private:
  constexpr explicit ColumnSet(unsigned bits) : bits_(bits) {}
  unsigned bits_ = 0;
};
constexpr ColumnSet operator|(Column a, Column b) {
  return ColumnSet(a) | ColumnSet(b);
}

/// "id", "position", then the names of the columns in the set: what a reader parses for it.
std::vector<std::string> column_names(ColumnSet columns);

/// Three columns of equal length, one per axis.
using Columns3 = std::array<std::vector<double>, 3>;

/// Particles in ascending order of id. A column that was not asked for is empty.
struct Particles {
  std::vector<std::int64_t> id;
  Columns3 position;           ///< as dumped, unwrapped coordinates included; [length]
  Columns3 velocity;           ///< [length/time]
  Columns3 angular_velocity;   ///< [1/time]
  std::vector<double> radius;  ///< > 0 [length]
  std::vector<double> mass;    ///< > 0 [mass]
  std::vector<int> type;
  Columns3 force;            ///< total force [force]
  std::vector<int> species;  ///< number in Pipeline::species, -1: none; not read but told by it, empty without species

  std::size_t size() const { return id.size(); }
};

/// Contacts in ascending order of (id1, id2); each pair once.
struct Contacts {
  std::vector<std::int64_t> id1;
  std::vector<std::int64_t> id2;
  Columns3 force;  ///< total contact force on the particle id1, -force acts on id2 [force]
  Columns3 point;  ///< contact point in the image frame of id1; empty where the dump has none [length]

  std::size_t size() const { return id1.size(); }
};

/// Contacts of particles with walls that are no particles, such as meshes, in ascending order of id. A particle may
/// have several.
struct WallContacts {
  std::vector<std::int64_t> id;
  Columns3 force;  ///< of the wall on the particle [force]
  Columns3 point;  ///< contact point, in any image frame [length]

  std::size_t size() const { return id.size(); }
};

/// One snapshot.
struct Frame {
  std::string file;            ///< the particle file it came from
  std::int64_t step = 0;       ///< TIMESTEP
  std::optional<double> time;  ///< ITEM: TIME, or step × dt where dt is known; [time]
  Box box;
  Particles particles;
  Contacts contacts;           ///< empty unless asked for
  WallContacts wall_contacts;  ///< empty unless asked for
};

}  // namespace grainvdb
