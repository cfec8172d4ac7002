#include "pipeline/material.hpp"

#include <cstddef>
#include <utility>
#include <vector>

#include "bin/half_step.hpp"
#include "pipeline/species.hpp"

namespace grainvdb {
namespace {

template <class T>
void keep_rows(std::vector<T>& column, const std::vector<std::size_t>& rows) {
  if (column.empty()) return;
  for (std::size_t n = 0; n < rows.size(); ++n) column[n] = column[rows[n]];
  column.resize(rows.size());
}

}  // namespace

void apply_selection(const Selection& selection, const Box& box, Particles& particles) {
  if (selection.empty()) return;
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < particles.size(); ++i)
    if (is_selected(selection, box, particles, i)) rows.push_back(i);
  keep_rows(particles.id, rows);
  for (Columns3* columns : {&particles.position, &particles.velocity, &particles.angular_velocity})
    for (std::vector<double>& column : *columns) keep_rows(column, rows);
  keep_rows(particles.radius, rows);
  keep_rows(particles.mass, rows);
  keep_rows(particles.type, rows);
  keep_rows(particles.species, rows);
}

void use_forces_of_run(const Pipeline& pipeline, Frame& frame) {
  if (const auto& half_step = pipeline.input.contacts.half_step;
      half_step && (frame.contacts.size() > 0 || frame.wall_contacts.size() > 0))
    correct_half_step(*half_step, frame);
  frame.particles.force = {};
}

Material make_material(Frame frame, const Pipeline& pipeline, const std::set<BranchKind>& wanted) {
  Material material;
  use_forces_of_run(pipeline, frame);
  frame.particles.species = species_of_particles(frame, pipeline.species);
  material.branches = make_branch_sets(frame, pipeline, wanted);
  material.file = std::move(frame.file);
  material.step = frame.step;
  material.box = frame.box;
  material.particles = std::move(frame.particles);
  apply_selection(pipeline.select, material.box, material.particles);
  return material;
}

}  // namespace grainvdb
