#pragma once
/// DIR/tracers.dump: the histories of tracers as a LAMMPS text dump, one snapshot per sample, for OVITO and LAMMPS.
///
/// Columns: id, type (always 1), x y z (wrapped into the box), ix iy iz; vx vy vz for a recorded velocity and omegax
/// omegay omegaz for an angular velocity, so that readers know them; NAME for other fields with one component, NAME_xx
/// … NAME_zz with nine, else NAME_1, NAME_2, …; displacement_1 …, strain, courant and gradient_number where recorded;
/// stop, the code of TracerStop. Numbers read back as the same; undefined ones are nan. Where there are provenances,
/// they are in no dump: write h5md as well.
#include <memory>
#include <string>

#include "grainvdb/tracer_sink.hpp"

namespace grainvdb {

std::unique_ptr<TracerSink> make_lammps_tracer_sink(const std::string& directory);

}  // namespace grainvdb
