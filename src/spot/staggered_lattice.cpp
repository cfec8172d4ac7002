#include "spot/staggered_lattice.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "grainvdb/error.hpp"
#include "pipeline/number.hpp"

namespace grainvdb::spot {
namespace {

constexpr double tolerance = 1e-6;  // of lengths that are to be equal or not shorter, relative

void require_gap(double distance, double diameter, const char* between) {
  if (distance < diameter * (1 - tolerance))
    throw ConfigError({{},
                       std::string("grains of the lattice overlap ") + between,
                       "a distance of " + print_number(distance),
                       "at least the diameter, " + print_number(diameter),
                       "Take larger steps: half a diameter sideways and 0.70711 upwards is the densest"});
}

}  // namespace

StaggeredLattice::StaggeredLattice(const Box& box, double diameter, const Vec3& step, double height) : step_(step) {
  if (!(step[2] > 0))
    throw ConfigError({{}, "the layers of the lattice have no height", {}, "a step above 0 along z", {}});
  require_gap(std::sqrt(step[0] * step[0] + step[1] * step[1] + step[2] * step[2]), diameter, "from layer to layer");
  require_gap(2 * step[2], diameter, "from one layer to the next but one");
  for (std::size_t axis = 0; axis < 2; ++axis) set_axis(box, diameter, axis);
  first_[2] = box.lo[2] + 0.5 * diameter;
  const double room = std::min(height, box.length(2)) - diameter;
  if (room < 0) throw ConfigError({{}, "the lattice has no layer", {}, "a height of one diameter or more", {}});
  layers_ = static_cast<std::size_t>(room / step[2] * (1 + tolerance)) + 1;
}

void StaggeredLattice::set_axis(const Box& box, double diameter, std::size_t axis) {
  const double length = box.length(static_cast<int>(axis));
  const bool shifted = step_[axis] > 0;
  periodic_[axis] = box.periodic[axis];
  if (!shifted) {
    const double n = std::floor(length / diameter * (1 + tolerance));
    if (n < 1)
      throw ConfigError({{}, std::string("no grain fits between the walls along ") + "xyz" [axis], {}, {}, {}});
    spacing_[axis] = length / n;
    first_[axis] = box.lo[axis] + 0.5 * spacing_[axis];
    columns_[0][axis] = columns_[1][axis] = static_cast<std::size_t>(n);
    return;
  }
  spacing_[axis] = 2 * step_[axis];
  require_gap(spacing_[axis], diameter, "in a layer");
  if (periodic_[axis]) {
    const double n = std::round(length / spacing_[axis]);
    if (n < 2 || std::abs(n * spacing_[axis] - length) > tolerance * length)
      throw ConfigError({{},
                         std::string("the lattice does not fit the periodic axis ") + "xyz"[axis],
                         "a length of " + print_number(length),
                         "a multiple of " + print_number(spacing_[axis]) + ", twice the step, from 2 on",
                         {}});
    // Exactly, so that the last site and the first are neighbours like any other.
    spacing_[axis] = length / n;
    step_[axis] = 0.5 * spacing_[axis];
    first_[axis] = box.lo[axis];
    columns_[0][axis] = columns_[1][axis] = static_cast<std::size_t>(n);
    return;
  }
  const double gaps = std::floor((length - diameter) / spacing_[axis] * (1 + tolerance));
  if (gaps < 1)
    throw ConfigError({{},
                       std::string("the lattice does not fit between the walls along ") + "xyz"[axis],
                       "a length of " + print_number(length),
                       "at least " + print_number(spacing_[axis] + diameter),
                       {}});
  columns_[0][axis] = static_cast<std::size_t>(gaps) + 1;
  columns_[1][axis] = static_cast<std::size_t>(gaps);
  first_[axis] = box.lo[axis] + 0.5 * (length - gaps * spacing_[axis]);
}

std::size_t StaggeredLattice::first_of(std::size_t layer) const {
  return (layer / 2) * (in_layer(0) + in_layer(1)) + (layer % 2) * in_layer(0);
}

StaggeredLattice::Place StaggeredLattice::place(std::size_t site) const {
  const std::size_t two = in_layer(0) + in_layer(1);
  Place p;
  p.layer = 2 * (site / two);
  std::size_t rest = site % two;
  if (rest >= in_layer(0)) {
    rest -= in_layer(0);
    ++p.layer;
  }
  p.column = {rest / columns_[p.layer % 2][1], rest % columns_[p.layer % 2][1]};
  return p;
}

Vec3 StaggeredLattice::position(std::size_t site) const {
  const Place p = place(site);
  Vec3 x = first_;
  for (std::size_t a = 0; a < 2; ++a)
    x[a] += static_cast<double>(p.column[a]) * spacing_[a] + (p.layer % 2 == 1 ? step_[a] : 0);
  x[2] += static_cast<double>(p.layer) * step_[2];
  return x;
}

StaggeredLattice::Neighbours StaggeredLattice::above(std::size_t site) const {
  const Place p = place(site);
  Neighbours result;
  if (p.layer + 1 == layers_) return result;
  // Of even layers, columns k-1 and k lie beside column k; of odd ones, k and k+1.
  const std::size_t odd = p.layer % 2;
  std::array<std::array<std::size_t, 2>, 2> columns{};
  std::array<std::size_t, 2> counts{};
  for (std::size_t a = 0; a < 2; ++a) {
    const std::size_t n = columns_[1 - odd][a], k = p.column[a];
    const auto add = [&](std::size_t column) { columns[a][counts[a]++] = column; };
    if (step_[a] == 0) {
      add(k);
      continue;
    }
    if (odd == 1)
      add(k);
    else if (k > 0 || periodic_[a])
      add(k > 0 ? k - 1 : n - 1);
    const std::size_t right = k + odd;
    if (right < n || periodic_[a]) add(right % n);
  }
  const std::size_t first = first_of(p.layer + 1);
  for (std::size_t i = 0; i < counts[0]; ++i)
    for (std::size_t j = 0; j < counts[1]; ++j)
      result.site[result.count++] = first + columns[0][i] * columns_[1 - odd][1] + columns[1][j];
  return result;
}

Packing lattice_packing(const StaggeredLattice& lattice, double diameter) {
  Packing packing;
  packing.diameter = diameter;
  packing.id.resize(lattice.size());
  std::iota(packing.id.begin(), packing.id.end(), std::int64_t{1});
  packing.position.reserve(lattice.size());
  for (std::size_t site = 0; site < lattice.size(); ++site) packing.position.push_back(lattice.position(site));
  return packing;
}

}  // namespace grainvdb::spot
