#include "read/contact_table.hpp"

#include <algorithm>
#include <charconv>
#include <map>
#include <string_view>
#include <utility>

#include "grainvdb/error.hpp"
#include "read/columns.hpp"
#include "read/row_order.hpp"

namespace grainvdb {
namespace {

using Names3 = std::array<std::string, 3>;

/// What a LIGGGHTS `compute pair/gran/local` can put out, in the order in which it does, whatever the order of its
/// keywords.
struct ComputeItem {
  std::string_view keyword;
  std::size_t width;
};
/// 3 for the tangential models with history; other models may keep more, which is found out where it matters.
constexpr std::size_t history_width = 3;
constexpr std::array compute_items{ComputeItem{"pos", 6},
                                   ComputeItem{"vel", 6},
                                   ComputeItem{"id", 3},
                                   ComputeItem{"force", 3},
                                   ComputeItem{"force_normal", 3},
                                   ComputeItem{"force_tangential", 3},
                                   ComputeItem{"torque", 3},
                                   ComputeItem{"torque_normal", 3},
                                   ComputeItem{"torque_tangential", 3},
                                   ComputeItem{"history", history_width},
                                   ComputeItem{"contactArea", 1},
                                   ComputeItem{"delta", 1},
                                   ComputeItem{"heatFlux", 1},
                                   ComputeItem{"contactPoint", 3},
                                   ComputeItem{"ms_id", 2},
                                   ComputeItem{"verbose", 0}};

/// The keys of a column map, and how many columns each takes.
constexpr std::array<std::pair<std::string_view, std::size_t>, 6> map_keys{
    {{"id1", 1}, {"id2", 1}, {"force", 3}, {"normal_force", 3}, {"tangential_force", 3}, {"point", 3}}};

/// Column names of the quantities; those that are not there are empty.
struct ContactNames {
  std::string id1, id2;
  std::optional<Names3> force, normal_force, tangential_force, point;
};

template <class List, class Name>
std::string listed(const List& list, Name name) {
  std::string text;
  for (const auto& item : list) text += (text.empty() ? "" : ", ") + std::string(name(item));
  return text;
}

bool contains(const std::vector<std::string>& list, std::string_view word) {
  return std::find(list.begin(), list.end(), word) != list.end();
}

/// A column named c_NAME[n].
struct Indexed {
  std::string prefix;  ///< "c_NAME"
  std::size_t index = 0;
};
std::optional<Indexed> parse_indexed(const std::string& name) {
  const std::size_t open = name.find('[');
  if (!name.starts_with("c_") || open == std::string::npos || name.back() != ']') return std::nullopt;
  Indexed result{name.substr(0, open), 0};
  const char* end = name.data() + name.size() - 1;
  const auto [next, error] = std::from_chars(name.data() + open + 1, end, result.index);
  if (error != std::errc() || next != end || result.index == 0) return std::nullopt;
  return result;
}

Names3 names_at(const std::string& prefix, std::size_t first) {
  const auto name = [&](std::size_t i) { return prefix + '[' + std::to_string(i) + ']'; };
  return {name(first), name(first + 1), name(first + 2)};
}

/// The compute whose columns the dump holds, and the largest index among them.
Indexed find_compute(const ColumnFinder& finder) {
  Indexed found;
  for (const std::string& column : finder.header().columns) {
    const auto indexed = parse_indexed(column);
    if (!indexed) continue;
    if (!found.prefix.empty() && found.prefix != indexed->prefix)
      throw InputError({finder.location(), "the dump holds columns of more than one compute", finder.names(),
                        "columns of one", "Use input.contacts.columns in place of compute"});
    found.prefix = indexed->prefix;
    found.index = std::max(found.index, indexed->index);
  }
  if (found.prefix.empty())
    throw InputError({finder.location(), "the dump has no columns of a compute", finder.names(),
                      "columns such as c_name[1]", "Use input.contacts.columns in place of compute"});
  return found;
}

ContactNames names_of_compute(const ColumnFinder& finder, const std::vector<std::string>& keywords) {
  const Indexed compute = find_compute(finder);
  std::map<std::string_view, std::size_t> first;  // index of the first column of each keyword
  std::size_t width = 0;
  for (const ComputeItem& item : compute_items) {
    if (!contains(keywords, item.keyword)) continue;
    first[item.keyword] = width + 1;
    width += item.width;
  }
  const bool wide_history = compute.index > width && first.contains("history");
  if (compute.index > width && (!wide_history || first.contains("contactPoint")))
    throw InputError(
        {finder.location(), "the keywords of input.contacts.compute do not account for all columns of the compute",
         compute.prefix + '[' + std::to_string(compute.index) + ']',
         "at most " + compute.prefix + '[' + std::to_string(width) + "] for " +
             listed(keywords, [](const std::string& k) { return k; }),
         wide_history ? "The contact history seems to be wider than 3, so the contact point cannot be found: use "
                        "input.contacts.columns"
                      : "List every keyword of the compute"});
  ContactNames names;
  const auto at = [&](std::string_view keyword, std::optional<Names3>& to) {
    if (first.contains(keyword)) to = names_at(compute.prefix, first[keyword]);
  };
  if (first.contains("id")) {
    const Names3 ids = names_at(compute.prefix, first["id"]);
    names.id1 = ids[0];
    names.id2 = ids[1];
  }
  at("force", names.force);
  at("force_normal", names.normal_force);
  at("force_tangential", names.tangential_force);
  at("contactPoint", names.point);
  // A dump may leave out columns of its compute.
  const auto drop_absent = [&](std::optional<Names3>& three) {
    if (three && std::none_of(three->begin(), three->end(), [&](const std::string& n) { return finder.has(n); }))
      three.reset();
  };
  drop_absent(names.point);
  if (names.normal_force && names.tangential_force && finder.has_all(*names.normal_force) &&
      finder.has_all(*names.tangential_force))
    drop_absent(names.force);
  return names;
}

ContactNames names_of_map(const std::map<std::string, std::vector<std::string>>& columns) {
  ContactNames names{columns.at("id1")[0], columns.at("id2")[0], {}, {}, {}, {}};
  const auto at = [&](const std::string& key, std::optional<Names3>& to) {
    const auto it = columns.find(key);
    if (it != columns.end()) to = Names3{it->second[0], it->second[1], it->second[2]};
  };
  at("force", names.force);
  at("normal_force", names.normal_force);
  at("tangential_force", names.tangential_force);
  at("point", names.point);
  return names;
}

ContactNames plain_names(const ColumnFinder& finder) {
  ContactNames names{"id1", "id2", Names3{"fx", "fy", "fz"}, {}, {}, {}};
  if (!finder.has("id1") || !finder.has("id2") || !finder.has_all(*names.force))
    throw InputError(
        {finder.location(), "what the columns of the contact dump mean is not known", finder.names(),
         "columns named id1 id2 fx fy fz",
         "Say it in the pipeline file: input.contacts.compute lists the keywords of the LIGGGHTS compute "
         "pair/gran/local that made the dump, or input.contacts.columns gives the column names of id1, id2 and force "
         "(or normal_force and tangential_force), and of point if there is one"});
  return names;
}

/// The order of ascending (id1, id2). Throws InputError for the first contact of a particle with itself, or else the
/// least pair that comes twice, in whichever order of its ids.
RowOrder order_of_pairs(const std::vector<std::int64_t>& id1, const std::vector<std::int64_t>& id2,
                        std::size_t first_line, const std::string& file) {
  std::vector<std::int64_t> low(id1.size()), high(id1.size());
  for (std::size_t i = 0; i < id1.size(); ++i) {
    if (id1[i] == id2[i])
      throw InputError({{file, first_line + i},
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
      throw InputError({{file, first_line + b},
                        "the contact of particles " + std::to_string(low[b]) + " and " + std::to_string(high[b]) +
                            " comes twice in one frame",
                        "it also on line " + std::to_string(first_line + a),
                        "each pair once",
                        {}});
  }
  return low == id1 ? order : ascending(id1, id2);
}

}  // namespace

void check_contact_spec(const InputSpec& spec) {
  const ContactSpec& contacts = spec.contacts;
  const Location compute_at = stated_at(spec, "input.contacts.compute"),
                 columns_at = stated_at(spec, "input.contacts.columns");
  if (!contacts.compute.empty() && !contacts.columns.empty())
    throw ConfigError({columns_at, "input.contacts has both compute and columns", {}, "one of them", {}});
  for (const std::string& keyword : contacts.compute) {
    if (std::count(contacts.compute.begin(), contacts.compute.end(), keyword) > 1)
      throw ConfigError({compute_at, "the keyword '" + keyword + "' is listed twice", {}, "each keyword once", {}});
    if (std::none_of(compute_items.begin(), compute_items.end(),
                     [&](const ComputeItem& i) { return i.keyword == keyword; }))
      throw ConfigError({compute_at,
                         "unknown keyword of compute pair/gran/local",
                         "'" + keyword + "'",
                         listed(compute_items, [](const ComputeItem& i) { return i.keyword; }),
                         {}});
  }
  if (contacts.columns.empty()) return;
  for (const auto& [key, names] : contacts.columns) {
    const auto known = std::find_if(map_keys.begin(), map_keys.end(), [&](const auto& k) { return k.first == key; });
    if (known == map_keys.end())
      throw ConfigError({columns_at,
                         "unknown quantity of input.contacts.columns",
                         "'" + key + "'",
                         listed(map_keys, [](const auto& k) { return k.first; }),
                         {}});
    if (names.size() != known->second)
      throw ConfigError({columns_at,
                         "input.contacts.columns." + key + " has the wrong number of columns",
                         std::to_string(names.size()),
                         std::to_string(known->second),
                         {}});
  }
  const auto given = [&](const char* key) { return contacts.columns.contains(key); };
  const bool parts = given("normal_force") && given("tangential_force");
  if (!given("id1") || !given("id2") || given("force") == (given("normal_force") || given("tangential_force")) ||
      (!given("force") && !parts))
    throw ConfigError({columns_at, "input.contacts.columns is incomplete or gives the force twice",
                       listed(contacts.columns, [](const auto& c) { return c.first; }),
                       "id1, id2 and either force or both normal_force and tangential_force",
                       "Grains without friction have a normal force only: name it force"});
}

ContactLayout contact_layout(const FrameHeader& header, const std::string& file, const InputSpec& spec) {
  ColumnFinder finder(header, file);
  const ContactNames names = !spec.contacts.compute.empty()   ? names_of_compute(finder, spec.contacts.compute)
                             : !spec.contacts.columns.empty() ? names_of_map(spec.contacts.columns)
                                                              : plain_names(finder);
  std::string missing;
  const auto require = [&](const std::string& name, const std::string& meaning) {
    if (!finder.has(name))
      missing += (missing.empty() ? "" : ", ") + (name.empty() ? meaning : name + " (" + meaning + ")");
  };
  const auto require3 = [&](const std::optional<Names3>& three, const std::string& meaning) {
    if (three)
      for (const std::string& name : *three) require(name, meaning);
  };
  require(names.id1, "id1");
  require(names.id2, "id2");
  if (names.force) {
    require3(names.force, "force");
  } else if (names.normal_force && names.tangential_force) {
    require3(names.normal_force, "normal force");
    require3(names.tangential_force, "tangential force");
  } else {
    require({}, "force, or normal and tangential force");
  }
  require3(names.point, "contact point");
  if (!missing.empty())
    throw InputError({finder.location(), "the contact dump lacks columns that are needed", finder.names(), missing,
                      "Check input.contacts in the pipeline file"});

  ContactLayout layout;
  layout.id1 = finder.whole(names.id1);
  layout.id2 = finder.whole(names.id2);
  if (names.force)
    layout.forces = {finder.real3(*names.force)};
  else
    layout.forces = {finder.real3(*names.normal_force), finder.real3(*names.tangential_force)};
  if (names.point) layout.point = finder.real3(*names.point);
  layout.request = finder.request();
  for (const std::size_t column : layout.request.whole)
    if (std::find(layout.request.real.begin(), layout.request.real.end(), column) != layout.request.real.end())
      throw InputError({finder.location(),
                        "one column stands for an id and for another quantity",
                        header.columns[column],
                        {},
                        "Check input.contacts.columns in the pipeline file"});
  return layout;
}

Contacts make_contacts(const ContactLayout& layout, Table table, const FrameHeader& header, const std::string& file) {
  std::vector<std::int64_t>&id1 = table.whole[layout.id1], &id2 = table.whole[layout.id2];
  check_ids(id1, header.columns[layout.request.whole[layout.id1]], table.first_line, file);
  check_ids(id2, header.columns[layout.request.whole[layout.id2]], table.first_line, file);
  reorder(table, order_of_pairs(id1, id2, table.first_line, file));

  Contacts contacts;
  for (std::size_t a = 0; a < 3; ++a) {
    contacts.force[a].assign(table.rows, 0.0);
    for (const auto& force : layout.forces)
      for (std::size_t i = 0; i < table.rows; ++i) contacts.force[a][i] += table.real[force[a]][i];
    if (layout.point) contacts.point[a] = table.real[(*layout.point)[a]];
  }
  contacts.id1 = std::move(id1);
  contacts.id2 = std::move(id2);
  return contacts;
}

}  // namespace grainvdb
