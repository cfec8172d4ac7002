#include "measure/bins.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "measure/option_values.hpp"

namespace grainvdb {
namespace {

template <class T>
const T& get(const OptionValues& options, const char* name) {
  return std::get<T>(options.at(name));
}

/// The axes across `axis`, so that (first, second, axis) is right-handed.
int first_across(int axis) {
  return (axis + 1) % 3;
}
int second_across(int axis) {
  return (axis + 2) % 3;
}

/// More than there are voxels along an axis.
constexpr std::int64_t shells_per_slab = std::int64_t{1} << 32;

}  // namespace

std::vector<OptionInfo> bin_options() {
  return {
      {.name = "geometry",
       .default_value = std::string("planes"),
       .help = "planes normal to the axis, or cylindrical shells about it",
       .choices = {"planes", "shells"}},
      {.name = "axis",
       .default_value = std::string("z"),
       .help = "the normal of the planes, or the axis of the shells",
       .choices = {"x", "y", "z"}},
      {.name = "centre",
       .default_value = std::vector<double>{0, 0, 0},
       .help = "a point of the axis of the shells, three coordinates [length]"},
      {.name = "from",
       .default_value = 0.0,
       .help = "voxel centres below along the axis are left out [length]; no bounds where from and to are 0"},
      {.name = "to", .default_value = 0.0, .help = "voxel centres from here on along the axis are left out [length]"},
      {.name = "bin", .default_value = 0.0, .help = "width of a bin [length]; 0: the voxel", .minimum = 0},
      {.name = "slab",
       .default_value = 0.0,
       .help = "height of the slabs that shells are cut into [length]; 0: each is one, over the whole height",
       .minimum = 0},
      {.name = "points",
       .default_value = std::int64_t{0},
       .help = "voxels of each plane, evenly spaced: a square number, 16 for 4 x 4; 0: all of them",
       .minimum = 0}};
}

BinSpec bin_spec(const OptionValues& options) {
  BinSpec spec;
  if (get<std::string>(options, "geometry") == "shells") spec.geometry = BinSpec::Geometry::shells;
  spec.axis = axis_option(options, "axis");
  const auto& centre = get<std::vector<double>>(options, "centre");
  for (std::size_t a = 0; a < 3; ++a) spec.centre[a] = centre.at(a);
  spec.from = get<double>(options, "from");
  spec.to = get<double>(options, "to");
  spec.width = get<double>(options, "bin");
  spec.slab = get<double>(options, "slab");
  spec.points = get<std::int64_t>(options, "points");
  return spec;
}

std::optional<OptionConflict> height_conflict(const OptionValues& options) {
  const double from = get<double>(options, "from"), to = get<double>(options, "to");
  if (from < to || (from == 0 && to == 0)) return std::nullopt;
  return OptionConflict{"to", std::to_string(to), "more than from, which is " + std::to_string(from)};
}

std::optional<OptionConflict> bin_conflict(const OptionValues& options) {
  const auto& centre = get<std::vector<double>>(options, "centre");
  if (centre.size() != 3)
    return OptionConflict{"centre", std::to_string(centre.size()) + " numbers", "three coordinates"};
  if (auto conflict = height_conflict(options)) return conflict;
  const BinSpec spec = bin_spec(options);
  const auto root = std::llround(std::sqrt(static_cast<double>(spec.points)));
  if (root * root != spec.points)
    return OptionConflict{"points", std::to_string(spec.points), "a square number, such as 16"};
  if (spec.points > 0 && spec.geometry == BinSpec::Geometry::shells)
    return OptionConflict{"points", std::to_string(spec.points) + " with geometry 'shells'",
                          "0: shells are averaged over all their voxels"};
  if (spec.slab > 0 && spec.geometry == BinSpec::Geometry::planes)
    return OptionConflict{"slab", std::to_string(spec.slab) + " with geometry 'planes'",
                          "0: `bin` is the height that planes are averaged over"};
  return std::nullopt;
}

std::set<std::int32_t> Bins::point_indices(int axis, const Topology::Bounds& bounds) const {
  const auto& period = lattice_.period(axis);
  const std::int64_t first = period ? period->first : bounds.first[axis];
  const std::int64_t count = period ? period->count : std::int64_t{bounds.last[axis]} - bounds.first[axis] + 1;
  const auto along = std::llround(std::sqrt(static_cast<double>(spec_.points)));
  // The voxels at (i+½)/n of the length, or all of them where there are no more than points.
  std::set<std::int32_t> indices;
  for (std::int64_t i = 0; i < along; ++i)
    indices.insert(static_cast<std::int32_t>(first + (2 * i + 1) * count / (2 * along)));
  return indices;
}

std::optional<VoxelPlace> Bins::place(std::size_t leaf, int offset, const Coord& c) const {
  const Vec3 x = lattice_.centre(c);
  const auto axis = static_cast<std::size_t>(spec_.axis);
  if (!within(x[axis])) return std::nullopt;
  VoxelPlace place{leaf, offset, c[spec_.axis], x[axis], x[axis]};
  if (spec_.geometry == BinSpec::Geometry::shells) {
    const auto p = static_cast<std::size_t>(first_across(spec_.axis));
    const auto q = static_cast<std::size_t>(second_across(spec_.axis));
    const double along = x[p] - spec_.centre[p], across = x[q] - spec_.centre[q];
    place.position = std::hypot(along, across);
    if (place.position == 0) return std::nullopt;
    place.cosine = along / place.position;
    place.sine = across / place.position;
    const double width = spec_.width > 0 ? spec_.width : lattice_.voxel();
    const double slab = spec_.slab > 0 ? std::floor(place.height / spec_.slab) : 0;
    place.bin = static_cast<std::int64_t>(slab) * shells_per_slab +
                static_cast<std::int64_t>(std::floor(place.position / width));
  } else if (spec_.width > 0) {
    place.bin = static_cast<std::int64_t>(std::floor(place.position / spec_.width));
  }
  return place;
}

void Bins::for_each(const Topology& topology, const std::function<void(const VoxelPlace&)>& f) const {
  const auto bounds = topology.bounds();
  if (!bounds) return;
  std::set<std::int32_t> first, second;
  if (spec_.points > 0) {
    first = point_indices(first_across(spec_.axis), *bounds);
    second = point_indices(second_across(spec_.axis), *bounds);
  }
  for (std::size_t leaf = 0; leaf < topology.leaf_count(); ++leaf)
    topology.mask(leaf).for_each([&](int offset) {
      const Coord c = voxel_at(topology.origin(leaf), offset);
      if (spec_.points > 0 &&
          !(first.contains(c[first_across(spec_.axis)]) && second.contains(c[second_across(spec_.axis)])))
        return;
      if (const auto found = place(leaf, offset, c)) f(*found);
    });
}

void Bins::rotate(const VoxelPlace& place, std::span<double> components) const {
  if (spec_.geometry == BinSpec::Geometry::planes || components.size() < 3) return;
  // The rows are e_r, e_θ and the axis.
  std::array<Vec3, 3> rows{};
  const auto p = static_cast<std::size_t>(first_across(spec_.axis));
  const auto q = static_cast<std::size_t>(second_across(spec_.axis));
  rows[0][p] = place.cosine;
  rows[0][q] = place.sine;
  rows[1][p] = -place.sine;
  rows[1][q] = place.cosine;
  rows[2][static_cast<std::size_t>(spec_.axis)] = 1;
  if (components.size() == 9) {
    std::array<double, 9> turned{};
    for (std::size_t i = 0; i < 9; ++i)
      for (std::size_t k = 0; k < 9; ++k) turned[i] += rows[i / 3][k / 3] * components[k] * rows[i % 3][k % 3];
    std::copy(turned.begin(), turned.end(), components.begin());
    return;
  }
  for (std::size_t v = 0; v + 3 <= components.size(); v += 3) {
    Vec3 turned{};
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t k = 0; k < 3; ++k) turned[i] += rows[i][k] * components[v + k];
    std::copy(turned.begin(), turned.end(), components.begin() + static_cast<std::ptrdiff_t>(v));
  }
}

std::array<std::string, 3> Bins::directions() const {
  if (spec_.geometry == BinSpec::Geometry::planes) return {"x", "y", "z"};
  return {"r", "theta", std::string(1, static_cast<char>('x' + spec_.axis))};
}

}  // namespace grainvdb
