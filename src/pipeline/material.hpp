#pragma once
/// What is splatted of one frame, whatever the lattice: the particles that count as material, and the contacts.
#include <cstdint>
#include <string>

#include "grainvdb/frame.hpp"
#include "grainvdb/moment.hpp"
#include "grainvdb/pipeline.hpp"

namespace grainvdb {

struct Material {
  std::string file;
  std::int64_t step = 0;
  Box box;
  Particles particles;    ///< those that the selection keeps
  HalfBranches branches;  ///< of all contacts, whatever the selection keeps
};

/// Keeps the particles that the selection counts as material.
void apply_selection(const Selection& selection, const Box& box, Particles& particles);

/// Throws InputError for contacts that do not fit the particles.
Material make_material(Frame frame, const Selection& selection);

}  // namespace grainvdb
