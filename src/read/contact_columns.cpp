#include "read/contact_columns.hpp"

#include <algorithm>
#include <charconv>

#include "base/listed.hpp"
#include "grainvdb/error.hpp"

namespace grainvdb {
namespace {

/// What a LIGGGHTS `compute pair/gran/local` or `wall/gran/local` can put out, in the order in which it does, whatever
/// the order of its keywords.
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

/// A column named c_NAME[n].
std::optional<ComputeUse> parse_indexed(const std::string& column) {
  const std::size_t open = column.find('[');
  if (!column.starts_with("c_") || open == std::string::npos || column.back() != ']') return std::nullopt;
  ComputeUse result{column.substr(2, open - 2), 0};
  const char* end = column.data() + column.size() - 1;
  const auto [next, error] = std::from_chars(column.data() + open + 1, end, result.largest);
  if (error != std::errc() || next != end || result.largest == 0) return std::nullopt;
  return result;
}

/// The compute whose columns the dump holds.
ComputeUse find_compute(const ColumnFinder& finder, const ContactSection& section) {
  const std::string hint = "Use " + section.path + ".columns in place of compute";
  const std::vector<ComputeUse> found = computes_among(finder.header().columns);
  if (found.size() > 1)
    throw InputError(
        {finder.location(), "the dump holds columns of more than one compute", finder.names(), "columns of one", hint});
  if (found.empty())
    throw InputError(
        {finder.location(), "the dump has no columns of a compute", finder.names(), "columns such as c_name[1]", hint});
  return found.front();
}

void check_keywords(const InputSpec& spec, const ContactSection& section, const std::vector<std::string>& keywords) {
  const Location at = stated_at(spec, section.path + ".compute");
  for (const std::string& keyword : keywords) {
    if (std::count(keywords.begin(), keywords.end(), keyword) > 1)
      throw ConfigError({at, "the keyword '" + keyword + "' is listed twice", {}, "each keyword once", {}});
    if (std::none_of(compute_items.begin(), compute_items.end(),
                     [&](const ComputeItem& i) { return i.keyword == keyword; }))
      throw ConfigError({at,
                         "unknown keyword of compute " + section.compute,
                         "'" + keyword + "'",
                         listed(compute_items, &ComputeItem::keyword),
                         {}});
  }
}

}  // namespace

std::vector<ComputeUse> computes_among(const std::vector<std::string>& columns) {
  std::vector<ComputeUse> all;
  for (const std::string& column : columns) {
    const auto use = parse_indexed(column);
    if (!use) continue;
    const auto known = std::find_if(all.begin(), all.end(), [&](const ComputeUse& u) { return u.name == use->name; });
    if (known == all.end())
      all.push_back(*use);
    else
      known->largest = std::max(known->largest, use->largest);
  }
  return all;
}

ContactSection contact_section() {
  return {"input.contacts", "pair/gran/local"};
}

ContactSection wall_contact_section() {
  return {"input.wall_contacts", "wall/gran/local"};
}

void check_contact_columns(const InputSpec& spec, const ContactSection& section,
                           const std::vector<std::string>& keywords, const ColumnMap& columns, const MapKeys& known,
                           const std::vector<std::string>& needed) {
  const Location at = stated_at(spec, section.path + ".columns");
  if (!keywords.empty() && !columns.empty())
    throw ConfigError({at, section.path + " has both compute and columns", {}, "one of them", {}});
  check_keywords(spec, section, keywords);
  if (columns.empty()) return;
  for (const auto& [key, names] : columns) {
    const auto it = std::find_if(known.begin(), known.end(), [&](const auto& k) { return k.first == key; });
    if (it == known.end())
      throw ConfigError({at,
                         "unknown quantity of " + section.path + ".columns",
                         "'" + key + "'",
                         listed(known, [](const auto& k) { return k.first; }),
                         {}});
    if (names.size() != it->second)
      throw ConfigError({at,
                         section.path + ".columns." + key + " has the wrong number of columns",
                         std::to_string(names.size()),
                         std::to_string(it->second),
                         {}});
  }
  const auto given = [&](const std::string& key) { return columns.contains(key); };
  const bool parts = given("normal_force") && given("tangential_force");
  if (!std::all_of(needed.begin(), needed.end(), given) ||
      given("force") == (given("normal_force") || given("tangential_force")) || (!given("force") && !parts))
    throw ConfigError({at, section.path + ".columns is incomplete or gives the force twice",
                       listed(columns, [](const auto& c) { return c.first; }),
                       listed(needed) + " and either force or both normal_force and tangential_force",
                       "Grains without friction have a normal force only: name it force"});
}

ComputeColumns::ComputeColumns(const ColumnFinder& finder, const ContactSection& section,
                               const std::vector<std::string>& keywords) {
  const ComputeUse compute = find_compute(finder, section);
  prefix_ = "c_" + compute.name;
  std::size_t width = 0;
  for (const ComputeItem& item : compute_items) {
    if (std::find(keywords.begin(), keywords.end(), item.keyword) == keywords.end()) continue;
    first_[item.keyword] = width + 1;
    width += item.width;
  }
  const bool wide_history = compute.largest > width && first_.contains("history");
  if (compute.largest > width && (!wide_history || first_.contains("contactPoint")))
    throw InputError({finder.location(),
                      "the keywords of " + section.path + ".compute do not account for all columns of the compute",
                      prefix_ + '[' + std::to_string(compute.largest) + ']',
                      "at most " + prefix_ + '[' + std::to_string(width) + "] for " + listed(keywords),
                      wide_history
                          ? "The contact history seems to be wider than 3, so the contact point cannot be found: use " +
                                section.path + ".columns"
                          : "List every keyword of the compute"});
}

std::string ComputeColumns::name(std::string_view keyword, std::size_t place) const {
  const auto it = first_.find(keyword);
  return it == first_.end() ? std::string() : prefix_ + '[' + std::to_string(it->second + place) + ']';
}

std::optional<Names3> ComputeColumns::names3(std::string_view keyword, std::size_t place) const {
  if (!first_.contains(keyword)) return std::nullopt;
  return Names3{name(keyword, place), name(keyword, place + 1), name(keyword, place + 2)};
}

ForceNames force_names(const ColumnFinder& finder, const ComputeColumns& compute) {
  ForceNames force{compute.names3("force"), compute.names3("force_normal"), compute.names3("force_tangential")};
  if (!force.total || !force.normal || !force.tangential) return force;
  if (finder.has_all(*force.normal) && finder.has_all(*force.tangential) &&
      std::none_of(force.total->begin(), force.total->end(), [&](const std::string& n) { return finder.has(n); }))
    force.total.reset();
  return force;
}

ForceNames force_names(const ColumnMap& columns) {
  return {names3(columns, "force"), names3(columns, "normal_force"), names3(columns, "tangential_force")};
}

std::optional<Names3> names3(const ColumnMap& columns, const std::string& key) {
  const auto it = columns.find(key);
  if (it == columns.end()) return std::nullopt;
  return Names3{it->second[0], it->second[1], it->second[2]};
}

void MissingColumns::require(const std::string& name, const std::string& meaning) {
  if (!finder_.has(name))
    missing_ += (missing_.empty() ? "" : ", ") + (name.empty() ? meaning : name + " (" + meaning + ")");
}

void MissingColumns::require(const Names3& names, const std::string& meaning) {
  for (const std::string& name : names) require(name, meaning);
}

void MissingColumns::require(const ForceNames& force) {
  if (force.total) {
    require(*force.total, "force");
  } else if (force.normal && force.tangential) {
    require(*force.normal, "normal force");
    require(*force.tangential, "tangential force");
  } else {
    require(std::string(), "force, or normal and tangential force");
  }
}

void MissingColumns::refuse(const ContactSection& section, const std::string& kind) const {
  if (missing_.empty()) return;
  throw InputError({finder_.location(), "the " + kind + " dump lacks columns that are needed", finder_.names(),
                    missing_, "Check " + section.path + " in the pipeline file"});
}

std::vector<Real3> request_force(ColumnFinder& finder, const ForceNames& force) {
  if (force.total) return {finder.real3(*force.total)};
  return {finder.real3(*force.normal), finder.real3(*force.tangential)};
}

Columns3 total_force(const DumpTable& table, const std::vector<Real3>& parts) {
  Columns3 total;
  for (std::size_t a = 0; a < 3; ++a) {
    total[a].assign(table.rows, 0.0);
    for (const Real3& part : parts)
      for (std::size_t i = 0; i < table.rows; ++i) total[a][i] += table.real[part[a]][i];
  }
  return total;
}

void refuse_double_use(const ColumnFinder& finder, const ContactSection& section) {
  const TableRequest& request = finder.request();
  for (const std::size_t column : request.whole)
    if (std::find(request.real.begin(), request.real.end(), column) != request.real.end())
      throw InputError({finder.location(),
                        "one column stands for an id and for another quantity",
                        finder.header().columns[column],
                        {},
                        "Check " + section.path + ".columns in the pipeline file"});
}

}  // namespace grainvdb
