#include "pipeline/species.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "grainvdb/error.hpp"
#include "pipeline/number.hpp"
#include "pipeline/text.hpp"

namespace grainvdb {
namespace {

[[noreturn]] void refuse_particle_of_two(const Frame& frame, std::size_t i, const Species& a, const Species& b) {
  const Particles& p = frame.particles;
  std::string grain = "particle " + std::to_string(p.id[i]);
  if (!p.type.empty()) grain += " of type " + std::to_string(p.type[i]);
  if (!p.radius.empty()) grain += " and diameter " + print_number(2 * p.radius[i]);
  throw InputError({{frame.file, 0},
                    "step " + std::to_string(frame.step) + ": a particle belongs to two species",
                    grain + ", which is in " + quote_text(a.name) + " and in " + quote_text(b.name),
                    "each particle in one species at most",
                    "Narrow one of them in the section species."});
}

}  // namespace

ColumnSet Species::columns() const {
  ColumnSet all;
  if (!types.empty()) all |= Column::type;
  if (diameter) all |= Column::radius;
  return all;
}

bool Species::contains(const Particles& p, std::size_t i) const {
  if (!types.empty() && std::find(types.begin(), types.end(), p.type[i]) == types.end()) return false;
  if (ids && (p.id[i] < ids->first || p.id[i] > ids->second)) return false;
  return !diameter || (diameter->first <= 2 * p.radius[i] && 2 * p.radius[i] < diameter->second);
}

ColumnSet columns_of(const std::vector<Species>& species) {
  ColumnSet all;
  for (const Species& s : species) all |= s.columns();
  return all;
}

std::vector<int> species_of_particles(const Frame& frame, const std::vector<Species>& species) {
  std::vector<int> number;
  if (species.empty()) return number;
  number.assign(frame.particles.size(), -1);
  for (std::size_t i = 0; i < number.size(); ++i)
    for (std::size_t s = 0; s < species.size(); ++s) {
      if (!species[s].contains(frame.particles, i)) continue;
      if (number[i] >= 0) refuse_particle_of_two(frame, i, species[static_cast<std::size_t>(number[i])], species[s]);
      number[i] = static_cast<int>(s);
    }
  return number;
}

std::string to_string(const Species& species) {
  std::vector<std::string> criteria;
  if (!species.types.empty()) {
    std::string types = species.types.size() == 1 ? "type" : "types";
    for (std::size_t n = 0; n < species.types.size(); ++n)
      types += (n == 0 ? " " : ", ") + std::to_string(species.types[n]);
    criteria.push_back(std::move(types));
  }
  if (species.ids)
    criteria.push_back("ids " + std::to_string(species.ids->first) + " to " + std::to_string(species.ids->second));
  if (species.diameter) {
    std::string diameter = "diameter from " + print_number(species.diameter->first);
    if (std::isfinite(species.diameter->second)) diameter += " to below " + print_number(species.diameter->second);
    criteria.push_back(std::move(diameter));
  }
  std::string text = species.name + ':';
  for (std::size_t n = 0; n < criteria.size(); ++n) text += (n == 0 ? " " : " and ") + criteria[n];
  return text;
}

}  // namespace grainvdb
