#include "spot/spot_file.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "pipeline/load_config.hpp"
#include "pipeline/number.hpp"
#include "pipeline/resolved.hpp"
#include "spot/spot_packing.hpp"
#include "spot/spot_schema.hpp"
#include "spot/spot_values.hpp"

namespace grainvdb::spot {
namespace {

constexpr double length_tolerance = 1e-6;  // relative, between lengths that are to be the same
// Places are whole numbers of 2⁻³¹ of a length: 5e-6 diameters then.
constexpr double longest_in_diameters = 1e4;

// A hole is a part of the floor.
void check_orifice(const Values& v, const Container& container) {
  const Box& box = container.box;
  const double half = 0.5 * container.orifice->width;
  const int axes = container.orifice->shape == Orifice::Shape::slot ? 1 : 2;
  for (int a = 0; a < axes; ++a) {
    const double tolerance = length_tolerance * box.length(a), centre = container.orifice->centre[a];
    const bool fits = box.periodic[a]
                          ? 2 * half <= box.length(a) + tolerance
                          : centre - half >= box.lo[a] - tolerance && centre + half <= box.hi[a] + tolerance;
    if (fits) continue;
    throw ConfigError({v.where("container.orifice"),
                       std::string("the orifice reaches beyond the floor along ") + "xyz"[a],
                       print_number(centre - half) + " to " + print_number(centre + half),
                       "an orifice between " + print_number(box.lo[a]) + " and " + print_number(box.hi[a]),
                       "Change container.orifice.width or centre"});
  }
}

Container read_container(const Values& v) {
  Container container;
  container.box.lo = v.vector("container.lo");
  container.box.hi = v.vector("container.hi");
  for (const std::string& axis :
       v.find<std::vector<std::string>>("container.periodic").value_or(std::vector<std::string>()))
    container.box.periodic[static_cast<std::size_t>(axis[0] - 'x')] = true;
  for (int a = 0; a < 3; ++a)
    if (!(container.box.lo[a] < container.box.hi[a]))
      throw ConfigError(
          {v.where("container.hi"), std::string("the container is empty along ") + "xyz" [a], {}, "lo < hi", {}});
  if (!v.has_section("container.orifice")) return container;
  if (container.box.periodic[2])
    throw ConfigError({v.where("container.orifice"), "an orifice needs a floor", "z is periodic", "walls along z", {}});
  Orifice orifice;
  orifice.shape =
      v.get<std::string>("container.orifice.shape") == "slot" ? Orifice::Shape::slot : Orifice::Shape::circle;
  orifice.width = v.get<double>("container.orifice.width");
  const auto centre = v.get<std::vector<double>>("container.orifice.centre");
  orifice.centre = {centre[0], centre[1]};
  container.orifice = orifice;
  check_orifice(v, container);
  return container;
}

SpotParameters read_spots(const Values& v, double diameter) {
  SpotParameters p;
  p.radius = v.get<double>("spots.radius");
  p.step = v.vector("spots.step");
  p.hop_rate = v.get<double>("spots.hop_rate");
  p.insertion_rate = v.get<double>("spots.insertion_rate");
  p.count = static_cast<std::size_t>(v.get<std::int64_t>("spots.count"));
  p.entry =
      v.get<std::string>("spots.entry") == "centre" ? SpotParameters::Entry::centre : SpotParameters::Entry::spread;
  p.entry_depth = v.get<double>("spots.entry_depth");
  p.direction =
      v.get<std::string>("spots.direction") == "up" ? SpotParameters::Direction::up : SpotParameters::Direction::any;
  p.wall_distance = v.get<double>("spots.wall_distance");
  p.floor_distance = v.get<double>("spots.floor_distance");
  if (v.has_section("spots.bias"))
    p.bias = Bias{v.get<double>("spots.bias.exponent"), v.get<double>("spots.bias.volume"),
                  v.get<double>("spots.bias.fewest")};
  const auto influence = v.find<double>("spots.influence");
  if (influence.has_value() == p.bias.has_value())
    throw ConfigError({v.where("spots"),
                       "the displacement of grains must be given in one way",
                       {},
                       "either spots.influence, or spots.bias with its volume",
                       {}});
  p.influence = influence.value_or(0);
  p.relaxation.every = v.get<std::int64_t>("relaxation.every");
  p.relaxation.probability = v.get<double>("relaxation.probability");
  p.relaxation.strength = v.get<double>("relaxation.strength");
  p.relaxation.radius = v.find<double>("relaxation.radius").value_or(p.radius + diameter);
  return p;
}

// One model, and a packing that it can have.
void check_model(const Values& v, const std::string& file) {
  const bool spots = v.has_section("spots"), voids = v.has_section("voids");
  if (spots == voids)
    throw ConfigError({spots ? v.where("voids") : Location{file},
                       spots ? "a run has either spots or voids" : "there are neither spots nor voids",
                       {},
                       "either the section 'spots' or the section 'voids'",
                       {}});
  if (!voids) return;
  if (!v.has_section("packing.lattice"))
    throw ConfigError({v.where("packing"), "voids need a lattice to hop on", {}, "packing.lattice", {}});
  if (v.has_section("relaxation"))
    throw ConfigError({v.where("relaxation"), "nothing is relaxed in the void model", {}, "no such section", {}});
  if (!v.has_section("container.orifice"))
    throw ConfigError({v.where("container"), "voids have no orifice to enter at", {}, "container.orifice", {}});
}

VoidRun read_voids(const Values& v, const SpotRun& run) {
  VoidParameters p;
  p.hop_rate = v.get<double>("voids.hop_rate");
  p.insertion_rate = v.get<double>("voids.insertion_rate");
  p.entry =
      v.get<std::string>("voids.entry") == "centre" ? VoidParameters::Entry::centre : VoidParameters::Entry::spread;
  VoidRun voids{read_lattice(v, run.container.box), p};
  placed(v.where("container.orifice"), [&] { return LatticeVoids(run.container, voids.lattice, p, run.seed); });
  return voids;
}

// Steps that spots can go, and that grains can follow.
void check_steps(const Values& v, const SpotRun& run) {
  const SpotParameters& p = run.parameters;
  const Box& box = run.container.box;
  const bool up = p.direction == SpotParameters::Direction::up;
  const double length = std::hypot(p.step[0], p.step[1], p.step[2]);
  if (up ? p.step[2] == 0 : length == 0)
    throw ConfigError({v.where("spots.step"),
                       up ? "spots would never rise" : "spots would never move",
                       {},
                       up ? "a step above 0 along z" : "a step above 0 along one axis",
                       {}});
  if (p.bias && !up)
    throw ConfigError({v.where("spots.direction"), "steps with a bias are always up", "any", "direction: up", {}});
  for (int a = 0; a < 3; ++a) {
    if (p.step[a] > 0.25 * box.length(a))
      throw ConfigError({v.where("spots.step"),
                         std::string("steps are long beside the container along ") + "xyz"[a],
                         print_number(p.step[a]),
                         "at most a quarter of its length, " + print_number(0.25 * box.length(a)),
                         {}});
    if (!box.periodic[a] && (a < 2 || !up) && !(2 * p.wall_distance < box.length(a)))
      throw ConfigError({v.where("spots.wall_distance"),
                         std::string("walls leave no room for spots along ") + "xyz"[a],
                         print_number(p.wall_distance),
                         "less than half the distance of the walls, " + print_number(0.5 * box.length(a)),
                         {}});
  }
  const double moved = length / (p.bias ? p.bias->fewest / p.bias->volume : p.influence);
  if (moved > 0.5 * run.packing.diameter)
    throw ConfigError({v.where("spots.step"), "a spot moves grains too far at once", print_number(moved),
                       "at most half a diameter", "Take shorter steps or a larger influence"});
}

// What no single key can tell.
void check_together(const Values& v, const SpotRun& run) {
  const SpotParameters& p = run.parameters;
  if (p.insertion_rate > 0 && !run.container.orifice)
    throw ConfigError(
        {v.where("spots.insertion_rate"), "spots have no orifice to enter at", {}, "container.orifice", {}});
  if (p.entry_depth > 2 * run.packing.diameter)
    throw ConfigError({v.where("spots.entry_depth"),
                       "spots enter too far below the floor",
                       print_number(p.entry_depth),
                       "at most two diameters",
                       {}});
  if (p.insertion_rate == 0 && p.count == 0)
    throw ConfigError({v.where("spots"), "there are no spots", {}, "spots.insertion_rate or spots.count above 0", {}});
  if (p.relaxation.radius < p.radius)
    throw ConfigError({v.where("relaxation.radius"),
                       "the zone that is relaxed must hold the spot",
                       print_number(p.relaxation.radius),
                       "at least spots.radius",
                       {}});
  const double reach = std::max(p.relaxation.radius, 2 * run.packing.diameter);
  for (int a = 0; a < 3; ++a) {
    if (run.container.box.periodic[a] && run.container.box.length(a) < 2 * reach)
      throw ConfigError({v.where("container.hi"),
                         std::string("the container is too short along the periodic axis ") + "xyz"[a],
                         print_number(run.container.box.length(a)), "at least " + print_number(2 * reach),
                         "A grain would meet a spot and its image"});
    const double longest = longest_in_diameters * run.packing.diameter;
    if (run.container.box.length(a) > longest)
      throw ConfigError({v.where("container.hi"),
                         std::string("the container is too long along ") + "xyz"[a] + " to tell small displacements",
                         print_number(run.container.box.length(a)), "at most 10,000 diameters",
                         "There is no wall at the top: a container little higher than the packing will do"});
  }
  check_steps(v, run);
}

void check_snapshots(const Values& v, const SpotRun& run) {
  if (run.end / run.interval > 1e7)
    throw ConfigError({v.where("output.interval"), "there would be too many snapshots", {}, "at most 1e7", {}});
  if (run.interval > run.end * (1 + length_tolerance))
    throw ConfigError({v.where("output.interval"),
                       "there would be no snapshot but that of the start",
                       print_number(run.interval),
                       "at most output.end, " + print_number(run.end),
                       {}});
  if (run.from > run.end * (1 + length_tolerance))
    throw ConfigError({v.where("output.from"),
                       "there would be no snapshot but that of the start",
                       print_number(run.from),
                       "at most output.end, " + print_number(run.end),
                       {}});
}

}  // namespace

SpotRun load_spot_run(const std::string& file, const std::vector<std::string>& overrides) {
  const Schema schema = make_spot_schema();
  CheckedConfig config = load_config(file, overrides, schema);
  const Values v(file, config);
  SpotRun run;
  check_model(v, file);
  run.container = read_container(v);
  run.seed = static_cast<std::uint64_t>(v.get<std::int64_t>("seed"));
  run.interval = v.get<double>("output.interval");
  run.end = v.get<double>("output.end");
  run.from = v.get<double>("output.from");
  check_snapshots(v, run);
  run.units = v.find<std::string>("output.units").value_or("");
  run.packing = make_packing(v, file, run);
  if (run.units.empty()) run.units = "lj";
  if (v.has_section("voids")) {
    run.voids = read_voids(v, run);
  } else {
    run.parameters = read_spots(v, run.packing.diameter);
    check_together(v, run);
    config.values.insert_or_assign("relaxation.radius", run.parameters.relaxation.radius);
  }
  // The resolved file lies in another folder.
  if (v.has_section("packing.dump")) config.values.insert_or_assign("packing.dump", packing_dumps(v, file));
  config.values.insert_or_assign("output.units", run.units);
  // Defaults of sections that are not there would make them be there.
  if (run.voids) std::erase_if(config.values, [](const auto& value) { return value.first.starts_with("relaxation."); });
  for (const char* section : {"packing.random", "container.orifice", "spots.bias"})
    if (!v.has_section(section))
      std::erase_if(config.values,
                    [&](const auto& value) { return value.first.starts_with(std::string(section) + '.'); });
  run.resolved = resolved_yaml(schema, config.values);
  return run;
}

}  // namespace grainvdb::spot
