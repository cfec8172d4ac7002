#pragma once
/// The peak memory of a run as a formula: what frames take on their way, and what the voxels take that are summed.
#include <cstddef>
#include <string>

#include "grainvdb/lattice.hpp"
#include "grainvdb/pipeline.hpp"
#include "grainvdb/plan.hpp"

namespace grainvdb {

/// What a frame and the voxels of a run count.
struct RunSize {
  double particles = 0;  ///< of the largest frame, those that count as material
  double contacts = 0;   ///< of the largest frame
  double images = 1;     ///< periodic images per particle: ∏ (1 + 2c/L) over the periodic axes
  double voxels = 0;     ///< of all leaves that are summed: active ones, and the others of their leaves; 64 a plane
  double tracers = 0;
};

/// Bytes. The number of frames is not among them: what a run takes does not grow with its length.
struct MemoryModel {
  std::size_t frames_in_flight = 1;
  double fixed = 0;               ///< the program, its libraries and buffers, and the roots of the grids
  double per_particle = 0;        ///< of each frame in flight
  double per_particle_image = 0;  ///< and for each image of it
  double per_contact = 0;
  double per_contact_image = 0;
  double per_voxel = 0;   ///< the sums, what one frame keeps, the fields at hand, the flow that carries tracers
  double per_tracer = 0;  ///< its seed, its state, and its sample on the way into files

  double peak(const RunSize& size) const;

  double program = 0;            ///< of what is fixed, that which does not depend on the pipeline
  double per_particle_read = 0;  ///< of each frame as it was read
  double per_contact_read = 0;

  /// What so many runs side by side (run_scales) take more than the sum of what each of them takes alone, where
  /// particles and contacts are those of the largest frame as it is read: they have one program, but keep up to
  /// frames_in_flight frames that some of them have had and others have not.
  double more_than_sum(std::size_t runs, double particles, double contacts) const;
};

/// What is read ahead: limits.frames_in_flight, or else one more than there are threads, 8 at most.
std::size_t frames_in_flight(const Limits& limits);

/// RunSize::images: an image of a particle is within reach of the box where it is within one cutoff of it. Over planes
/// that counts along their normal alone.
double images_per_particle(const Lattice& lattice, const Pipeline& pipeline);

MemoryModel memory_model(const Plan& plan, const Pipeline& pipeline);

/// The formula with its numbers.
std::string to_string(const MemoryModel& model);
/// What its letters mean.
std::string symbols(const MemoryModel& model);
/// The formula for so many runs side by side, of which each has its own.
std::string to_string_of_all(const MemoryModel& model, std::size_t runs);

}  // namespace grainvdb
