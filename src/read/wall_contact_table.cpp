#include "read/wall_contact_table.hpp"

#include <algorithm>

#include "grainvdb/error.hpp"
#include "read/columns.hpp"
#include "read/contact_columns.hpp"
#include "read/row_order.hpp"
#include "read/text.hpp"

namespace grainvdb {
namespace {

/// Column names of the quantities; those that are not there are empty.
struct WallContactNames {
  std::string mesh, triangle, id;
  ForceNames force;
  Names3 point;
};

WallContactNames names_in_compute(const ColumnFinder& finder, const std::vector<std::string>& keywords) {
  const ComputeColumns compute(finder, wall_contact_section(), keywords);
  return {compute.name("id", 0), compute.name("id", 1), compute.name("id", 2), force_names(finder, compute),
          compute.names3("pos").value_or(Names3{})};
}

WallContactNames plain_wall_names(const ColumnFinder& finder) {
  WallContactNames names{{}, {}, "id", {Names3{"fx", "fy", "fz"}, {}, {}}, {"cx", "cy", "cz"}};
  if (!finder.has(names.id) || !finder.has_all(*names.force.total) || !finder.has_all(names.point))
    throw InputError(
        {finder.location(), "what the columns of the wall contact dump mean is not known", finder.names(),
         "columns named id fx fy fz cx cy cz",
         "Say it in the pipeline file: input.wall_contacts.compute lists the keywords of the LIGGGHTS compute "
         "wall/gran/local that made the dump, or input.wall_contacts.columns gives the column names of id, point and "
         "force (or normal_force and tangential_force)"});
  return names;
}

WallContactNames names_in_map(const ColumnMap& columns) {
  const auto one = [&](const std::string& key) {
    const auto it = columns.find(key);
    return it == columns.end() ? std::string() : it->second[0];
  };
  return {one("mesh"), one("triangle"), one("id"), force_names(columns), names3(columns, "point").value_or(Names3{})};
}

void check_particles(const std::vector<std::int64_t>& found, const std::vector<std::int64_t>& ids,
                     const DumpTable& table, const std::string& file) {
  const auto unknown = std::find_if(found.begin(), found.end(),
                                    [&](std::int64_t id) { return !std::binary_search(ids.begin(), ids.end(), id); });
  if (unknown == found.end()) return;
  throw InputError(
      {{file, table.line(static_cast<std::size_t>(unknown - found.begin()))},
       "a wall contact names a particle that the particle dump of this step lacks",
       "id " + std::to_string(*unknown),
       "an id of the particle dump",
       "Dump every particle that touches a wall, and check which column is the particle's id: the third of "
       "keyword id, after mesh and triangle"});
}

/// Numbers that order rows by mesh and triangle; rows of the same triangle have the same.
std::vector<std::int64_t> ranks(const std::vector<std::int64_t>& mesh, const std::vector<std::int64_t>& triangle) {
  const RowOrder order = ascending(mesh, triangle);
  const auto row = [&](std::size_t i) { return order ? (*order)[i] : i; };
  std::vector<std::int64_t> rank(mesh.size());
  for (std::size_t i = 1; i < mesh.size(); ++i) {
    const std::size_t a = row(i - 1), b = row(i);
    rank[b] = rank[a] + (mesh[a] == mesh[b] && triangle[a] == triangle[b] ? 0 : 1);
  }
  return rank;
}

/// Throws InputError for a contact that comes twice.
RowOrder order_of_walls(const DumpTable& table, const WallContactLayout& layout, const std::string& file) {
  const std::vector<std::int64_t>& id = table.whole[layout.id];
  if (!layout.wall) return ascending(id);
  const std::vector<std::int64_t>&mesh = table.whole[layout.wall->first], &triangle = table.whole[layout.wall->second];
  const std::vector<std::int64_t> rank = ranks(mesh, triangle);
  RowOrder order = ascending(id, rank);
  const auto row = [&](std::size_t i) { return order ? (*order)[i] : i; };
  for (std::size_t i = 1; i < id.size(); ++i) {
    const std::size_t a = row(i - 1), b = row(i);
    if (id[a] == id[b] && rank[a] == rank[b])
      throw InputError({{file, table.line(b)},
                        "the contact of particle " + std::to_string(id[b]) + " with triangle " +
                            std::to_string(triangle[b]) + " of mesh " + std::to_string(mesh[b]) +
                            " comes twice in one frame",
                        "it also on line " + std::to_string(table.line(a)),
                        "each contact once",
                        {}});
  }
  return order;
}

}  // namespace

void check_wall_contact_spec(const InputSpec& spec) {
  const WallContactSpec& contacts = spec.wall_contacts;
  static const MapKeys keys{{"id", 1},    {"mesh", 1},         {"triangle", 1},
                            {"force", 3}, {"normal_force", 3}, {"tangential_force", 3},
                            {"point", 3}};
  check_contact_columns(spec, wall_contact_section(), contacts.compute, contacts.columns, keys, {"id", "point"});
  if (contacts.compute.empty()) return;
  const auto given = [&](const char* keyword) {
    return std::find(contacts.compute.begin(), contacts.compute.end(), keyword) != contacts.compute.end();
  };
  const Location at = stated_at(spec, "input.wall_contacts.compute");
  if (!given("pos"))
    throw ConfigError({at, "wall contacts without a contact point",
                       given("contactPoint") ? "contactPoint, which compute wall/gran/local never fills in" : "no pos",
                       "pos, whose first three columns are the contact point",
                       "Dump with keyword pos, or give input.wall_contacts.columns.point"});
  if (!given("id") || (!given("force") && !(given("force_normal") && given("force_tangential"))))
    throw ConfigError({at, "wall contacts without particle or force", joined(contacts.compute),
                       "pos, id and force, or force_normal and force_tangential in its place", "Dump with these"});
}

WallContactLayout wall_contact_layout(const FrameHeader& header, const std::string& file, const InputSpec& spec) {
  ColumnFinder finder(header, file);
  const WallContactNames names = !spec.wall_contacts.compute.empty()
                                     ? names_in_compute(finder, spec.wall_contacts.compute)
                                 : !spec.wall_contacts.columns.empty() ? names_in_map(spec.wall_contacts.columns)
                                                                       : plain_wall_names(finder);
  MissingColumns missing(finder);
  missing.require(names.id, "id of the particle");
  missing.require(names.force);
  missing.require(names.point, "contact point");
  missing.refuse(wall_contact_section(), "wall contact");

  WallContactLayout layout;
  layout.id = finder.whole(names.id);
  if (finder.has(names.mesh) && finder.has(names.triangle))
    layout.wall.emplace(finder.whole(names.mesh), finder.whole(names.triangle));
  layout.forces = request_force(finder, names.force);
  layout.point = finder.real3(names.point);
  layout.request = finder.request();
  refuse_double_use(finder, wall_contact_section());
  return layout;
}

WallContacts make_wall_contacts(const WallContactLayout& layout, DumpTable table, const FrameHeader& header,
                                const std::string& file, const std::vector<std::int64_t>& ids) {
  check_ids(table.whole[layout.id], header.columns[layout.request.whole[layout.id]], table, file);
  check_particles(table.whole[layout.id], ids, table, file);
  reorder(table, order_of_walls(table, layout, file));

  WallContacts contacts;
  contacts.force = total_force(table, layout.forces);
  for (std::size_t a = 0; a < 3; ++a) contacts.point[a] = table.real[layout.point[a]];
  contacts.id = std::move(table.whole[layout.id]);
  return contacts;
}

}  // namespace grainvdb
