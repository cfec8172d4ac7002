#include "pipeline/schema.hpp"

#include <algorithm>
#include <cmath>
#include <locale>
#include <map>
#include <sstream>
#include <utility>

#include "grainvdb/field_sink.hpp"
#include "grainvdb/units.hpp"
#include "pipeline/average_keys.hpp"
#include "pipeline/contact_keys.hpp"
#include "pipeline/frame_range.hpp"
#include "pipeline/half_step_keys.hpp"
#include "pipeline/key_builders.hpp"
#include "pipeline/measure_keys.hpp"
#include "pipeline/option_keys.hpp"
#include "pipeline/reduced_keys.hpp"
#include "pipeline/scale_keys.hpp"
#include "pipeline/species_keys.hpp"
#include "pipeline/text.hpp"
#include "pipeline/trace_schema.hpp"
#include "pipeline/unsaid_keys.hpp"
#include "pipeline/wall_schema.hpp"

namespace grainvdb {
namespace {

void add_input(Schema& schema) {
  schema.sections.push_back({"input", "What to read.", true});
  auto key = texts_key("input", "particles",
                       "Particle dumps: a file, directory or pattern, or a list of them; relative to the folder of the "
                       "pipeline file.",
                       {}, [](Pipeline& p, const ConfigValue& v) { p.input.particles = input_paths(p, v); });
  key.required = true;
  schema.keys.push_back(key);
  schema.keys.push_back(number_key("input", "dt", "time", "Time per step, for dumps without ITEM: TIME.",
                                   [](Pipeline& p, const ConfigValue& v) { p.input.dt = std::get<double>(v); }));
  KeyInfo units{"input", "units", ValueType::text, "Unit system, for dumps without ITEM: UNITS."};
  for (const UnitSystem& system : unit_systems()) units.choices.push_back(system.name);
  units.apply = [](Pipeline& p, const ConfigValue& v) { p.input.units = std::get<std::string>(v); };
  schema.keys.push_back(units);
  schema.keys.push_back(number_key("input", "density", "mass/length^3",
                                   "Density of the grains, for dumps without mass.",
                                   [](Pipeline& p, const ConfigValue& v) { p.input.density = std::get<double>(v); }));
  schema.keys.push_back(number_key("input", "radius", "length",
                                   "Radius of all grains, for dumps without radius and diameter.",
                                   [](Pipeline& p, const ConfigValue& v) { p.input.radius = std::get<double>(v); }));
  KeyInfo on_error{"input", "on_error", ValueType::text,
                   "What becomes of a frame that is malformed, or lacks columns or contacts: 'error' ends the run, "
                   "'skip_frame' leaves it out, says so and records it in the result."};
  on_error.choices = {"error", "skip_frame"};
  on_error.default_value = std::string("error");
  on_error.apply = [](Pipeline& p, const ConfigValue& v) {
    p.input.on_error = std::get<std::string>(v) == "error" ? OnError::error : OnError::skip_frame;
  };
  schema.keys.push_back(on_error);
}

void add_selection(Schema& schema) {
  schema.sections.push_back({"select", "What counts as material: particles that satisfy every criterion given."});
  KeyInfo types{"select", "types", ValueType::integers, "Particle types."};
  types.minimum = 0;
  types.maximum = std::numeric_limits<int>::max();
  types.apply = [](Pipeline& p, const ConfigValue& v) {
    for (const std::int64_t type : std::get<std::vector<std::int64_t>>(v))
      p.select.types.push_back(static_cast<int>(type));
  };
  schema.keys.push_back(types);
  KeyInfo ids{"select", "ids", ValueType::integers, "First and last id, both included."};
  ids.fewest = ids.most = 2;
  ids.apply = [](Pipeline& p, const ConfigValue& v) {
    const auto& range = std::get<std::vector<std::int64_t>>(v);
    p.select.ids.emplace(range.at(0), range.at(1));
  };
  schema.keys.push_back(ids);
  schema.sections.push_back({"select.region", "A box: lo <= x < hi along each axis; .inf leaves a side open."});
  add_box_keys(
      schema, "select.region", [](Pipeline & p) -> auto& { return p.select.region; });
}

void add_accumulation(Schema& schema) {
  static const std::map<std::string, Accumulation> ways{
      {"shifted", Accumulation::shifted}, {"float", Accumulation::single}, {"double", Accumulation::twofold}};
  KeyInfo key{"kernel", "accumulation", ValueType::text,
              "How the sums over a frame's grains and contacts at a voxel are formed: 'shifted', in single precision "
              "about local references, and again in double where that could matter; 'float', in single precision with "
              "neither, which shows what they are for; 'double', all in double precision, slowly. Gradients by the "
              "kernel and closed line integrals are in double precision always."};
  key.choices = {"shifted", "float", "double"};
  key.default_value = key.choices.front();
  key.apply = [](Pipeline& p, const ConfigValue& v) { p.accumulation = ways.at(std::get<std::string>(v)); };
  schema.keys.push_back(key);
}

void add_method(Schema& schema) {
  KeyInfo frames{"", "frames", ValueType::frame_range,
                 "Frames first:end:step of the sorted list, as Python slices: the end is left out, negative numbers "
                 "count from the end, one number is one frame."};
  frames.default_value = std::string("::");
  frames.apply = [](Pipeline& p, const ConfigValue& v) {
    p.frames = parse_frame_range(std::get<std::string>(v)).value();
  };
  schema.keys.push_back(frames);

  schema.sections.push_back(
      {"lattice", "The voxels on which the fields live; needed where there are any.", false, true});
  auto voxel =
      number_key("lattice", "voxel", "length", "Edge of a voxel. Periodic lengths must be whole numbers of it.",
                 [](Pipeline& p, const ConfigValue& v) { p.voxel = std::get<double>(v); });
  voxel.required = true;
  schema.keys.push_back(voxel);
  auto origin = vector_key("lattice", "origin", "Corner of voxel (0,0,0); lattices with one origin and voxel agree.",
                           [](Pipeline& p, const ConfigValue& v) { p.origin = vector_of(v); });
  origin.default_value = std::vector<double>{0, 0, 0};
  schema.keys.push_back(origin);

  schema.sections.push_back({"region",
                             "A box in which fields are wanted, the same there as without it: voxels with centres "
                             "lo <= x < hi along each axis; .inf leaves a side open."});
  add_box_keys(
      schema, "region", [](Pipeline & p) -> auto& { return p.region; });

  schema.sections.push_back({"kernel", "The smoothing kernel; needed where there are fields.", false, true});
  KeyInfo kernel{"kernel", "name", ValueType::text, "Shape of the kernel."};
  kernel.choices = {"lucy"};
  kernel.default_value = std::string("lucy");
  kernel.apply = [](Pipeline&, const ConfigValue&) {};  // there is one kernel
  schema.keys.push_back(kernel);
  auto cutoff =
      number_key("kernel", "cutoff", "length", "Radius of the kernel's support; 3 mean diameters give a width of 1.5.",
                 [](Pipeline& p, const ConfigValue& v) { p.cutoff = std::get<double>(v); });
  cutoff.required = true;
  schema.keys.push_back(cutoff);
  add_accumulation(schema);
}

void add_output(Schema& schema, const StageRegistry& registry) {
  schema.sections.push_back({"output", "What to write; needed where nothing is traced or measured.", false, true});
  std::vector<std::string> names;
  for (const Stage& stage : registry.stages()) names.push_back(stage.name);
  auto fields = texts_key(
      "output", "fields", "Fields, in the order in which they are written; needed unless 'reduced' alone is given.",
      names, [](Pipeline& p, const ConfigValue& v) { p.fields = std::get<std::vector<std::string>>(v); });
  fields.hint = hint_at_species(registry);
  fields.name_pattern = pattern_of_species(registry);
  schema.keys.push_back(fields);
  std::vector<std::string> formats;
  for (const SinkInfo& sink : sink_registry()) formats.push_back(sink.name);
  auto format = texts_key("output", "formats", "File formats.", formats,
                          [](Pipeline& p, const ConfigValue& v) { p.formats = std::get<std::vector<std::string>>(v); });
  format.default_value = std::vector<std::string>{"hdf5"};
  schema.keys.push_back(format);
  add_reduced_keys(schema);
}

void add_stages(Schema& schema, const StageRegistry& registry) {
  schema.sections.push_back({"stages", "Options of stages."});
  for (const Stage& stage : registry.stages()) {
    if (!stage.species_of.empty()) continue;
    schema.sections.push_back({"stages." + stage.name, "Options of " + stage.name + ": " + stage.description});
    for (const OptionInfo& option : stage.options)
      schema.keys.push_back(option_key("stages." + stage.name, option,
                                       [name = stage.name](Pipeline& p) -> OptionValues& { return p.stages[name]; }));
  }
}

void add_limits(Schema& schema) {
  schema.sections.push_back({"limits", "Bounds that are checked before the work they bound begins."});
  const Limits defaults;
  KeyInfo extent{"limits", "extent", ValueType::integer, "Voxels along any axis."};
  extent.default_value = defaults.extent;
  extent.minimum = 1;
  extent.maximum = 1e9;  // voxel indices are 32-bit
  extent.apply = [](Pipeline& p, const ConfigValue& v) { p.limits.extent = std::get<std::int64_t>(v); };
  schema.keys.push_back(extent);
  KeyInfo dense{"limits", "dense_voxels", ValueType::integer, "Voxels of the box that is written."};
  dense.default_value = defaults.dense_voxels;
  dense.minimum = 1;
  dense.apply = [](Pipeline& p, const ConfigValue& v) { p.limits.dense_voxels = std::get<std::int64_t>(v); };
  schema.keys.push_back(dense);
  KeyInfo memory{"limits", "memory_gb", ValueType::number,
                 "Memory of the moment sums; 0 means three quarters of the machine's.", "GB"};
  memory.default_value = defaults.memory_gb;
  memory.minimum = 0;
  memory.apply = [](Pipeline& p, const ConfigValue& v) { p.limits.memory_gb = std::get<double>(v); };
  schema.keys.push_back(memory);
  KeyInfo in_flight{"limits", "frames_in_flight", ValueType::integer,
                    "Frames in memory at the same time; 0 means one more than there are threads, and 8 at most."};
  in_flight.default_value = std::int64_t{0};
  in_flight.minimum = 0;
  in_flight.maximum = 1000;
  in_flight.apply = [](Pipeline& p, const ConfigValue& v) {
    p.limits.frames_in_flight = static_cast<std::size_t>(std::get<std::int64_t>(v));
  };
  schema.keys.push_back(in_flight);
  KeyInfo volume{
      "limits", "volume_error", ValueType::number,
      "Largest relative error of a grain's volume, which coarse voxels make: 0.037 at a cutoff of 1.5 voxels, "
      "0.0022 at 3, 2.4e-5 at 6."};
  volume.default_value = defaults.volume_error;
  volume.minimum = 0;
  volume.above_minimum = true;
  volume.apply = [](Pipeline& p, const ConfigValue& v) { p.limits.volume_error = std::get<double>(v); };
  schema.keys.push_back(volume);
  KeyInfo narrow{
      "limits", "cutoff_in_diameters", ValueType::number,
      "Least cutoff in mean diameters of the grains: below it the run warns that fields show single grains."};
  narrow.default_value = defaults.cutoff_in_diameters;
  narrow.minimum = 0;
  narrow.apply = [](Pipeline& p, const ConfigValue& v) { p.limits.cutoff_in_diameters = std::get<double>(v); };
  schema.keys.push_back(narrow);
}

std::string range_of(const KeyInfo& key) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(10);
  const bool low = std::isfinite(key.minimum), high = std::isfinite(key.maximum);
  if (low && high && key.minimum == key.maximum) {
    text << " equal to " << key.minimum;
  } else {
    if (low) text << (key.above_minimum ? " > " : " >= ") << key.minimum;
    if (high) text << (low ? " and <= " : " <= ") << key.maximum;
  }
  if (!key.unit.empty()) text << " [" << key.unit << ']';
  return text.str();
}

// "{point, normal}"
std::string keys_of(const ItemKind& kind) {
  std::string text = "{";
  for (std::size_t n = 0; n < kind.keys.size(); ++n) text += (n == 0 ? "" : ", ") + kind.keys[n].name;
  return text + '}';
}

// "a list of plane: {point, normal}, cylinder: {...} or ..."
std::string list_of_kinds(const KeyInfo& key) {
  std::string text = "a list of";
  for (std::size_t k = 0; k < key.kinds.size(); ++k) {
    const ItemKind& kind = key.kinds[k];
    text += (k == 0 ? " " : k + 1 < key.kinds.size() ? ", " : " or ") + kind.name + ": " + keys_of(kind);
  }
  return text;
}

std::string list_of(const KeyInfo& key, const std::string& items) {
  if (key.fewest == key.most) return "a list of " + std::to_string(key.fewest) + ' ' + items;
  return "a list of " + items;
}

}  // namespace

