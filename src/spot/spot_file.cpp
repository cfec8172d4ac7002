#include "spot/spot_file.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "grainvdb/frame_source.hpp"
#include "pipeline/load_config.hpp"
#include "pipeline/number.hpp"
#include "pipeline/resolved.hpp"
#include "spot/random_packing.hpp"
#include "spot/spot_schema.hpp"

namespace grainvdb::spot {
namespace {

constexpr double size_tolerance = 1e-3;  // relative, between grains

/// The checked values of a file, by type.
class Values {
 public:
  Values(const std::string& file, const CheckedConfig& config) : file_(file), config_(config) {}

  template <class T>
  std::optional<T> find(const std::string& key) const {
    const auto it = config_.values.find(key);
    if (it == config_.values.end()) return std::nullopt;
    return std::get<T>(it->second);
  }
  template <class T>
  T get(const std::string& key) const {
    return find<T>(key).value();
  }
  bool has_section(const std::string& section) const { return config_.places.contains(section); }
  Location where(const std::string& key) const {
    const auto it = config_.places.find(key);
    return it == config_.places.end() ? Location{file_} : it->second;
  }
  Vec3 vector(const std::string& key) const {
    const auto v = get<std::vector<double>>(key);
    return {v[0], v[1], v[2]};
  }

 private:
  const std::string& file_;
  const CheckedConfig& config_;
};

/// make(), whose errors stand at that place.
template <class F>
auto placed(const Location& where, F make) {
  try {
    return make();
  } catch (const ConfigError& error) {
    Problem problem = error.problem();
    problem.where = where;
    throw ConfigError(problem);
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

StaggeredLattice read_lattice(const Values& v, const Box& box) {
  return placed(v.where("packing.lattice"), [&] {
    return StaggeredLattice(box, v.get<double>("packing.lattice.diameter"), v.vector("packing.lattice.step"),
                            v.find<double>("packing.lattice.height").value_or(box.length(2)));
  });
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
    if (p.step[a] > 0.25 * run.container.box.length(a))
      throw ConfigError({v.where("spots.step"), "steps must be short beside the container", {}, {}, {}});
  }
  const double moved = p.step[2] / (p.bias ? p.bias->fewest / p.bias->volume : p.influence);
  if (moved > 0.5 * run.packing.diameter)
    throw ConfigError({v.where("spots.step"), "a spot moves grains too far at once", print_number(moved),
                       "at most half a diameter", "Take shorter steps or a larger influence"});
}

std::vector<std::string> dump_paths(const std::string& file, std::vector<std::string> paths) {
  const std::filesystem::path folder = std::filesystem::path(file).parent_path();
  for (std::string& path : paths) path = (folder / path).string();
  return paths;
}

bool contains(const Box& box, const Vec3& x) {
  for (int a = 0; a < 3; ++a)
    if (!box.periodic[a] && (x[a] < box.lo[a] || x[a] > box.hi[a])) return false;
  return true;
}

Packing read_dump(const Values& v, const std::string& file, SpotRun& run) {
  InputSpec spec;
  spec.particles = dump_paths(file, v.get<std::vector<std::string>>("packing.dump"));
  spec.radius = v.find<double>("packing.radius");
  const auto source = open_dumps(spec);
  if (run.units.empty() && find_unit_system(source->units().name) != nullptr) run.units = source->units().name;
  const auto n = static_cast<std::int64_t>(source->frames().size());
  const std::int64_t wanted = v.get<std::int64_t>("packing.frame"), k = wanted < 0 ? wanted + n : wanted;
  if (k < 0 || k >= n)
    throw ConfigError({v.where("packing.frame"),
                       "there is no such frame",
                       std::to_string(wanted),
                       "one of the " + std::to_string(n) + " frames of the dump",
                       {}});
  const auto types = v.find<std::vector<std::int64_t>>("packing.types");
  ColumnSet columns = Column::radius;
  if (types) columns |= Column::type;
  const Frame frame = source->read(static_cast<std::size_t>(k), columns);
  Packing packing;
  double least = 0, most = 0;
  for (std::size_t i = 0; i < frame.particles.size(); ++i) {
    if (types && std::find(types->begin(), types->end(), frame.particles.type[i]) == types->end()) continue;
    const Vec3 x{frame.particles.position[0][i], frame.particles.position[1][i], frame.particles.position[2][i]};
    if (!contains(run.container.box, x)) {
      ++run.left_out;
      continue;
    }
    const double d = 2 * frame.particles.radius[i];
    least = packing.id.empty() ? d : std::min(least, d);
    most = std::max(most, d);
    packing.id.push_back(frame.particles.id[i]);
    packing.position.push_back(x);
  }
  if (packing.id.empty())
    throw InputError({{frame.file},
                      "no grain of this dump lies in the container",
                      {},
                      {},
                      "Compare container.lo and hi with `grainvdb info`"});
  if (most - least > size_tolerance * most)
    throw InputError({{frame.file},
                      "the grains have several sizes",
                      "diameters " + print_number(least) + " to " + print_number(most),
                      "equal spheres",
                      "Choose a type by packing.types, or set packing.radius for a dump without sizes"});
  packing.diameter = 0.5 * (least + most);
  return packing;
}

Packing make_packing(const Values& v, const std::string& file, SpotRun& run) {
  const bool random = v.has_section("packing.random"), dump = v.has_section("packing.dump"),
             lattice = v.has_section("packing.lattice");
  if (random + dump + lattice != 1)
    throw ConfigError({v.where("packing"),
                       "the packing must be given in one way",
                       {},
                       "either packing.dump or packing.random or packing.lattice",
                       {}});
  if (dump) return read_dump(v, file, run);
  if (lattice) return lattice_packing(read_lattice(v, run.container.box), v.get<double>("packing.lattice.diameter"));
  Box box = run.container.box;
  if (const auto height = v.find<double>("packing.random.height")) box.hi[2] = std::min(box.hi[2], box.lo[2] + *height);
  const double phi = v.get<double>("packing.random.phi"), diameter = v.get<double>("packing.random.diameter");
  for (int a = 0; a < 3; ++a)
    if (box.length(a) < 4 * diameter)
      throw ConfigError({v.where("packing.random"),
                         std::string("the packing is too thin along ") + "xyz" [a],
                         {},
                         "at least four diameters",
                         {}});
  return random_packing(box, phi, diameter, run.seed);
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
  if (run.end / run.interval > 1e7)
    throw ConfigError({v.where("output.interval"), "there would be too many snapshots", {}, "at most 1e7", {}});
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
