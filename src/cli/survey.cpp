#include "cli/survey.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "grainvdb/lattice.hpp"

namespace grainvdb::cli {
namespace {

// Velocities that differ by less are one: dumps have six digits.
constexpr double same_velocity = 1e-5;

bool has(FrameSource& source, std::size_t k, ColumnSet columns) {
  try {
    source.require(k, columns);
    return true;
  } catch (const Error&) {
    return false;
  }
}

ColumnSet available(FrameSource& source, std::size_t k) {
  ColumnSet all;
  for (const Column c : {Column::type, Column::radius, Column::velocity, Column::contacts})
    if (has(source, k, c)) all |= c;
  return all;
}

// The least and the greatest of each component of the velocities of one type.
struct Range {
  std::array<double, 3> least, greatest;
  Range() {
    least.fill(std::numeric_limits<double>::infinity());
    greatest.fill(-std::numeric_limits<double>::infinity());
  }
  void add(const Columns3& velocity, std::size_t i) {
    for (std::size_t a = 0; a < 3; ++a) {
      least[a] = std::min(least[a], velocity[a][i]);
      greatest[a] = std::max(greatest[a], velocity[a][i]);
    }
  }
  double spread() const {
    double most = 0;
    for (std::size_t a = 0; a < 3; ++a) most = std::max(most, greatest[a] - least[a]);
    return most;
  }
  double speed() const {
    double most = 0;
    for (std::size_t a = 0; a < 3; ++a) most = std::max({most, std::abs(least[a]), std::abs(greatest[a])});
    return most;
  }
};

Motion motion_of(const Range& range, std::size_t count, double fastest) {
  if (range.speed() <= same_velocity * fastest) return Motion::at_rest;
  return count > 1 && range.spread() <= same_velocity * range.speed() ? Motion::rigid : Motion::flowing;
}

double to_three_digits(double x, double (*round)(double) = std::round) {
  const double unit = std::pow(10.0, std::floor(std::log10(x)) - 2);
  // By division where the unit is a fraction: 1/unit is a whole number, which the unit is not.
  const double digits = round(x / unit * (1 + 1e-12));
  return unit < 1 ? digits / std::round(1 / unit) : digits * unit;
}

}  // namespace

const char* name_of(Motion motion) {
  switch (motion) {
    case Motion::at_rest:
      return "at rest";
    case Motion::rigid:
      return "moving as one body";
    case Motion::flowing:
      return "flowing";
    case Motion::unknown:
      break;
  }
  return "of unknown motion";
}

std::vector<int> Survey::material() const {
  std::vector<int> types;
  for (const Kind& kind : kinds)
    if (kind.motion == Motion::flowing) types.push_back(kind.type);
  if (types.empty())
    for (const Kind& kind : kinds) types.push_back(kind.type);
  return types;
}

double Survey::mean_diameter() const {
  const std::vector<int> types = material();
  double sum = 0, count = 0;
  for (const Kind& kind : kinds)
    if (std::find(types.begin(), types.end(), kind.type) != types.end()) {
      sum += kind.mean * static_cast<double>(kind.count);
      count += static_cast<double>(kind.count);
    }
  return count > 0 ? sum / count : 0;
}

Survey survey(FrameSource& source, std::size_t k) {
  const ColumnSet columns = available(source, k);
  const Frame frame = source.read(k, columns);
  const Particles& p = frame.particles;

  Survey result;
  result.has_types = columns.has(Column::type);
  result.has_sizes = columns.has(Column::radius);
  if (columns.has(Column::contacts)) result.contacts = frame.contacts.size();

  std::map<int, Kind> kinds;
  std::map<int, Range> velocities;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const int type = result.has_types ? p.type[i] : 0;
    Kind& kind = kinds[type];
    kind.type = type;
    ++kind.count;
    if (result.has_sizes) {
      const double d = 2 * p.radius[i];
      kind.least = kind.count == 1 ? d : std::min(kind.least, d);
      kind.greatest = std::max(kind.greatest, d);
      kind.mean += d;
    }
    if (columns.has(Column::velocity)) velocities[type].add(p.velocity, i);
  }
  double fastest = 0;
  for (const auto& [type, range] : velocities) fastest = std::max(fastest, range.speed());
  for (auto& [type, kind] : kinds) {
    kind.mean /= static_cast<double>(kind.count);
    if (columns.has(Column::velocity)) kind.motion = motion_of(velocities[type], kind.count, fastest);
    result.kinds.push_back(kind);
  }
  return result;
}

double suggested_cutoff(double diameter, const Box& box) {
  double most = 3 * diameter;
  for (int a = 0; a < 3; ++a)
    if (box.periodic[static_cast<std::size_t>(a)]) most = std::min(most, 0.5 * box.length(a));
  return to_three_digits(most, std::floor);
}

std::optional<double> suggested_voxel(double diameter, const Box& box) {
  const auto axis = std::find(box.periodic.begin(), box.periodic.end(), true);
  if (axis == box.periodic.end()) return to_three_digits(0.5 * diameter);
  const double length = box.length(static_cast<int>(axis - box.periodic.begin()));
  std::optional<double> best;
  for (double n = std::ceil(length / (0.6 * diameter)); n <= length / (0.25 * diameter); ++n) {
    double voxel = length / n;
    if (std::abs(to_three_digits(voxel) - voxel) <= 1e-9 * voxel) voxel = to_three_digits(voxel);
    try {
      Lattice(voxel, {}).set_periods(box);
    } catch (const std::invalid_argument&) {
      continue;
    }
    if (!best || std::abs(voxel - 0.5 * diameter) < std::abs(*best - 0.5 * diameter)) best = voxel;
  }
  return best;
}

}  // namespace grainvdb::cli