const ConfigValue* ConfigItem::find(const std::string& name) const {
  const auto it = std::find_if(values.begin(), values.end(), [&](const auto& v) { return v.first == name; });
  return it == values.end() ? nullptr : &it->second;
}

std::string SectionInfo::parent() const {
  const auto dot = path.rfind('.');
  return dot == std::string::npos ? std::string() : path.substr(0, dot);
}

std::string SectionInfo::name() const {
  return path.substr(path.rfind('.') + 1);
}

const KeyInfo* Schema::find_key(const std::string& section, const std::string& name) const {
  const auto it =
      std::find_if(keys.begin(), keys.end(), [&](const KeyInfo& k) { return k.section == section && k.name == name; });
  return it == keys.end() ? nullptr : &*it;
}

const SectionInfo* Schema::find_section(const std::string& path) const {
  const auto it = std::find_if(sections.begin(), sections.end(), [&](const SectionInfo& s) { return s.path == path; });
  return it == sections.end() ? nullptr : &*it;
}

std::vector<std::string> Schema::names_in(const std::string& section) const {
  std::vector<std::string> names;
  for (const KeyInfo& key : keys)
    if (key.section == section) names.push_back(key.name);
  for (const SectionInfo& s : sections)
    if (s.parent() == section) names.push_back(s.name());
  return names;
}

