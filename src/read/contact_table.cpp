#include "read/contact_table.hpp"

#include <algorithm>
#include <utility>

#include "grainvdb/error.hpp"
#include "read/columns.hpp"
#include "read/contact_columns.hpp"
#include "read/row_order.hpp"

namespace grainvdb {
namespace {

const MapKeys& map_keys() {
  static const MapKeys keys{{"id1", 1},  {"id2", 1}, {"force", 3}, {"normal_force", 3}, {"tangential_force", 3},
                            {"point", 3}};
  return keys;
}

/// Column names of the quantities; those that are not there are empty.
struct ContactNames {
  std::string id1, id2;
  ForceNames force;
  std::optional<Names3> point;
};

ContactNames names_of_compute(const ColumnFinder& finder, const std::vector<std::string>& keywords) {
  const ComputeColumns compute(finder, contact_section(), keywords);
  ContactNames names{compute.name("id", 0), compute.name("id", 1), force_names(finder, compute),
                     compute.names3("contactPoint")};
  // A dump may leave out columns of its compute.
  if (names.point &&
      std::none_of(names.point->begin(), names.point->end(), [&](const std::string& n) { return finder.has(n); }))
    names.point.reset();
  return names;
}

ContactNames names_of_map(const ColumnMap& columns) {
  return {columns.at("id1")[0], columns.at("id2")[0], force_names(columns), names3(columns, "point")};
}

ContactNames plain_names(const ColumnFinder& finder) {
  ContactNames names{"id1", "id2", {Names3{"fx", "fy", "fz"}, {}, {}}, {}};
  if (!finder.has("id1") || !finder.has("id2") || !finder.has_all(*names.force.total))
    throw InputError({finder.location(), "what the columns of the contact dump mean is not known", finder.names(),
                      "columns named id1 id2 fx fy fz",
                      "Say it in the pipeline file: input.contacts.compute lists the keywords of the LIGGGHTS compute "
                      "pair/gran/local that made the dump, input.contacts.lammps names the two computes of LAMMPS, or "
                      "input.contacts.columns gives the column names of id1, id2 and force "
                      "(or normal_force and tangential_force), and of point if there is one"});
  return names;
}

/// The order of ascending (id1, id2). Throws InputError for the first contact of a particle with itself, or else the
/// least pair that comes twice, in whichever order of its ids.
RowOrder order_of_pairs(const std::vector<std::int64_t>& id1, const std::vector<std::int64_t>& id2,
                        const DumpTable& table, const std::string& file) {
  std::vector<std::int64_t> low(id1.size()), high(id1.size());
  for (std::size_t i = 0; i < id1.size(); ++i) {
    if (id1[i] == id2[i])
      throw InputError({{file, table.line(i)},
                        "a contact of a particle with itself",
                        "id " + std::to_string(id1[i]) + " twice",
                        "two different ids",
                        {}});
    low[i] = std::min(id1[i], id2[i]);
    high[i] = std::max(id1[i], id2[i]);
  }
  RowOrder order = ascending(low, high);
  const auto row = [&](std::size_t i) { return order ? (*order)[i] : i; };
  for (std::size_t i = 1; i < low.size(); ++i) {
    const std::size_t a = row(i - 1), b = row(i);
    if (low[a] == low[b] && high[a] == high[b])
      throw InputError({{file, table.line(b)},
                        "the contact of particles " + std::to_string(low[b]) + " and " + std::to_string(high[b]) +
                            " comes twice in one frame",
                        "it also on line " + std::to_string(table.line(a)),
                        "each pair once",
                        {}});
  }
  return low == id1 ? order : ascending(id1, id2);
}

}  // namespace

void check_contact_spec(const InputSpec& spec) {
  check_contact_columns(spec, contact_section(), spec.contacts.compute, spec.contacts.columns, map_keys(),
                        {"id1", "id2"});
}

ContactLayout contact_layout(const FrameHeader& header, const std::string& file, const InputSpec& spec) {
  ColumnFinder finder(header, file);
  const ContactNames names = !spec.contacts.compute.empty()   ? names_of_compute(finder, spec.contacts.compute)
                             : !spec.contacts.columns.empty() ? names_of_map(spec.contacts.columns)
                                                              : plain_names(finder);
  MissingColumns missing(finder);
  missing.require(names.id1, "id1");
  missing.require(names.id2, "id2");
  missing.require(names.force);
  if (names.point) missing.require(*names.point, "contact point");
  missing.refuse(contact_section(), "contact");

  ContactLayout layout;
  layout.id1 = finder.whole(names.id1);
  layout.id2 = finder.whole(names.id2);
  layout.forces = request_force(finder, names.force);
  if (names.point) layout.point = finder.real3(*names.point);
  layout.request = finder.request();
  refuse_double_use(finder, contact_section());
  return layout;
}

Contacts make_contacts(const ContactLayout& layout, DumpTable table, const FrameHeader& header,
                       const std::string& file) {
  std::vector<std::int64_t>&id1 = table.whole[layout.id1], &id2 = table.whole[layout.id2];
  check_ids(id1, header.columns[layout.request.whole[layout.id1]], table, file);
  check_ids(id2, header.columns[layout.request.whole[layout.id2]], table, file);
  reorder(table, order_of_pairs(id1, id2, table, file));

  Contacts contacts;
  contacts.force = total_force(table, layout.forces);
  if (layout.point)
    for (std::size_t a = 0; a < 3; ++a) contacts.point[a] = table.real[(*layout.point)[a]];
  contacts.id1 = std::move(id1);
  contacts.id2 = std::move(id2);
  return contacts;
}

}  // namespace grainvdb
