#include "read/particle_table.hpp"

#include <algorithm>
#include <charconv>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "grainvdb/error.hpp"
#include "read/columns.hpp"
#include "read/huge_pages.hpp"
#include "read/row_order.hpp"

namespace grainvdb {
namespace {

using Names3 = std::array<std::string, 3>;

/// Families of position columns in order of preference: as they are, unwrapped, scaled, scaled and unwrapped.
struct PositionFamily {
  Names3 names;
  bool scaled;
};
const std::array<PositionFamily, 4>& position_families() {
  static const std::array<PositionFamily, 4> families{{{{"x", "y", "z"}, false},
                                                       {{"xu", "yu", "zu"}, false},
                                                       {{"xs", "ys", "zs"}, true},
                                                       {{"xsu", "ysu", "zsu"}, true}}};
  return families;
}

/// What is missing, gathered so that one error names it all.
class Missing {
 public:
  void add(const std::string& what, const std::string& hint) {
    what_ += (what_.empty() ? "" : "; ") + what;
    if (!hint.empty()) hints_ += (hints_.empty() ? "" : ". ") + hint;
  }
  void refuse(const ColumnFinder& finder) const {
    if (what_.empty()) return;
    throw InputError({finder.location(), "the dump lacks columns that are needed", finder.names(), what_, hints_});
  }

