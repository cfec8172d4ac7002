#pragma once
/// Mirror images of particles and half branches behind planes.
#include <vector>

#include "grainvdb/frame.hpp"
#include "grainvdb/moment.hpp"
#include "grainvdb/walls.hpp"

namespace grainvdb {

class Mirror {
 public:
  /// Planes with directions of unit length, each two of which are perpendicular or face each other: then the images of
  /// images are the same in whatever order they are made, and those between planes that face each other lie deeper each
  /// time. Images are made of what lies less than `depth` from a plane.
  Mirror(const std::vector<Wall>& planes, double depth);

  double depth() const { return depth_; }

  /// Adds images after the rest: place, velocity and force are reflected, the angular velocity as the pseudo-vector
  /// that it is; id, type, radius and mass are the same. A half branch has images where either end lies less than
  /// `depth` from a plane, also a little behind it.
  void add_images(Particles& particles) const;
  void add_images(HalfBranches& branches) const;

 private:
  std::vector<std::vector<Wall>> groups_;  // of one plane, or two that face each other
  double depth_;
};

}  // namespace grainvdb
