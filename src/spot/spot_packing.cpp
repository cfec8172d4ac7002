#include "spot/spot_packing.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <optional>

#include "grainvdb/frame_source.hpp"
#include "pipeline/key_builders.hpp"
#include "pipeline/number.hpp"
#include "spot/random_packing.hpp"

namespace grainvdb::spot {
namespace {

constexpr double size_tolerance = 1e-3;    // relative, between grains
constexpr double period_tolerance = 1e-6;  // relative, between container and dump

bool contains(const Box& box, const Vec3& x) {
  for (int a = 0; a < 3; ++a)
    if (!box.periodic[a] && (x[a] < box.lo[a] || x[a] > box.hi[a])) return false;
  return true;
}

// A container that is periodic otherwise than the dump would cut the packing, or put grains into each other.
void check_periods(const Values& v, const Box& container, const Frame& frame) {
  for (int a = 0; a < 3; ++a) {
    const double here = container.length(a), there = frame.box.length(a);
    if (!container.periodic[a] || !frame.box.periodic[a] || std::abs(here - there) <= period_tolerance * there)
      continue;
    throw ConfigError({v.where("container.periodic"),
                       std::string("the container and the dump have different periods along ") + "xyz"[a],
                       print_number(here), print_number(there) + ", as in " + frame.file,
                       "Compare container.lo and hi with `grainvdb info`"});
  }
}

// Nothing would ever part them.
void check_places(const Packing& packing, const std::string& file) {
  std::vector<std::size_t> order(packing.id.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto& x = packing.position;
  std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) { return x[i] < x[j]; });
  const auto same =
      std::adjacent_find(order.begin(), order.end(), [&](std::size_t i, std::size_t j) { return x[i] == x[j]; });
  if (same == order.end()) return;
  throw InputError({{file},
                    "two grains are at the same place",
                    "ids " + std::to_string(packing.id[same[0]]) + " and " + std::to_string(packing.id[same[1]]),
                    "a place for each grain",
                    {}});
}

Packing read_dump(const Values& v, const std::string& file, SpotRun& run) {
  InputSpec spec;
  spec.particles = packing_dumps(v, file);
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
  check_periods(v, run.container.box, frame);
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
  check_places(packing, frame.file);
  return packing;
}

}  // namespace

std::vector<std::string> packing_dumps(const Values& v, const std::string& file) {
  return paths_beside(std::filesystem::absolute(file).string(), v.get<std::vector<std::string>>("packing.dump"));
}

StaggeredLattice read_lattice(const Values& v, const Box& box) {
  return placed(v.where("packing.lattice"), [&] {
    return StaggeredLattice(box, v.get<double>("packing.lattice.diameter"), v.vector("packing.lattice.step"),
                            v.find<double>("packing.lattice.height").value_or(box.length(2)));
  });
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
  Packing packing = random_packing(box, phi, diameter, run.seed);
  if (packing.id.empty())
    throw ConfigError({v.where("packing.random"),
                       "there is no grain in the packing",
                       "packing fraction " + print_number(phi),
                       "enough for one grain",
                       {}});
  return packing;
}

}  // namespace grainvdb::spot