Schema make_schema(const StageRegistry& registry) {
  Schema schema;
  KeyInfo version{"", "grainvdb", ValueType::integer, "Version of the file format."};
  version.required = true;
  version.minimum = version.maximum = 1;
  version.hint = "Other versions need another release of grainvdb.";
  version.apply = [](Pipeline&, const ConfigValue&) {};
  schema.keys.push_back(version);
  for (const char* section : {"spots", "voids", "packing", "container"})
    schema.foreign.push_back({section, "a spot file", "grainvdb spot run"});
  add_input(schema);
  add_unsaid_keys(schema);
  add_contact_keys(schema);
  add_half_step_keys(schema);
  add_selection(schema);
  add_species(schema);
  add_walls(schema);
  add_method(schema);
  add_scale_keys(schema);
  add_average_keys(schema, registry);
  add_output(schema, registry);
  add_trace(schema, registry);
  add_stages(schema, registry);
  add_measure(schema, registry);
  add_limits(schema);
  return schema;
}

std::string accepted(const KeyInfo& key) {
  switch (key.type) {
    case ValueType::boolean:
      return "true or false";
    case ValueType::integer:
      return "a whole number" + range_of(key);
    case ValueType::number:
      return "a number" + range_of(key);
    case ValueType::text:
      return key.choices.empty() ? "a text" : join_choices(key.choices);
    case ValueType::texts:
      return key.choices.empty() ? list_of(key, "texts") : list_of(key, "names among " + join_choices(key.choices));
    case ValueType::integers:
      return list_of(key, "whole numbers" + range_of(key));
    case ValueType::numbers:
      return (key.one_for_all ? "a number, or " : "") + list_of(key, "numbers" + range_of(key));
    case ValueType::points:
      return "a list of places, each [x, y, z]" + range_of(key);
    case ValueType::items:
      return list_of_kinds(key);
    case ValueType::named_items:
      return "sections by name, each with " + keys_of(key.kinds.at(0));
    case ValueType::frame_range:
      return "a frame number or first:end:step, e.g. 0, 10:, -5:, ::2 or 10:50:2";
    case ValueType::window:
      break;
  }
  return "all, none, or a whole number" + range_of(key);
}

}  // namespace grainvdb