 private:
  std::string what_, hints_;
};

void find_position(ColumnFinder& finder, ParticleLayout& layout, Missing& missing) {
  for (const PositionFamily& family : position_families()) {
    if (!finder.has_all(family.names)) continue;
    layout.position = finder.real3(family.names);
    layout.scaled = family.scaled;
    return;
  }
  missing.add("x y z (or xu yu zu, xs ys zs, xsu ysu zsu)", {});
}

void find_radius(ColumnFinder& finder, const InputSpec& spec, ParticleLayout& layout, Missing& missing) {
  if (finder.has("radius")) {
    layout.radius = finder.real("radius");
  } else if (finder.has("diameter")) {
    layout.radius = finder.real("diameter");
    layout.radius_factor = 0.5;
  } else if (spec.radius) {
    layout.common_radius = *spec.radius;
  } else {
    missing.add("radius or diameter", "Set input.radius if all grains have the same");
  }
}

/// Without masses, m = ρ 4/3 π r³ needs the radii too.
void find_mass(ColumnFinder& finder, const InputSpec& spec, ParticleLayout& layout, Missing& missing) {
  if (finder.has("mass")) {
    layout.mass = finder.real("mass");
    return;
  }
  if (finder.has("density")) {
    layout.density = finder.real("density");
  } else if (spec.density) {
    layout.common_density = *spec.density;
  } else {
    missing.add("mass or density", "Set input.density if all grains have the same");
    return;
  }
  if (!layout.wanted.has(Column::radius)) find_radius(finder, spec, layout, missing);
}

void find_vector(ColumnFinder& finder, const Names3& names, std::optional<std::array<std::size_t, 3>>& to,
                 Missing& missing) {
  if (finder.has_all(names))
    to = finder.real3(names);
  else
    missing.add(names[0] + " " + names[1] + " " + names[2], {});
}

std::string shown(double value) {
  char text[32];
  const auto end = std::to_chars(std::begin(text), std::end(text), value).ptr;
  return {std::begin(text), end};
}

void check_positive(const std::vector<double>& values, const std::string& column, std::size_t first_line,
                    const std::string& file) {
  const auto bad = std::find_if(values.begin(), values.end(), [](double value) { return !(value > 0); });
  if (bad == values.end()) return;
  const auto row = static_cast<std::size_t>(bad - values.begin());
  throw InputError({{file, first_line + row}, "bad value in column " + column, shown(*bad), "a number above 0", {}});
}

/// Throws InputError for the least id that comes twice.
void check_unique(const std::vector<std::int64_t>& id, const RowOrder& order, std::size_t first_line,
                  const std::string& file) {
  const auto row = [&](std::size_t i) { return order ? (*order)[i] : i; };
  for (std::size_t i = 1; i < id.size(); ++i) {
    if (id[row(i)] != id[row(i - 1)]) continue;
    throw InputError({{file, first_line + row(i)},
                      "the particle id " + std::to_string(id[row(i)]) + " comes twice in one frame",
                      "it also on line " + std::to_string(first_line + row(i - 1)),
                      "each id once",
                      {}});
  }
}

void check_types(const std::vector<std::int64_t>& type, std::size_t first_line, const std::string& file) {
  const auto bad = std::find_if(type.begin(), type.end(), [](std::int64_t t) {
    return t < std::numeric_limits<int>::min() || t > std::numeric_limits<int>::max();
  });
  if (bad == type.end()) return;
  throw InputError({{file, first_line + static_cast<std::size_t>(bad - type.begin())},
                    "bad value in column type",
                    std::to_string(*bad),
                    "a particle type",
                    {}});
}

}  // namespace

ParticleLayout particle_layout(const FrameHeader& header, const std::string& file, const InputSpec& spec,
                               ColumnSet wanted) {
  ColumnFinder finder(header, file);
  ParticleLayout layout;
  layout.wanted = wanted;
  Missing missing;
  if (finder.has("id"))
    layout.id = finder.whole("id");
  else
    missing.add("id", {});
  find_position(finder, layout, missing);
  if (wanted.has(Column::velocity)) find_vector(finder, {"vx", "vy", "vz"}, layout.velocity, missing);
  if (wanted.has(Column::angular_velocity))
    find_vector(finder, {"omegax", "omegay", "omegaz"}, layout.angular_velocity, missing);
  if (wanted.has(Column::radius)) find_radius(finder, spec, layout, missing);
  if (wanted.has(Column::mass)) find_mass(finder, spec, layout, missing);
  if (wanted.has(Column::force)) find_vector(finder, {"fx", "fy", "fz"}, layout.force, missing);
  if (wanted.has(Column::type)) {
    if (finder.has("type"))
      layout.type = finder.whole("type");
    else
      missing.add("type", {});
  }
  missing.refuse(finder);
  layout.request = finder.request();
  return layout;
}

Particles make_particles(const ParticleLayout& layout, DumpTable table, const FrameHeader& header,
                         const std::string& file) {
  const std::size_t n = table.rows;
  check_ids(table.whole[layout.id], "id", table, file);
  const RowOrder order = ascending(table.whole[layout.id]);
  check_unique(table.whole[layout.id], order, table.first_line, file);
  for (const std::optional<std::size_t>& column : {layout.radius, layout.mass, layout.density})
    if (column)
      check_positive(table.real[*column], header.columns[layout.request.real[*column]], table.first_line, file);
  if (layout.type) check_types(table.whole[*layout.type], table.first_line, file);
  reorder(table, order);

  Particles particles;
  particles.id = std::move(table.whole[layout.id]);
  const auto take3 = [&](const std::array<std::size_t, 3>& from, Columns3& to) {
    for (std::size_t a = 0; a < 3; ++a) to[a] = std::move(table.real[from[a]]);
  };
  take3(layout.position, particles.position);
  if (layout.scaled)
    for (std::size_t a = 0; a < 3; ++a)
      for (double& x : particles.position[a]) x = header.box.lo[a] + x * (header.box.hi[a] - header.box.lo[a]);
  if (layout.velocity) take3(*layout.velocity, particles.velocity);
  if (layout.angular_velocity) take3(*layout.angular_velocity, particles.angular_velocity);
  if (layout.force) take3(*layout.force, particles.force);

  std::vector<double> radius;
  if (layout.radius) {
    radius = std::move(table.real[*layout.radius]);
    for (double& r : radius) r *= layout.radius_factor;
  } else if (layout.common_radius > 0) {
    radius.assign(n, layout.common_radius);
  }
  if (layout.mass) {
    particles.mass = std::move(table.real[*layout.mass]);
  } else if (layout.wanted.has(Column::mass)) {
    particles.mass =
        layout.density ? std::move(table.real[*layout.density]) : std::vector<double>(n, layout.common_density);
    for (std::size_t i = 0; i < n; ++i)
      particles.mass[i] *= 4.0 / 3.0 * std::numbers::pi * radius[i] * radius[i] * radius[i];
  }
  if (layout.wanted.has(Column::radius)) particles.radius = std::move(radius);
  if (layout.type) {
    reserve_pages(particles.type, n);
    particles.type.assign(table.whole[*layout.type].begin(), table.whole[*layout.type].end());
  }
  return particles;
}

}  // namespace grainvdb
