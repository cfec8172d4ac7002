#include "pipeline/species_keys.hpp"

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "base/listed.hpp"
#include "pipeline/convert.hpp"
#include "pipeline/number.hpp"
#include "pipeline/species_stages.hpp"
#include "pipeline/text.hpp"

namespace grainvdb {
namespace {

constexpr const char* name_pattern = "[A-Za-z][A-Za-z0-9_]*";

/// Other fields end in _error.
bool is_name_of_species(const std::string& name) {
  if (name.ends_with("_error")) return false;
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  return !name.empty() && is_letter(name.front()) && std::all_of(name.begin(), name.end(), [&](char c) {
    return is_letter(c) || (c >= '0' && c <= '9') || c == '_';
  });
}

std::vector<KeyInfo> species_criteria() {
  KeyInfo types{"species.NAME", "types", ValueType::integers, "Particle types."};
  types.minimum = 0;
  types.maximum = std::numeric_limits<int>::max();
  KeyInfo ids{"species.NAME", "ids", ValueType::integers, "First and last id, both included."};
  ids.fewest = ids.most = 2;
  KeyInfo diameter{"species.NAME", "diameter", ValueType::numbers, "From, included, and to, left out; .inf is no end.",
                   "length"};
  diameter.fewest = diameter.most = 2;
  diameter.minimum = 0;
  diameter.infinite_allowed = true;
  return {types, ids, diameter};
}

Species species_of(const ConfigItem& item) {
  Species species{item.kind, {}, {}, {}};
  if (const ConfigValue* types = item.find("types"))
    for (const std::int64_t type : std::get<std::vector<std::int64_t>>(*types))
      species.types.push_back(static_cast<int>(type));
  if (const ConfigValue* ids = item.find("ids")) {
    const auto& range = std::get<std::vector<std::int64_t>>(*ids);
    species.ids.emplace(range.at(0), range.at(1));
  }
  if (const ConfigValue* diameter = item.find("diameter")) {
    const auto& range = std::get<std::vector<double>>(*diameter);
    species.diameter.emplace(range.at(0), range.at(1));
  }
  return species;
}

/// What is in both of two species that are told by the same criteria; nothing where that hangs on the grains.
std::string common(const Species& a, const Species& b) {
  if (a.types.empty() != b.types.empty() || a.ids.has_value() != b.ids.has_value() ||
      a.diameter.has_value() != b.diameter.has_value())
    return {};
  std::vector<std::string> all;
  if (!a.types.empty()) {
    const auto shared = std::find_first_of(a.types.begin(), a.types.end(), b.types.begin(), b.types.end());
    if (shared == a.types.end()) return {};
    all.push_back("type " + std::to_string(*shared));
  }
  if (a.ids) {
    const std::int64_t first = std::max(a.ids->first, b.ids->first);
    if (first > std::min(a.ids->second, b.ids->second)) return {};
    all.push_back("id " + std::to_string(first));
  }
  if (a.diameter) {
    const double from = std::max(a.diameter->first, b.diameter->first);
    if (from >= std::min(a.diameter->second, b.diameter->second)) return {};
    all.push_back("diameter " + print_number(from));
  }
  return listed(all);
}

[[noreturn]] void refuse_empty(const Pipeline& p, const Species& s, const std::string& found,
                               const std::string& expected) {
  throw ConfigError(
      {p.location("species." + s.name), "species " + quote_text(s.name) + " selects nothing", found, expected, {}});
}

}  // namespace

void add_species(Schema& schema) {
  KeyInfo key{"", "species", ValueType::named_items,
              "Types or size classes of grains by names of their own, of which there are partial fields such as "
              "phi_NAME. No grain may belong to two."};
  key.kinds.push_back({"species", "Grains that satisfy every criterion given.", species_criteria()});
  key.name_pattern = name_pattern;
  key.apply = [](Pipeline& p, const ConfigValue& v) {
    for (const ConfigItem& item : std::get<std::vector<ConfigItem>>(v)) p.species.push_back(species_of(item));
  };
  schema.keys.push_back(std::move(key));
}

Pipeline with_species_of(const ConfigNode& root, const std::string& file, const Schema& schema) {
  Pipeline pipeline;
  pipeline.file = file;
  const auto it =
      std::find_if(root.entries.begin(), root.entries.end(), [](const auto& e) { return e.key == "species"; });
  if (it == root.entries.end()) return pipeline;
  const KeyInfo& key = *schema.find_key("", "species");
  key.apply(pipeline, convert(key, it->value));
  for (const ConfigEntry& entry : it->value.entries) {
    pipeline.where.emplace("species." + entry.key, entry.where);
    if (!is_name_of_species(entry.key))
      throw ConfigError({entry.where,
                         "the name of a species is part of the names of its fields",
                         quote_text(entry.key),
                         "a letter, then letters, digits and _, without _error at the end",
                         {}});
  }
  return pipeline;
}

void check_species(const Pipeline& p) {
  for (std::size_t n = 0; n < p.species.size(); ++n) {
    const Species& s = p.species[n];
    if (s.types.empty() && !s.ids && !s.diameter)
      throw ConfigError({p.location("species." + s.name),
                         "species " + quote_text(s.name) + " has no criterion",
                         {},
                         "types, ids or diameter",
                         {}});
    if (s.ids && s.ids->first > s.ids->second)
      refuse_empty(p, s, "ids [" + std::to_string(s.ids->first) + ", " + std::to_string(s.ids->second) + ']',
                   "the first id, then the last");
    if (s.diameter && !(s.diameter->first < s.diameter->second))
      refuse_empty(p, s, "diameter [" + print_number(s.diameter->first) + ", " + print_number(s.diameter->second) + ']',
                   "the smaller diameter, then the larger");
    for (std::size_t other = 0; other < n; ++other)
      if (const std::string both = common(p.species[other], s); !both.empty())
        throw ConfigError({p.location("species." + s.name),
                           "species " + quote_text(p.species[other].name) + " and " + quote_text(s.name) + " overlap",
                           both + " in both", "each grain in one species at most",
                           "Diameters go from the first, included, to the second, left out."});
  }
}

std::string hint_at_species(const StageRegistry& registry) {
  for (const Stage& stage : registry.stages())
    if (!stage.species_of.empty())
      return "Of each species there are " + join_choices(fields_by_species(registry)) + ", as in " + stage.name + '.';
  return {};
}

std::string pattern_of_species(const StageRegistry& registry) {
  std::string fields;
  for (const std::string& field : fields_by_species(registry)) fields += (fields.empty() ? "" : "|") + field;
  return fields.empty() ? fields : "^(" + fields + ")_" + name_pattern + '$';
}

}  // namespace grainvdb
