#pragma once
/// Small random packings that reach into the corners: periodic images, walls that are no material, voids, stray
/// particles, positions outside the periodic bounds, sparse ids, particles that come and go between frames.
#include <string>
#include <vector>

#include "grainvdb/frame.hpp"
#include "grainvdb/pipeline.hpp"

namespace grainvdb::testing {

/// Frames and the lattice on which to look at them.
struct Scene {
  std::string name;
  std::vector<Frame> frames;
  double voxel = 0;
  Vec3 origin{};
  double cutoff = 0;
  Selection select;

  /// A pipeline on this lattice with default options, but exact line integrals: what a brute force can know.
  Pipeline pipeline(std::vector<std::string> fields) const;
};

/// A periodic box of 13 × 12 × 15 voxels, densely filled, c = 5.4 h.
Scene periodic_scene();
/// Periodic in x and y, open along z; wall grains of types 2 and 3 that are no material; one stray grain above.
Scene walled_scene();
/// A periodic box of 21 × 18 × 20 voxels with a few grains and c = 1.9 h: mostly rims.
Scene dilute_scene();

/// So many frames of a scene: its own, then these again with the particles moved by less than half a voxel and with
/// other velocities.
Scene moving(Scene scene, std::size_t count);

/// Appends a particle. Ids must ascend.
void add_particle(Particles& p, std::int64_t id, int type, const Vec3& x, const Vec3& v, const Vec3& spin,
                  double radius, double mass);
/// Appends a contact.
void add_contact(Contacts& c, std::int64_t id1, std::int64_t id2, const Vec3& force, const Vec3& point);

}  // namespace grainvdb::testing
