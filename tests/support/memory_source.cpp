#include "support/memory_source.hpp"

namespace grainvdb::testing {

MemorySource::MemorySource(std::vector<Frame> frames) : frames_(std::move(frames)) {
  for (const Frame& f : frames_) infos_.push_back({f.file, 0, f.step, f.time, f.particles.size(), f.box});
}

const UnitSystem& MemorySource::units() const {
  return *find_unit_system("si");
}

Frame MemorySource::read(std::size_t k, ColumnSet wanted) {
  Frame f = frames_.at(k);
  if (!wanted.has(Column::velocity)) f.particles.velocity = {};
  if (!wanted.has(Column::angular_velocity)) f.particles.angular_velocity = {};
  if (!wanted.has(Column::radius)) f.particles.radius = {};
  if (!wanted.has(Column::mass)) f.particles.mass = {};
  if (!wanted.has(Column::type)) f.particles.type = {};
  if (!wanted.has(Column::contacts)) f.contacts = {};
  if (!wanted.has(Column::wall_contacts)) f.wall_contacts = {};
  if (!wanted.has(Column::force)) f.particles.force = {};
  for (const std::string& name : column_names(wanted)) counters_.columns_parsed.insert(name);
  ++counters_.frames_read;
  return f;
}

}  // namespace grainvdb::testing
