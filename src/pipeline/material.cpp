#include "pipeline/material.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "bin/branches.hpp"

namespace grainvdb {
namespace {

template <class T>
void keep_rows(std::vector<T>& column, const std::vector<std::size_t>& rows) {
  if (column.empty()) return;
  for (std::size_t n = 0; n < rows.size(); ++n) column[n] = column[rows[n]];
  column.resize(rows.size());
}

bool selected(const Selection& s, const Box& box, const Particles& p, std::size_t i) {
  if (!s.types.empty() && std::find(s.types.begin(), s.types.end(), p.type[i]) == s.types.end()) return false;
  if (s.ids && (p.id[i] < s.ids->first || p.id[i] > s.ids->second)) return false;
  if (!s.region) return true;
  for (int a = 0; a < 3; ++a) {
    const auto axis = static_cast<std::size_t>(a);
    const double x = box.wrap(a, p.position[axis][i]);
    if (x < s.region->first[axis] || x >= s.region->second[axis]) return false;
  }
  return true;
}

}  // namespace

void apply_selection(const Selection& selection, const Box& box, Particles& particles) {
  if (selection.empty()) return;
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < particles.size(); ++i)
    if (selected(selection, box, particles, i)) rows.push_back(i);
  keep_rows(particles.id, rows);
  for (Columns3* columns : {&particles.position, &particles.velocity, &particles.angular_velocity})
    for (std::vector<double>& column : *columns) keep_rows(column, rows);
  keep_rows(particles.radius, rows);
  keep_rows(particles.mass, rows);
  keep_rows(particles.type, rows);
}

Material make_material(Frame frame, const Selection& selection) {
  Material material;
  if (frame.contacts.size() > 0) material.branches = half_branches(frame);
  material.file = std::move(frame.file);
  material.step = frame.step;
  material.box = frame.box;
  material.particles = std::move(frame.particles);
  apply_selection(selection, material.box, material.particles);
  return material;
}

}  // namespace grainvdb
