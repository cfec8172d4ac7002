#include "spot/spot_schema.hpp"

#include <utility>

#include "grainvdb/units.hpp"

namespace grainvdb::spot {
namespace {

KeyInfo key(std::string section, std::string name, ValueType type, std::string help) {
  return {std::move(section), std::move(name), type, std::move(help)};
}
KeyInfo positive(std::string section, std::string name, std::string unit, std::string help) {
  KeyInfo info = key(std::move(section), std::move(name), ValueType::number, std::move(help));
  info.unit = std::move(unit);
  info.minimum = 0;
  info.above_minimum = true;
  return info;
}
KeyInfo numbers(std::string section, std::string name, std::size_t count, std::string help) {
  KeyInfo info = key(std::move(section), std::move(name), ValueType::numbers, std::move(help));
  info.unit = "length";
  info.fewest = info.most = count;
  return info;
}
KeyInfo choice(std::string section, std::string name, std::vector<std::string> choices, std::string help) {
  KeyInfo info = key(std::move(section), std::move(name), ValueType::text, std::move(help));
  info.default_value = choices.front();
  info.choices = std::move(choices);
  return info;
}
KeyInfo with_default(KeyInfo info, ConfigValue value) {
  info.default_value = std::move(value);
  return info;
}
KeyInfo required(KeyInfo info) {
  info.required = true;
  return info;
}
KeyInfo whole(KeyInfo info, double minimum) {
  info.minimum = minimum;
  return info;
}
KeyInfo zero_allowed(KeyInfo info) {
  info.above_minimum = false;
  return info;
}

void add_packing(Schema& s) {
  s.sections.push_back({"packing", "The grains at the start: of a dump, random, or on a lattice.", true});
  s.keys.push_back(key("packing", "dump", ValueType::texts,
                       "Particle dumps, relative to the folder of the file; one frame of them is taken."));
  s.keys.push_back(
      with_default(key("packing", "frame", ValueType::integer, "Which frame; negative numbers count from the end."),
                   std::int64_t{0}));
  s.keys.push_back(key("packing", "types", ValueType::integers, "Particle types that count; all when not given."));
  s.keys.push_back(positive("packing", "radius", "length", "Radius of all grains, for dumps without it."));
  s.sections.push_back({"packing.random", "A random packing without overlaps, φ up to about 0.6."});
  s.keys.push_back(required(positive("packing.random", "phi", "1", "Packing fraction.")));
  s.keys.push_back(with_default(positive("packing.random", "diameter", "length", "Of the grains."), 1.0));
  s.keys.push_back(
      positive("packing.random", "height", "length", "How high it fills the container; all of it when not given."));
  s.sections.push_back({"packing.lattice", "Staggered layers, on which voids can rise.", false, true});
  s.keys.push_back(with_default(positive("packing.lattice", "diameter", "length", "Of the grains."), 1.0));
  KeyInfo step = required(numbers("packing.lattice", "step", 3,
                                  "From a grain to its upper neighbours along x, y, z; 0 along x or y: not staggered. "
                                  "Half a diameter sideways and 0.70711 upwards is the densest."));
  step.minimum = 0;
  s.keys.push_back(step);
  s.keys.push_back(
      positive("packing.lattice", "height", "length", "How high it fills the container; all of it when not given."));
}

void add_container(Schema& s) {
  s.sections.push_back({"container", "A box with walls, floor and orifice, or periodic sides.", true});
  s.keys.push_back(required(numbers("container", "lo", 3, "Lower corner; its z is the floor.")));
  s.keys.push_back(required(numbers("container", "hi", 3, "Upper corner; there is no wall at the top.")));
  KeyInfo periodic = key("container", "periodic", ValueType::texts, "Axes without walls.");
  periodic.choices = {"x", "y", "z"};
  s.keys.push_back(periodic);
  s.sections.push_back({"container.orifice", "A hole in the floor."});
  s.keys.push_back(
      choice("container.orifice", "shape", {"slot", "circle"}, "A slot runs through the whole depth along y."));
  s.keys.push_back(required(positive("container.orifice", "width", "length", "Of the slot along x, or the diameter.")));
  s.keys.push_back(
      with_default(numbers("container.orifice", "centre", 2, "x and y of the middle."), std::vector<double>{0, 0}));
}

void add_voids(Schema& s) {
  s.sections.push_back(
      {"voids", "Voids instead of spots, which hop from grain to grain of a lattice: what fails, for comparison.",
       false, true});
  s.keys.push_back(required(positive("voids", "hop_rate", "1/time", "Hops of a void per time.")));
  s.keys.push_back(required(positive("voids", "insertion_rate", "1/time", "Voids entering at the orifice.")));
  s.keys.push_back(choice("voids", "entry", {"centre", "spread"},
                          "Voids enter nearest to the middle of the orifice, or all over it."));
}

void add_spots(Schema& s) {
  s.sections.push_back({"spots", "The spots and their walk.", false, true});
  s.keys.push_back(required(positive("spots", "radius", "length", "r_s: grains within it move.")));
  s.keys.push_back(
      positive("spots", "influence", "1", "w: grains move by -1/w of the spot's step. Needed without a bias."));
  KeyInfo step = required(numbers("spots", "step", 3, "Lengths of a step along x, y, z; the signs are drawn."));
  step.minimum = 0;
  s.keys.push_back(step);
  s.keys.push_back(required(positive("spots", "hop_rate", "1/time", "Steps of a spot per time.")));
  s.keys.push_back(
      with_default(zero_allowed(positive("spots", "insertion_rate", "1/time", "Spots entering at the orifice.")), 0.0));
  s.keys.push_back(with_default(
      whole(key("spots", "count", ValueType::integer, "Spots at random places at the start."), 0), std::int64_t{0}));
  s.keys.push_back(
      choice("spots", "entry", {"centre", "spread"}, "Spots enter in the middle of the orifice, or all over it."));
  s.keys.push_back(with_default(
      zero_allowed(positive("spots", "entry_depth", "length", "How far below the floor, at most two diameters.")),
      0.0));
  s.keys.push_back(choice("spots", "direction", {"up", "any"}, "Whether steps along z are always up."));
  KeyInfo wall = with_default(key("spots", "wall_distance", ValueType::number,
                                  "Spots stay that far from side walls; negative: they may pass them by as much."),
                              0.0);
  wall.unit = "length";
  s.keys.push_back(wall);
  s.keys.push_back(with_default(
      zero_allowed(positive("spots", "floor_distance", "length",
                            "Spots stay that far from the floor beside the orifice; 0: they pass over it.")),
      0.0));
  s.sections.push_back(
      {"spots.bias", "Steps are taken with a probability ∝ p^exponent, p the grains within the radius after it."});
  s.keys.push_back(with_default(zero_allowed(positive("spots.bias", "exponent", "1", "Of p.")), 3.0));
  s.keys.push_back(
      required(positive("spots.bias", "volume", "1", "Free volume of a spot in grain volumes: w = p/volume.")));
  s.keys.push_back(with_default(positive("spots.bias", "fewest", "1", "p is taken as at least that in w."), 20.0));
  s.sections.push_back({"relaxation", "Pushing grains apart after a step."});
  s.keys.push_back(
      with_default(whole(key("relaxation", "every", ValueType::integer, "After every so many steps; 0: never."), 0),
                   std::int64_t{1}));
  KeyInfo probability =
      with_default(zero_allowed(positive("relaxation", "probability", "1", "Of relaxing after such a step.")), 1.0);
  probability.maximum = 1;
  s.keys.push_back(probability);
  s.keys.push_back(positive("relaxation", "radius", "length",
                            "Grains within it are moved; one diameter more than spots.radius when not given."));
  KeyInfo strength =
      with_default(positive("relaxation", "strength", "1", "α: the share of an overlap that is undone."), 0.8);
  strength.maximum = 1;
  s.keys.push_back(strength);
}

}  // namespace

Schema make_spot_schema() {
  Schema s;
  KeyInfo version = required(key("", "grainvdb", ValueType::integer, "Version of the file format."));
  version.minimum = version.maximum = 1;
  version.hint = "Other versions need another release of grainvdb.";
  s.keys.push_back(version);
  add_packing(s);
  add_container(s);
  add_spots(s);
  add_voids(s);
  s.sections.push_back({"output", "Snapshots.", true});
  s.keys.push_back(required(positive("output", "interval", "time", "Between snapshots.")));
  s.keys.push_back(required(positive("output", "end", "time", "Of the run.")));
  s.keys.push_back(with_default(
      zero_allowed(positive("output", "from", "time", "No snapshot before that time but the one of the start.")), 0.0));
  KeyInfo units =
      key("output", "units", ValueType::text, "Unit system that the dumps name; that of the packing's dump, or lj.");
  for (const UnitSystem& system : unit_systems()) units.choices.push_back(system.name);
  s.keys.push_back(units);
  KeyInfo seed = with_default(whole(key("", "seed", ValueType::integer, "Of the random numbers."), 0), std::int64_t{1});
  s.keys.push_back(seed);
  for (const char* section : {"input", "lattice", "kernel"})
    s.foreign.push_back({section, "a pipeline file", "grainvdb run"});
  return s;
}

std::string spot_file_schema() {
  return json_schema(make_spot_schema(), "grainvdb spot file", "Which grains to start from, and how spots move them.");
}

}  // namespace grainvdb::spot
